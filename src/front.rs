//! The functions at the root of the crate: what most callers want, without progress and report.

use crate::ldi::Expression;
use crate::mesh::Solid;
use crate::pipeline::{self, BooleanError, Operand, Options};
use crate::progress::Progress;

/// Repairs one mesh, which may be open, cracked, self-intersecting, flipped or doubled: [`pipeline::repair`] without progress and report.
/// The options may be a voxel size alone.
///
/// ```
/// use meshwright::{VoxelSize, io};
///
/// let scan = io::read("testdata/broken_mug.obj")?;
/// let solid = meshwright::repair(&scan, VoxelSize::Along(64))?;
/// # let out = tempfile::tempdir()?.path().join("mug.stl");
/// # std::fs::create_dir_all(out.parent().unwrap())?;
/// io::write(&out, &solid)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`BooleanError`].
pub fn repair<'a>(mesh: impl Into<Operand<'a>>, options: impl Into<Options>) -> Result<Solid, BooleanError> {
    boolean([mesh], Expression::union, options)
}

/// Everything inside at least one of the meshes, each of which may be broken.
///
/// ```
/// use meshwright::glam::DVec3;
/// use meshwright::{TriMesh, VoxelSize};
///
/// // Two tetrahedra, one of them without its lower side.
/// let corners = |at: f64| [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + at).to_vec();
/// let open = TriMesh::new(corners(0.0), vec![[0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let closed = TriMesh::new(corners(0.1), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let both = meshwright::union([&open, &closed], VoxelSize::Along(64))?;
///
/// let distance = both.distance();
/// assert!(distance.contains(DVec3::splat(0.2)) && distance.at(DVec3::splat(-1.0)) > 1.0);
/// let rounder = both.dilate(0.1, VoxelSize::Along(64))?;
/// assert!(rounder.validity().volume > both.validity().volume);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`BooleanError`].
pub fn union<'a>(
    meshes: impl IntoIterator<Item: Into<Operand<'a>>>,
    options: impl Into<Options>,
) -> Result<Solid, BooleanError> {
    boolean(meshes, Expression::union, options)
}

/// Everything inside all of the meshes, each of which may be broken.
///
/// # Errors
/// See [`BooleanError`].
pub fn intersection<'a>(
    meshes: impl IntoIterator<Item: Into<Operand<'a>>>,
    options: impl Into<Options>,
) -> Result<Solid, BooleanError> {
    boolean(meshes, Expression::intersection, options)
}

/// The first mesh without all the others; each may be broken.
///
/// # Errors
/// See [`BooleanError`].
pub fn difference<'a>(
    meshes: impl IntoIterator<Item: Into<Operand<'a>>>,
    options: impl Into<Options>,
) -> Result<Solid, BooleanError> {
    boolean(meshes, Expression::difference, options)
}

fn boolean<'a>(
    meshes: impl IntoIterator<Item: Into<Operand<'a>>>,
    expression: fn(usize) -> Expression,
    options: impl Into<Options>,
) -> Result<Solid, BooleanError> {
    let operands: Vec<Operand<'a>> = meshes.into_iter().map(Into::into).collect();
    let expression = expression(operands.len());
    let outcome = pipeline::boolean(operands, &expression, &options.into(), &Progress::none())?;
    Ok(outcome.solid)
}

/// The programs of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
