//! What can be wrong with a file of a lattice, with the place.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::GridFormat;
use crate::io::Place;

/// Why a file gave no lattice: which file, where in it, what was found and what was expected.
#[derive(Debug)]
pub struct GridReadError {
    /// The file; `None` for a stream.
    pub path: Option<PathBuf>,
    /// The format it was read as, once known.
    pub format: Option<GridFormat>,
    /// Where in the file, when there is such a place.
    pub place: Option<Place>,
    /// What is wrong.
    pub problem: Box<GridReadProblem>,
}

/// What is wrong with a file of a lattice.
#[derive(Debug, thiserror::Error)]
pub enum GridReadProblem {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Neither the content nor the extension tells a format.
    #[error("is no file of a lattice known here (VTI, NRRD, NPY, VDB)")]
    UnknownFormat,
    /// Not one byte.
    #[error("the file is empty")]
    Empty,
    /// The file ends early; a new download or export is needed.
    #[error("the file is cut short: {expected} expected, {found}")]
    Truncated {
        /// What should have been there.
        expected: String,
        /// What is there instead.
        found: String,
    },
    /// Something else stands where it should.
    #[error("{expected} expected, found {found}")]
    Syntax {
        /// What should have been there.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A value that is not a finite number.
    #[error("a finite value expected at voxel {} {} {}, found {value}", voxel[0], voxel[1], voxel[2])]
    NotFinite {
        /// The voxel, from 0 along x, y, z.
        voxel: [i64; 3],
        /// What is there, in single precision.
        value: f32,
    },
    /// Voxels that are not cubes: distances cannot be taken on them. Resample the grid to one spacing.
    #[error("the spacing is {} along x, {} along y and {} along z; one spacing for all axes is needed", .0[0], .0[1], .0[2])]
    Anisotropic(
        /// The spacing along x, y, z, model units.
        [f64; 3],
    ),
    /// Axes that are not x, y, z in this order and direction. Resample the grid along them.
    #[error(
        "the axes of the lattice are turned, sheared or mirrored ({0}); x, y, z in this order and direction are needed"
    )]
    Turned(
        /// The axes as the file has them.
        String,
    ),
    /// The file would unfold into far more than its length justifies.
    #[error("{what} exceed the limit of {limit}; the file unfolds into far more than its size justifies")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// More memory than allowed; said before it is taken.
    #[error("about {needed} bytes of memory would be needed, and {allowed} are allowed")]
    Memory {
        /// For the values and the file, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
    },
    /// A part of the format that is not read here, and what to do about it.
    #[error("{0}")]
    Unsupported(String),
}

impl GridReadProblem {
    pub(super) fn syntax(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Syntax { expected: expected.into(), found: found.into() }
    }

    pub(super) fn truncated(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Truncated { expected: expected.into(), found: found.into() }
    }

    pub(super) fn unsupported(text: impl Into<String>) -> Self {
        Self::Unsupported(text.into())
    }

    pub(super) fn at_byte(self, byte: usize) -> GridReadError {
        GridReadError { place: Some(Place::Byte(byte as u64)), ..self.into() }
    }

    pub(super) fn at_line(self, line: usize) -> GridReadError {
        GridReadError { place: Some(Place::Line(line)), ..self.into() }
    }

    pub(super) fn at_item(self, item: impl Into<String>) -> GridReadError {
        GridReadError { place: Some(Place::Item(item.into())), ..self.into() }
    }
}

impl From<GridReadProblem> for GridReadError {
    fn from(problem: GridReadProblem) -> Self {
        Self { path: None, format: None, place: None, problem: Box::new(problem) }
    }
}

impl GridReadError {
    pub(super) fn in_file(self, path: Option<&Path>, format: Option<GridFormat>) -> Self {
        Self { path: path.map(Path::to_owned), format: self.format.or(format), ..self }
    }
}

impl fmt::Display for GridReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.path {
            Some(path) => write!(f, "{}", path.display())?,
            None => f.write_str("input")?,
        }
        match &self.place {
            Some(place) => write!(f, ": {place}: {}", self.problem),
            None => write!(f, ": {}", self.problem),
        }
    }
}

impl std::error::Error for GridReadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.problem {
            GridReadProblem::Io(error) => Some(error),
            _ => None,
        }
    }
}

/// At most the first characters of `text`, for messages.
pub(super) fn shown(text: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&text[..text.len().min(4 * MOST)]);
    let short: String = text.trim().chars().take(MOST).collect();
    format!("`{}`", short.escape_debug())
}
