//! The command line as users meet it: real processes, real files.

#[path = "../common/mod.rs"]
mod common;

mod batch;
#[cfg(target_os = "linux")]
mod batch_stops;
mod compare;
mod documents;
mod each;
mod each_gltf;
mod each_obj;
mod each_three_mf;
mod exact;
mod faults;
mod fields;
mod files;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(unix)]
mod lead;
mod maps;
mod page;
mod pictures;
mod readers;
mod schema;
mod sdf;
mod sheets;
mod slices;
mod solids;
mod stops;
mod stumbles;
mod testdata;
mod textures;
mod tools;
mod usage;
mod view;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// One run of the program.
struct Run {
    status: i32,
    stdout: Vec<u8>,
    stderr: String,
}

impl Run {
    /// Asserts the exit status; a failure shows what the program said.
    #[track_caller]
    fn exits(self, status: i32) -> Self {
        assert_eq!(self.status, status, "stderr:\n{}", self.stderr);
        self
    }

    /// Asserts that standard error has all of `words`.
    #[track_caller]
    fn says(self, words: &[&str]) -> Self {
        for word in words {
            assert!(self.stderr.contains(word), "`{word}` is missing in:\n{}", self.stderr);
        }
        self
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(&self.stdout).into_owned()
    }

    #[track_caller]
    fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).unwrap_or_else(|e| panic!("{e} in:\n{}\n{}", self.text(), self.stderr))
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            status: output.status.code().unwrap_or(-1),
            stdout: output.stdout,
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshwright"));
    command.stdin(Stdio::null()).current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// Runs the program with arguments separated by spaces; `OUT` stands for `folder`.
#[track_caller]
fn run_in(folder: &TempDir, arguments: &str) -> Run {
    let folder = folder.path().to_str().expect("temporary folders have plain names");
    let arguments: Vec<String> = arguments.split_whitespace().map(|a| a.replace("OUT", folder)).collect();
    program().args(arguments).output().expect("the program starts").into()
}

/// Runs the program with the given arguments.
#[track_caller]
fn run(arguments: &[&str]) -> Run {
    program().args(arguments).output().expect("the program starts").into()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Width, height, frames and the pixels of the first one, of a PNG picture.
fn picture(folder: &TempDir, name: &str) -> (u32, u32, u32, Vec<[u8; 4]>) {
    let file = std::fs::File::open(folder.path().join(name)).expect("a picture");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a picture");
    let mut bytes = vec![0; reader.output_buffer_size().expect("it fits")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    let frames = reader.info().animation_control().map_or(1, |control| control.num_frames);
    (info.width, info.height, frames, bytes.as_chunks::<4>().0.to_vec())
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[track_caller]
fn assert_empty(folder: &TempDir) {
    assert_eq!(names_in(folder.path()), Vec::<String>::new(), "a failed run left files behind");
}

/// A path of `testdata/`.
fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("testdata").join(name)
}
