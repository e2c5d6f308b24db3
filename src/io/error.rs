//! What can go wrong with a file, with the place.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::Format;

/// Why a file gave no mesh: which file, where in it, what was found and what was expected.
#[derive(Debug)]
pub struct ReadError {
    /// The file; `None` for a stream.
    pub path: Option<PathBuf>,
    /// The format it was read as, once known.
    pub format: Option<Format>,
    /// Where in the file, when there is such a place.
    pub place: Option<Place>,
    /// What is wrong.
    pub problem: Box<ReadProblem>,
}

/// A place within a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A line of a text file, from 1.
    Line(usize),
    /// A byte offset in a binary file, from 0.
    Byte(u64),
    /// A byte offset in an uncompressed file of a package.
    Part {
        /// Name of the file in the package.
        name: String,
        /// Offset, from 0.
        byte: u64,
    },
    /// A named piece of a structured file, such as `accessors[3]`.
    Item(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Part { name, byte } => write!(f, "{name}, byte {byte}"),
            Self::Item(item) => f.write_str(item),
        }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum ReadProblem {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Neither the content nor the extension tells a format.
    #[error("is no mesh file known here (STL, OBJ, PLY, OFF, glTF, GLB, 3MF); name the format if it is one")]
    UnknownFormat,
    /// Not one byte.
    #[error("the file is empty")]
    Empty,
    /// The file is sound as far as it goes and holds no triangle.
    #[error("the file holds no triangle")]
    NoTriangles,
    /// The file holds points alone; a surface must be laid through them first.
    #[error(
        "a point cloud: the file holds {} and no face; a program that lays a surface through points must come first",
        super::soup::counted(*points, "point")
    )]
    PointCloud {
        /// How many there are.
        points: usize,
    },
    /// All triangles of the file had to be left out.
    #[error("no triangle is left: {0}")]
    NothingLeft(
        /// What was left out, and why.
        String,
    ),
    /// The content is that of a file that is no mesh, or of a format that is not read here.
    #[error("the file holds {what}: {advice}")]
    Foreign {
        /// What the file really is.
        what: &'static str,
        /// What to do about it.
        advice: &'static str,
    },
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
    /// A number of a transform that is not finite. Vertices with such coordinates are left out instead.
    #[error("a finite number expected, found {found}")]
    NotFinite {
        /// The number as it stands in the file.
        found: String,
    },
    /// A face refers to something that is not there.
    #[error("index {index} is out of range, there are {count} {what}")]
    IndexOutOfRange {
        /// The index as it stands in the file.
        index: i64,
        /// How many there are.
        count: usize,
        /// Of what: vertices, nodes, objects.
        what: &'static str,
    },
    /// The file would unfold into far more than its length justifies (a zip bomb, a component that
    /// contains itself over and over).
    #[error("{what} exceed the limit of {limit}; the file unfolds into far more than its size justifies")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// A part of the format that is not read here.
    #[error("{0}")]
    Unsupported(String),
}

impl ReadError {
    pub(super) fn new(problem: ReadProblem) -> Self {
        Self { path: None, format: None, place: None, problem: Box::new(problem) }
    }

    pub(super) fn at(place: Place, problem: ReadProblem) -> Self {
        Self { place: Some(place), ..Self::new(problem) }
    }

    pub(super) fn line(line: usize, problem: ReadProblem) -> Self {
        Self::at(Place::Line(line), problem)
    }

    pub(super) fn byte(byte: usize, problem: ReadProblem) -> Self {
        Self::at(Place::Byte(byte as u64), problem)
    }

    pub(super) fn item(item: impl Into<String>, problem: ReadProblem) -> Self {
        Self::at(Place::Item(item.into()), problem)
    }

    pub(super) fn in_file(self, path: Option<&Path>, format: Option<Format>) -> Self {
        Self { path: path.map(Path::to_owned), format: self.format.or(format), ..self }
    }
}

impl From<ReadProblem> for ReadError {
    fn from(problem: ReadProblem) -> Self {
        Self::new(problem)
    }
}

impl fmt::Display for ReadError {
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

impl std::error::Error for ReadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.problem {
            ReadProblem::Io(error) => Some(error),
            _ => None,
        }
    }
}

impl ReadProblem {
    pub(super) fn syntax(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Syntax { expected: expected.into(), found: found.into() }
    }

    pub(super) fn truncated(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Truncated { expected: expected.into(), found: found.into() }
    }

    pub(super) fn vertex(index: i64, count: usize) -> Self {
        Self::IndexOutOfRange { index, count, what: "vertices" }
    }
}

/// Why a file was not written. Nothing is left at the target that was not there before.
#[derive(Debug)]
pub struct WriteError {
    /// The file; `None` for a stream.
    pub path: Option<PathBuf>,
    /// What is wrong.
    pub problem: WriteProblem,
}

/// What kept a mesh from being written.
#[derive(Debug, thiserror::Error)]
pub enum WriteProblem {
    /// The operating system refused.
    #[error("cannot be written: {0}")]
    Io(#[from] io::Error),
    /// An empty mesh: no format here can hold one that its readers accept.
    #[error("there is no triangle to write")]
    NoTriangles,
    /// A triangle refers to a vertex that is not there.
    #[error("triangle {triangle} refers to a vertex that is not there")]
    BadIndex {
        /// Number of the triangle, from 0.
        triangle: usize,
    },
    /// A coordinate that is not finite, or too large for the format.
    #[error("vertex {vertex} has the coordinate {value}, which {format} cannot hold")]
    Coordinate {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// The coordinate.
        value: f64,
        /// The format to be written.
        format: Format,
    },
    /// Not one colour for each triangle or vertex.
    #[error("there are {found} colours where {expected} are needed, one for each triangle or vertex")]
    Colours {
        /// How many colours there are.
        found: usize,
        /// How many triangles, or vertices, there are.
        expected: usize,
    },
    /// Textures whose lists are not as long as the mesh has triangles, or that name materials or images that are not there.
    #[error("the textures do not fit the mesh")]
    Textures,
    /// The format counts in 32 bits and the mesh is larger; PLY holds the most.
    #[error("the mesh is too large for {format}")]
    TooLarge {
        /// The format to be written.
        format: Format,
    },
}

impl WriteError {
    pub(super) fn in_file(self, path: &Path) -> Self {
        Self { path: Some(path.to_owned()), ..self }
    }
}

impl From<WriteProblem> for WriteError {
    fn from(problem: WriteProblem) -> Self {
        Self { path: None, problem }
    }
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> Self {
        WriteProblem::Io(error).into()
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.path {
            Some(path) => write!(f, "{}: {}", path.display(), self.problem),
            None => write!(f, "output: {}", self.problem),
        }
    }
}

impl std::error::Error for WriteError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.problem {
            WriteProblem::Io(error) => Some(error),
            _ => None,
        }
    }
}
