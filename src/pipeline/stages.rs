//! Times the stages of a run and announces them.

use std::time::Instant;

use super::StageTime;
use crate::progress::{Progress, Stage, Stopped};

/// Announces stages one after another and keeps the seconds each took.
pub(super) struct Stages<'a> {
    progress: &'a Progress,
    times: Vec<StageTime>,
    since: Instant,
}

impl<'a> Stages<'a> {
    pub(super) fn new(progress: &'a Progress) -> Self {
        Self { progress, times: Vec::new(), since: Instant::now() }
    }

    /// Ends the stage before and begins `stage`.
    pub(super) fn begin(&mut self, stage: Stage) -> Result<(), Stopped> {
        self.end();
        self.times.push(StageTime { stage, seconds: 0.0 });
        self.progress.stage(stage)
    }

    /// The seconds of all stages.
    pub(super) fn finish(mut self) -> Vec<StageTime> {
        self.end();
        self.times
    }

    fn end(&mut self) {
        if let Some(last) = self.times.last_mut() {
            last.seconds = self.since.elapsed().as_secs_f64();
        }
        self.since = Instant::now();
    }
}
