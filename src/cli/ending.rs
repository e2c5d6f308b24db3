//! Ending the process from outside the work: a deadline, a signal, memory that is used up. It must not wait for anything that
//! can wait for ever: neither for the work, nor for whoever reads what the program writes.

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use super::exit::{Exit, Failure};
use super::machine;
use super::say::print_failure;
use crate::io::draft::Draft;
use crate::progress::Stopped;

/// How long stages have to stop by themselves before the process is ended for them (reading one
/// large file, for instance, cannot be stopped half-way).
const PATIENCE: Duration = Duration::from_millis(700);

/// How often a run is looked at.
const GLANCE: Duration = Duration::from_millis(25);

/// How long the last words may take: standard error may be a pipe that nobody reads.
const LAST_WORDS: Duration = Duration::from_millis(150);

/// What must not be left behind, and what is said at the end; shared with the threads that may end the process.
#[derive(Clone)]
pub struct Ending {
    state: Arc<Mutex<State>>,
    speaker: Arc<Mutex<Sender<Words>>>,
    interrupted: Arc<OnceLock<Instant>>,
}

/// What is to be said, and whom to tell when it has been.
type Words = (Failure, Sender<()>);

/// Behind a lock that is held for moments only: never while something is written.
#[derive(Default)]
pub struct State {
    /// Files that have not got their names yet.
    pub drafts: Vec<Draft>,
    /// A folder that was made for them.
    pub folder: Option<PathBuf>,
    /// The exit status, once the work is done and the files are in their places.
    pub finished: Option<Exit>,
}

impl State {
    /// Removes all files that have not got their names, and the folder that was made for them.
    pub fn discard(&mut self) {
        self.drafts.clear();
        if let Some(folder) = self.folder.take() {
            // It stays when somebody else has put something into it.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

impl Ending {
    /// Listens for signals from now on, and watches the clock and the memory.
    pub fn watch(deadline: Option<Instant>, max_memory: Option<u64>, flag: Arc<AtomicBool>) -> Result<Self, Failure> {
        let (speaker, words) = channel();
        let ending =
            Self { state: Arc::default(), speaker: Arc::new(Mutex::new(speaker)), interrupted: Arc::default() };
        start("last words", move || speak(&words))?;
        let watching = ending.clone();
        start("watch", move || watching.look(deadline, max_memory))?;
        let listening = ending.clone();
        let heard = move || {
            if flag.swap(true, Ordering::Relaxed) {
                listening.abandon(&Stopped::Interrupted.into());
            }
            let _ = listening.interrupted.set(Instant::now());
        };
        match ctrlc::set_handler(heard) {
            Ok(()) => Ok(ending),
            Err(ctrlc::Error::System(error)) => Err(machine::no_threads(super::streams::plain_reason(&error))),
            Err(error) => Err(Failure::internal(format!("cannot listen for Ctrl-C: {error}"))),
        }
    }

    /// Of a run that its caller ends: nobody listens or watches.
    pub fn unwatched() -> Self {
        let (speaker, _) = channel();
        Self { state: Arc::default(), speaker: Arc::new(Mutex::new(speaker)), interrupted: Arc::default() }
    }

    /// What must not be left behind.
    pub fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Looks at the run now and then, and ends it when it must be.
    fn look(&self, deadline: Option<Instant>, max_memory: Option<u64>) {
        loop {
            std::thread::sleep(GLANCE);
            if deadline.is_some_and(|deadline| Instant::now() > deadline + PATIENCE) {
                self.abandon(&Stopped::Deadline.into());
            }
            if self.interrupted.get().is_some_and(|since| since.elapsed() > PATIENCE) {
                self.abandon(&Stopped::Interrupted.into());
            }
            // Nobody waits for it any more.
            if machine::is_orphan() {
                self.abandon(&Stopped::Interrupted.into());
            }
            if let Some(shortage) = machine::shortage(max_memory) {
                self.abandon(&shortage);
            }
        }
    }

    /// Ends the process. Nothing is left behind of a run that has not finished; one that has keeps its own exit status, and
    /// only what it still had to say is lost. Holds the lock to the end, so that no file gets its name in between.
    fn abandon(&self, failure: &Failure) {
        let mut state = self.lock();
        let exit = state.finished.unwrap_or_else(|| {
            state.discard();
            self.last_words(failure);
            failure.exit
        });
        std::process::exit(exit.code().into());
    }

    fn last_words(&self, failure: &Failure) {
        let (done, said) = channel();
        let speaker = self.speaker.lock().unwrap_or_else(PoisonError::into_inner);
        if speaker.send((failure.clone(), done)).is_ok() {
            let _ = said.recv_timeout(LAST_WORDS);
        }
    }
}

/// Prints what it is given; a thread of its own, because it may wait for ever.
fn speak(words: &Receiver<Words>) {
    for (failure, done) in words {
        print_failure(&failure);
        let _ = std::io::stderr().flush();
        let _ = done.send(());
    }
}

fn start(name: &str, work: impl FnOnce() + Send + 'static) -> Result<(), Failure> {
    let started = Builder::new().name(name.to_owned()).spawn(work);
    started.map(drop).map_err(|error| machine::no_threads(super::streams::plain_reason(&error)))
}
