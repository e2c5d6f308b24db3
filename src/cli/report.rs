//! The report: one JSON object a run, the same for every verb.

use std::borrow::Cow;
use std::time::Instant;

use serde::Serialize;

use super::entries::InputEntry;
use super::entries::OutputEntry;
use super::exit::{Exit, Failure};
use super::machine::peak_memory;
use super::result::RunResult;
use crate::pipeline::{Report, StageTime};
use crate::progress::Stage;

/// Raised when a field changes its meaning or goes away; new fields do not raise it.
pub const SCHEMA: u32 = 2;

/// The account of one run of the program.
#[derive(Debug, Serialize, schemars::JsonSchema)]
pub struct RunReport {
    /// Version of this layout.
    pub schema: u32,
    /// `meshwright`.
    pub tool: &'static str,
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// The verb.
    pub verb: &'static str,
    /// Exit status of the process.
    pub exit: u8,
    /// Why there is no result, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<Failure>,
    /// Options after defaults were filled in.
    pub options: serde_json::Value,
    /// The inputs, in the order given.
    pub inputs: Vec<InputEntry>,
    /// What the verb found and made; nothing of a run that failed before it had found anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub result: Option<RunResult>,
    /// Sentences a user should read.
    pub warnings: Vec<String>,
    /// Wall-clock seconds of each stage, in order.
    pub stages: Vec<StageTime>,
    /// Wall-clock seconds of the whole run.
    pub seconds: f64,
    /// Largest resident memory, where the system tells it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_memory_bytes: Option<u64>,
}

impl RunReport {
    /// An empty report of `verb`.
    pub fn new(verb: &'static str) -> Self {
        Self {
            schema: SCHEMA,
            tool: env!("CARGO_PKG_NAME"),
            version: Cow::Borrowed(env!("CARGO_PKG_VERSION")),
            verb,
            exit: Exit::Internal.code(),
            error: None,
            options: serde_json::Value::Null,
            inputs: Vec::new(),
            result: None,
            warnings: Vec::new(),
            stages: Vec::new(),
            seconds: 0.0,
            peak_memory_bytes: None,
        }
    }

    /// The account of a solid, where one was made.
    pub fn pipeline(&self) -> Option<&Report> {
        self.result.as_ref().and_then(RunResult::pipeline)
    }

    /// The file that was written last.
    pub fn output(&self) -> Option<&OutputEntry> {
        self.result.as_ref().and_then(RunResult::output)
    }

    /// Notes the file that the result was written to.
    pub fn written(&mut self, entry: OutputEntry) {
        if let Some(result) = &mut self.result {
            result.written(entry);
        }
    }

    /// Runs `work` and notes how long it took under `stage`.
    pub fn timed<T>(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        let result = work(self);
        self.stages.push(StageTime { stage, seconds: start.elapsed().as_secs_f64() });
        result
    }

    /// Fills in what the run has taken so far.
    pub fn measure(&mut self, start: Instant) {
        self.seconds = start.elapsed().as_secs_f64();
        self.peak_memory_bytes = peak_memory();
    }

    /// Fills in how the run ended.
    pub fn close(&mut self, outcome: &Result<Exit, Failure>, start: Instant) {
        match outcome {
            Ok(exit) => self.exit = exit.code(),
            Err(failure) => {
                self.exit = failure.exit.code();
                self.error = Some(failure.clone());
            }
        }
        self.measure(start);
    }
}
