//! What can go wrong with a file, with the place in it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::file_format::FileFormat;
use super::format::Format;
use super::text::counted;
use crate::mesh::IndexError;

/// Why a file gave no mesh or no lattice: which file, where in it, what was found and what was expected.
/// [`FileError::hint`] says what may be tried.
#[derive(Debug)]
pub struct FileError {
    /// The file; `None` for bytes that came without a name.
    pub path: Option<PathBuf>,
    /// The format that the file was read as, once it is known.
    pub format: Option<FileFormat>,
    /// Where in the file the problem is, when there is such a place.
    pub location: Option<Location>,
    /// What is wrong.
    pub problem: Box<FileProblem>,
}

/// A place within a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Location {
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte of a binary file, counted from 0.
    Byte(u64),
    /// A byte of a file within a package, counted from 0 after unpacking.
    Part {
        /// Name of the file in the package.
        name: String,
        /// The byte.
        byte: u64,
    },
    /// A named piece of a structured file, such as `accessors[3]`.
    Item(String),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Part { name, byte } => write!(f, "{name}, byte {byte}"),
            Self::Item(item) => f.write_str(item),
        }
    }
}

/// What a reader was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// A mesh.
    Mesh,
    /// Values over a lattice.
    Grid,
}

impl Wanted {
    fn formats(self) -> &'static str {
        match self {
            Self::Mesh => "no mesh file known here (STL, OBJ, PLY, OFF, glTF, GLB, 3MF)",
            Self::Grid => "no file of a lattice known here (VTI, NRRD, NPY, VDB)",
        }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum FileProblem {
    /// The operating system refused to give the file.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Neither the content nor the extension tells a format.
    #[error("is {}", .0.formats())]
    UnknownFormat(
        /// What was wanted of the file.
        Wanted,
    ),
    /// The file has not one byte.
    #[error("the file is empty")]
    Empty,
    /// The file is sound as far as it goes and holds no triangle.
    #[error("the file holds no triangle")]
    NoTriangles,
    /// The file holds points alone, which bound no solid.
    #[error("a point cloud: the file holds {} and no face", counted(*points, "point"))]
    PointCloud {
        /// How many points there are.
        points: usize,
    },
    /// All triangles of the file had to be left out.
    #[error("no triangle is left: {0}")]
    NothingLeft(
        /// What was left out, and why.
        String,
    ),
    /// The content is that of a file that is no mesh, or of a format that is not read here.
    #[error("the file holds {what}")]
    Foreign {
        /// What the file really is.
        what: &'static str,
        /// What to do about it.
        advice: &'static str,
    },
    /// The file ends early.
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
    /// A number of a transform that is not finite. Vertices with such coordinates are left out instead, with a warning.
    #[error("a finite number expected, found {found}")]
    NotFinite {
        /// The number as it stands in the file.
        found: String,
    },
    /// A value of a lattice that is not a finite number.
    #[error("a finite value expected at voxel {} {} {}, found {value}", voxel[0], voxel[1], voxel[2])]
    NotFiniteVoxel {
        /// The voxel, from 0 along x, y, z.
        voxel: [i64; 3],
        /// What is there, in single precision.
        value: f32,
    },
    /// A face, node or component refers to something that is not there.
    #[error("index {index} is out of range, there are {count} {what}")]
    IndexOutOfRange {
        /// The index as it stands in the file.
        index: i64,
        /// How many there are.
        count: usize,
        /// Of what: vertices, nodes, objects.
        what: &'static str,
    },
    /// Voxels that are not cubes: distances cannot be taken on them.
    #[error("the spacing is {} along x, {} along y and {} along z; one spacing for all axes is needed", .0[0], .0[1], .0[2])]
    Anisotropic(
        /// The spacing along x, y, z, model units.
        [f64; 3],
    ),
    /// Axes of a lattice that are not x, y, z in this order and direction.
    #[error(
        "the axes of the lattice are turned, sheared or mirrored ({0}); x, y, z in this order and direction are needed"
    )]
    Turned(
        /// The axes as the file has them.
        String,
    ),
    /// The file would unfold into far more than its length justifies: a zip bomb, or a component that contains itself over and over.
    #[error("{what} exceed the limit of {limit}; the file unfolds into far more than its size justifies")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// More memory than allowed would be needed; this is found before it is taken.
    #[error("about {needed} bytes of memory would be needed, and {allowed} are allowed")]
    Memory {
        /// What the values and the file need, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
    },
    /// A part of the format that is not read here, and what to do about it.
    #[error("{0}")]
    Unsupported(String),
}

