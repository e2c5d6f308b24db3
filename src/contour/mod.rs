//! From signs on the lattice to a closed surface: the dual of the cuberille (Bærentzen §5).
//!
//! The voxels inside are seen as cubes; shared faces vanish, and cubes that share only an edge or a
//! corner are separated. The surface is the dual of what is left: a vertex for each lattice edge
//! whose ends differ in sign, and one polygon or more for each cell.
//!
//! Why the result is closed, oriented, 2-manifold and free of self-intersection for *every* pattern
//! of signs: a polygon's sides lie in the faces of its cell and are chosen there by a rule that
//! both cells of the face see alike; no diagonal lies in a face; so triangles of different cells
//! meet only in vertices and sides that they share, and what is left to check, exactly, is each
//! cell for itself. Rounding to `f32` keeps this, because it is monotone in each coordinate: the
//! lattice stays a lattice of boxes, as long as `h` is some ulp (of `f32`, at the largest
//! coordinate) wide.
//!
//! A distance of exactly 0 counts as outside, and so does every voxel beyond [`Lattice::dims`](crate::lattice::Lattice::dims).

mod bodies;
mod cells;
mod collapse;
mod groups;
mod merging;
mod place;
mod signs;
mod star;
mod table;
mod vertices;

pub use collapse::collapse_same_voxel;

use glam::IVec3;
use rayon::prelude::*;

use crate::lattice::DistanceField;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// The exact crossing of the surface with a lattice edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Place on the edge: 0 at its lower voxel, 1 at its upper one.
    pub t: f64,
    /// The triangle of the input that is crossed, where it is one.
    pub triangle: Option<u32>,
}

/// The lattice edge from `voxel` to the next voxel along `axis`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LatticeEdge {
    /// The voxel at its lower end.
    pub voxel: IVec3,
    /// The axis along which it runs: 0, 1 or 2 for x, y or z.
    pub axis: u8,
}

/// Options of [`contour`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourOptions {
    /// Vertices keep this distance from the ends of their lattice edge, in h (0 to 0.5). At 0
    /// triangles can degenerate.
    pub margin: f64,
}

impl Default for ContourOptions {
    fn default() -> Self {
        Self { margin: 0.01 }
    }
}

/// What a vertex of a contour lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Ground {
    /// Nothing that is known: no triangle was crossed there.
    #[default]
    Unknown,
    /// The triangle of the input with this number.
    Triangle(u32),
    /// A plane where the input has no triangle, by its number in a list that comes with the contour: the lid over a hole, or
    /// the tangent plane of a level.
    Plane(u32),
}

/// Where a vertex comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContourVertex {
    /// What the vertex lies on.
    pub ground: Ground,
    /// The voxel inside the solid to whose cube it belongs.
    pub voxel: IVec3,
    /// The voxel at the other end of its lattice edge, outside of the solid.
    pub outside: IVec3,
}

/// A contoured surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Contour {
    /// The surface, model units. Every coordinate is exactly an `f32`.
    pub mesh: TriMesh,
    /// Where each vertex of the mesh comes from.
    pub vertices: Vec<ContourVertex>,
    /// Loops that had no triangulation free of folds. Not seen yet; if it is not 0, the mesh may
    /// intersect itself there.
    pub folded_loops: usize,
}

/// Which vertices are merged: those of which voxels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Merge {
    /// Those of every voxel, as in the paper.
    All,
    /// Those of voxels whose vertices lie nearly in one plane, so that merging them loses nothing.
    Flat {
        /// How far the merged vertex may lie beside the planes, h.
        within: f64,
    },
}

/// What [`collapse_same_voxel`] made of a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct Collapsed {
    /// The coarser contour. The voxel of a vertex stays the one it belongs to.
    pub contour: Contour,
    /// The raw vertices that became vertex v: `members[starts[v]..starts[v + 1]]` in `raw`.
    pub starts: Vec<u32>,
    /// The numbers of raw vertices, vertex after vertex of the merged contour; `starts` says where each one's begin.
    pub members: Vec<u32>,
    /// The vertices of the raw contour.
    pub raw: Vec<ContourVertex>,
    /// Voxels whose vertices became one.
    pub merged: usize,
    /// Voxels whose vertices stayed apart, because merging them would have made the mesh
    /// non-manifold, turned a triangle over, or made triangles intersect.
    pub kept_apart: usize,
}

/// The surface between the voxels of negative `distance` and the others.
///
/// The signs of `distance` decide, and its values choose the triangulations. `crossing` gives
/// the exact place of the surface on a lattice edge whose ends differ; where it gives none, the
/// place is interpolated from the distances. Wherever two neighbouring voxels differ in sign, both
/// must lie in active bricks or one of them beyond the lattice and the other in an active brick.
///
/// The order of vertices and triangles is that of bricks, voxels and axes. Bærentzen §5.
pub fn contour(
    distance: &DistanceField,
    crossing: &(impl Fn(LatticeEdge) -> Option<Crossing> + Sync),
    options: &ContourOptions,
    progress: &Progress,
) -> Result<Contour, Stopped> {
    let DistanceField { lattice, grid: distance, .. } = distance;
    let signs = signs::Signs::new(lattice, distance);
    let crossed: Vec<signs::Crossed> = signs.bricks.par_iter().map(|b| signs::Crossed::new(&signs, b)).collect();
    let first: Vec<u32> = crossed
        .iter()
        .scan(0, |sum, c| {
            let first = *sum;
            *sum += c.count;
            Some(first)
        })
        .collect();
    progress.check()?;
    let vertices = vertices::vertices(lattice, distance, crossing, options, (&signs, &crossed), progress)?;
    let tables = cells::Tables { signs: &signs, crossed: &crossed, first: &first, vertices: &vertices, distance };
    let (triangles, folded_loops) = cells::triangles(&tables, progress)?;
    let mesh = TriMesh { positions: vertices.positions, triangles };
    Ok(Contour { mesh, vertices: vertices.sources, folded_loops })
}
