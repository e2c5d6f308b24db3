//! From a file to a lattice.

use std::fs;
use std::path::Path;

use super::numbers::Cap;
use super::{GridFile, GridFormat, npy, nrrd, vdb, vti};
use crate::io::error::{FileError, FileProblem, Wanted};
use crate::io::text::quoted;

/// Reads the lattice in the file at `path`. Its format is told by the content, which begins in its own way in each of them.
///
/// # Errors
/// [`FileError`] with the file, the place in it and a [`FileProblem`]: the file cannot be opened, is of no format known here, is cut
/// short, breaks the rules of its format, has voxels that are not cubes along the axes or values that are not finite, or unfolds into far
/// more than its size justifies.
pub fn read_grid(path: impl AsRef<Path>) -> Result<GridFile, FileError> {
    let path = path.as_ref();
    let failed = |error| FileError::from(FileProblem::Io(error)).in_file(Some(path), None::<GridFormat>);
    let bytes = fs::read(path).map_err(failed)?;
    read_grid_bytes(&bytes, None, Some(path))
}

/// Reads a lattice from `bytes`. Without a `format`, it is told by the content. `path` names the file in errors.
///
/// # Errors
/// As [`read_grid`], but for files that cannot be opened.
pub fn read_grid_bytes(bytes: &[u8], format: Option<GridFormat>, path: Option<&Path>) -> Result<GridFile, FileError> {
    read_grid_within(bytes, format, path, None)
}

/// [`read_grid_bytes`] within a cap on the memory for the file and its values: as soon as the header tells how many
/// there are, and before there is room made for them, more is refused.
///
/// # Errors
/// [`FileProblem::Memory`], and as [`read_grid_bytes`].
pub fn read_grid_within(
    bytes: &[u8],
    format: Option<GridFormat>,
    path: Option<&Path>,
    max_memory: Option<u64>,
) -> Result<GridFile, FileError> {
    let cap = Cap { length: bytes.len(), allowed: max_memory };
    let found = format.or_else(|| GridFormat::detect(bytes, path));
    let read = match found {
        _ if bytes.is_empty() => Err(FileProblem::Empty.into()),
        None => Err(FileProblem::UnknownFormat(Wanted::Grid).into()),
        // A name alone makes no format: every one begins in its own way.
        Some(named) if GridFormat::from_content(bytes) != Some(named) => {
            let expected = format!("the beginning of a file of {named}");
            Err(FileProblem::syntax(expected, quoted(&bytes[..bytes.len().min(16)])).at_byte(0))
        }
        Some(GridFormat::Vti) => vti::read(bytes, cap),
        Some(GridFormat::Nrrd) => nrrd::read(bytes, cap),
        Some(GridFormat::Npy) => npy::read(bytes, cap),
        Some(GridFormat::Vdb) => vdb::read(bytes, cap),
    };
    read.map_err(|error| error.in_file(path, found))
}
