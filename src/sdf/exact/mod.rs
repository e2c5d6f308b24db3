//! The exact signed distance to a mesh: at any point ([`ExactDistance`]), and over a lattice ([`exact`]).
//!
//! Over a lattice every face, edge and vertex has a region, an intersection of half-spaces that holds all points
//! it can be nearest to: the prism over a face, the wedge at an edge, the cone at a vertex (Sigg et al. 2003 after
//! Mauch). Blocks of voxels are halved from tiles down to eight voxels, with lists of the features whose regions
//! they meet and that can be nearest to one of their points; the few that are left are measured at all eight voxels at
//! once, in single precision about the tile's centre. Where that cannot tell the side of a voxel, double precision does.

mod blocks;
mod cost;
mod descend;
mod feature;
mod of_solid;
mod point;
mod quads;
mod sides;
mod slabs;
mod tiles;

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

pub use blocks::BlockDistance;
pub use cost::{Cost, cost, cost_of_planes};
pub use of_solid::SolidDistance;
pub use point::{ExactDistance, Nearest, PointSign};
pub use slabs::{Slab, Slabs};

use crate::lattice::{BRICK, Bricks, DistanceField, Grid, Lattice, brick_of};
use crate::ldi::Expression;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stopped};
use crate::sdf::Levels;
use crate::vote::{Votes, Winding};
pub(crate) use descend::Filled;
pub(crate) use feature::{EdgeFeature, FaceFeature, Features, Measured, VertexFeature};
pub(crate) use tiles::{MARGIN, Region, Scope};

/// Voxels along an axis, at most.
const MOST_VOXELS: i32 = 1 << 15;

/// How far from the surface the field is filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Band {
    /// All voxels within this distance, in h; less than 1 counts as 1.
    Within(f64),
    /// The whole lattice is filled.
    Full,
}

/// What tells the inside from the outside.
#[derive(Clone, Copy)]
pub enum Sign<'a> {
    /// The angle-weighted pseudonormal at the nearest point: for closed, oriented meshes.
    Pseudonormal,
    /// The votes of the rays on the same lattice: for soups.
    Votes(&'a Grid<Votes>),
    /// The winding numbers of the operands of a soup on the same lattice, and what is made of them.
    Winding(&'a Winding<'a>, &'a Expression),
    /// The slice contours of an oriented surface in the planes of the same lattice.
    Levels(&'a Levels),
}

/// Options of [`exact`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactOptions {
    /// How far from the surface the field is filled.
    pub band: Band,
    /// Upper bound for the working memory, bytes, by [`cost`]; `None`: no bound.
    pub max_memory: Option<u64>,
}

/// Why there is no field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExactError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The mesh has no triangles.
    #[error("a mesh without triangles has no distance")]
    Empty,
    /// The lattice has no voxels, or more than 2¹⁵ along an axis, or its spacing is not a positive number.
    #[error("a lattice of {dims} voxels of {h} cannot be filled: 1 to {MOST_VOXELS} along each axis are possible")]
    Lattice {
        /// Voxels along x, y, z.
        dims: IVec3,
        /// Spacing, model units.
        h: f64,
    },
    /// The band is not a number.
    #[error("a band of {0} voxels cannot be filled; it must be a positive length, or full")]
    Band(f64),
    /// More memory would be needed than allowed.
    #[error("about {} MB would be needed and {} MB are allowed: use a narrower band or a larger voxel",
        needed / 1_000_000, allowed / 1_000_000)]
    Memory {
        /// Estimated peak, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
    },
}

/// The signed distance to `mesh` at the voxels of `lattice`, counted in voxels.
///
/// Every voxel within the band is right to 1e-4 h (and to 3e-7 of its distance). Bricks without such a voxel are
/// inactive and have their side; voxels beyond the band in active bricks have ± the band's width. With
/// [`Band::Full`] every brick that meets the lattice is active. The field does not depend on the number of threads.
///
/// With [`Sign::Pseudonormal`] the side is that of the nearest point's pseudonormal: exact for closed, oriented
/// meshes without self-intersections. Time and memory grow with the volume of the band and the number of triangles.
///
/// # Errors
/// See [`ExactError`].
pub fn exact(
    mesh: &TriMesh,
    lattice: &Lattice,
    sign: Sign<'_>,
    options: &ExactOptions,
    progress: &Progress,
) -> Result<DistanceField, ExactError> {
    let needed = cost(mesh, lattice, options.band).memory;
    whole(mesh, lattice, sign, options, needed, progress, |scope| found(mesh, lattice, scope, progress))
}

