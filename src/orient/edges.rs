//! Half-edges of a soup, sorted so that those of one edge stand together.

use rayon::prelude::*;

/// Edges with more triangles than this are left out of decisions about single triangles.
pub(super) const UNIQUE_EDGE_LIMIT: usize = 16;

/// One side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct HalfEdge {
    /// The two vertices, smaller first.
    pub ends: [u32; 2],
    /// The triangle.
    pub triangle: u32,
    /// Whether the triangle runs from the smaller vertex to the larger.
    pub forward: bool,
}

/// All half-edges of the triangles, sorted by edge.
pub(super) fn sorted_half_edges(triangles: &[[u32; 3]]) -> Vec<HalfEdge> {
    let mut all: Vec<HalfEdge> = triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(t, &[a, b, c])| {
            [(a, b), (b, c), (c, a)].map(|(from, to)| HalfEdge {
                ends: [from.min(to), from.max(to)],
                triangle: t as u32,
                forward: from < to,
            })
        })
        .collect();
    all.par_sort_unstable();
    all
}
