//! A band between two rims that face each other: where a seam is torn open all around, a ring is missing, or a wall has lost its end.
//!
//! Zou, Ju and Carr (An algorithm for triangulating multiple 3D polygons, 2013) triangulate several loops at once. Of two loops that a band joins every triangle has an edge of one loop
//! and a vertex of the other, so that the best band is a shortest way through the pairs of their vertices (Fuchs, Kedem and Uselton 1977), from the pair that is nearest to each other once around
//! to the same pair. A step is a triangle; it weighs as in a lid: the bends against the triangle before it and that beside its rim, and its area.

use glam::DVec3;

use super::boundary::{normal, on_a_line};
use super::refine::area;
use super::{Boundary, Lid, NoLid, Rim, Style, Surroundings};

/// Up to so many pairs of vertices the best band is found; between longer rims every step is the one over the shorter edge.
const ALL_PAIRS: usize = 1 << 21;

/// What a bend weighs: the area of a strip so many times as wide as the gap for each unit of (1 − cosine), along the edge.
const BEND: f64 = 1.0;

/// What a triangle without an area weighs: more than any other.
const FLAT: f64 = 1e9;

/// Which rim a step goes on along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    First = 0,
    Second = 1,
}

/// The points of two rims, the second one against its direction, from the pair that is nearest to each other. Both come to their first point again at the end.
struct Strip {
    /// Numbers in the mesh.
    vertices: [Vec<u32>; 2],
    /// Places, scaled by a power of two.
    points: [Vec<DVec3>; 2],
    /// For each edge the unit normal of the triangle beside it, or zero.
    beside: [Vec<DVec3>; 2],
    scale: f64,
}

/// Joins two rims. The triangles over the edges of the first one are the first lid, those over the edges of the other the second; they have no new vertices.
///
/// # Errors
/// [`NoLid`] where a rim is none of this mesh, where the two share a vertex, or where the band would repeat an edge or have a triangle without an area.
pub fn band(around: &Surroundings<'_>, rims: [&Rim; 2]) -> Result<[Lid; 2], NoLid> {
    if rims[0].vertices.iter().any(|v| rims[1].vertices.contains(v)) {
        return Err(NoLid::NoLoop);
    }
    let strip = Strip::new(around, rims)?;
    let [n, m] = strip.vertices.each_ref().map(|list| list.len() - 1);
    let steps = if n * m <= ALL_PAIRS { strip.best() } else { strip.shortest() };
    let mut lids =
        [(); 2].map(|()| Lid { positions: Vec::new(), triangles: Vec::new(), style: Style::Flat, area: 0.0 });
    let (mut i, mut j) = (0, 0);
    for step in steps {
        let (triangle, places) = (strip.corners(i, j, step), strip.places(i, j, step));
        let joined =
            |v: u32, other: u32| around.of(v).iter().any(|&t| around.mesh().triangles[t as usize].contains(&other));
        if on_a_line(places) {
            return Err(NoLid::NoArea);
        }
        if joined(strip.vertices[0][i], strip.vertices[1][j]) {
            return Err(NoLid::Folded);
        }
        let lid = &mut lids[step as usize];
        lid.triangles.push(triangle);
        lid.area += area(places) / strip.scale / strip.scale;
        (i, j) = next(i, j, step);
    }
    Ok(lids)
}

/// Where a step leads.
fn next(i: usize, j: usize, step: Step) -> (usize, usize) {
    match step {
        Step::First => (i + 1, j),
        Step::Second => (i, j + 1),
    }
}

