//! Times the stages of a run and announces them.

use std::time::Instant;

use super::StageTime;
use crate::progress::{Progress, Stage, Stopped};

/// Announces stages one after another and keeps the seconds each took.
pub(super) struct Stages<'a> {
    progress: &'a Progress,
    times: Vec<StageTime>,
    /// When the last stage began, if it goes on.
    since: Option<Instant>,
}

impl<'a> Stages<'a> {
    pub(super) fn new(progress: &'a Progress) -> Self {
        Self { progress, times: Vec::new(), since: None }
    }

    /// Ends the stage before and begins `stage`.
    pub(super) fn begin(&mut self, stage: Stage) -> Result<(), Stopped> {
        self.end();
        self.times.push(StageTime { stage, seconds: 0.0 });
        self.since = Some(Instant::now());
        self.progress.stage(stage)
    }

    /// Adds stages that were timed elsewhere.
    pub(super) fn took(&mut self, others: &[StageTime]) {
        self.end();
        self.times.extend(others.iter().cloned());
    }

    /// The seconds of all stages.
    pub(super) fn finish(mut self) -> Vec<StageTime> {
        self.end();
        self.times
    }

    fn end(&mut self) {
        if let (Some(since), Some(last)) = (self.since.take(), self.times.last_mut()) {
            last.seconds = since.elapsed().as_secs_f64();
        }
    }
}
