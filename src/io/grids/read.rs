//! From a file to a lattice.

use std::fs;
use std::path::Path;

use super::error::{GridReadError, GridReadProblem};
use super::numbers::Cap;
use super::{GridFile, GridFormat, npy, nrrd, vdb, vti};

/// Reads the lattice in the file at `path`; its format is told by content, then by extension.
///
/// # Errors
/// When the file cannot be read or is not sound: see [`GridReadProblem`].
pub fn read_grid(path: &Path) -> Result<GridFile, GridReadError> {
    let bytes = fs::read(path).map_err(|e| GridReadError::from(GridReadProblem::Io(e)).in_file(Some(path), None))?;
    read_grid_bytes(&bytes, None, Some(path))
}

/// Reads a lattice from `bytes`. With `format` none, it is told by content, then by the extension of `path`, which also
/// names the file in errors.
///
/// # Errors
/// When the bytes are not a sound file: see [`GridReadProblem`].
pub fn read_grid_bytes(
    bytes: &[u8],
    format: Option<GridFormat>,
    path: Option<&Path>,
) -> Result<GridFile, GridReadError> {
    read_grid_within(bytes, format, path, None)
}

/// [`read_grid_bytes`] within a cap on the memory for the file and its values: as soon as the header tells how many
/// there are, and before there is room made for them, more is refused.
///
/// # Errors
/// [`GridReadProblem::Memory`], and when the bytes are not a sound file.
pub fn read_grid_within(
    bytes: &[u8],
    format: Option<GridFormat>,
    path: Option<&Path>,
    max_memory: Option<u64>,
) -> Result<GridFile, GridReadError> {
    let cap = Cap { length: bytes.len(), allowed: max_memory };
    let found = format.or_else(|| GridFormat::detect(bytes, path));
    let read = match found {
        _ if bytes.is_empty() => Err(GridReadProblem::Empty.into()),
        None => Err(GridReadProblem::UnknownFormat.into()),
        // A name alone makes no format: every one begins in its own way.
        Some(named) if GridFormat::from_content(bytes) != Some(named) => {
            let expected = format!("the beginning of a file of {named}");
            Err(GridReadProblem::syntax(expected, super::error::shown(&bytes[..bytes.len().min(16)])).at_byte(0))
        }
        Some(GridFormat::Vti) => vti::read(bytes, cap),
        Some(GridFormat::Nrrd) => nrrd::read(bytes, cap),
        Some(GridFormat::Npy) => npy::read(bytes, cap),
        Some(GridFormat::Vdb) => vdb::read(bytes, cap),
    };
    read.map_err(|error| error.in_file(path, found))
}
