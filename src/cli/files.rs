//! The files of a run, looked at before it starts: none is written twice, no input is lost, and all can be written.

use std::collections::HashMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::exit::{Exit, Failure};
use super::streams::{self, is_stream, label, plain_reason};
use crate::io::draft::folder_of;
use crate::io::leftovers::clear_leftovers;

/// A file that a run makes.
pub struct Made {
    /// The flag that asks for it.
    pub flag: &'static str,
    /// Where it goes.
    pub path: PathBuf,
    /// Whether it may be written over an input.
    pub force: bool,
}

impl Made {
    /// What `flag` asks for, if it is given; never over an input.
    pub fn side(flag: &'static str, path: Option<&PathBuf>) -> Option<Self> {
        path.map(|path| Self { flag, path: path.clone(), force: false })
    }
}

/// Refuses files that would collide with one another or with an input, and places where there can be no file.
pub fn check(inputs: &[&Path], made: &[Made]) -> Result<(), Failure> {
    let read: HashMap<Key, &Path> =
        inputs.iter().filter_map(|path| Some((Key::of(path, "/dev/stdin")?, *path))).collect();
    let mut written: HashMap<Key, &Made> = HashMap::new();
    for file in made {
        let (flag, name) = (file.flag, file.path.display());
        if !is_stream(&file.path) {
            check_place(&file.path)?;
        }
        let Some(key) = Key::of(&file.path, "/dev/stdout") else { continue };
        if !file.force && read.contains_key(&key) {
            let failure = Failure::usage(format!("{name} is an input and would be overwritten"));
            return Err(failure.hint(match flag {
                "-o" => "another name after -o, or --force".into(),
                _ => format!("another name after {flag}"),
            }));
        }
        if let Some(other) = written.insert(key, file) {
            let (first, other) = (other.flag, other.path.display());
            return Err(Failure::usage(format!("{first} {other} and {flag} {name} are the same file")));
        }
    }
    Ok(())
}

/// The files of a run, which those that go beside its output must leave alone.
#[derive(Default)]
pub struct KeptFiles {
    keys: Vec<Key>,
    /// Whether an output may take the place of an input.
    pub force: bool,
}

impl KeptFiles {
    /// Those of a run.
    pub fn of(inputs: &[&Path], made: &[Made]) -> Self {
        let paths = inputs.iter().copied().chain(made.iter().map(|made| made.path.as_path()));
        let keys = paths.filter(|path| !is_stream(path)).filter_map(|path| Key::of(path, "/dev/stdin")).collect();
        Self { keys, force: made.iter().any(|made| made.force) }
    }

    /// Whether the file at `path` is an input, or one that the run makes by name.
    pub fn contain(&self, path: &Path) -> bool {
        Key::of(path, "/dev/stdin").is_some_and(|key| self.keys.contains(&key))
    }
}

/// Makes sure that files can be made in all folders, and removes what killed runs have left of these files.
pub fn prepare<'a>(made: impl IntoIterator<Item = &'a Made>) -> Result<(), Failure> {
    let files = made.into_iter().map(|made| made.path.as_path());
    let targets: Vec<PathBuf> = files.filter(|path| !streams::is_direct(path)).map(resolved).collect();
    let mut folders: Vec<&Path> = targets.iter().map(|target| folder_of(target)).collect();
    folders.sort_unstable();
    folders.dedup();
    for folder in folders {
        tempfile::tempfile_in(folder).map_err(|error| {
            Failure::new(Exit::Write, format!("cannot write into {}: {}", folder.display(), plain_reason(&error)))
                .hint("another folder, or the right to write into this one")
        })?;
    }
    clear_leftovers(&targets);
    Ok(())
}

/// Refuses an input that cannot be read, as far as can be told without reading it.
pub fn check_input(path: &Path) -> Result<(), Failure> {
    if is_stream(path) {
        return Ok(());
    }
    if let Some(why) = broken_link(path) {
        return Err(Failure::input(format!("{} is {why}", path.display())));
    }
    let opened = match path.metadata() {
        Ok(metadata) if metadata.is_dir() => return Err(Failure::input(format!("{} is a folder", path.display()))),
        // A pipe would be opened twice.
        Ok(metadata) if !metadata.is_file() => Ok(()),
        Ok(_) => File::open(path).map(drop),
        Err(error) => Err(error),
    };
    opened.map_err(|error| Failure::input(format!("cannot read {}: {}", label(path), plain_reason(&error))))
}

