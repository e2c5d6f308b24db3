//! Mesh files, in and out: one folder or file a format, detection, and writing that never leaves
//! half a file behind.
//!
//! A reader takes the whole file as bytes and returns a soup or an error that names the place. It
//! trusts no count in the file: memory is taken only for what the bytes back. Nothing is repaired,
//! scaled or merged here, except that STL, which repeats a vertex for every facet, is welded by
//! equal coordinates. The rules for each format are in `docs/formats.md`.
//!
//! ```
//! use meshwright::io::{Format, WriteOptions, encode, read_bytes};
//!
//! let off = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
//! let loaded = read_bytes(off, None, None)?;
//! assert_eq!((loaded.format, loaded.mesh.triangles.len()), (Format::Off, 4));
//!
//! let mut stl = Vec::new();
//! encode(&loaded.mesh, &WriteOptions::new(Format::Stl), &mut stl)?;
//! assert_eq!(read_bytes(&stl, None, None)?.mesh.triangles.len(), 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod colour;
pub(crate) mod draft;
mod encoding;
mod error;
mod foreign;
mod format;
mod gltf;
mod grids;
#[cfg(feature = "cli")]
pub(crate) mod leftovers;
mod obj;
mod off;
mod ply;
mod polygon;
mod save;
mod soup;
mod stl;
mod text;
mod texture;
mod three_mf;
mod unit;

use std::borrow::Cow;
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::Path;

use crate::mesh::TriMesh;

pub(crate) use colour::linear_from_srgb;
pub use colour::{Carried, Colours, Rgba};
pub use error::{Place, ReadError, ReadProblem, WriteError, WriteProblem};
pub use format::{Format, UnknownFormat};
pub use grids::{
    BLOCK_SIDE, BLOCK_VOXELS, Block, BlockValues, DistanceSamples, GridFile, GridFormat, GridMeasures, GridReadError,
    GridReadProblem, GridValues, SampleBlocks, SparseValues, Tile, UnknownGridFormat, encode_grid, read_grid,
    read_grid_bytes, read_grid_within, write_grid,
};
pub use ply::{FaceMap, LegendEntry, VertexMap, encode_face_map, encode_vertex_map};
pub use save::save_bytes;
pub use texture::{ImageKind, Material, SideFile, TexCoords, TextureImage, TextureMap, shown_colours};
pub use unit::{Unit, UnknownUnit};

/// A named piece of a file: an object, a solid, a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// The name in the file; empty where it has none.
    pub name: String,
    /// Its triangles in the mesh.
    pub triangles: Range<usize>,
}

/// Solids that a file takes away from its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Negative {
    /// The triangles: at least one; every coordinate finite, every index in range.
    pub mesh: TriMesh,
    /// The pieces, in order and without gaps; at least one, none empty.
    pub parts: Vec<Part>,
}

/// A file as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The triangles: at least one; every coordinate finite, every index in range.
    pub mesh: TriMesh,
    /// The colours of `mesh`, one for each triangle, vertex or corner; `None` where the file has none.
    pub colours: Option<Colours>,
    /// The textures of `mesh`: coordinates, materials, images; `None` where the file has none.
    pub texture: Option<TextureMap>,
    /// What the file says that its colours mean: a map in PLY.
    pub legend: Vec<LegendEntry>,
    /// The format that was found.
    pub format: Format,
    /// The unit of length that the file states.
    pub unit: Option<Unit>,
    /// The pieces of the file, in order and without gaps; at least one, none empty.
    pub parts: Vec<Part>,
    /// What the file says is to be taken away from `mesh`: negative volumes of slicers in 3MF.
    pub negative: Option<Negative>,
    /// Sentences about what was left out or read otherwise than it stands.
    pub warnings: Vec<String>,
}

/// How to write a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WriteOptions {
    /// The format.
    pub format: Format,
    /// STL and PLY as text. The other formats have one form each.
    pub ascii: bool,
    /// The unit of length of the coordinates. 3MF states it; glTF is in metres, so its one node scales them to metres.
    /// The other formats have no place for it. Without a unit coordinates are written as they are.
    pub unit: Option<Unit>,
}

