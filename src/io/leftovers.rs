//! What killed runs have left of files on their way.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::draft::{MARK, folder_of, place, short_name};

/// Files of processes that cannot be asked (of another machine, or of another container) are abandoned after this time.
const FORGOTTEN: Duration = Duration::from_secs(24 * 60 * 60);

/// Removes what killed runs have left of files that were to be `targets`, links followed.
pub(crate) fn clear_leftovers(targets: &[PathBuf]) {
    let mut names: BTreeMap<&Path, BTreeSet<String>> = BTreeMap::new();
    for target in targets {
        names.entry(folder_of(target)).or_default().insert(short_name(target));
    }
    for (folder, names) in names {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let parts = name.to_str().and_then(|name| name.strip_prefix('.')?.rsplit_once(MARK));
            let owner = parts.filter(|(of, _)| names.contains(*of)).and_then(|(_, rest)| Owner::parse(rest));
            if owner.is_some_and(|owner| owner.is_gone(entry.metadata().ok().as_ref())) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}

/// A process, and where its number means something.
struct Owner<'a> {
    process: u32,
    place: &'a str,
}

impl<'a> Owner<'a> {
    /// Of the rest of a name: `PROCESS-PLACE-NUMBER.tmp`.
    fn parse(rest: &'a str) -> Option<Self> {
        let mut words = rest.strip_suffix(".tmp")?.split('-');
        let (process, place, number) = (words.next()?, words.next()?, words.next()?);
        number.parse::<u32>().ok()?;
        (words.next().is_none()).then_some(Self { process: process.parse().ok()?, place })
    }

    /// Whether it no longer runs. This process itself has not begun when it asks.
    fn is_gone(&self, file: Option<&Metadata>) -> bool {
        if self.place == place() && Path::new("/proc/self").exists() {
            return self.process == std::process::id() || !runs(self.process);
        }
        let age = file.and_then(|file| SystemTime::now().duration_since(file.modified().ok()?).ok());
        age.is_some_and(|age| age > FORGOTTEN)
    }
}

/// Whether a process of this number runs, and is called as this one is.
fn runs(process: u32) -> bool {
    let name = |process: &str| fs::read(format!("/proc/{process}/comm")).ok();
    name(&process.to_string()).is_some_and(|other| name("self").is_none_or(|own| own == other))
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use super::*;
    use crate::io::draft::tests::names;

    #[test]
    #[cfg(target_os = "linux")]
    fn only_what_dead_processes_left_of_this_file_is_cleared() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, place) = (folder.path().join("a.stl"), place());
        // Numbers of processes end far below this one. The first process runs, under another name.
        let dead = format!(".a.stl.meshwright-4194999999-{place}-0.tmp");
        let (own, first) = (std::process::id(), format!(".a.stl.meshwright-1-{place}-0.tmp"));
        let own = format!(".a.stl.meshwright-{own}-{place}-7.tmp");
        let kept = [
            ".a.stl.meshwright-4194999999-elsewhere-0.tmp".to_owned(),
            format!(".b.stl.meshwright-4194999999-{place}-0.tmp"),
            ".a.stl.meshwright-notes.tmp".to_owned(),
            "a.stl".to_owned(),
        ];
        for name in [&dead, &first, &own].into_iter().chain(&kept) {
            fs::write(folder.path().join(name), "x").expect("written");
        }
        let elsewhere = File::options().write(true).open(folder.path().join(&kept[0])).expect("there");
        clear_leftovers(std::slice::from_ref(&path));
        let mut expected = kept.to_vec();
        expected.sort();
        assert_eq!(names(folder.path()), expected);
        // After a day nobody comes back for it.
        elsewhere.set_modified(SystemTime::now() - 2 * FORGOTTEN).expect("set");
        clear_leftovers(std::slice::from_ref(&path));
        assert!(!names(folder.path()).contains(&kept[0]));
    }
}
