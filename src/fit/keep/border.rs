//! Where the kept triangles end.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::choose::Kept;
use crate::mesh::edges::{Edges, Union};
use crate::mesh::{ClosestTree, Shape};

/// No component.
pub(super) const NONE: u32 = u32::MAX;

/// How often the nearest points of an edge and of the border are found from each other.
const ROUNDS: usize = 4;

/// One edge of the border, in the direction of its kept triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Where it begins, a vertex of the source.
    pub from: u32,
    /// Where it ends.
    pub to: u32,
    /// Its kept triangle.
    pub facet: u32,
    /// The loop that it is part of.
    pub ring: u32,
    /// How far along the loop it begins, model units.
    pub start: f64,
}

/// The border of the kept triangles, as closed loops.
pub(super) struct Border {
    /// All edges, loop after loop, each loop in order.
    pub segments: Vec<Segment>,
    /// First segment of each loop, and one more.
    pub starts: Vec<u32>,
    /// Length of each loop, model units.
    pub lengths: Vec<f64>,
    /// The connected part of each triangle; [`NONE`] for those not kept.
    pub component: Vec<u32>,
    tree: ClosestTree<[DVec3; 2]>,
}

/// A point on the border.
#[derive(Debug, Clone, Copy)]
pub(super) struct OnBorder {
    pub at: DVec3,
    pub segment: u32,
    /// How far it is from the edge that it is to cut.
    pub off: f64,
}

impl Border {
    /// The border of `kept`, which must be tidy.
    pub(super) fn new(kept: &Kept) -> Self {
        let facets = kept.facets();
        let triangles: Vec<[u32; 3]> = facets.iter().map(|&t| kept.corners(t)).collect();
        let edges = Edges::new(&triangles, kept.mesh.positions.len());
        let mut union = Union::new(facets.len());
        let mut leaving: FxHashMap<u32, (u32, u32)> = FxHashMap::default();
        let mut order: Vec<u32> = Vec::new();
        edges.each(|edge| {
            let mut halves = edge.halves();
            match (halves.next(), halves.next()) {
                (Some(a), Some(b)) => drop(union.join(a / 3, b / 3)),
                (Some(a), None) => {
                    let t = triangles[a as usize / 3];
                    let (from, to) = (t[a as usize % 3], t[(a as usize + 1) % 3]);
                    leaving.insert(from, (to, facets[a as usize / 3]));
                    order.push(from);
                }
                _ => {}
            }
        });
        let mut component = vec![NONE; kept.is.len()];
        for (n, &facet) in (0..).zip(&facets) {
            component[facet as usize] = facets[union.root(n) as usize];
        }
        let mut border = Self {
            segments: Vec::with_capacity(order.len()),
            starts: vec![0],
            lengths: Vec::new(),
            component,
            tree: ClosestTree::new(Vec::new()),
        };
        for first in order {
            border.walk(kept, first, &mut leaving);
        }
        let ends = |s: &Segment| [s.from, s.to].map(|v| kept.mesh.positions[v as usize]);
        border.tree = ClosestTree::new(border.segments.iter().map(ends).collect());
        border
    }

    /// Adds the loop that leaves `first`, unless it is there.
    fn walk(&mut self, kept: &Kept, first: u32, leaving: &mut FxHashMap<u32, (u32, u32)>) {
        let at = |v: u32| kept.mesh.positions[v as usize];
        let (mut from, mut start, ring) = (first, 0.0, self.lengths.len() as u32);
        while let Some((to, facet)) = leaving.remove(&from) {
            self.segments.push(Segment { from, to, facet, ring, start });
            start += at(from).distance(at(to));
            from = to;
        }
        if start > 0.0 {
            self.lengths.push(start);
            self.starts.push(self.segments.len() as u32);
        }
    }

    /// The segments of a loop.
    pub(super) fn ring(&self, ring: u32) -> &[Segment] {
        &self.segments[self.starts[ring as usize] as usize..self.starts[ring as usize + 1] as usize]
    }

    /// The component whose border is nearest to `p`, if that is not farther than `limit`.
    pub(super) fn component_near(&self, p: DVec3, limit: f64) -> Option<u32> {
        let nearest = self.tree.nearest_within(p, limit)?;
        Some(self.component[self.segments[nearest.id as usize].facet as usize])
    }

    /// Where the border passes the edge from `a` to `b`.
    pub(super) fn crossing(&self, a: DVec3, b: DVec3) -> Option<OnBorder> {
        let edge = [a, b];
        let mut on_edge = (a + b) / 2.0;
        let mut found = None;
        for _ in 0..ROUNDS {
            let nearest = self.tree.nearest(on_edge)?;
            on_edge = edge.nearest(nearest.point).0;
            found = Some(OnBorder { at: nearest.point, segment: nearest.id, off: nearest.point.distance(on_edge) });
        }
        found
    }
}
