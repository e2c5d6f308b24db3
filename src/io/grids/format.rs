//! The formats of lattices, told by content first, then by extension.

use std::ffi::OsStr;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// The first bytes of every OpenVDB file.
pub(super) const VDB_MAGIC: [u8; 8] = *b" BDV\0\0\0\0";

/// A file format for lattices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum GridFormat {
    /// VTK image data: XML, the numbers appended as they are.
    Vti,
    /// Nearly raw raster data: a text header and the numbers as they are.
    Nrrd,
    /// A NumPy array, which has no place for origin, spacing and unit.
    Npy,
    /// OpenVDB: a tree of 8³ blocks that has numbers near the surface only.
    Vdb,
}

impl GridFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Vti, Self::Nrrd, Self::Npy, Self::Vdb];

    /// The name, which is also the usual extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vti => "vti",
            Self::Nrrd => "nrrd",
            Self::Npy => "npy",
            Self::Vdb => "vdb",
        }
    }

    /// The format that the extension of `path` names, in any case of letters.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        path.as_ref().extension().and_then(OsStr::to_str)?.parse().ok()
    }

    /// The format that `bytes` begin as. Every format here has a beginning of its own, which no mesh file has.
    pub fn from_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"NRRD000") {
            Some(Self::Nrrd)
        } else if bytes.starts_with(b"\x93NUMPY") {
            Some(Self::Npy)
        } else if bytes.starts_with(&VDB_MAGIC) {
            Some(Self::Vdb)
        } else {
            looks_like_vtk(bytes).then_some(Self::Vti)
        }
    }

    /// The format of `bytes` by what they hold; if that tells nothing, by the extension of `path`.
    pub fn detect(bytes: &[u8], path: Option<&Path>) -> Option<Self> {
        Self::from_content(bytes).or_else(|| path.and_then(Self::from_path))
    }

    /// Whether the file says where the lattice lies and in which unit.
    pub fn says_where(self) -> bool {
        self != Self::Npy
    }
}

/// Whether the first element is that of VTK's XML files.
fn looks_like_vtk(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let start = &text[..text.len().min(4096)];
    start.starts_with(b"<") && start.windows(8).any(|window| window == b"<VTKFile")
}

impl fmt::Display for GridFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A word that names no format of lattices.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no format for lattices known here; use vti, nrrd, npy or vdb")]
pub struct UnknownGridFormat(pub String);

impl FromStr for GridFormat {
    type Err = UnknownGridFormat;

    fn from_str(text: &str) -> Result<Self, UnknownGridFormat> {
        let found = Self::ALL.into_iter().find(|format| format.name().eq_ignore_ascii_case(text));
        found.ok_or_else(|| UnknownGridFormat(text.to_owned()))
    }
}
