//! Files on their way: written beside their place under a name that tells whose they are, renamed at the end.

use std::fs::{self, File, Metadata, OpenOptions};
use std::hash::{Hash, Hasher};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use rustc_hash::FxHasher;

/// More of a file's name is not repeated in the temporary one: names have at most 255 bytes.
const MOST_OF_NAME: usize = 180;

pub(super) const MARK: &str = ".meshwright-";

/// A file that has not yet got its name. Dropped, it is gone.
#[derive(Debug)]
pub(crate) struct Draft {
    target: PathBuf,
    temporary: Option<PathBuf>,
}

impl Draft {
    /// A new file beside `target`, with the permissions of the one that it will replace. A link stays a link: what it
    /// leads to is replaced.
    pub(crate) fn new(target: &Path) -> io::Result<(Self, File)> {
        let existing = target.metadata().ok();
        let target = if existing.is_some() { target.canonicalize()? } else { target.to_owned() };
        let (temporary, file) = create(&target, existing.as_ref())?;
        Ok((Self { target, temporary: Some(temporary) }, file))
    }

    /// Where it is until it is renamed.
    pub(crate) fn temporary(&self) -> &Path {
        self.temporary.as_deref().unwrap_or(&self.target)
    }

    /// Where it will be; links are followed.
    pub(crate) fn target(&self) -> &Path {
        &self.target
    }

    fn rename(&mut self) -> io::Result<()> {
        fs::rename(self.temporary(), &self.target)?;
        self.temporary = None;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if let Some(path) = &self.temporary {
            let _ = fs::remove_file(path);
        }
    }
}

/// Gives all drafts their names, one right after the other. When one cannot have its name, none has: what was there before is put
/// back, and the error comes with the number of the draft. The files must have been flushed to the disk.
pub(crate) fn publish(mut drafts: Vec<Draft>) -> Result<(), (usize, io::Error)> {
    // One alone needs no way back.
    let alone = drafts.len() == 1;
    let mut before = Vec::with_capacity(drafts.len());
    for n in 0..drafts.len() {
        before.push(if alone { Before::Unknown } else { Before::of(&drafts[n].target) });
        if let Err(error) = drafts[n].rename() {
            for (draft, before) in drafts.iter().zip(&before).take(n) {
                before.put_back(&draft.target);
            }
            before[n].forget();
            return Err((n, error));
        }
    }
    before.iter().for_each(Before::forget);
    Ok(())
}

/// What was where a file is to be.
enum Before {
    Nothing,
    /// A file, which has this second name for now.
    Kept(PathBuf),
    /// Something that could not be kept.
    Unknown,
}

impl Before {
    fn of(target: &Path) -> Self {
        if target.symlink_metadata().is_err_and(|error| error.kind() == ErrorKind::NotFound) {
            return Self::Nothing;
        }
        let second = name_beside(target);
        // Not every file system has second names.
        fs::hard_link(target, &second).map_or(Self::Unknown, |()| Self::Kept(second))
    }

    fn put_back(&self, target: &Path) {
        let _ = match self {
            Self::Nothing => fs::remove_file(target),
            Self::Kept(second) => fs::rename(second, target),
            Self::Unknown => Ok(()),
        };
    }

    fn forget(&self) {
        if let Self::Kept(second) = self {
            let _ = fs::remove_file(second);
        }
    }
}

/// Makes the names in the folders of these files last, where the system can.
pub(crate) fn flush_folders<'a>(files: impl IntoIterator<Item = &'a Path>) {
    let mut folders: Vec<&Path> = files.into_iter().map(folder_of).collect();
    folders.sort_unstable();
    folders.dedup();
    for folder in folders {
        // Not every file system can; the files themselves are on the disk in any case.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Tells machines, and containers on one machine, apart: numbers of processes mean something only within one.
pub(super) fn place() -> &'static str {
    static PLACE: OnceLock<String> = OnceLock::new();
    PLACE.get_or_init(|| {
        let mut hasher = FxHasher::default();
        fs::read("/proc/sys/kernel/hostname").ok().hash(&mut hasher);
        fs::read_link("/proc/self/ns/pid").ok().hash(&mut hasher);
        format!("{:08x}", hasher.finish() as u32)
    })
}

/// The name of a file, or its beginning where it is long.
pub(super) fn short_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let end = (0..=name.len().min(MOST_OF_NAME)).rev().find(|&n| name.is_char_boundary(n));
    name[..end.unwrap_or(0)].to_owned()
}

/// A name beside `target` that no other process uses.
fn name_beside(target: &Path) -> PathBuf {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!(".{}{MARK}{}-{}-{number}.tmp", short_name(target), std::process::id(), place());
    folder_of(target).join(name)
}

fn create(target: &Path, existing: Option<&Metadata>) -> io::Result<(PathBuf, File)> {
    loop {
        let path = name_beside(target);
        // As any new file, less what the process's mask takes.
        let file = match OpenOptions::new().read(true).write(true).create_new(true).open(&path) {
            // Of a process long gone that had this one's number.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            made => made?,
        };
        if let Some(existing) = existing {
            let _ = file.set_permissions(existing.permissions());
        }
        return Ok((path, file));
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// What lies in a folder, in order.
    pub(in crate::io) fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("it is there");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("one").file_name().to_string_lossy().into()).collect();
        names.sort();
        names
    }

    fn draft(target: &Path, text: &str) -> Draft {
        let (draft, mut file) = Draft::new(target).expect("it can be made");
        io::Write::write_all(&mut file, text.as_bytes()).expect("it can be written");
        draft
    }

    #[test]
    fn drafts_get_their_names_together_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("old"), "old").expect("written");
        publish(vec![draft(&at("old"), "new"), draft(&at("other"), "other")]).expect("both can be renamed");
        assert_eq!(fs::read_to_string(at("old")).expect("there"), "new");
        assert_eq!(names(folder.path()), ["old", "other"]);
        // A folder took the place of the last one.
        let drafts = vec![draft(&at("old"), "newer"), draft(&at("fresh"), "fresh"), draft(&at("last"), "last")];
        fs::create_dir(at("last")).expect("made");
        let (number, _) = publish(drafts).expect_err("a file cannot replace a folder");
        assert_eq!(number, 2);
        assert_eq!(fs::read_to_string(at("old")).expect("there"), "new");
        assert_eq!(names(folder.path()), ["last", "old", "other"]);
    }

    #[test]
    fn a_dropped_draft_is_gone_and_the_file_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.stl");
        fs::write(&path, "old").expect("written");
        drop(draft(&path, "new"));
        assert_eq!(names(folder.path()), ["a.stl"]);
        assert_eq!(fs::read_to_string(path).expect("there"), "old");
    }

    #[test]
    fn long_names_have_room() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("ä".repeat(127));
        publish(vec![draft(&path, "x")]).expect("it fits");
        assert!(path.exists());
    }
}
