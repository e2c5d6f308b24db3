//! `--manifest`: jobs from a file, one in each line.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::super::exit::Failure;
use super::super::streams::plain_reason;

/// What a line says.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// The verb, where it is not that of the command line.
    pub verb: Option<String>,
    input: Option<PathBuf>,
    #[serde(default)]
    inputs: Vec<PathBuf>,
    /// The output, seen from the folder of the outputs.
    pub output: Option<PathBuf>,
    #[serde(default)]
    options: Vec<Word>,
    /// Its number in the file.
    #[serde(skip)]
    pub number: usize,
}

/// A word of the options.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Word {
    Text(String),
    Number(serde_json::Number),
}

impl Line {
    /// What it reads.
    pub fn inputs(&self) -> Vec<PathBuf> {
        self.input.iter().chain(&self.inputs).cloned().collect()
    }

    /// Its options, as words of a command line.
    pub fn options(&self) -> Vec<OsString> {
        let word = |word: &Word| match word {
            Word::Text(text) => text.into(),
            Word::Number(number) => number.to_string().into(),
        };
        self.options.iter().map(word).collect()
    }

    /// How it is called in messages.
    pub fn place(&self, manifest: &Path) -> String {
        format!("{}, line {}", manifest.display(), self.number)
    }
}

/// The lines of a manifest; empty ones are left out.
pub fn read(path: &Path) -> Result<Vec<Line>, Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::usage(format!("cannot read {}: {}", path.display(), plain_reason(&error))))?;
    let mut lines = Vec::new();
    for (n, text) in text.lines().enumerate().filter(|(_, text)| !text.trim().is_empty()) {
        let line = serde_json::from_str::<Line>(text).map(|line| Line { number: n + 1, ..line });
        lines.push(line.map_err(|error| {
            Failure::usage(format!("{}, line {}, is no job: {}", path.display(), n + 1, without_place(&error)))
                .hint(r#"{"verb": "repair", "input": "a.stl", "output": "a.ply", "options": ["--resolution", 128]}"#)
        })?);
    }
    Ok(lines)
}

/// What is wrong, without the place within the one line.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.rsplit_once(" at line ").map_or(text.clone(), |(what, _)| what.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_jobs_or_are_refused_with_their_number() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("jobs.jsonl");
        let read = |text: &str| {
            std::fs::write(&path, text).expect("written");
            read(&path)
        };
        let lines = read(
            "{\"input\": \"a.stl\", \"options\": [\"--resolution\", 64]}\n\n{\"inputs\": [\"a\", \"b\"], \"verb\": \"union\"}\n",
        );
        let lines = lines.expect("jobs");
        assert_eq!(lines.iter().map(|line| (line.number, line.inputs().len())).collect::<Vec<_>>(), [(1, 1), (3, 2)]);
        assert_eq!(lines[0].options(), ["--resolution", "64"]);
        for text in ["{}\nnonsense", "\n{\"inptu\": \"a\"}", "\n[1]"] {
            let failure = read(text).expect_err("no job");
            assert!(failure.message.contains("line 2"), "{failure}");
        }
    }
}
