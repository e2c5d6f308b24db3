//! Names of files and streams, what is written to a stream, and why a file cannot be had.

use std::io::{ErrorKind, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

use super::exit::{Exit, Failure};

/// Whether `path` stands for a standard stream.
pub fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether what is written to `path` goes there at once: a stream, a pipe, a device.
pub fn is_direct(path: &Path) -> bool {
    is_stream(path) || path.metadata().is_ok_and(|metadata| !metadata.is_file())
}

/// How a path is called in messages.
pub fn label(path: &Path) -> String {
    if is_stream(path) { "standard input".into() } else { path.display().to_string() }
}

/// "No such file or directory" without "(os error 2)".
pub fn plain_reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_string()
}

/// Why there is no file at `path`.
pub fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let name = if is_stream(path) { "to standard output".into() } else { path.display().to_string() };
    let reason = match error.kind() {
        ErrorKind::BrokenPipe => "whoever read it has stopped reading".into(),
        _ => plain_reason(error),
    };
    let failure = Failure::new(Exit::Write, format!("cannot write {name}: {reason}"));
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            failure.hint("room for it, or another folder; what was there before is as it was")
        }
        _ => failure,
    }
}

/// Writes `bytes` to standard output.
pub fn write_stream(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|error| unwritable(Path::new("-"), &error))
}

/// SHA-256 of `bytes`, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