impl WriteOptions {
    /// The usual form of `format`, without a unit.
    pub fn new(format: Format) -> Self {
        Self { format, ascii: false, unit: None }
    }

    /// What a reader of the file finds coordinates multiplied by: lengths with a unit become metres in glTF.
    pub fn factor(&self) -> f64 {
        match (self.format, self.unit) {
            (Format::Glb | Format::Gltf, Some(unit)) => unit.metres(),
            _ => 1.0,
        }
    }

    /// The unit in which a reader takes the file: glTF is always in metres, and a 3MF file that states none in millimetres. For
    /// formats without a place for it, the unit of the coordinates.
    pub fn unit_in_file(&self) -> Option<Unit> {
        match self.format {
            Format::Glb | Format::Gltf => Some(Unit::Metre),
            Format::ThreeMf => self.unit.or(Some(Unit::Millimetre)),
            Format::Stl | Format::Obj | Format::Ply | Format::Off => self.unit,
        }
    }
}

/// Reads the mesh file at `path`; its format is told by content, then by extension.
///
/// # Errors
/// When the file cannot be read or is not sound: see [`ReadProblem`].
pub fn read(path: &Path) -> Result<Loaded, ReadError> {
    let bytes = fs::read(path).map_err(|e| ReadError::new(e.into()).in_file(Some(path), None))?;
    read_bytes(&bytes, None, Some(path))
}

/// Reads a mesh from `bytes`. With `format` none, it is told by content, then by the extension of
/// `path`. `path` also names the file in errors and is where a glTF's external buffers, materials of OBJ and
/// images lie beside; without it the buffers are refused, and materials and images are left out.
///
/// # Errors
/// When the bytes are not a sound file: see [`ReadProblem`].
pub fn read_bytes(bytes: &[u8], format: Option<Format>, path: Option<&Path>) -> Result<Loaded, ReadError> {
    let plain = match stl::is_exactly_binary(bytes) {
        true => Cow::Borrowed(bytes),
        false => encoding::plain(bytes),
    };
    let bytes = plain.as_ref();
    let found = format.or_else(|| Format::detect(bytes, path));
    let foreign = || foreign::recognise(bytes, path);
    // A name says little: what begins as something else is that.
    let misnamed = match format.is_none() && Format::from_content(bytes).is_none() {
        true => foreign(),
        false => None,
    };
    let loaded = match found {
        _ if bytes.is_empty() => Err(ReadProblem::Empty.into()),
        _ if misnamed.is_some() => Err(misnamed.unwrap_or(ReadProblem::UnknownFormat).into()),
        None => Err(ReadProblem::UnknownFormat.into()),
        Some(Format::Stl) => stl::read(bytes),
        Some(Format::Obj) => obj::read(bytes, path),
        Some(Format::Ply) => ply::read(bytes, path),
        Some(Format::Off) => off::read(bytes),
        Some(Format::Glb) => gltf::read_glb(bytes, path),
        Some(Format::Gltf) => gltf::read_json(bytes, path),
        Some(Format::ThreeMf) => three_mf::read(bytes),
    };
    loaded.map_err(|error| match format.and_then(|_| foreign::recognise(bytes, None)) {
        Some(problem) => ReadError::from(problem).in_file(path, found),
        None => error.in_file(path, found),
    })
}

/// Writes `mesh` to `path`, whole or not at all: see [`save_bytes`].
///
/// # Errors
/// See [`WriteProblem`].
pub fn write(path: &Path, mesh: &TriMesh, options: &WriteOptions) -> Result<(), WriteError> {
    save::save(path, |out| encode(mesh, options, out))
}

/// [`write()`] with colours, as [`encode_coloured`] stores them.
///
/// # Errors
/// See [`WriteProblem`].
pub fn write_coloured(
    path: &Path,
    mesh: &TriMesh,
    colours: Option<&Colours>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    save::save(path, |out| encode_coloured(mesh, colours, options, out))
}

