//! Regions of the plane, with holes, cut into triangles without new vertices; exactly.
//!
//! A hole is joined to what lies on its right by a bridge from its last vertex (by x, then y) to the nearest vertex beyond that is seen from there. The faces on
//! the left of all edges and of both sides of the bridges are then polygons without holes, whose ears are clipped.

use std::cmp::Ordering;

use glam::DVec2;

use super::polygon::clip_ears;
use crate::mesh::predicates::side_of_line;

/// The triangles, counter-clockwise, of what lies on the left of directed edges, of which as many arrive at each vertex as leave it. `None` where edges cross or
/// touch elsewhere than at a vertex that they share, or where they enclose something on their right that is not enclosed on their left.
pub(crate) fn region(points: &[DVec2], edges: &[[u32; 2]]) -> Option<Vec<[u32; 3]>> {
    if any_meet(points, edges) {
        return None;
    }
    let mut sides = edges.to_vec();
    for face in Faces::new(points, edges).all()? {
        if is_hole(points, &face) {
            let bridge = bridge(points, &face, &sides)?;
            sides.extend([bridge, [bridge[1], bridge[0]]]);
        }
    }
    let mut triangles = Vec::new();
    for face in Faces::new(points, &sides).all()? {
        if face.len() < 3 || is_hole(points, &face) {
            return None;
        }
        let around: Vec<DVec2> = face.iter().map(|&v| points[v as usize]).collect();
        triangles.extend(clip_ears(&around)?.into_iter().map(|corners| corners.map(|k| face[k as usize])));
    }
    let has_area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| points[v as usize]);
        side_of_line(a, b, c) > 0.0
    };
    triangles.iter().all(has_area).then_some(triangles)
}

/// The order in which vertices come from left to right.
fn along(a: DVec2, b: DVec2) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

/// Edges by the vertex that they leave.
struct Faces<'a> {
    points: &'a [DVec2],
    edges: &'a [[u32; 2]],
    /// For each vertex where its edges begin in `leaving`.
    starts: Vec<u32>,
    leaving: Vec<u32>,
}

impl<'a> Faces<'a> {
    fn new(points: &'a [DVec2], edges: &'a [[u32; 2]]) -> Self {
        let mut leaving: Vec<u32> = (0..edges.len() as u32).collect();
        leaving.sort_by_key(|&e| edges[e as usize]);
        let mut starts = vec![0; points.len() + 1];
        edges.iter().for_each(|edge| starts[edge[0] as usize + 1] += 1);
        (0..points.len()).for_each(|v| starts[v + 1] += starts[v]);
        Self { points, edges, starts, leaving }
    }

    /// The closed ways around the faces on the left of the edges; `None` where a way ends.
    fn all(&self) -> Option<Vec<Vec<u32>>> {
        let mut seen = vec![false; self.edges.len()];
        let mut faces = Vec::new();
        for first in 0..self.edges.len() {
            let (mut at, mut face) = (first, Vec::new());
            while !seen[at] {
                seen[at] = true;
                face.push(self.edges[at][0]);
                at = self.next(at)?;
            }
            if !face.is_empty() {
                faces.push(face);
            }
        }
        Some(faces)
    }

    /// The edge after one on the way around the face on its left: the first that leaves its end clockwise from where it comes from.
    fn next(&self, edge: usize) -> Option<usize> {
        let [from, at] = self.edges[edge];
        let leaving = &self.leaving[self.starts[at as usize] as usize..self.starts[at as usize + 1] as usize];
        let to = |e: u32| self.points[self.edges[e as usize][1] as usize];
        let (back, middle) = (self.points[from as usize], self.points[at as usize]);
        let before = |&a: &u32, &b: &u32| clockwise(middle, back, to(a), to(b));
        leaving.iter().copied().min_by(before).map(|e| e as usize)
    }
}

/// Which of two directions comes first on the way around `middle`, clockwise from `back`; `back` itself comes last.
fn clockwise(middle: DVec2, back: DVec2, a: DVec2, b: DVec2) -> Ordering {
    let part = |p: DVec2| match side_of_line(middle, back, p) {
        side if side < 0.0 => 0,
        side if side > 0.0 => 2,
        _ if (back - middle).dot(p - middle) < 0.0 => 1,
        _ => 3,
    };
    part(a).cmp(&part(b)).then_with(|| side_of_line(middle, a, b).total_cmp(&0.0))
}

