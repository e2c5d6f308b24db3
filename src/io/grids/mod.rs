//! Files of numbers on a regular lattice: written plane by plane or block by block, so that the whole need not be in
//! memory, and read into a [`GridFile`].

mod file;
mod format;
mod npy;
mod nrrd;
mod numbers;
mod read;
mod vdb;
mod vti;

use std::io::{self, Write};
use std::path::Path;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

pub use file::{
    BLOCK_SIDE, BLOCK_VOXELS, BlockValues, GridBlock, GridFile, GridMeasures, GridTile, GridValues, SparseValues,
};
use file::{all_finite, one_spacing, spacing_of_axes};
pub use format::{GridFormat, UnknownGridFormat};
pub use read::{read_grid, read_grid_bytes, read_grid_within};

use super::error::{Wanted, WriteError, WriteProblem};
use super::save::save_bytes;
use super::unit::Unit;

/// A signed distance at the points of a regular lattice.
pub struct DistanceSamples<'a> {
    /// Position of the first point, model units.
    pub origin: DVec3,
    /// Distance between neighbouring points, model units; the same along all axes.
    pub spacing: f64,
    /// Number of points along x, y, z.
    pub dims: [usize; 3],
    /// The unit of all lengths, where it is known.
    pub unit: Option<Unit>,
    /// The values are clamped to ± this, model units; `None` where they are not clamped.
    pub band: Option<f64>,
    /// Appends to the list the values of plane `z`, model units and negative inside: x changes fastest, then y.
    pub plane: &'a (dyn Fn(usize, &mut Vec<f32>) + Sync),
    /// The same values in blocks, where the caller has them so. Without them, formats that store blocks make them of the planes.
    pub blocks: Option<&'a SampleBlocks<'a>>,
}

/// Values near the surface in blocks of 8³ voxels. The first voxel of block `b` is `8 b`.
pub struct SampleBlocks<'a> {
    /// The numbers of the blocks that have values, none twice; those outside the lattice do not count. Wherever two neighbouring voxels
    /// lie on different sides, their blocks are among them.
    pub stored: &'a [IVec3],
    /// The values of block `stored[n]`, model units and negative inside. What lies beyond the lattice does not count.
    pub values: &'a (dyn Fn(usize) -> BlockValues + Sync),
    /// Whether a block of the lattice that is not stored lies inside; all its values are ± the band.
    pub inside: &'a (dyn Fn(IVec3) -> bool + Sync),
}

/// Writes the samples as bytes to `out`: `f32`, the lowest byte first. VDB leaves out what lies beyond the band.
///
/// # Errors
/// What `out` returns, and [`io::ErrorKind::InvalidData`] when a plane has not as many values as it has points.
pub fn encode_grid(samples: &DistanceSamples<'_>, format: GridFormat, out: &mut dyn Write) -> io::Result<()> {
    match format {
        GridFormat::Vti => vti::write(samples, out),
        GridFormat::Nrrd => nrrd::write(samples, out),
        GridFormat::Npy => npy::write(samples, out),
        GridFormat::Vdb => vdb::write(samples, out),
    }
}

/// Writes the samples to `path` in the format that its extension names, whole or not at all: see [`save_bytes`].
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("plane.nrrd");
/// # let path = path.to_str().expect("a plain name");
/// use glam::{DVec3, IVec3};
/// use meshwright::io::{DistanceSamples, read_grid, write_grid};
///
/// // The distance to the plane z = 0.5 at 3 x 2 x 2 points.
/// let samples = DistanceSamples {
///     origin: DVec3::ZERO,
///     spacing: 1.0,
///     dims: [3, 2, 2],
///     unit: None,
///     band: None,
///     plane: &|z, values| values.extend([z as f32 - 0.5; 6]),
///     blocks: None,
/// };
/// write_grid(path, &samples)?; // "plane.nrrd"
/// assert_eq!(read_grid(path)?.at(IVec3::new(2, 1, 1)), Some(0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteProblem::UnknownFormat`] where the extension names no format of lattices, and [`WriteProblem::Io`] for what
/// [`encode_grid`] returns or the operating system refuses.
pub fn write_grid(path: impl AsRef<Path>, samples: &DistanceSamples<'_>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let unknown = || WriteError::from(WriteProblem::UnknownFormat { wanted: Wanted::Grid }).in_file(path);
    write_grid_as(path, samples, GridFormat::from_path(path).ok_or_else(unknown)?)
}

/// [`write_grid`] in a format that the name need not tell.
///
/// # Errors
/// As [`write_grid`], but the name of the file does not matter.
pub fn write_grid_as(
    path: impl AsRef<Path>,
    samples: &DistanceSamples<'_>,
    format: GridFormat,
) -> Result<(), WriteError> {
    save_bytes(path, |out| encode_grid(samples, format, out))
}

/// About so many values are made at once.
const AT_ONCE: usize = 1 << 20;

/// All values, plane by plane; several planes are made at once, on all threads.
fn write_values(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
    let points = samples.dims[0] * samples.dims[1];
    let at_once = (AT_ONCE / points.max(1)).clamp(1, 64);
    let made = |z: usize| {
        let mut values = Vec::with_capacity(points);
        read_plane(samples, z, &mut values)?;
        Ok(values.iter().flat_map(|value| value.to_le_bytes()).collect())
    };
    for first in (0..samples.dims[2]).step_by(at_once) {
        let planes = (first..(first + at_once).min(samples.dims[2])).into_par_iter().map(made);
        let planes: Vec<Vec<u8>> = planes.collect::<io::Result<_>>()?;
        planes.iter().try_for_each(|bytes| out.write_all(bytes))?;
    }
    Ok(())
}

/// Replaces `values` by those of plane `z`.
fn read_plane(samples: &DistanceSamples<'_>, z: usize, values: &mut Vec<f32>) -> io::Result<()> {
    let points = samples.dims[0] * samples.dims[1];
    values.clear();
    (samples.plane)(z, values);
    match values.len() == points {
        true => Ok(()),
        false => {
            let text = format!("plane {z} has {} values, and {points} points", values.len());
            Err(io::Error::new(io::ErrorKind::InvalidData, text))
        }
    }
}

/// The convention in words, for formats with a place for remarks.
fn remark(samples: &DistanceSamples<'_>) -> String {
    let unit = samples.unit.map_or_else(|| "the units of the model".to_owned(), |unit| unit.to_string());
    let band = samples.band.map_or(String::new(), |band| format!(", clamped to +/- {band}"));
    format!("signed distance in {unit}, negative inside{band}")
}
