//! Files that are either whole or not there.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::draft::{Draft, flush_folders, folder_of, publish};
use super::error::WriteError;
use super::texture::SideFile;

/// Lets `write` fill a temporary file beside `path`, flushes it to the disk, renames it to `path` and
/// flushes the folder. On an error, and if the process dies, `path` is as it was before; on an error
/// nothing else is left either. A link is followed, and what is not a regular file (a pipe, a device) is
/// written to directly.
///
/// # Errors
/// What `write` returns, or the operating system's refusal, with the path.
pub fn save_bytes(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    save(path.as_ref(), &[], |out| write(out).map_err(WriteError::from))
}

/// [`save_bytes`] with files that get their names together with `path`. A pipe or a device has none of these.
pub(super) fn save(
    path: &Path,
    beside: &[SideFile],
    write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let place = |error: WriteError| error.in_file(path);
    match fs::metadata(path) {
        Ok(target) if !target.is_file() => {
            let file = OpenOptions::new().write(true).open(path).map_err(|e| place(e.into()))?;
            fill(file, write).map(drop).map_err(place)
        }
        _ => replace(path, beside, write).map_err(place),
    }
}

fn replace(
    path: &Path,
    beside: &[SideFile],
    write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let (draft, file) = Draft::new(path)?;
    fill(file, write)?.sync_all()?;
    let mut drafts = vec![draft];
    for SideFile { name, bytes } in beside {
        let (draft, mut file) = Draft::new(&folder_of(path).join(name))?;
        file.write_all(bytes)?;
        file.sync_all()?;
        drafts.push(draft);
    }
    let targets: Vec<PathBuf> = drafts.iter().map(|draft| draft.target().to_owned()).collect();
    publish(drafts).map_err(|(_, error)| error)?;
    flush_folders(targets.iter().map(PathBuf::as_path));
    Ok(())
}

fn fill(file: File, write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<File, WriteError> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out)?;
    Ok(out.into_inner().map_err(io::IntoInnerError::into_error)?)
}
