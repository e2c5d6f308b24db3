//! The progress bar on a terminal, or with `-v` a line now and then where there is none.

use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::course::Course;
use crate::progress::{Event, Stage};

/// Where nobody sees a bar, a line comes so often.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// Columns of the bar.
const WIDTH: usize = 24;

/// Shows how far the run is.
pub struct Meter {
    bar: ProgressBar,
    course: Watched,
    /// Dropped, it ends the lines.
    lines: Mutex<Option<Sender<()>>>,
}

/// How far the run is, and when it began.
#[derive(Clone)]
struct Watched {
    course: Arc<Mutex<Course>>,
    start: Instant,
}

impl Watched {
    fn lock(&self) -> (MutexGuard<'_, Course>, Duration) {
        (self.course.lock().unwrap_or_else(PoisonError::into_inner), self.start.elapsed())
    }

    fn show(&self, event: Event) {
        let (mut course, now) = self.lock();
        match event {
            Event::Stage(stage) => course.begin(stage, now),
            Event::Share(share) => course.share(share, now),
        }
    }

    fn style(&self) -> Option<ProgressStyle> {
        let (bar, figures) = (self.clone(), self.clone());
        let style = ProgressStyle::with_template("{spinner} {msg:<32} [{course}] {figures}").ok()?;
        let drawn = move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
            let (course, now) = bar.lock();
            let filled = (course.position(now) * WIDTH as f64) as usize;
            let _ = write!(out, "{:<WIDTH$}", "=".repeat(filled.min(WIDTH)));
        };
        let told = move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
            let (course, now) = figures.lock();
            let _ = out.write_str(&course.figures(now));
        };
        Some(style.with_key("course", drawn).with_key("figures", told))
    }
}

impl Meter {
    /// Of a run of `verb`: a bar on standard error where that is a terminal; lines where it is none and they are wanted; nothing when `quiet`.
    pub fn new(verb: &str, quiet: bool, verbose: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let course = Watched { course: Arc::new(Mutex::new(Course::of(verb))), start: Instant::now() };
        let bar = if terminal && !quiet {
            ProgressBar::new(1)
        } else {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden())
        };
        if !bar.is_hidden() {
            course.style().into_iter().for_each(|style| bar.set_style(style));
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        let told = (!terminal && verbose && !quiet)
            .then(|| tell_every(BETWEEN_LINES, course.clone(), super::say::eprintln_quietly));
        Self { bar, course, lines: Mutex::new(told.flatten()) }
    }

    /// So many results will be made one after the other.
    pub fn expect_frames(&self, frames: usize) {
        *self.course.lock().0 = Course::of_frames(frames);
    }

    /// The stages that will come, and the seconds that each may take.
    pub fn expect(&self, seconds: &[(Stage, f64)]) {
        let (mut course, now) = self.course.lock();
        course.expect(seconds, now);
    }

    /// Shows `event`.
    pub fn show(&self, event: Event) {
        self.course.show(event);
        if let Event::Stage(_) = event {
            // A bar that is drawn looks at the course: it must not be locked then.
            let words = self.course.lock().0.words();
            self.bar.set_message(words);
        }
    }

    /// Prints a line above the bar.
    pub fn above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Takes the bar away, and ends the lines.
    pub fn clear(&self) {
        self.course.lock().0.finish();
        self.bar.finish_and_clear();
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).take();
    }
}

/// Says how far the run is, every so often until what is returned is dropped. Where no thread can be had, nothing is said.
fn tell_every(pause: Duration, watched: Watched, tell: impl Fn(&str) + Send + 'static) -> Option<Sender<()>> {
    let (end, ended) = channel();
    let telling = move || {
        while ended.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
            let (course, now) = watched.lock();
            let line = course.line(now);
            drop(course);
            tell(&line);
        }
    };
    Builder::new().name("progress".into()).spawn(telling).ok().map(|_| end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_drawn_without_a_terminal_or_a_wish() {
        let meter = Meter::new("repair", true, false);
        assert!(meter.bar.is_hidden() && meter.lines.lock().expect("nobody panics").is_none());
    }

    #[test]
    fn lines_come_in_time_and_end_with_the_run() {
        let course = Watched { course: Arc::new(Mutex::new(Course::of("repair"))), start: Instant::now() };
        course.show(Event::Stage(Stage::Vote));
        let said = Arc::new(Mutex::new(Vec::new()));
        let saying = said.clone();
        let lines = tell_every(Duration::from_millis(20), course.clone(), move |line| {
            saying.lock().expect("nobody panics").push(line.to_owned());
        });
        let count = || said.lock().expect("nobody panics").len();
        let start = Instant::now();
        while count() < 3 && start.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(5));
        }
        drop(lines);
        std::thread::sleep(Duration::from_millis(60));
        let after = count();
        std::thread::sleep(Duration::from_millis(100));
        assert_eq!(count(), after, "the lines go on after the run");
        let said = said.lock().expect("nobody panics");
        assert!(said.len() >= 3 && said[0].contains("telling inside from outside, "), "{said:?}");
    }
}
