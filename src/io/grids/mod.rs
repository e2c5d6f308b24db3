//! Files of numbers on a regular lattice, written plane by plane, so that the whole need not be in memory.

mod npy;
mod nrrd;
mod vti;

use std::ffi::OsStr;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::str::FromStr;

use glam::DVec3;

use super::save::save_bytes;
use super::{Unit, WriteError};

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
    /// Values are clamped to ± this, model units; `None`: they are not.
    pub band: Option<f64>,
    /// Appends to the list the values of plane `z`, model units and negative inside: x changes fastest, then y.
    pub plane: &'a (dyn Fn(usize, &mut Vec<f32>) + Sync),
}

/// A file format for lattices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum GridFormat {
    /// VTK image data: XML, the numbers appended as they are.
    Vti,
    /// Nearly raw raster data: a text header and the numbers as they are.
    Nrrd,
    /// A NumPy array, which has no place for origin, spacing and unit.
    Npy,
}

impl GridFormat {
    /// Every format.
    pub const ALL: [Self; 3] = [Self::Vti, Self::Nrrd, Self::Npy];

    /// The name, which is also the usual extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vti => "vti",
            Self::Nrrd => "nrrd",
            Self::Npy => "npy",
        }
    }

    /// The format that the extension of `path` names, in any case of letters.
    pub fn from_path(path: &Path) -> Option<Self> {
        path.extension().and_then(OsStr::to_str)?.parse().ok()
    }

    /// Whether the file says where the lattice lies and in which unit.
    pub fn says_where(self) -> bool {
        self != Self::Npy
    }
}

impl fmt::Display for GridFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is no format for lattices.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no format for lattices known here; use vti, nrrd or npy")]
pub struct UnknownGridFormat(pub String);

impl FromStr for GridFormat {
    type Err = UnknownGridFormat;

    fn from_str(text: &str) -> Result<Self, UnknownGridFormat> {
        let found = Self::ALL.into_iter().find(|format| format.name().eq_ignore_ascii_case(text));
        found.ok_or_else(|| UnknownGridFormat(text.to_owned()))
    }
}

/// Writes the samples as bytes to `out`: `f32`, the lowest byte first.
///
/// # Errors
/// What `out` returns, and [`io::ErrorKind::InvalidData`] when a plane has not as many values as it has points.
pub fn encode_grid(samples: &DistanceSamples<'_>, format: GridFormat, out: &mut dyn Write) -> io::Result<()> {
    match format {
        GridFormat::Vti => vti::write(samples, out),
        GridFormat::Nrrd => nrrd::write(samples, out),
        GridFormat::Npy => npy::write(samples, out),
    }
}

/// Writes the samples to `path`, whole or not at all: see [`save_bytes`].
///
/// # Errors
/// See [`encode_grid`].
pub fn write_grid(path: &Path, samples: &DistanceSamples<'_>, format: GridFormat) -> Result<(), WriteError> {
    save_bytes(path, |out| encode_grid(samples, format, out))
}

/// All values, plane by plane.
fn write_values(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
    let points = samples.dims[0] * samples.dims[1];
    let (mut values, mut bytes) = (Vec::with_capacity(points), Vec::with_capacity(4 * points));
    for z in 0..samples.dims[2] {
        values.clear();
        (samples.plane)(z, &mut values);
        if values.len() != points {
            let text = format!("plane {z} has {} values, and {points} points", values.len());
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        bytes.clear();
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// The convention in words, for formats with a place for remarks.
fn remark(samples: &DistanceSamples<'_>) -> String {
    let unit = samples.unit.map_or_else(|| "the units of the model".to_owned(), |unit| unit.to_string());
    let band = samples.band.map_or(String::new(), |band| format!(", clamped to +/- {band}"));
    format!("signed distance in {unit}, negative inside{band}")
}
