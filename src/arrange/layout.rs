//! The points of a sheet, ready to be triangulated.

use rustc_hash::FxHashMap;

use super::flat::FlatPoints;
use super::planar::Planar;
use super::plane::Plane;
use super::point::Points;

/// Beyond all lattice points: the corners of a triangle around them.
const BEYOND: [[i64; 2]; 3] = [[-(1 << 33), -(1 << 32)], [1 << 33, -(1 << 32)], [0, 1 << 33]];

/// Points of a plane, and the triangle that their triangulation grows in. They are in the order of their places, not of their numbers, and
/// are seen from the tip of an axis, whichever way the plane faces: where several triangulations are as good, the result must not depend on the order
/// of the input, nor on which of two facets that face each other comes first.
#[derive(Debug)]
pub(super) struct Layout {
    numbers: Vec<u32>,
    /// Whether facets of the plane run clockwise as they are seen here.
    reversed: bool,
    local: FxHashMap<u32, u32>,
    flat: FlatPoints,
    root: [u32; 3],
}

impl Layout {
    /// Points by their numbers. `facet`: the corners of one, counted among the points, that all of them lie in; without one the triangulation grows in a triangle around all that there can be, whose corners come after all points.
    pub(super) fn new(points: &Points, mut numbers: Vec<u32>, plane: &Plane, facet: Option<[u32; 3]>) -> Self {
        numbers.extend(facet.into_iter().flatten());
        numbers.sort_unstable();
        numbers.dedup();
        numbers.sort_by(|&a, &b| {
            (0..3).map(|axis| points.compare_along(a, b, axis)).find(|order| order.is_ne()).unwrap_or(a.cmp(&b))
        });
        let local: FxHashMap<u32, u32> = numbers.iter().zip(0..).map(|(&number, n)| (number, n)).collect();
        let axis = plane.axis();
        let reversed = plane.normal[axis] < 0;
        let mut flat = FlatPoints::new(points, &numbers, axis);
        let root = match facet {
            Some(corners) => {
                let corners = turned(corners, reversed).map(|v| local[&v]);
                let first = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
                [0, 1, 2].map(|n| corners[(first + n) % 3])
            }
            None => BEYOND.map(|[x, y]| flat.push(x, y)),
        };
        Self { numbers, reversed, local, flat, root }
    }

    /// A triangulation with all points in it.
    pub(super) fn planar(&self) -> Planar<'_> {
        let mut planar = Planar::new(&self.flat, self.root);
        (0..self.numbers.len() as u32).filter(|p| !self.root.contains(p)).for_each(|p| planar.insert(p));
        planar
    }

    /// The place of a point in the triangulation.
    pub(super) fn local(&self, number: u32) -> u32 {
        self.local[&number]
    }

    /// An edge between points by their numbers that has something on its left, seen as the facets of the plane are, in the triangulation.
    pub(super) fn local_edge(&self, [u, v]: [u32; 2]) -> [u32; 2] {
        let [u, v] = [u, v].map(|p| self.local(p));
        if self.reversed { [v, u] } else { [u, v] }
    }

    /// The numbers of a triangle's points, counter-clockwise seen as the facets of the plane are.
    pub(super) fn named(&self, corners: [u32; 3]) -> [u32; 3] {
        turned(corners.map(|v| self.numbers[v as usize]), self.reversed)
    }
}

fn turned([a, b, c]: [u32; 3], reversed: bool) -> [u32; 3] {
    if reversed { [a, c, b] } else { [a, b, c] }
}
