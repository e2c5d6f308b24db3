//! Files beside a mesh: buffers, materials, images. Nothing outside of its folder is ever read.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Bytes that all files beside a mesh may have together. A GLB file cannot hold more either.
pub(in crate::io) const MOST_BESIDE: u64 = 1 << 32;

/// The file of this name below the folder of `base`; `None` for a name that leads elsewhere.
pub(in crate::io) fn file_beside(name: &str, base: &Path) -> Option<PathBuf> {
    let relative = Path::new(name);
    let plain = relative.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let has_scheme = name.split(['/', '?', '#']).next().is_some_and(|first| first.contains(':'));
    (plain && !has_scheme && !name.is_empty() && !name.contains('\0'))
        .then(|| base.parent().unwrap_or(Path::new("")).join(relative))
}

/// The first bytes of `file`, as many as `most`; `None` when it is a link that leads out of the folder of `base`, or no file but a
/// device or a pipe, which may never end.
pub(in crate::io) fn read_beside(file: &Path, base: &Path, most: u64) -> io::Result<Option<Vec<u8>>> {
    let folder = base.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let place = file.canonicalize()?;
    if !place.starts_with(folder.canonicalize()?) || !fs::metadata(&place)?.is_file() {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    File::open(&place)?.take(most).read_to_end(&mut bytes)?;
    Ok(Some(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_elsewhere_are_not_found() {
        let base = Path::new("models/a.gltf");
        assert_eq!(file_beside("my mesh.bin", base), Some("models/my mesh.bin".into()));
        assert_eq!(file_beside("sub/./b.bin", base), Some("models/sub/./b.bin".into()));
        for name in ["/etc/passwd", "../b.bin", "sub/../../b.bin", "http://x/b.bin", "file:b", "C:b", "", "a\0b"] {
            assert_eq!(file_beside(name, base), None, "{name}");
        }
    }
}