impl FileError {
    /// What may be tried; `None` where the error itself says all there is to say.
    pub fn hint(&self) -> Option<&'static str> {
        match &*self.problem {
            FileProblem::UnknownFormat(_) => Some("name the format if it is one of these"),
            FileProblem::Foreign { advice, .. } => Some(advice),
            FileProblem::PointCloud { .. } => Some("a program that lays a surface through points must come first"),
            FileProblem::Empty | FileProblem::Truncated { .. } => Some("load the file down, or export it, once more"),
            FileProblem::NoTriangles => Some("export the model as a mesh of triangles"),
            FileProblem::NotFiniteVoxel { .. } => Some("replace such values by a large one of the right sign"),
            FileProblem::Anisotropic(_) => Some("resample the lattice to one spacing first"),
            FileProblem::Turned(_) => Some("resample the lattice along x, y and z first"),
            FileProblem::Memory { .. } => Some("allow more memory, or make the lattice coarser"),
            FileProblem::Io(_)
            | FileProblem::NothingLeft(_)
            | FileProblem::Syntax { .. }
            | FileProblem::NotFinite { .. }
            | FileProblem::IndexOutOfRange { .. }
            | FileProblem::TooLarge { .. }
            | FileProblem::Unsupported(_) => None,
        }
    }

    pub(super) fn new(problem: FileProblem) -> Self {
        Self { path: None, format: None, location: None, problem: Box::new(problem) }
    }

    pub(super) fn at(location: Location, problem: FileProblem) -> Self {
        Self { location: Some(location), ..Self::new(problem) }
    }

    pub(super) fn line(line: usize, problem: FileProblem) -> Self {
        Self::at(Location::Line(line), problem)
    }

    pub(super) fn byte(byte: usize, problem: FileProblem) -> Self {
        Self::at(Location::Byte(byte as u64), problem)
    }

    pub(super) fn item(item: impl Into<String>, problem: FileProblem) -> Self {
        Self::at(Location::Item(item.into()), problem)
    }

    pub(super) fn in_file(self, path: Option<&Path>, format: Option<impl Into<FileFormat>>) -> Self {
        Self { path: path.map(Path::to_owned), format: self.format.or(format.map(Into::into)), ..self }
    }
}

impl From<FileProblem> for FileError {
    fn from(problem: FileProblem) -> Self {
        Self::new(problem)
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.path {
            Some(path) => write!(f, "{}", path.display())?,
            None => f.write_str("input")?,
        }
        match &self.location {
            Some(location) => write!(f, ": {location}: {}", self.problem),
            None => write!(f, ": {}", self.problem),
        }
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.problem {
            FileProblem::Io(error) => Some(error),
            _ => None,
        }
    }
}

impl FileProblem {
    pub(super) fn syntax(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Syntax { expected: expected.into(), found: found.into() }
    }

    pub(super) fn truncated(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Truncated { expected: expected.into(), found: found.into() }
    }

    pub(super) fn unsupported(text: impl Into<String>) -> Self {
        Self::Unsupported(text.into())
    }

    pub(super) fn vertex(index: i64, count: usize) -> Self {
        Self::IndexOutOfRange { index, count, what: "vertices" }
    }

    pub(super) fn at_byte(self, byte: usize) -> FileError {
        FileError::byte(byte, self)
    }

    pub(super) fn at_line(self, line: usize) -> FileError {
        FileError::line(line, self)
    }

    pub(super) fn at_item(self, item: impl Into<String>) -> FileError {
        FileError::item(item, self)
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

/// What kept a mesh or a lattice from being written.
#[derive(Debug, thiserror::Error)]
pub enum WriteProblem {
    /// The operating system refused.
    #[error("cannot be written: {0}")]
    Io(#[from] io::Error),
    /// The name of the file does not tell a format that holds what is to be written.
    #[error("the name does not tell a format that holds {}", match wanted { Wanted::Mesh => "a mesh", Wanted::Grid => "a lattice" })]
    UnknownFormat {
        /// What is to be written.
        wanted: Wanted,
    },
    /// The mesh is empty: no format here can hold one that its readers accept.
    #[error("there is no triangle to write")]
    NoTriangles,
    /// A triangle refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
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
    /// There is not one colour for each triangle or vertex.
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
    /// The files of materials and images that belong beside the mesh would replace one that the textures were read from.
    #[error("its textures belong into {}, which the textures of the input were read from", file.display())]
    TextureInUse {
        /// The file that would be replaced.
        file: PathBuf,
    },
    /// A scene of several objects for a format that holds one mesh.
    #[error("{format} holds one mesh and no objects")]
    NoObjects {
        /// The format to be written.
        format: Format,
    },
    /// The format counts in 32 bits and the mesh is larger.
    #[error("the mesh is too large for {format}")]
    TooLarge {
        /// The format to be written.
        format: Format,
    },
}

impl WriteError {
    /// What may be tried; `None` where the error itself says all there is to say.
    pub fn hint(&self) -> Option<&'static str> {
        match &self.problem {
            WriteProblem::UnknownFormat { wanted: Wanted::Mesh } => {
                Some("end the name in .stl, .obj, .ply, .off, .glb, .gltf or .3mf, or name the format in the options")
            }
            WriteProblem::UnknownFormat { wanted: Wanted::Grid } => {
                Some("end the name in .vti, .nrrd, .npy or .vdb, or name the format")
            }
            WriteProblem::Coordinate { value, .. } if value.is_finite() => {
                Some("PLY, OBJ, OFF and 3MF hold coordinates in double precision")
            }
            WriteProblem::TextureInUse { .. } => Some("write to another name, or into another folder"),
            WriteProblem::TooLarge { .. } => Some("PLY holds the most"),
            WriteProblem::Io(_)
            | WriteProblem::NoTriangles
            | WriteProblem::NoObjects { .. }
            | WriteProblem::Index(_)
            | WriteProblem::Coordinate { .. }
            | WriteProblem::Colours { .. }
            | WriteProblem::Textures => None,
        }
    }

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
            WriteProblem::Index(error) => Some(error),
            _ => None,
        }
    }
}
