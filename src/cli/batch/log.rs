//! The log of a batch: a line of JSON for every job that has ended.

use std::collections::HashMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::super::exit::Failure;
use super::super::streams::unwritable;
use super::class::Class;

/// So often the log is put on the disk; a killed process loses nothing of what it has written before.
const BETWEEN_FLUSHES: Duration = Duration::from_secs(1);

/// What every line begins with.
const BEGINNING: &[u8] = b"{\"job\":";

/// What the log says of one job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Its name.
    pub job: String,
    /// What was done.
    pub verb: String,
    /// How it ended.
    pub class: Class,
    /// The exit status of its process; null where a signal has ended it, or where none began.
    pub status: Option<i32>,
    /// The signal that has ended it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signal: Option<i32>,
    /// What kind of error its report tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Why it failed, in a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Wall-clock seconds of its process.
    pub seconds: f64,
    /// The most memory that it held, where it is known.
    pub peak_memory_bytes: Option<u64>,
    /// The threads that it had.
    pub threads: usize,
    /// How often it was run.
    pub runs: usize,
    /// What was read.
    pub inputs: Vec<String>,
    /// Hashes of these; null for what is no regular file, or cannot be read.
    pub input_sha256: Vec<Option<String>>,
    /// Its options.
    pub options: Vec<String>,
    /// Where the output is, or would be.
    pub output: String,
    /// Hash of the output; null where none was written.
    pub output_sha256: Option<String>,
    /// Where the report is; null where none was written.
    pub report: Option<String>,
}

/// A log that is written to, by this process alone.
#[derive(Debug)]
pub struct Log {
    file: File,
    path: PathBuf,
    flushed: Instant,
}

impl Log {
    /// Begins a log, or goes on with the one that is there, of which the last entry for each job is returned.
    pub fn open(path: &Path, resume: bool) -> Result<(Self, HashMap<String, Entry>), Failure> {
        if path.metadata().is_ok_and(|data| !data.is_file()) {
            return Err(Failure::usage(format!("the log {} is no regular file", path.display())));
        }
        let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = options.map_err(|error| unwritable(path, &error))?;
        // A file system without locks is no reason to refuse.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(Failure::usage(format!("another batch is writing {}", path.display()))
                .hint("wait for it, or give another log with --log"));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(|error| unwritable(path, &error))?;
        if !bytes.is_empty() && !resume {
            return Err(Failure::usage(format!("{} is the log of an earlier batch", path.display()))
                .hint("--resume goes on with it; for a new batch remove it, or give another one with --log"));
        }
        if !bytes.is_empty() && !bytes.starts_with(BEGINNING) {
            return Err(
                Failure::usage(format!("{} is no log of a batch", path.display())).hint("another name after --log")
            );
        }
        let (entries, whole) = read(&bytes);
        // What was being written when a batch was killed.
        file.set_len(whole as u64)
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .map_err(|error| unwritable(path, &error))?;
        Ok((Self { file, path: path.to_owned(), flushed: Instant::now() }, entries))
    }

    /// Adds a line, in one go.
    pub fn add(&mut self, entry: &Entry) -> Result<(), Failure> {
        let mut line = serde_json::to_vec(entry)
            .map_err(|error| Failure::internal(format!("the log cannot be written as JSON: {error}")))?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(|error| unwritable(&self.path, &error))?;
        if self.flushed.elapsed() > BETWEEN_FLUSHES { self.flush() } else { Ok(()) }
    }

    /// Puts all lines on the disk.
    pub fn flush(&mut self) -> Result<(), Failure> {
        self.flushed = Instant::now();
        self.file.sync_data().map_err(|error| unwritable(&self.path, &error))
    }
}

/// The last entry for each job, and how many bytes of whole lines there are. Lines that are no entries are passed over.
fn read(bytes: &[u8]) -> (HashMap<String, Entry>, usize) {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let lines = bytes[..whole].split(|&byte| byte == b'\n');
    let entries = lines.filter_map(|line| serde_json::from_slice::<Entry>(line).ok());
    (entries.map(|entry| (entry.job.clone(), entry)).collect(), whole)
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A job that is done.
    pub fn entry(job: &str) -> Entry {
        Entry {
            job: job.into(),
            verb: "repair".into(),
            class: Class::Done,
            status: Some(0),
            signal: None,
            error: None,
            message: None,
            seconds: 0.5,
            peak_memory_bytes: Some(1 << 20),
            threads: 1,
            runs: 1,
            inputs: vec![job.into()],
            input_sha256: vec![Some("ab".into())],
            options: Vec::new(),
            output: job.into(),
            output_sha256: Some("cd".into()),
            report: None,
        }
    }

    #[test]
    fn a_file_that_is_no_log_stays_as_it_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("part.stl");
        std::fs::write(&path, "solid part\nend").expect("written");
        assert!(Log::open(&path, true).expect_err("no log").message.contains("is no log of a batch"));
        assert_eq!(std::fs::read(&path).expect("there"), b"solid part\nend");
        assert!(Log::open(folder.path(), true).expect_err("no log").message.contains("no regular file"));
    }

    #[test]
    fn a_torn_last_line_is_taken_away() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("batch.jsonl");
        let (mut log, before) = Log::open(&path, false).expect("a log");
        assert!(before.is_empty());
        log.add(&entry("a.stl")).expect("written");
        let failure = Log::open(&path, true).expect_err("it is locked");
        assert!(failure.message.contains("another batch"), "{failure}");
        drop(log);
        assert!(Log::open(&path, false).expect_err("it is there").message.contains("earlier batch"));
        let mut text = std::fs::read_to_string(&path).expect("there");
        text.push_str("no entry\n{\"job\": \"b.st");
        std::fs::write(&path, text).expect("written");
        let (mut log, before) = Log::open(&path, true).expect("a log");
        assert_eq!(before.keys().collect::<Vec<_>>(), ["a.stl"]);
        log.add(&entry("c.stl")).expect("written");
        drop(log);
        let (_, before) = Log::open(&path, true).expect("a log");
        assert_eq!(before.len(), 2);
        assert_eq!(before["c.stl"], entry("c.stl"));
    }
}
