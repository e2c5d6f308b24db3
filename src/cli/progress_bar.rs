//! The progress bar: on a terminal only.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::progress::Event;

/// The stages of a run in order, and about what share of its time each takes, in percent (the
/// Stanford bunny at 256, file to file).
const STAGES: [(&str, u32); 12] = [
    ("read", 2),
    ("examine", 4),
    ("orient", 2),
    ("ldi", 6),
    ("spans", 1),
    ("vote", 12),
    ("sdf", 8),
    ("contour", 5),
    ("collapse", 12),
    ("fit", 38),
    ("write", 2),
    ("verify", 7),
];

/// The bar and the stage it shows.
pub struct Meter {
    bar: ProgressBar,
    stage: AtomicUsize,
}

impl Meter {
    /// A bar on standard error where that is a terminal and `wanted`; else one that draws nothing.
    pub fn new(wanted: bool) -> Self {
        let bar = if wanted && std::io::stderr().is_terminal() {
            ProgressBar::new(total().into())
        } else {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden())
        };
        if !bar.is_hidden() {
            if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:<9} [{bar:30}] {elapsed}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar, stage: AtomicUsize::new(STAGES.len()) }
    }

    /// Shows `event`.
    pub fn show(&self, event: Event<'_>) {
        match event {
            Event::Stage(name) => {
                let stage = STAGES.iter().position(|(stage, _)| *stage == name).unwrap_or(STAGES.len());
                self.stage.store(stage, Ordering::Relaxed);
                self.bar.set_message(name.to_string());
                self.bar.set_position(position(stage, 0.0));
            }
            Event::Share(share) => self.bar.set_position(position(self.stage.load(Ordering::Relaxed), share)),
        }
    }

    /// Prints a line above the bar.
    pub fn above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

fn total() -> u32 {
    STAGES.iter().map(|(_, weight)| weight).sum()
}

/// How far the run is when `share` of `stage` is done; an unknown stage counts for nothing.
fn position(stage: usize, share: f32) -> u64 {
    let before: u32 = STAGES.iter().take(stage).map(|(_, weight)| weight).sum();
    match STAGES.get(stage) {
        Some((_, weight)) => u64::from(before) + (share.clamp(0.0, 1.0) * *weight as f32) as u64,
        None => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_only_goes_forwards_and_ends_full() {
        let positions: Vec<u64> = (0..STAGES.len())
            .flat_map(|stage| [position(stage, 0.0), position(stage, 0.5), position(stage, 1.0)])
            .collect();
        assert!(positions.is_sorted(), "{positions:?}");
        assert_eq!((positions[0], positions[positions.len() - 1]), (0, total().into()));
        assert_eq!(position(STAGES.len(), 0.5), 0);
    }

    #[test]
    fn nothing_is_drawn_without_a_terminal_or_a_wish() {
        assert!(Meter::new(false).bar.is_hidden());
    }
}
