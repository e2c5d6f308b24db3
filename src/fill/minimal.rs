//! Triangles over one loop without new vertices, of least weight.
//!
//! Barequet and Sharir (Filling gaps in the boundary of a polyhedron, 1995) triangulate a loop in space as one triangulates a polygon: the best way for the part from
//! point i to point j is a triangle over the chord from i to j with a point m between them, and the best ways for the parts from i to m and from m to j. All parts are done by
//! growing length, in time of the third power of the number of points. Liepa (Filling holes in meshes, 2003) judges by the largest angle by which two triangles that share an
//! edge are bent against each other, also across the rim, and between equals by the area. Where the rim itself is bent, as at an edge of the surface, one such angle is large in any case, and then the area alone decides: the
//! edge is cut off. So the bends are summed here, one minus the cosine times the length of the edge, and the area with them.
//!
//! Loops that are too long for the third power are done in two steps: some points, evenly chosen along the loop, are triangulated first, and then
//! every part of the loop between two of them against its chord. For n points that are √n parts of √n points each, and the time is that of the second power of n.

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::boundary::{Boundary, normal, on_a_line};

/// Loops of up to so many points are done at once.
pub(super) const AT_ONCE: usize = 160;

/// What a bend weighs: the area of a strip so many times as wide as the loop for each unit of (1 − cosine), along the edge. With 1 and with 4
/// lids over bent rims are alike; at the rim of a cylinder 4 is better.
const BEND: f64 = 4.0;

/// The share of the squares of the edges beside the area: it decides where all ways have the same area.
const SHAPE: f64 = 0.01;

/// How bad a triangulation is: the parts count in their order.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Weight {
    /// Triangles without an area, and edges that the mesh has already.
    wrong: u32,
    /// Bends, area and shape.
    sum: f64,
}

/// Nothing to object.
const NOTHING: Weight = Weight { wrong: 0, sum: 0.0 };

impl Weight {
    fn and(self, other: Self) -> Self {
        Self { wrong: self.wrong + other.wrong, sum: self.sum + other.sum }
    }
}

/// The best way over the part of a loop between two points.
#[derive(Debug, Clone, Copy)]
struct Part {
    weight: Weight,
    /// The third corner of the triangle over the chord.
    apex: u32,
    /// Unit normal of that triangle, or of the one beside the rim.
    normal: DVec3,
}

/// The triangles over the rim, in numbers of its points. They may be wrong (without an area, or over an edge that the mesh has) only where the loop leaves no other
/// way, or where it is too long to try all.
pub(super) fn triangulate(boundary: &Boundary) -> Vec<[u32; 3]> {
    let beside: Vec<DVec3> = (0..boundary.len()).map(|edge| boundary.normal_beside(edge)).collect();
    let mut triangles = Vec::with_capacity(boundary.len() - 2);
    let all: Vec<u32> = (0..boundary.len() as u32).collect();
    of_loop(&Task { joined: &boundary.joined, places: &boundary.points }, &all, &beside, &mut triangles);
    triangles
}

/// The triangles over several loops that share points, which may be others than those of the rim. Each loop comes with the normals across its edges, zero where none is known. No
/// two loops get the same edge, nor one of those pairs of points that are `joined`.
pub(super) fn of_loops(
    mut joined: FxHashSet<[u32; 2]>,
    places: &[DVec3],
    loops: &[(Vec<u32>, Vec<DVec3>)],
) -> Vec<[u32; 3]> {
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for (points, beside) in loops {
        let first = triangles.len();
        of_loop(&Task { joined: &joined, places }, points, beside, &mut triangles);
        let edges = triangles[first..].iter().flat_map(|t| (0..3).map(|k| [t[k], t[(k + 1) % 3]]));
        joined.extend(edges.map(|[a, b]| [a.min(b), a.max(b)]));
    }
    triangles
}

/// What is asked of all loops of a rim.
#[derive(Clone, Copy)]
struct Task<'a> {
    /// Pairs of points, the smaller number first, that are joined already.
    joined: &'a FxHashSet<[u32; 2]>,
    /// Where all points are.
    places: &'a [DVec3],
}