/// Whether what is on the left of a face is its outside: at its last vertex it turns clockwise.
fn is_hole(points: &[DVec2], face: &[u32]) -> bool {
    let at = |k: usize| points[face[k % face.len()] as usize];
    let Some(last) = face.iter().map(|&v| points[v as usize]).max_by(|a, b| along(*a, *b)) else { return false };
    let turn = |k: usize| side_of_line(at(k + face.len() - 1), at(k), at(k + 1));
    (0..face.len()).any(|k| at(k) == last && turn(k) < 0.0)
}

/// An edge from the last vertex of a hole to the nearest vertex beyond that is seen from there.
fn bridge(points: &[DVec2], hole: &[u32], sides: &[[u32; 2]]) -> Option<[u32; 2]> {
    let from = hole.iter().copied().max_by(|a, b| along(points[*a as usize], points[*b as usize]))?;
    let at = points[from as usize];
    let mut beyond: Vec<u32> = sides.iter().map(|side| side[0]).collect();
    beyond.retain(|&v| along(points[v as usize], at) == Ordering::Greater);
    beyond.sort_unstable();
    beyond.dedup();
    while !beyond.is_empty() {
        let far = |k: &usize| points[beyond[*k] as usize].distance_squared(at);
        let nearest = (0..beyond.len()).min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let to = beyond.swap_remove(nearest);
        if !sides.iter().any(|&side| meet(points, [from, to], side)) {
            return Some([from, to]);
        }
    }
    None
}

/// Whether two edges meet elsewhere than at a vertex that they share.
fn meet(points: &[DVec2], [p, q]: [u32; 2], [r, s]: [u32; 2]) -> bool {
    let [a, b, c, d] = [p, q, r, s].map(|v| points[v as usize]);
    if a.min(b).cmpgt(c.max(d)).any() || c.min(d).cmpgt(a.max(b)).any() {
        return false;
    }
    let beside = |shared: DVec2, own: DVec2, other: DVec2| {
        side_of_line(shared, own, other) == 0.0 && (own - shared).dot(other - shared) > 0.0
    };
    match (p == r, p == s, q == r, q == s) {
        (true, _, _, true) | (_, true, true, _) => return true,
        (true, ..) => return beside(a, b, d),
        (_, true, ..) => return beside(a, b, c),
        (_, _, true, _) => return beside(b, a, d),
        (_, _, _, true) => return beside(b, a, c),
        _ => {}
    }
    let apart = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    !apart(side_of_line(a, b, c), side_of_line(a, b, d)) && !apart(side_of_line(c, d, a), side_of_line(c, d, b))
}

