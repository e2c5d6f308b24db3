//! What is wrong with a mesh, and where.

use super::TriMesh;
use super::edges::{Edges, copies};
use super::self_intersection::intersecting_triangles;
use super::validity::{Indexed, ValidateOptions, degenerate, is_inconsistent};
use crate::progress::{Progress, Stopped};

/// The places of the defects that [`Validity`](super::Validity) counts. Every list is ascending. Edges are pairs of vertex
/// ids, the smaller first; of welded vertices the first one stands for all.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Defects {
    /// Edges with one triangle.
    pub open_edges: Vec<[u32; 2]>,
    /// Edges with more than two triangles.
    pub nonmanifold_edges: Vec<[u32; 2]>,
    /// Vertices whose triangles form more than one fan.
    pub nonmanifold_vertices: Vec<u32>,
    /// Edges with an even number of triangles of which not exactly half run each way.
    pub inconsistent_edges: Vec<[u32; 2]>,
    /// Triangles with a repeated index or with collinear corners.
    pub degenerate: Vec<u32>,
    /// Triangles that repeat an earlier one.
    pub duplicates: Vec<u32>,
    /// Triangles that intersect another one; empty if that was not asked for.
    pub self_intersecting: Vec<u32>,
}

/// Finds the defects of `mesh`.
pub fn defects(mesh: &TriMesh, options: &ValidateOptions, progress: &Progress) -> Result<Defects, Stopped> {
    progress.check()?;
    let indexed = Indexed::new(mesh, options.weld);
    let edges = Edges::new(&indexed.triangles, mesh.positions.len());
    let mut found = Defects::default();
    edges.each(|edge| {
        match edge.count() {
            1 => found.open_edges.push(edge.ends),
            2 => {}
            _ => found.nonmanifold_edges.push(edge.ends),
        }
        if is_inconsistent(&edges, &edge) {
            found.inconsistent_edges.push(edge.ends);
        }
    });
    let fans = edges.connectivity().fans;
    found.nonmanifold_vertices = (0u32..).zip(&fans).filter(|&(_, &fans)| fans > 1).map(|(v, _)| v).collect();
    found.degenerate = degenerate(mesh, &indexed.triangles).collect();
    found.duplicates = copies(&indexed.triangles, mesh.positions.len()).iter().map(|&[copy, _]| copy).collect();
    if options.self_intersections {
        found.self_intersecting = intersecting_triangles(mesh, progress)?;
    }
    Ok(found)
}
