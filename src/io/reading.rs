//! From a file or bytes to a [`Loaded`].

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use super::error::{FileError, FileProblem, Wanted};
use super::format::Format;
use super::loaded::Loaded;
use super::{encoding, foreign, gltf, obj, off, ply, stl, three_mf};

/// Reads the mesh file at `path`. Its format is told by the content; the extension counts only where the content tells nothing.
/// Materials and images that the file names are read where they lie beside it, and nothing outside of its folder is.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("scan.off");
/// # std::fs::write(&path, "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")?;
/// # let path = path.to_str().expect("a plain name");
/// use meshwright::io;
///
/// let loaded = io::read(path)?; // a &str, a String, a Path: "scan.off"
/// assert_eq!((loaded.format, loaded.mesh.triangles.len()), (io::Format::Off, 4));
/// assert!(loaded.warnings.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FileError`] with the file, the place in it and a [`FileProblem`]: the file cannot be opened, is of no format known here, is cut
/// short, breaks the rules of its format, refers to what is not there, unfolds into far more than its size justifies, or
/// holds no triangle.
pub fn read(path: impl AsRef<Path>) -> Result<Loaded, FileError> {
    read_file(path.as_ref(), None)
}

/// [`read`] for a file whose format is known; neither content nor extension are asked.
///
/// # Errors
/// As [`read`]; a file of another format mostly fails as one that breaks the rules.
pub fn read_as(path: impl AsRef<Path>, format: Format) -> Result<Loaded, FileError> {
    read_file(path.as_ref(), Some(format))
}

fn read_file(path: &Path, format: Option<Format>) -> Result<Loaded, FileError> {
    let bytes = fs::read(path).map_err(|error| FileError::from(FileProblem::Io(error)).in_file(Some(path), format))?;
    read_bytes(&bytes, format, Some(path))
}

/// Reads a mesh from `bytes`. Without a `format`, it is told by the content, then by the extension of `path`. `path` also
/// names the file in errors, and the external buffers of glTF, the materials of OBJ and images are looked for beside it; without it
/// such buffers are refused, and materials and images are left out with a warning.
///
/// ```
/// use meshwright::io::{Format, read_bytes};
///
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// assert_eq!(read_bytes(obj, None, None)?.format, Format::Obj);
///
/// let error = read_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", None, None).unwrap_err();
/// assert_eq!(error.to_string(), "input: line 4: index 9 is out of range, there are 3 vertices");
/// # Ok::<(), meshwright::io::FileError>(())
/// ```
///
/// # Errors
/// As [`read`], but for files that cannot be opened.
pub fn read_bytes(bytes: &[u8], format: Option<Format>, path: Option<&Path>) -> Result<Loaded, FileError> {
    let plain = plain(bytes);
    let bytes = plain.as_ref();
    let found = recognised(bytes, format, path)?;
    let loaded = match found {
        Format::Stl => stl::read(bytes),
        Format::Obj => obj::read(bytes, path),
        Format::Ply => ply::read(bytes, path),
        Format::Off => off::read(bytes),
        Format::Glb => gltf::read_glb(bytes, path),
        Format::Gltf => gltf::read_json(bytes, path),
        Format::ThreeMf => three_mf::read(bytes),
    };
    let mut loaded = loaded.map_err(|error| match format.and_then(|_| foreign::recognise(bytes, None)) {
        Some(problem) => FileError::from(problem).in_file(path, Some(found)),
        None => error.in_file(path, Some(found)),
    })?;
    if let (None, Some(named)) = (format, path.and_then(Format::from_path)) {
        let misnamed = named != loaded.format;
        let warning = || format!("named as {named}, and read as {}, which it is", loaded.format);
        let warning = misnamed.then(warning);
        loaded.warnings.extend(warning);
    }
    Ok(loaded)
}

/// The bytes as the readers take them.
pub(super) fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    match stl::is_exactly_binary(bytes) {
        true => Cow::Borrowed(bytes),
        false => encoding::plain(bytes),
    }
}

/// The format of a file: the one that is given, else the one that the content tells, else that of the name.
pub(super) fn recognised(bytes: &[u8], format: Option<Format>, path: Option<&Path>) -> Result<Format, FileError> {
    let found = format.or_else(|| Format::detect(bytes, path));
    // A name says little: what begins as something else is that.
    let misnamed = match format.is_none() && Format::from_content(bytes).is_none() {
        true => foreign::recognise(bytes, path),
        false => None,
    };
    let problem = match (found, misnamed) {
        _ if bytes.is_empty() => FileProblem::Empty,
        (_, Some(misnamed)) => misnamed,
        (None, None) => FileProblem::UnknownFormat(Wanted::Mesh),
        (Some(found), None) => return Ok(found),
    };
    // Bytes that are given as a format and are known as something else are told as that.
    let problem = format.and_then(|_| foreign::recognise(bytes, None)).unwrap_or(problem);
    Err(FileError::from(problem).in_file(path, found))
}