/// The same values in some planes of z alone, from the first on and before the second, which are multiples of eight or beyond the lattice. All else is
/// told to lie outside. Time and memory grow with what lies in these planes; `options.max_memory` is not looked at.
///
/// # Errors
/// See [`ExactError`].
pub fn exact_planes(
    mesh: &TriMesh,
    lattice: &Lattice,
    sign: Sign<'_>,
    options: &ExactOptions,
    planes: [i32; 2],
    progress: &Progress,
) -> Result<DistanceField, ExactError> {
    let scope = checked_scope(mesh, lattice, options, 0)?;
    let scope = Scope {
        planes: planes.map(|plane| (plane + BRICK - 1) / BRICK * BRICK).map(|plane| plane.min(scope.end.z)),
        ..scope
    };
    let mut raw = assemble(found(mesh, lattice, &scope, progress)?, &scope);
    sides::settle(&mut raw, mesh, lattice, sign, progress)?;
    Ok(DistanceField::in_voxels(*lattice, raw.grid))
}

fn found(mesh: &TriMesh, lattice: &Lattice, scope: &Scope, progress: &Progress) -> Result<Vec<Filled>, ExactError> {
    let features = Features::of(mesh, lattice, scope.band);
    progress.check()?;
    Ok(tiles::bricks(&features, scope, progress)?)
}

/// The field whose bricks `bricks` finds, which takes `needed` bytes: checked before, and given its sides after.
pub(crate) fn whole<E: From<ExactError>>(
    mesh: &TriMesh,
    lattice: &Lattice,
    sign: Sign<'_>,
    options: &ExactOptions,
    needed: u64,
    progress: &Progress,
    bricks: impl FnOnce(&Scope) -> Result<Vec<Filled>, E>,
) -> Result<DistanceField, E> {
    let scope = checked_scope(mesh, lattice, options, needed)?;
    let mut raw = assemble(bricks(&scope)?, &scope);
    sides::settle(&mut raw, mesh, lattice, sign, progress)?;
    Ok(DistanceField::in_voxels(*lattice, raw.grid))
}

/// What is to be filled, which takes `needed` bytes, or why it cannot be.
fn checked_scope(mesh: &TriMesh, lattice: &Lattice, options: &ExactOptions, needed: u64) -> Result<Scope, ExactError> {
    let bounds = mesh.bounds().ok_or(ExactError::Empty)?;
    let countable = lattice.dims.min_element() >= 1 && lattice.dims.max_element() <= MOST_VOXELS;
    if !(countable && lattice.h > 0.0 && lattice.h.is_finite()) {
        return Err(ExactError::Lattice { dims: lattice.dims, h: lattice.h });
    }
    let scope = scope(lattice, options.band, &bounds)?;
    if let Some(allowed) = options.max_memory.filter(|&allowed| needed > allowed) {
        return Err(ExactError::Memory { needed, allowed });
    }
    Ok(scope)
}

/// The voxels of the bricks that meet the lattice, and a finite band.
fn scope(lattice: &Lattice, band: Band, bounds: &Bounds) -> Result<Scope, ExactError> {
    let end = (brick_of(lattice.dims - 1) + 1) * BRICK;
    let farthest = farthest(lattice, bounds, end);
    let band = match band {
        Band::Within(h) if h > 0.0 && h.is_finite() => h.max(1.0).min(farthest),
        Band::Within(h) => return Err(ExactError::Band(h)),
        Band::Full => farthest,
    };
    Ok(Scope { end, band, planes: [0, end.z] })
}

/// No voxel is farther from the surface than this, in h: it is the farthest that a corner of the lattice is from a
/// corner of the bounding box.
fn farthest(lattice: &Lattice, bounds: &Bounds, end: IVec3) -> f64 {
    let [min, max] = [bounds.min, bounds.max].map(|p| lattice.to_lattice(p));
    let span = max.max(end.as_dvec3()) - min.min(DVec3::ZERO);
    span.length() + 1.0
}

/// A field whose sides are not settled yet.
struct Raw {
    grid: Grid<f32>,
    band: f32,
    end: IVec3,
    /// The planes of z that are wanted.
    planes: [i32; 2],
}

fn assemble(mut filled: Vec<Filled>, scope: &Scope) -> Raw {
    filled.sort_unstable_by_key(|filled| (filled.brick.z, filled.brick.y, filled.brick.x));
    let bricks = Arc::new(Bricks::new(filled.iter().map(|filled| filled.brick)));
    let values = filled.into_par_iter().map(|filled| *filled.values).collect();
    let band = scope.band as f32;
    Raw { grid: Grid { bricks, values, inside: -band, outside: band }, band, end: scope.end, planes: scope.planes }
}
