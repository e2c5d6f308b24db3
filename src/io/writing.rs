//! From a mesh to bytes or a file.

use std::io::Write;
use std::path::Path;

use super::colour::Colours;
use super::error::{Wanted, WriteError, WriteProblem};
use super::format::Format;
use super::paint::Paint;
use super::sound::check;
use super::texture::shown_colours;
use super::unit::Unit;
use super::{gltf, obj, off, ply, save, stl, three_mf};
use crate::mesh::TriMesh;

/// How to write a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WriteOptions {
    /// The format of the file.
    pub format: Format,
    /// Whether STL and PLY are written as text. The other formats have one form each.
    pub ascii: bool,
    /// The unit of length of the coordinates. 3MF states it; glTF is in metres, so its one node scales them to metres.
    /// The other formats have no place for it. Without a unit, coordinates are written as they are.
    pub unit: Option<Unit>,
}

impl WriteOptions {
    /// The usual form of `format`, without a unit.
    pub fn new(format: Format) -> Self {
        Self { format, ascii: false, unit: None }
    }

    /// The usual form of the format that the extension of `path` names, without a unit.
    ///
    /// # Errors
    /// [`WriteProblem::UnknownFormat`] where the extension names no format of meshes.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let unknown = || WriteError::from(WriteProblem::UnknownFormat { wanted: Wanted::Mesh }).in_file(path);
        Format::from_path(path).map(Self::new).ok_or_else(unknown)
    }

    /// What a reader of the file finds coordinates multiplied by: lengths with a unit become metres in glTF.
    pub fn factor(&self) -> f64 {
        match (self.format, self.unit) {
            (Format::Glb | Format::Gltf, Some(unit)) => unit.metres(),
            _ => 1.0,
        }
    }

    /// The unit in which a reader takes the file: glTF is always in metres, and a 3MF file that states none in millimetres. For
    /// formats without a place for it, this is the unit of the coordinates.
    pub fn unit_in_file(&self) -> Option<Unit> {
        match self.format {
            Format::Glb | Format::Gltf => Some(Unit::Metre),
            Format::ThreeMf => self.unit.or(Some(Unit::Millimetre)),
            Format::Stl | Format::Obj | Format::Ply | Format::Off => self.unit,
        }
    }
}

/// Writes `mesh` to `path` in the format that its extension names. The file is whole or not there: see
/// [`save_bytes`](crate::io::save_bytes). Coordinates are stored as they are where the format holds `f64`, and rounded to `f32` in STL, glTF
/// and GLB.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("out.stl");
/// # let path = path.to_str().expect("a plain name");
/// use glam::DVec3;
/// use meshwright::io;
/// use meshwright::mesh::TriMesh;
///
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// io::write(path, &mesh)?; // "out.stl"
/// assert_eq!(io::read(path)?.mesh.triangles.len(), 4);
///
/// let error = io::write("out.docx", &mesh).unwrap_err();
/// assert!(error.to_string().starts_with("out.docx: the name does not tell a format"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] with a [`WriteProblem`]: the extension names no format of meshes, the mesh is empty, an index is out of range, a
/// coordinate is not finite or too large for the format, or the operating system refuses.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), WriteError> {
    let path = path.as_ref();
    write_file(path, mesh, &Paint::default(), &WriteOptions::of_path(path)?)
}

/// [`write()`] with a format that the name need not tell, as text, or with a unit.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("part.3mf");
/// # let path = path.to_str().expect("a plain name");
/// # use meshwright::io;
/// # let off = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
/// # let mesh = io::read_bytes(off, None, None)?.mesh;
/// use meshwright::io::{Unit, WriteOptions};
///
/// let options = WriteOptions { unit: Some(Unit::Inch), ..WriteOptions::of_path(path)? };
/// io::write_with(path, &mesh, &options)?; // "part.3mf"
/// assert_eq!(io::read(path)?.unit, Some(Unit::Inch));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`write()`], but the name of the file does not matter.
pub fn write_with(path: impl AsRef<Path>, mesh: &TriMesh, options: &WriteOptions) -> Result<(), WriteError> {
    write_file(path.as_ref(), mesh, &Paint::default(), options)
}

