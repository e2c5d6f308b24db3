//! Hashes of files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::super::streams::hex;

/// SHA-256 of a regular file; of others, which may have nothing to read for ever, none.
pub fn of_file(path: &Path) -> Option<String> {
    if !path.metadata().ok()?.is_file() {
        return None;
    }
    let mut file = File::open(path).ok()?;
    let (mut hasher, mut block) = (Sha256::new(), vec![0; 1 << 17]);
    loop {
        match file.read(&mut block).ok()? {
            0 => return Some(hex(&hasher.finalize())),
            count => hasher.update(&block[..count]),
        }
    }
}
