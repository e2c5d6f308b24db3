//! Files that are written at once, and not read back.

use std::io::Write;
use std::path::Path;

use super::exit::Failure;
use super::session::Session;
use super::streams::{is_direct, is_stream, unwritable, write_stream};

/// Writes a file that is not read back: a map, a report, a picture.
pub fn write_side(path: &Path, bytes: &[u8], session: &Session) -> Result<(), Failure> {
    if is_direct(path) {
        return write_at_once(path, bytes);
    }
    let mut file = session.draft(path)?.file;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(|error| unwritable(path, &error))
}

/// Writes to a stream, a pipe or a device.
pub fn write_at_once(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    match is_stream(path) {
        true => write_stream(bytes),
        false => std::fs::write(path, bytes).map_err(|error| unwritable(path, &error)),
    }
}
