//! One job: what is done to which files, and where the result goes.

use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

use super::args::EachArgs;
use super::verbs::{BatchVerb, with_more};

/// The folder of the reports, in that of the outputs.
const REPORTS: &str = "batch.reports";

/// One job.
#[derive(Debug, Clone)]
pub struct Job {
    /// What it is called in the log: its output, as seen from the folder of the outputs, or its input if it writes none.
    pub name: String,
    /// What is done.
    pub verb: &'static BatchVerb,
    /// What is read.
    pub inputs: Vec<PathBuf>,
    /// What is written.
    pub output: PathBuf,
    /// Its report; the same as the output where nothing else is written.
    pub report: PathBuf,
    /// Options of the verb.
    pub options: Vec<OsString>,
    /// What it may take.
    pub each: EachArgs,
    /// Where it is from, for messages.
    pub origin: String,
    /// Size of its inputs, bytes; none where one is no regular file.
    pub bytes: Option<u64>,
}

impl Job {
    /// Of files, whose output is to be `output` as seen from the folder `out`.
    pub fn new(verb: &'static BatchVerb, inputs: Vec<PathBuf>, output: &Path, out: &Path) -> Self {
        let bytes =
            inputs.iter().map(|input| input.metadata().ok().filter(|data| data.is_file()).map(|data| data.len()));
        let report =
            if verb.only_reports() { out.join(output) } else { with_more(&out.join(REPORTS).join(output), "json") };
        Self {
            name: output.to_string_lossy().into_owned(),
            verb,
            output: out.join(output),
            report,
            options: Vec::new(),
            each: EachArgs::default(),
            origin: inputs.iter().map(|input| input.display().to_string()).collect::<Vec<_>>().join(" and "),
            bytes: bytes.sum(),
            inputs,
        }
    }

    /// The arguments of the program that does it.
    pub fn arguments(&self, threads: usize) -> Vec<OsString> {
        let mut words: Vec<OsString> = vec![self.verb.name.into()];
        words.extend_from_slice(&self.options);
        words.extend(["--quiet".into(), "--threads".into(), threads.to_string().into()]);
        if let Some(timeout) = self.each.timeout {
            words.extend(["--timeout".into(), format!("{}ms", timeout.as_millis()).into()]);
        }
        if let Some(cap) = self.each.max_memory.filter(|_| self.verb.caps_memory()) {
            words.extend(["--max-memory".into(), cap.to_string().into()]);
        }
        if !self.verb.only_reports() {
            words.extend(["-o".into(), self.output.clone().into()]);
        }
        if let Some(format) = self.each.out_format {
            words.extend(["--out-format".into(), format.name().into()]);
        }
        words.extend(["--report".into(), self.report.clone().into(), "--".into()]);
        words.extend(self.inputs.iter().map(|input| input.clone().into()));
        words
    }

    /// Its options as the log has them.
    pub fn option_words(&self) -> Vec<String> {
        self.options.iter().map(|word| word.to_string_lossy().into_owned()).collect()
    }

    /// Its inputs as the log has them.
    pub fn input_words(&self) -> Vec<String> {
        self.inputs.iter().map(|input| input.display().to_string()).collect()
    }
}

/// Whether a path leads from the folder of the outputs to a file in or below it.
pub fn stays_below(path: &Path) -> bool {
    path.file_name().is_some() && path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
