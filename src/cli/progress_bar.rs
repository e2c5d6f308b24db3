//! The progress bar: on a terminal only.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::progress::Event;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// A bar on standard error where that is a terminal and `wanted`; else one that draws nothing.
pub fn progress_bar(wanted: bool) -> ProgressBar {
    if !wanted || !std::io::stderr().is_terminal() {
        return ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    }
    let bar = ProgressBar::new(STEPS);
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:<12} [{bar:30}] {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Shows `event` on `bar`.
pub fn show(bar: &ProgressBar, event: Event<'_>) {
    match event {
        Event::Stage(name) => {
            bar.set_message(name.to_string());
            bar.set_position(0);
        }
        Event::Share(share) => bar.set_position((share.clamp(0.0, 1.0) * STEPS as f32) as u64),
    }
}