/// Whether any two of these edges meet elsewhere than at a vertex that they share.
fn any_meet(points: &[DVec2], edges: &[[u32; 2]]) -> bool {
    // A direction along which few rims run, so that few edges are looked at together.
    let skew = DVec2::new(0.876, 0.482);
    let size = points.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
    let rounding = 16.0 * f64::EPSILON * size;
    let range = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|v| skew.dot(points[v as usize]));
        [a.min(b) - rounding, a.max(b) + rounding]
    };
    let mut order: Vec<([f64; 2], [u32; 2])> = edges.iter().map(|edge| (range(edge), *edge)).collect();
    order.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.1.cmp(&b.1)));
    let mut active: Vec<([f64; 2], [u32; 2])> = Vec::new();
    for (range, edge) in order {
        active.retain(|other| other.0[1] >= range[0]);
        if active.iter().any(|other| meet(points, edge, other.1)) {
            return true;
        }
        active.push((range, edge));
    }
    false
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ring(points: &mut Vec<DVec2>, edges: &mut Vec<[u32; 2]>, corners: &[[f64; 2]]) {
        let (first, count) = (points.len() as u32, corners.len() as u32);
        points.extend(corners.iter().map(|&p| DVec2::from_array(p)));
        edges.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
    }

    fn square(low: [f64; 2], side: f64) -> [[f64; 2]; 4] {
        let [x, y] = low;
        [[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    }

    fn area(points: &[DVec2], triangles: &[[u32; 3]]) -> f64 {
        let corners = triangles.iter().map(|t| t.map(|v| points[v as usize]));
        corners.map(|[a, b, c]| (b - a).perp_dot(c - a) / 2.0).sum()
    }

    /// Each edge of the region has one triangle on its left, and each other edge one on either side.
    fn check(points: &[DVec2], edges: &[[u32; 2]], triangles: &[[u32; 3]]) {
        let mut sides: Vec<[u32; 2]> =
            triangles.iter().flat_map(|t| (0..3).map(move |k| [t[k], t[(k + 1) % 3]])).collect();
        sides.sort_unstable();
        assert!(sides.windows(2).all(|pair| pair[0] != pair[1]));
        let has = |edge: [u32; 2]| sides.binary_search(&edge).is_ok();
        for &[a, b] in &sides {
            assert!(has([b, a]) != edges.contains(&[a, b]), "{a} {b} of {points:?}");
        }
        assert!(edges.iter().all(|&edge| has(edge)));
    }

    #[test]
    fn a_square_with_holes_and_an_island_in_one_of_them() {
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        ring(&mut points, &mut edges, &square([0.0, 0.0], 10.0));
        for (low, side) in [([1.0, 1.0], 2.0), ([1.0, 4.0], 5.0), ([7.0, 1.0], 1.0)] {
            let mut hole = square(low, side);
            hole.reverse();
            ring(&mut points, &mut edges, &hole);
        }
        ring(&mut points, &mut edges, &square([2.0, 5.0], 3.0));
        let triangles = region(&points, &edges).expect("nothing crosses");
        check(&points, &edges, &triangles);
        assert_eq!(area(&points, &triangles), 100.0 - 4.0 - 25.0 - 1.0 + 9.0);
    }

    #[test]
    fn what_crosses_touches_or_encloses_the_outside_has_no_triangles() {
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        ring(&mut points, &mut edges, &square([0.0, 0.0], 2.0));
        ring(&mut points, &mut edges, &square([1.0, 1.0], 2.0));
        assert_eq!(region(&points, &edges), None);
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        ring(&mut points, &mut edges, &square([0.0, 0.0], 2.0));
        ring(&mut points, &mut edges, &[[2.0, 1.0], [3.0, 0.0], [3.0, 2.0]]);
        assert_eq!(region(&points, &edges), None);
        let mut around = square([0.0, 0.0], 2.0);
        around.reverse();
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        ring(&mut points, &mut edges, &around);
        assert_eq!(region(&points, &edges), None);
    }

    proptest! {
        /// Cells of a grid: many edges lie on one line, holes touch at corners and lie in one another.
        #[test]
        fn any_cells_of_a_grid_are_covered(taken in prop::collection::vec(any::<bool>(), 36)) {
            let is = |x: i32, y: i32| (0..6).contains(&x) && (0..6).contains(&y) && taken[(6 * y + x) as usize];
            let points: Vec<DVec2> = (0..49).map(|n| DVec2::new(f64::from(n % 7), f64::from(n / 7))).collect();
            let mut edges = Vec::new();
            for n in 0..36 {
                let (x, y) = (n % 6, n / 6);
                if !is(x, y) {
                    continue;
                }
                let v = |x: i32, y: i32| (7 * y + x) as u32;
                let beside = [
                    (is(x, y - 1), [v(x, y), v(x + 1, y)]),
                    (is(x + 1, y), [v(x + 1, y), v(x + 1, y + 1)]),
                    (is(x, y + 1), [v(x + 1, y + 1), v(x, y + 1)]),
                    (is(x - 1, y), [v(x, y + 1), v(x, y)]),
                ];
                edges.extend(beside.into_iter().filter(|side| !side.0).map(|side| side.1));
            }
            let triangles = region(&points, &edges).expect("nothing crosses");
            check(&points, &edges, &triangles);
            prop_assert_eq!(area(&points, &triangles), taken.iter().filter(|taken| **taken).count() as f64);
        }
    }
}