/// Whether there can be a file at `path`.
fn check_place(path: &Path) -> Result<(), Failure> {
    if let Some(why) = broken_link(path) {
        let name = path.display();
        return Err(Failure::usage(format!("{name} is {why}")).hint("remove the link, or give another name"));
    }
    if path.is_dir() {
        return Err(Failure::usage(format!("{} is a folder", path.display())));
    }
    if path.file_name().is_none() {
        return Err(Failure::usage(format!("`{}` is not the name of a file", path.display())));
    }
    let folder = folder_of(path);
    match folder.metadata() {
        Ok(metadata) if metadata.is_dir() => Ok(()),
        Ok(_) => Err(Failure::usage(format!("{} is not a folder", folder.display()))),
        Err(e) => Err(Failure::usage(format!("cannot write into {}: {}", folder.display(), plain_reason(&e)))),
    }
}

/// What is wrong with the link at `path`, if it is one that leads to nothing.
fn broken_link(path: &Path) -> Option<&'static str> {
    // As many links on the way as Linux follows.
    const MOST_LINKS: usize = 40;
    if !path.is_symlink() || path.metadata().is_ok() {
        return None;
    }
    let mut at = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&at) {
            Ok(next) => at = folder_of(&at).join(next),
            Err(_) => return Some("a link that leads nowhere"),
        }
    }
    Some("a link that leads back to itself")
}

/// The path of a file behind its links, also of one that does not exist yet.
fn resolved(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = folder_of(path);
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        path.file_name().map_or_else(|| path.to_owned(), |name| folder.join(name))
    })
}

/// What makes two names names of one file.
#[derive(PartialEq, Eq, Hash)]
enum Key {
    /// An existing file: the device and the number that it has there.
    #[cfg(unix)]
    Node(u64, u64),
    /// The path behind all links.
    Path(PathBuf),
}

impl Key {
    /// Of a path; of `stream` where the path stands for it. None where it does not matter how often it is used, as with `/dev/null`,
    /// or cannot be told.
    fn of(path: &Path, stream: &str) -> Option<Self> {
        let path = if is_stream(path) { Path::new(stream) } else { path };
        let metadata = path.metadata();
        #[cfg(unix)]
        if let Ok(metadata) = &metadata {
            use std::os::unix::fs::{FileTypeExt, MetadataExt};
            let kind = metadata.file_type();
            return (kind.is_file() || kind.is_fifo()).then(|| Self::Node(metadata.dev(), metadata.ino()));
        }
        (path.as_os_str() != stream && metadata.as_ref().map_or(true, fs::Metadata::is_file))
            .then(|| Self::Path(resolved(path)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(flag: &'static str, path: impl Into<PathBuf>) -> Made {
        Made { flag, path: path.into(), force: false }
    }

    #[test]
    fn files_are_compared_as_files() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("sub")).expect("made");
        fs::write(at("in.off"), "x").expect("written");
        let refused = |inputs: &[&Path], files: &[Made], words: &str| {
            let failure = check(inputs, files).expect_err("they are the same");
            assert_eq!(failure.exit, Exit::Usage);
            assert!(failure.message.contains(words), "{failure}");
        };
        // Neither exists yet.
        refused(&[], &[made("-o", at("x.ply")), made("--map", at("./sub/../x.ply"))], "are the same file");
        refused(&[&at("in.off")], &[made("--map", at("sub/../in.off"))], "is an input");
        assert!(check(&[&at("in.off")], &[made("-o", at("x.ply")), made("--map", at("y.ply"))]).is_ok());
        let forced = Made { force: true, ..made("-o", at("in.off")) };
        assert!(check(&[&at("in.off")], &[forced]).is_ok());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("in.off", at("link.off")).expect("linked");
            fs::hard_link(at("in.off"), at("second.off")).expect("linked");
            std::os::unix::fs::symlink("sub", at("way")).expect("linked");
            refused(&[&at("in.off")], &[made("-o", at("link.off"))], "is an input");
            refused(&[&at("in.off")], &[made("-o", at("second.off"))], "is an input");
            refused(&[], &[made("-o", at("sub/new.ply")), made("--report", at("way/new.ply"))], "are the same file");
            let nowhere = [made("-o", "/dev/null"), made("--map", "/dev/null")];
            assert!(check(&[], &nowhere).is_ok());
        }
    }

    #[test]
    #[cfg(unix)]
    fn links_to_nothing_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for (link, to) in
            [("nowhere", "absent"), ("far", "nowhere"), ("self", "self"), ("there", "back"), ("back", "there")]
        {
            std::os::unix::fs::symlink(to, at(link)).expect("linked");
        }
        for (link, words) in [("nowhere", "leads nowhere"), ("far", "nowhere"), ("self", "itself"), ("there", "itself")]
        {
            let output = check(&[], &[made("-o", at(link))]).expect_err("no file can be there");
            assert!(output.message.contains(words), "{output}");
            let input = check_input(&at(link)).expect_err("no file is there");
            assert!(input.exit == Exit::Input && input.message.contains(words), "{input}");
        }
    }
}
