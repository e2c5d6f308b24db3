//! How far a run is: a share that never goes back, the stage in words people know, and the time that is left.

use std::time::Duration;

use super::weights::{stages_of, stages_of_field};
use super::words;
use crate::progress::Stage;

/// A stage in words.
pub fn in_words(stage: Stage) -> &'static str {
    match stage {
        Stage::Read => "reading",
        Stage::Examine => "looking for defects",
        Stage::Orient => "finding the outer sides",
        Stage::Shells => "taking the bodies apart",
        Stage::Zip => "closing cracks",
        Stage::Fill => "closing holes",
        Stage::Arrange => "cutting what crosses",
        Stage::Ldi => "casting rays through the model",
        Stage::Spans => "finding the walls along the rays",
        Stage::Vote => "telling inside from outside",
        Stage::Sdf => "measuring distances",
        Stage::Contour => "making the new surface",
        Stage::Collapse => "joining small triangles",
        Stage::Fit => "fitting edges, saving triangles",
        Stage::Offset => "moving the surface",
        Stage::FirstOffset => "moving the surface",
        Stage::SecondOffset => "moving the surface back",
        Stage::ThinWalls => "looking for thin walls",
        Stage::Canals => "looking for canals",
        Stage::Distance => "measuring distances",
        Stage::Levels => "closing outlines, plane by plane",
        Stage::Field => "working out the expression",
        Stage::Compare => "comparing",
        Stage::Map => "colouring the map",
        Stage::Draw => "drawing the picture",
        Stage::Write => "writing",
        Stage::Verify => "checking the written file",
        Stage::WriteAndVerify => "writing and checking the file",
        Stage::Thickness => "measuring walls and gaps",
        Stage::Hollow => "making the cavity",
        Stage::Subtract => "cutting",
        Stage::Decimate => "taking triangles away",
        Stage::Split => "taking bodies apart",
        Stage::List => "looking for graphics adapters",
    }
}

#[cfg(test)]
mod tests;

/// Stages that are never left out: what is found beyond one that has not begun belongs to something that comes again.
const GATES: [Stage; 6] =
    [Stage::Field, Stage::Offset, Stage::FirstOffset, Stage::SecondOffset, Stage::ThinWalls, Stage::Distance];

/// A run whose stages are about these takes so long, seconds, until it has shown how fast it is.
const GUESS: f64 = 20.0;

/// Less than this share says nothing of the whole.
const TELLING: f64 = 0.04;

/// How far a run is. Times count from its start.
#[derive(Debug, Clone)]
pub struct Course {
    /// The stages with where each begins and ends, shares of the whole.
    stages: Vec<(Stage, f64, f64)>,
    /// The first stage that may still come, or that is on.
    at: usize,
    /// Whether one has begun.
    begun: bool,
    /// Words for the stage that is on.
    words: &'static str,
    /// Where it began and where it will end, shares of the whole.
    from: f64,
    to: f64,
    /// When it began.
    since: Duration,
    /// What it has told of itself.
    share: Option<f64>,
    /// How long the whole may take, seconds, until the run has shown how fast it is.
    guess: f64,
}

impl Course {
    /// Of a verb.
    pub fn of(verb: &str) -> Self {
        Self::along(&stages_of(verb))
    }

    /// Of `field` with so many results.
    pub fn of_frames(frames: usize) -> Self {
        Self::along(&stages_of_field(frames))
    }

    fn along(weights: &[(Stage, f64)]) -> Self {
        let total = weights.iter().map(|(_, weight)| weight).sum::<f64>().max(f64::MIN_POSITIVE);
        let mut end = 0.0;
        let stages = weights.iter().map(|&(name, weight)| {
            let begin = end;
            end += weight / total;
            (name, begin, end)
        });
        let stages = stages.collect();
        let (words, since) = ("starting", Duration::ZERO);
        Self { stages, at: 0, begun: false, words, from: 0.0, to: 0.0, since, share: None, guess: GUESS }
    }

