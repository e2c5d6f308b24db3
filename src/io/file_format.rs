//! The formats of meshes and of lattices, as one list of names.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use super::format::Format;
use super::grids::GridFormat;

/// A file format, of meshes or of values over a lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FileFormat {
    /// A format of meshes.
    Mesh(Format),
    /// A format of lattices.
    Grid(GridFormat),
}

impl FileFormat {
    /// The format that the extension of `path` names, in any case of letters.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        let path = path.as_ref();
        Format::from_path(path).map(Self::Mesh).or_else(|| GridFormat::from_path(path).map(Self::Grid))
    }

    /// The name, which is also the usual extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh(format) => format.name(),
            Self::Grid(format) => format.name(),
        }
    }
}

impl From<Format> for FileFormat {
    fn from(format: Format) -> Self {
        Self::Mesh(format)
    }
}

impl From<GridFormat> for FileFormat {
    fn from(format: GridFormat) -> Self {
        Self::Grid(format)
    }
}

impl fmt::Display for FileFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is neither a format of meshes nor one of lattices.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no format known here; use stl, obj, ply, off, glb, gltf or 3mf, or for lattices vti, nrrd, npy or vdb"
)]
pub struct UnknownFileFormat(pub String);

impl FromStr for FileFormat {
    type Err = UnknownFileFormat;

    fn from_str(text: &str) -> Result<Self, UnknownFileFormat> {
        let mesh = text.parse().map(Self::Mesh).ok();
        mesh.or_else(|| text.parse().map(Self::Grid).ok()).ok_or_else(|| UnknownFileFormat(text.to_owned()))
    }
}
