//! How far a batch is.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::super::course::about;
use super::super::say::eprintln_quietly;
use super::super::words;

/// The bar on a terminal, and the lines above it.
pub struct Bar {
    bar: ProgressBar,
    quiet: bool,
    start: Instant,
    jobs: usize,
    ended: usize,
    failed: usize,
    /// Of all, and of what has ended in this run.
    work: (u64, u64),
}

impl Bar {
    /// For so many jobs and so much work.
    pub fn new(jobs: usize, work: u64, quiet: bool) -> Self {
        let bar = if std::io::stderr().is_terminal() && !quiet {
            ProgressBar::new(work)
        } else {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden())
        };
        if !bar.is_hidden() {
            let style = ProgressStyle::with_template("{spinner} [{bar:24}] {msg}");
            style.into_iter().for_each(|style| bar.set_style(style.progress_chars("=> ")));
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar, quiet, start: Instant::now(), jobs, ended: 0, failed: 0, work: (work, 0) }
    }

    /// A job has ended.
    pub fn ended(&mut self, work: u64, failed: bool) {
        self.ended += 1;
        self.failed += usize::from(failed);
        self.work.1 += work;
        self.bar.set_position(self.work.1);
        self.bar.set_message(self.message());
    }

    /// `312 of 1,000 jobs, 2 failed, about 40 s left`.
    fn message(&self) -> String {
        let failed = if self.failed > 0 { format!(", {} failed", words::count(self.failed)) } else { String::new() };
        let (all, done) = self.work;
        let left = self.start.elapsed().mul_f64(all.saturating_sub(done) as f64 / done.max(1) as f64);
        format!("{} of {} jobs{failed}, about {} left", words::count(self.ended), words::count(self.jobs), about(left))
    }

    /// A line for the user, unless `-q`.
    pub fn tell(&self, line: &str) {
        if !self.quiet {
            self.bar.suspend(|| eprintln_quietly(line));
        }
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