/// Writes `mesh` as bytes to `out`. Coordinates are stored as they are where the format holds
/// `f64`, and rounded to `f32` in STL, glTF and GLB.
///
/// # Errors
/// See [`WriteProblem`]. The mesh is checked before the first byte is written.
pub fn encode(mesh: &TriMesh, options: &WriteOptions, out: &mut dyn Write) -> Result<(), WriteError> {
    encode_painted(mesh, &Paint::default(), options, out)
}

/// What a surface looks like.
#[derive(Debug, Clone, Copy, Default)]
pub struct Paint<'a> {
    /// Colours of triangles, vertices or corners.
    pub colours: Option<&'a Colours>,
    /// Textures.
    pub texture: Option<&'a TextureMap>,
    /// Where the file will lie, which names the files beside it ([`TextureMap::side_files`]); `None` for a stream, which has none.
    pub beside: Option<&'a Path>,
}

impl<'a> From<Option<&'a Colours>> for Paint<'a> {
    fn from(colours: Option<&'a Colours>) -> Self {
        Self { colours, ..Self::default() }
    }
}

/// [`encode`] with the colours of `mesh`, one for each triangle, vertex or corner. What the format cannot hold is left
/// out or averaged; [`Colours::carried_by`] tells. GLB and glTF repeat a vertex where colours meet; the other formats
/// keep the vertices as they are.
///
/// # Errors
/// See [`WriteProblem`]. Mesh and colours are checked before the first byte is written.
pub fn encode_coloured(
    mesh: &TriMesh,
    colours: Option<&Colours>,
    options: &WriteOptions,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    encode_painted(mesh, &colours.into(), options, out)
}

/// [`encode_coloured`] with textures, as far as the format holds them; [`TextureMap::lost_in`] tells what it does not. Materials of OBJ, and images
/// of OBJ and PLY, are files of their own, which [`TextureMap::side_files`] makes; the mesh names them. glTF writes the triangles of each
/// material in one piece if they are in one, and in several if not.
///
/// # Errors
/// See [`WriteProblem`]. Mesh, colours and textures are checked before the first byte is written.
pub fn encode_painted(
    mesh: &TriMesh,
    paint: &Paint<'_>,
    options: &WriteOptions,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    check(mesh, options.format)?;
    let Paint { colours, texture, .. } = *paint;
    if texture.is_some_and(|texture| !texture.fits(mesh)) {
        return Err(WriteProblem::Textures.into());
    }
    if let Some([found, expected]) = colours.map(|colours| colours.counts(mesh))
        && found != expected
    {
        return Err(WriteProblem::Colours { found, expected }.into());
    }
    match options.format {
        Format::Stl if options.ascii => stl::write_ascii(mesh, out),
        Format::Stl => stl::write_binary(mesh, out),
        Format::Obj => obj::write(mesh, paint, out),
        Format::Ply if options.ascii => ply::write_ascii(mesh, paint, out),
        Format::Ply => ply::write_binary(mesh, paint, out),
        Format::Off => off::write(mesh, shown_colours(colours, texture).as_deref(), out),
        Format::Glb => gltf::write_glb(mesh, paint, options.unit, out),
        Format::Gltf => gltf::write_json(mesh, paint, options.unit, out),
        Format::ThreeMf => three_mf::write(mesh, paint, options.unit, out),
    }
}

fn check(mesh: &TriMesh, format: Format) -> Result<(), WriteError> {
    if mesh.triangles.is_empty() {
        return Err(WriteProblem::NoTriangles.into());
    }
    let count = mesh.positions.len();
    if let Some(triangle) = mesh.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= count)) {
        return Err(WriteProblem::BadIndex { triangle }.into());
    }
    let holds = |x: f64| if format.is_single() { (x as f32).is_finite() } else { x.is_finite() };
    for (vertex, p) in mesh.positions.iter().enumerate() {
        if let Some(value) = p.to_array().into_iter().find(|&x| !holds(x)) {
            return Err(WriteProblem::Coordinate { vertex, value, format }.into());
        }
    }
    Ok(())
}
