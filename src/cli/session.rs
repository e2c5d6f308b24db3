//! One run of the program: what it says, when it must stop, and what it must not leave behind.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::args::CommonArgs;
use super::exit::{Exit, Failure};
use super::progress_bar::Meter;
use crate::progress::{Progress, Stopped};

/// How long stages have to stop by themselves before the process is ended for them (reading one
/// large file, for instance, cannot be stopped half-way).
const PATIENCE: Duration = Duration::from_millis(700);

/// One run.
pub struct Session {
    /// When it began.
    pub start: Instant,
    /// Handed to every stage.
    pub progress: Progress,
    /// Whether `-v` was given.
    pub verbose: bool,
    quiet: bool,
    meter: Arc<Meter>,
    unfinished: Unfinished,
}

impl Session {
    /// Sets up threads, signals, the deadline and the progress bar.
    pub fn new(common: &CommonArgs) -> Result<Self, Failure> {
        let start = Instant::now();
        if let Some(threads) = common.threads {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads.into())
                .build_global()
                .map_err(|e| Failure::internal(format!("cannot start {threads} threads: {e}")))?;
        }
        let unfinished = Unfinished::default();
        let meter = Arc::new(Meter::new(!common.quiet));
        let flag = Arc::new(AtomicBool::new(false));
        let listening = meter.clone();
        let mut progress = Progress::none().with_flag(flag.clone()).with_listener(move |event| listening.show(event));
        if let Some(deadline) = common.timeout.and_then(|timeout| start.checked_add(timeout)) {
            progress = progress.with_deadline(deadline);
            watch_deadline(deadline, unfinished.clone());
        }
        watch_signals(flag, unfinished.clone())?;
        Ok(Self { start, progress, verbose: common.verbose, quiet: common.quiet, meter, unfinished })
    }

    /// A line for the user, unless `-q`.
    pub fn say(&self, line: &str) {
        if !self.quiet {
            self.meter.above(|| eprintln_quietly(line));
        }
    }

    /// Takes the progress bar away.
    pub fn clear_bar(&self) {
        self.meter.clear();
    }

    /// Notes that `path` exists and must go if the run ends early.
    pub fn temporary(&self, path: &Path) {
        self.unfinished.lock().temporary = Some(path.to_path_buf());
    }

    /// Does the last, indivisible step (`finish`: a rename) unless the run was stopped before.
    /// After it, a signal can no longer undo the run.
    pub fn finish<T>(&self, finish: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
        let mut state = self.unfinished.lock();
        self.progress.check()?;
        let result = finish()?;
        *state = State { temporary: None, finished: true };
        Ok(result)
    }
}

/// What must not be left behind; shared with the threads that may end the process.
#[derive(Clone, Default)]
struct Unfinished(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    temporary: Option<PathBuf>,
    finished: bool,
}

impl Unfinished {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends the process, leaving nothing behind, unless its work is done. Holds the lock to the
    /// end, so that no rename can come in between.
    fn abandon(&self, stopped: Stopped) {
        let state = self.lock();
        if state.finished {
            return;
        }
        if let Some(path) = &state.temporary {
            let _ = std::fs::remove_file(path);
        }
        let failure = Failure::from(stopped);
        print_failure(&failure);
        std::process::exit(failure.exit.code().into());
    }
}

fn watch_deadline(deadline: Instant, unfinished: Unfinished) {
    std::thread::spawn(move || {
        std::thread::sleep((deadline + PATIENCE).saturating_duration_since(Instant::now()));
        unfinished.abandon(Stopped::Deadline);
    });
}

fn watch_signals(flag: Arc<AtomicBool>, unfinished: Unfinished) -> Result<(), Failure> {
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            unfinished.abandon(Stopped::Interrupted);
            std::process::exit(Exit::Interrupted.code().into());
        }
        let unfinished = unfinished.clone();
        std::thread::spawn(move || {
            std::thread::sleep(PATIENCE);
            unfinished.abandon(Stopped::Interrupted);
        });
    })
    .map_err(|e| Failure::internal(format!("cannot listen for Ctrl-C: {e}")))
}

/// `error: ...`, the place, and `hint: ...` on standard error.
pub fn print_failure(failure: &Failure) {
    eprintln_quietly(&format!("{} {}", painted("error:", "1;31"), failure.message));
    if let Some(place) = &failure.place {
        eprintln_quietly(place);
    }
    if let Some(hint) = &failure.hint {
        eprintln_quietly(&format!("{} {hint}", painted("hint:", "1;36")));
    }
}

/// `text` in the ANSI style `code`, on a terminal without `NO_COLOR`.
pub fn painted(text: &str, code: &str) -> String {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty())
        || std::env::var_os("TERM").is_some_and(|v| v == "dumb")
        || !std::io::stderr().is_terminal();
    if plain { text.to_string() } else { format!("\x1b[{code}m{text}\x1b[0m") }
}

/// Like `eprintln!`, but a closed standard error is no reason to panic.
fn eprintln_quietly(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
