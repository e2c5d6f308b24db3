//! One small handle, passed down through every stage: progress out, cancellation in.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use serde::{Deserialize, Serialize};

/// Why a stage stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Stopped {
    /// The caller asked for it (Ctrl-C on the command line).
    #[error("interrupted")]
    Interrupted,
    /// The deadline given with [`Progress::with_deadline`] has passed.
    #[error("the deadline has passed")]
    Deadline,
}

/// The stages of all runs: what a listener hears of, and what reports have times of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Files are read.
    Read,
    /// The defects of the input are counted.
    Examine,
    /// Patches are turned so that they agree.
    Orient,
    /// Closed surfaces that touch nothing are set apart.
    Shells,
    /// Cracks are closed by moving vertices a little.
    Zip,
    /// Holes are closed from their rims.
    Fill,
    /// What crosses is cut, exactly.
    Arrange,
    /// Rays are cast through the model.
    Ldi,
    /// The rays' pieces inside the solid are found.
    Spans,
    /// The rays vote on what is inside.
    Vote,
    /// Distances near the surface are smoothed.
    Sdf,
    /// The surface is made from the distances.
    Contour,
    /// Small triangles are merged.
    Collapse,
    /// Edges and corners are fitted, and triangles saved.
    Fit,
    /// The surface is moved.
    Offset,
    /// The surface is moved, to be moved back later.
    #[serde(rename = "first offset")]
    FirstOffset,
    /// The surface is moved back.
    #[serde(rename = "second offset")]
    SecondOffset,
    /// Walls that are too thin are looked for.
    #[serde(rename = "thin walls")]
    ThinWalls,
    /// Canals are looked for.
    Canals,
    /// Distances are measured over a lattice.
    Distance,
    /// Outlines are closed, plane by plane.
    Levels,
    /// An expression is worked out.
    Field,
    /// Two meshes are compared.
    Compare,
    /// A map of the surface is coloured.
    Map,
    /// A picture is drawn.
    Draw,
    /// A file is written.
    Write,
    /// The written file is read and checked.
    Verify,
    /// Both, where the time of both is told as one.
    #[serde(rename = "write and verify")]
    WriteAndVerify,
    /// Walls and gaps are measured.
    Thickness,
    /// A cavity is made.
    Hollow,
    /// What is drilled is cut out.
    Subtract,
    /// Triangles are taken away.
    Decimate,
    /// Bodies are taken apart.
    Split,
    /// Graphics adapters are looked for.
    List,
}

/// What a listener hears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A stage begins.
    Stage(Stage),
    /// The share of the current stage that is done, 0 to 1.
    Share(f32),
}

type Listener = Arc<dyn Fn(Event) + Send + Sync>;

/// Progress and cancellation. Cheap to clone; clones share the same flag and listener.
#[derive(Clone, Default)]
pub struct Progress {
    listener: Option<Listener>,
    cancelled: Arc<AtomicBool>,
    deadline: Option<Instant>,
}

impl Progress {
    /// A handle nobody listens to and nobody cancels.
    pub fn none() -> Self {
        Self::default()
    }

    /// Calls `listener` at the start of each stage and now and then within it, from any thread.
    pub fn with_listener(mut self, listener: impl Fn(Event) + Send + Sync + 'static) -> Self {
        self.listener = Some(Arc::new(listener));
        self
    }

    /// Stops with [`Stopped::Deadline`] after `deadline`.
    pub fn with_deadline(mut self, deadline: Instant) -> Self {
        self.deadline = Some(deadline);
        self
    }

    /// Uses `flag` for cancellation: set it to true from anywhere (a signal handler) to stop.
    pub fn with_flag(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancelled = flag;
        self
    }

    /// Announces a stage and checks for cancellation.
    pub fn stage(&self, stage: Stage) -> Result<(), Stopped> {
        self.tell(Event::Stage(stage));
        self.check()
    }

    /// Announces the share of the current stage that is done.
    pub fn share(&self, share: f32) {
        self.tell(Event::Share(share));
    }

    /// An error when the work should stop. Stages call it at least ten times a second.
    pub fn check(&self) -> Result<(), Stopped> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Stopped::Interrupted);
        }
        match self.deadline {
            Some(deadline) if Instant::now() >= deadline => Err(Stopped::Deadline),
            _ => Ok(()),
        }
    }

    fn tell(&self, event: Event) {
        if let Some(listener) = &self.listener {
            listener(event);
        }
    }
}

impl std::fmt::Debug for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("cancelled", &self.cancelled).field("deadline", &self.deadline).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_flag_and_a_past_deadline_stop() {
        let flag = Arc::new(AtomicBool::new(false));
        let progress = Progress::none().with_flag(flag.clone());
        assert_eq!(progress.check(), Ok(()));
        flag.store(true, Ordering::Relaxed);
        assert_eq!(progress.check(), Err(Stopped::Interrupted));
        assert_eq!(Progress::none().with_deadline(Instant::now()).check(), Err(Stopped::Deadline));
    }
}
