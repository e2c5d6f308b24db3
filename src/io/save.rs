//! Files that are either whole or not there.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::error::WriteError;

/// Lets `write` fill a temporary file beside `path`, flushes it to the disk and renames it to
/// `path`. On an error, and if the process dies, `path` is as it was before; on an error nothing
/// else is left either. A link is followed, and what is not a regular file (a pipe, a device) is
/// written to directly.
///
/// # Errors
/// What `write` returns, or the operating system's refusal, with the path.
pub fn save_bytes(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
    save(path, |out| write(out).map_err(WriteError::from))
}

pub(super) fn save(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let place = |error: WriteError| error.in_file(path);
    match fs::metadata(path) {
        Ok(target) if !target.is_file() => {
            let file = OpenOptions::new().write(true).open(path).map_err(|e| place(e.into()))?;
            fill(file, write).map(drop).map_err(place)
        }
        existing => replace(path, existing.ok(), write).map_err(place),
    }
}

fn replace(
    path: &Path,
    existing: Option<fs::Metadata>,
    write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let target = if existing.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".meshwright-").suffix(".part");
    #[cfg(unix)]
    {
        // As an ordinary new file gets them; the process's mask still applies.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let (file, temporary) = builder.tempfile_in(folder)?.into_parts();
    let file = fill(file, write)?;
    if let Some(existing) = existing {
        file.set_permissions(existing.permissions())?;
    }
    file.sync_all()?;
    drop(file);
    temporary.persist(&target).map_err(|e| e.error)?;
    Ok(())
}

fn fill(file: File, write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<File, WriteError> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out)?;
    Ok(out.into_inner().map_err(io::IntoInnerError::into_error)?)
}