    /// From here on these stages will come, and each will take about so many seconds: what is left of the whole is shared out
    /// among them.
    pub fn expect(&mut self, seconds: &[(Stage, f64)], now: Duration) {
        let here = self.position(now);
        let ahead = Self::along(seconds);
        let place = |share: f64| here + (1.0 - here) * share;
        self.stages = ahead.stages.into_iter().map(|(stage, from, to)| (stage, place(from), place(to))).collect();
        (self.at, self.begun, self.from, self.to) = (0, false, here, here);
        self.guess = seconds.iter().map(|(_, seconds)| seconds).sum::<f64>() / (1.0 - here).max(f64::EPSILON);
    }

    /// The run is at its end.
    pub fn finish(&mut self) {
        (self.from, self.to, self.share) = (1.0, 1.0, None);
    }

    /// A stage begins. One that is not expected any more (voxels are halved, and all comes again) goes on where the run is.
    pub fn begin(&mut self, stage: Stage, now: Duration) {
        let here = self.position(now);
        self.words = in_words(stage);
        let next = if self.begun { self.at + 1 } else { self.at };
        let ahead = self.stages.iter().skip(next);
        let wall = ahead.clone().position(|(name, ..)| GATES.contains(name)).unwrap_or(usize::MAX);
        let coming = ahead.clone().position(|(name, ..)| *name == stage).filter(|&n| n <= wall).map(|n| next + n);
        if let Some((_, begin, end)) = coming.map(|n| self.stages[n]) {
            (self.at, self.begun) = (coming.unwrap_or(self.at), true);
            (self.from, self.to) = (here.max(begin), end.max(here));
        } else {
            self.from = here;
        }
        (self.since, self.share) = (now, None);
    }

    /// The stage tells how much of it is done.
    pub fn share(&mut self, share: f32, now: Duration) {
        let done = self.within(now).max(f64::from(share).clamp(0.0, 1.0));
        self.share = Some(done);
    }

    /// The share of the whole that is done; it never falls as `now` and the events go on.
    pub fn position(&self, now: Duration) -> f64 {
        self.from + (self.to - self.from) * self.within(now)
    }

    /// The share of the stage that is done: as it says, or else by the speed of the run so far, and slower when it takes longer.
    fn within(&self, now: Duration) -> f64 {
        if let Some(share) = self.share {
            return share;
        }
        let spent = now.saturating_sub(self.since).as_secs_f64();
        let whole = if self.from > TELLING { self.since.as_secs_f64() / self.from } else { self.guess };
        let expected = (whole * (self.to - self.from)).max(1e-3);
        match spent / expected {
            early if early < 1.0 => 0.8 * early,
            late => 1.0 - 0.2 / late,
        }
    }

    /// Whole percents, below 100 as long as the run goes on.
    pub fn percent(&self, now: Duration) -> u32 {
        let most = if self.from < 1.0 { 99.0 } else { 100.0 };
        (100.0 * self.position(now)).floor().clamp(0.0, most) as u32
    }

    /// The time that is left, as soon as anything can be said of it.
    pub fn left(&self, now: Duration) -> Option<Duration> {
        let done = self.position(now);
        let known = done > TELLING && now >= Duration::from_secs(2);
        known.then(|| now.mul_f64((1.0 - done) / done))
    }

    /// What is done now.
    pub fn words(&self) -> &'static str {
        self.words
    }

    /// `45 %, about 40 s left`.
    pub fn figures(&self, now: Duration) -> String {
        let left = self.left(now).map_or(String::new(), |left| format!(", about {} left", about(left)));
        format!("{} %{left}", self.percent(now))
    }

    /// A line for a log: `30 s: telling inside from outside, 45 %, about 40 s left`.
    pub fn line(&self, now: Duration) -> String {
        format!("{}: {}, {}", about(now), self.words, self.figures(now))
    }
}

/// A time as one says it.
pub fn about(time: Duration) -> String {
    let seconds = time.as_secs_f64().ceil() as usize;
    match seconds {
        0..100 => format!("{seconds} s"),
        100..6000 => format!("{} min", seconds.div_ceil(60)),
        _ => words::plural(seconds.div_ceil(3600), "hour"),
    }
}
