//! The inputs of a batch: files, folders and patterns.

use std::fs;
use std::path::{Component, Path, PathBuf};

use super::super::exit::Failure;
use super::super::streams::{is_stream, plain_reason};
use crate::io::Format;

/// A file, and what its output is called, seen from the folder of the outputs, before its extension is settled.
#[derive(Debug, PartialEq, Eq)]
pub struct Found {
    /// Where it is.
    pub path: PathBuf,
    /// Its name with the folders that are kept.
    pub name: PathBuf,
}

/// All files that `inputs` stand for. What lies in the folder of the outputs is left out of folders and patterns.
pub fn gather(inputs: &[PathBuf], out: &Path) -> Result<Vec<Found>, Failure> {
    let out = out.canonicalize().ok();
    let mut found = Vec::new();
    for input in inputs {
        let count = found.len();
        if is_stream(input) {
            return Err(Failure::usage("a batch reads files, and `-` is standard input").hint("the names of files"));
        }
        match input.metadata() {
            Ok(data) if data.is_dir() => {
                walk(input, Path::new(""), out.as_deref(), &mut found)?;
                if found.len() == count {
                    let failure = Failure::usage(format!("there is no mesh in the folder {}", input.display()));
                    return Err(
                        failure.hint("folders are searched for files that end in stl, obj, ply, off, glb, gltf or 3mf")
                    );
                }
            }
            Ok(_) => {
                let name = input.file_name().map(PathBuf::from);
                let name =
                    name.ok_or_else(|| Failure::usage(format!("{} is not the name of a file", input.display())))?;
                found.push(Found { path: input.clone(), name });
            }
            Err(_) if is_pattern(input) => match_pattern(input, out.as_deref(), &mut found)?,
            Err(error) => {
                return Err(Failure::usage(format!("cannot read {}: {}", input.display(), plain_reason(&error))));
            }
        }
    }
    Ok(found)
}

/// The meshes in a folder and in those below it, in the order of their names. Links to files are followed, links to folders are not,
/// and names that begin with a point are left alone.
fn walk(folder: &Path, name: &Path, out: Option<&Path>, found: &mut Vec<Found>) -> Result<(), Failure> {
    let unreadable = |error: std::io::Error| {
        Failure::usage(format!("cannot read the folder {}: {}", folder.display(), plain_reason(&error)))
    };
    let mut entries =
        fs::read_dir(folder).and_then(|entries| entries.collect::<Result<Vec<_>, _>>()).map_err(unreadable)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let (path, name) = (entry.path(), name.join(entry.file_name()));
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            if out.is_none() || path.canonicalize().ok().as_deref() != out {
                walk(&path, &name, out, found)?;
            }
        } else if Format::from_path(&path).is_some() && path.is_file() {
            found.push(Found { path, name });
        }
    }
    Ok(())
}

fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?', '['])
}

/// The files that a pattern matches; the folders from its first wildcard on are kept.
fn match_pattern(pattern: &Path, out: Option<&Path>, found: &mut Vec<Found>) -> Result<(), Failure> {
    let text = pattern.to_string_lossy();
    let wrong = |why: String| Failure::usage(format!("`{text}` is no pattern: {why}"));
    let options =
        glob::MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };
    let base: PathBuf = pattern.components().take_while(|part| !is_pattern(Path::new(part.as_os_str()))).collect();
    let count = found.len();
    for path in glob::glob_with(&text, options).map_err(|error| wrong(error.to_string()))? {
        let path = path.map_err(|error| {
            Failure::usage(format!("cannot read {}: {}", error.path().display(), plain_reason(error.error())))
        })?;
        let in_outputs = out.is_some_and(|out| path.canonicalize().is_ok_and(|path| path.starts_with(out)));
        let outputs_hold_base = out.is_some_and(|out| base.canonicalize().is_ok_and(|base| base.starts_with(out)));
        if path.is_dir() || (in_outputs && !outputs_hold_base) {
            continue;
        }
        let kept = path.strip_prefix(&base).unwrap_or(&path);
        let name = kept.components().filter(|part| matches!(part, Component::Normal(_))).collect();
        found.push(Found { path, name });
    }
    if found.len() == count {
        return Err(Failure::usage(format!("no file matches {text}")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_patterns_keep_what_is_below_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for sub in ["in/sub/deep", "in/out", "in/.hidden"] {
            fs::create_dir_all(at(sub)).expect("made");
        }
        for name in [
            "in/a.stl",
            "in/b.txt",
            "in/sub/c.OBJ",
            "in/sub/deep/a.stl",
            "in/out/d.stl",
            "in/.hidden/e.stl",
            "in/.f.stl",
        ] {
            fs::write(at(name), "x").expect("written");
        }
        let names = |input: &str| -> Vec<String> {
            let found = gather(&[at(input)], &at("in/out")).expect("found");
            found.iter().map(|found| found.name.display().to_string()).collect()
        };
        assert_eq!(names("in"), ["a.stl", "sub/c.OBJ", "sub/deep/a.stl"]);
        assert_eq!(names("in/**/*.stl"), ["a.stl", "sub/deep/a.stl"]);
        assert_eq!(names("in/sub/*"), ["c.OBJ"]);
        assert_eq!(names("in/b.txt"), ["b.txt"]);
        for (input, words) in
            [("in/none", "cannot read"), ("in/*.ply", "no file matches"), ("in/out/../.hidden/x[", "no pattern")]
        {
            let failure = gather(&[at(input)], &at("elsewhere")).expect_err("nothing is there");
            assert!(failure.message.contains(words), "{failure}");
        }
    }
}