/// [`write_with`] with colours and textures, as [`encode_painted`] stores them. The materials and images of OBJ and PLY get files beside the mesh
/// ([`TextureMap::side_files`](crate::io::TextureMap::side_files)); all files get their names together, or none does. [`Paint::lost_in`] tells beforehand what the
/// format cannot hold.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("painted.ply");
/// # let path = path.to_str().expect("a plain name");
/// # use meshwright::io;
/// # let off = b"OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1 255 0 0\n";
/// let loaded = io::read_bytes(off, None, None)?; // a red triangle
/// io::write_painted(path, &loaded.mesh, &loaded.paint(), &io::WriteOptions::of_path(path)?)?;
/// assert_eq!(io::read(path)?.colours, loaded.colours);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`write()`]. In addition, colours or textures that do not fit the mesh are refused, and so is a name by which a file of
/// materials or an image would replace another one that `paint` was read from ([`WriteProblem::TextureInUse`]).
pub fn write_painted(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    paint: &Paint<'_>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    write_file(path.as_ref(), mesh, paint, options)
}

fn write_file(path: &Path, mesh: &TriMesh, paint: &Paint<'_>, options: &WriteOptions) -> Result<(), WriteError> {
    let paint = Paint { beside: Some(path), ..*paint };
    let beside = match paint.texture {
        Some(texture) => texture.files_to_write(options.format, path).map_err(|error| error.in_file(path))?,
        None => Vec::new(),
    };
    save::save(path, &beside, |out| encode_painted(mesh, &paint, options, out))
}

/// Writes `mesh` as bytes to `out`. Coordinates are stored as they are where the format holds `f64`, and rounded to `f32` in STL,
/// glTF and GLB.
///
/// # Errors
/// As [`write()`]. The mesh is checked before the first byte is written.
pub fn encode(mesh: &TriMesh, options: &WriteOptions, out: &mut dyn Write) -> Result<(), WriteError> {
    encode_painted(mesh, &Paint::default(), options, out)
}

/// [`encode`] with the colours of `mesh`, one for each triangle, vertex or corner. What the format cannot hold is left
/// out or averaged; [`Colours::carried_by`] tells. GLB and glTF repeat a vertex where colours meet; the other formats
/// keep the vertices as they are.
///
/// # Errors
/// As [`write()`], and for colours that do not fit. Mesh and colours are checked before the first byte is written.
pub fn encode_coloured(
    mesh: &TriMesh,
    colours: Option<&Colours>,
    options: &WriteOptions,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    encode_painted(mesh, &colours.into(), options, out)
}

/// [`encode_coloured`] with textures, as far as the format holds them; [`Paint::lost_in`] tells what it does not. The materials of OBJ, and
/// the images of OBJ and PLY, are files of their own, which [`TextureMap::side_files`](crate::io::TextureMap::side_files) makes; the mesh names them. glTF writes the triangles of
/// each material in one piece if they follow one another, and in several pieces if not.
///
/// # Errors
/// As [`write()`], and for colours or textures that do not fit. All are checked before the first byte is written.
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
        Format::Obj => obj::write(mesh, paint, &[], out),
        Format::Ply if options.ascii => ply::write_ascii(mesh, paint, out),
        Format::Ply => ply::write_binary(mesh, paint, out),
        Format::Off => off::write(mesh, shown_colours(colours, texture).as_deref(), out),
        Format::Glb => gltf::write_glb(mesh, paint, options.unit, out),
        Format::Gltf => gltf::write_json(mesh, paint, options.unit, out),
        Format::ThreeMf => three_mf::write(mesh, paint, options.unit, out),
    }
}