impl Strip {
    fn new(around: &Surroundings<'_>, rims: [&Rim; 2]) -> Result<Self, NoLid> {
        let bounds = [Boundary::new(around, rims[0])?, Boundary::new(around, rims[1])?];
        let scale = bounds[0].scale.min(bounds[1].scale);
        let place = |v: u32| around.mesh().positions[v as usize] * scale;
        let [first, second] = rims.map(|rim| rim.vertices.iter().map(|&v| place(v)).collect::<Vec<DVec3>>());
        let nearest = |(i, p): (usize, &DVec3)| {
            let away = second.iter().enumerate().map(|(j, q)| (p.distance_squared(*q), j));
            let (away, j) = away.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0));
            (away, i, j)
        };
        let (_, from, to) =
            first.iter().enumerate().map(nearest).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0, 0));
        let (n, m) = (first.len(), second.len());
        let along = |k: usize| (from + k) % n;
        let against = |k: usize| (to + m - k % m) % m;
        // Edge k of a rim runs from its vertex k on: against its direction it is the one that ends there.
        let beside = [
            (0..n).map(|k| bounds[0].normal_beside(along(k))).collect(),
            (0..m).map(|k| bounds[1].normal_beside(against(k + 1))).collect(),
        ];
        Ok(Self {
            vertices: [
                (0..=n).map(|k| rims[0].vertices[along(k)]).collect(),
                (0..=m).map(|k| rims[1].vertices[against(k)]).collect(),
            ],
            points: [(0..=n).map(|k| first[along(k)]).collect(), (0..=m).map(|k| second[against(k)]).collect()],
            beside,
            scale,
        })
    }

    /// The triangle of a step from vertex `i` of the first rim and `j` of the second, in numbers of the mesh.
    fn corners(&self, i: usize, j: usize, step: Step) -> [u32; 3] {
        let [a, b] = &self.vertices;
        match step {
            Step::First => [a[i], a[i + 1], b[j]],
            Step::Second => [b[j + 1], b[j], a[i]],
        }
    }

    fn places(&self, i: usize, j: usize, step: Step) -> [DVec3; 3] {
        let [a, b] = &self.points;
        match step {
            Step::First => [a[i], a[i + 1], b[j]],
            Step::Second => [b[j + 1], b[j], a[i]],
        }
    }

    /// The mean distance from a point of the first rim to the nearest one of the second, or of that to the first, whichever is larger.
    fn gap(&self) -> f64 {
        let mean = |from: &[DVec3], to: &[DVec3]| {
            let nearest = |p: &DVec3| to.iter().map(|q| p.distance_squared(*q)).fold(f64::INFINITY, f64::min).sqrt();
            from.iter().map(nearest).sum::<f64>() / from.len() as f64
        };
        mean(&self.points[0], &self.points[1]).max(mean(&self.points[1], &self.points[0]))
    }

    /// What a step weighs by itself, and the unit normal of its triangle.
    fn weight(&self, i: usize, j: usize, step: Step, bend: f64) -> (f64, DVec3) {
        let places = self.places(i, j, step);
        let own = normal(places);
        let beside = match step {
            Step::First => self.beside[0][i],
            Step::Second => self.beside[1][j],
        };
        match own == DVec3::ZERO {
            true => (FLAT, own),
            false => (area(places) + bend * places[0].distance(places[1]) * bent(own, beside), own),
        }
    }

    /// The steps of least weight.
    fn best(&self) -> Vec<Step> {
        let [n, m] = self.points.each_ref().map(|list| list.len() - 1);
        let bend = BEND * self.gap();
        let at = |i: usize, j: usize| i * (m + 1) + j;
        // For each pair, by the last step: the least weight of a way there, the normal of its last triangle, and its last step but one.
        let mut ways = vec![[Way::NONE; 2]; (n + 1) * (m + 1)];
        ways[0] = [Way { weight: 0.0, ..Way::NONE }; 2];
        for (i, j) in (0..=n).flat_map(|i| (0..=m).map(move |j| (i, j))) {
            let across = bend * self.points[0][i].distance(self.points[1][j]);
            for step in [Step::First, Step::Second] {
                let (to_i, to_j) = next(i, j, step);
                if to_i > n || to_j > m {
                    continue;
                }
                let (own, normal) = self.weight(i, j, step, bend);
                for last in [Step::First, Step::Second] {
                    let way = &ways[at(i, j)][last as usize];
                    let weight = way.weight + own + across * bent(normal, way.normal);
                    let known = &mut ways[at(to_i, to_j)][step as usize];
                    if weight < known.weight {
                        *known = Way { weight, normal, last };
                    }
                }
            }
        }
        let [first, second] = ways[at(n, m)];
        let mut step = if second.weight < first.weight { Step::Second } else { Step::First };
        let (mut i, mut j) = (n, m);
        let mut steps = Vec::with_capacity(n + m);
        while i + j > 0 {
            steps.push(step);
            let last = ways[at(i, j)][step as usize].last;
            match step {
                Step::First => i -= 1,
                Step::Second => j -= 1,
            }
            step = last;
        }
        steps.reverse();
        steps
    }

    /// Steps over the shorter edge each.
    fn shortest(&self) -> Vec<Step> {
        let [a, b] = &self.points;
        let (mut i, mut j) = (0, 0);
        let mut steps = Vec::with_capacity(a.len() + b.len() - 2);
        while i + 1 < a.len() || j + 1 < b.len() {
            let over = |on: bool, p: usize, q: usize| if on { a[p].distance_squared(b[q]) } else { f64::INFINITY };
            let first = over(i + 1 < a.len(), (i + 1).min(a.len() - 1), j);
            let second = over(j + 1 < b.len(), i, (j + 1).min(b.len() - 1));
            let step = if second < first { Step::Second } else { Step::First };
            steps.push(step);
            (i, j) = next(i, j, step);
        }
        steps
    }
}

/// The best way to a pair of vertices with a certain last step.
#[derive(Debug, Clone, Copy)]
struct Way {
    weight: f64,
    /// The unit normal of the last triangle, zero where there is none.
    normal: DVec3,
    /// The step before the last one.
    last: Step,
}

impl Way {
    /// No way is known.
    const NONE: Self = Self { weight: f64::INFINITY, normal: DVec3::ZERO, last: Step::First };
}

/// By how much two triangles are bent against each other, 0 in a plane to 2 folded; 0 where one has no direction.
fn bent(a: DVec3, b: DVec3) -> f64 {
    if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { 1.0 - a.dot(b) }
}