fn of_loop(task: &Task<'_>, points: &[u32], beside: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    let count = points.len();
    if count <= AT_ONCE {
        let far = |&v: &u32| task.places[v as usize].distance(task.places[points[0] as usize]);
        let size = points.iter().map(far).fold(0.0, f64::max);
        Table { task: *task, points, parts: Vec::new(), size }.fill(beside, triangles);
        return;
    }
    let parts = ((count as f64).sqrt().ceil() as usize).clamp(3, AT_ONCE);
    let starts: Vec<usize> = (0..=parts).map(|k| k * count / parts).collect();
    let chosen: Vec<u32> = starts[..parts].iter().map(|&k| points[k]).collect();
    let over = |k: usize| beside[starts[k]..starts[k + 1]].iter().sum::<DVec3>().normalize_or_zero();
    let chords: Vec<DVec3> = (0..parts).map(over).collect();
    let first = triangles.len();
    of_loop(task, &chosen, &chords, triangles);
    let mut across = vec![DVec3::ZERO; parts];
    let place: rustc_hash::FxHashMap<u32, usize> = chosen.iter().copied().zip(0..).collect();
    for t in &triangles[first..] {
        for k in 0..3 {
            let (from, to) = (place[&t[k]], place[&t[(k + 1) % 3]]);
            if (from + 1) % parts == to {
                across[from] = normal(t.map(|v| task.places[v as usize]));
            }
        }
    }
    for k in 0..parts {
        let part: Vec<u32> = (starts[k]..=starts[k + 1]).map(|at| points[at % count]).collect();
        if part.len() > 2 {
            let mut beside = beside[starts[k]..starts[k + 1]].to_vec();
            beside.push(across[k]);
            of_loop(task, &part, &beside, triangles);
        }
    }
}

/// The best ways over all parts of a loop.
struct Table<'a> {
    task: Task<'a>,
    points: &'a [u32],
    parts: Vec<Part>,
    /// The largest distance of a point from the first one.
    size: f64,
}

impl Table<'_> {
    fn at(&self, from: usize, to: usize) -> &Part {
        &self.parts[from * self.points.len() + to]
    }

    fn place(&self, k: usize) -> DVec3 {
        self.task.places[self.points[k] as usize]
    }

    /// Finds the best ways and appends the triangles.
    fn fill(&mut self, beside: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
        let count = self.points.len();
        self.parts = vec![Part { weight: NOTHING, apex: 0, normal: DVec3::ZERO }; count * count];
        for (k, &normal) in beside[..count - 1].iter().enumerate() {
            self.parts[k * count + k + 1].normal = normal;
        }
        for length in 2..count {
            for from in 0..count - length {
                let to = from + length;
                let closing = (length == count - 1).then_some(beside[count - 1]);
                self.parts[from * count + to] = self.best(from, to, closing);
            }
        }
        let mut open = vec![[0, count - 1]];
        while let Some([from, to]) = open.pop() {
            if to - from > 1 {
                let apex = self.at(from, to).apex as usize;
                triangles.push([self.points[from], self.points[apex], self.points[to]]);
                open.extend([[apex, to], [from, apex]]);
            }
        }
    }

    /// The best way over the part from one point to another; `closing` is the normal across its chord, if that is known.
    fn best(&self, from: usize, to: usize, closing: Option<DVec3>) -> Part {
        let ends = [self.points[from], self.points[to]];
        let known = closing.is_none() && self.task.joined.contains(&[ends[0].min(ends[1]), ends[0].max(ends[1])]);
        let (a, c) = (self.place(from), self.place(to));
        let mut best: Option<Part> = None;
        for apex in from + 1..to {
            let parts = self.at(from, apex).weight.and(self.at(apex, to).weight);
            if best.is_some_and(|best| parts >= best.weight) {
                continue;
            }
            let b = self.place(apex);
            let cross = (b - a).cross(c - a);
            let length = cross.length();
            let normal = if length > 0.0 { cross / length } else { DVec3::ZERO };
            let mut weight = parts;
            weight.wrong += u32::from(known) + u32::from(on_a_line([a, b, c]));
            let [mut bends, ab, bc, ca] = [0.0, a.distance(b), b.distance(c), c.distance(a)];
            let mut bend = |other: DVec3, length: f64| {
                if other != DVec3::ZERO {
                    bends += length * (1.0 - normal.dot(other)).max(0.0);
                }
            };
            bend(self.at(from, apex).normal, ab);
            bend(self.at(apex, to).normal, bc);
            if let Some(other) = closing {
                bend(other, ca);
            }
            let squares = ab * ab + bc * bc + ca * ca;
            weight.sum += BEND * bends * self.size + length / 2.0 + SHAPE * squares;
            if best.is_none_or(|best| weight < best.weight) {
                best = Some(Part { weight, apex: apex as u32, normal });
            }
        }
        best.unwrap_or(Part { weight: NOTHING, apex: from as u32, normal: DVec3::ZERO })
    }
}
