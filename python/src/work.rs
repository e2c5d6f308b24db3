//! Work on a thread of its own, while the caller's thread lets other Python threads run, hears Ctrl-C and tells how far the work is.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use meshwright::Progress;
use meshwright::progress::Event;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often the caller's thread looks for signals.
const GLANCE: Duration = Duration::from_millis(50);

/// How a caller follows the work.
pub struct Hearing {
    /// Called with the stage and the share of it that is done, 0 to 1.
    pub hear: Option<Py<PyAny>>,
    /// Threads of the work; `None`: those that all such calls share.
    pub threads: Option<usize>,
}

/// What was heard last.
#[derive(Default)]
struct Heard {
    stage: String,
    share: f32,
    is_new: bool,
}

/// Whether the work is over.
#[derive(Default)]
struct Over {
    flag: Mutex<bool>,
    told: Condvar,
}

/// Tells when it is dropped, also by a panic.
struct Telling(Arc<Over>);

impl Drop for Telling {
    fn drop(&mut self) {
        *self.0.flag.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.told.notify_all();
    }
}

/// Does `work` on another thread.
pub fn beside<T: Send + 'static>(
    py: Python<'_>,
    hearing: Hearing,
    work: impl FnOnce(Progress) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = match hearing.threads {
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build();
            Some(pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?)
        }
        None => None,
    };
    let flag = Arc::new(AtomicBool::new(false));
    let heard = Arc::new(Mutex::new(Heard::default()));
    let mut progress = Progress::none().with_flag(flag.clone());
    if hearing.hear.is_some() {
        let heard = heard.clone();
        progress = progress.with_listener(move |event| note(&heard, event));
    }
    let over = Arc::new(Over::default());
    let telling = Telling(over.clone());
    let thread = std::thread::Builder::new().name("meshwright".into()).spawn(move || {
        let _telling = telling;
        match &pool {
            Some(pool) => pool.install(|| work(progress)),
            None => work(progress),
        }
    })?;
    let stopped = wait(py, &over, &heard, hearing.hear.as_ref());
    if stopped.is_err() {
        flag.store(true, Ordering::Relaxed);
    }
    let made = py.detach(|| thread.join()).unwrap_or_else(|panic| resume_unwind(panic));
    stopped.map(|()| made)
}

fn note(heard: &Mutex<Heard>, event: Event) {
    let mut heard = heard.lock().unwrap_or_else(PoisonError::into_inner);
    match event {
        Event::Stage(stage) => {
            heard.stage =
                serde_json::to_value(stage).ok().and_then(|word| Some(word.as_str()?.to_owned())).unwrap_or_default();
            heard.share = 0.0;
        }
        Event::Share(share) => heard.share = share,
    }
    heard.is_new = true;
}

/// Waits for the work. An error of the caller's function, or Ctrl-C, ends the wait.
fn wait(py: Python<'_>, over: &Over, heard: &Mutex<Heard>, hear: Option<&Py<PyAny>>) -> PyResult<()> {
    loop {
        let over = py.detach(|| {
            let flag = over.flag.lock().unwrap_or_else(PoisonError::into_inner);
            let waited = over.told.wait_timeout_while(flag, GLANCE, |over| !*over);
            *waited.unwrap_or_else(PoisonError::into_inner).0
        });
        if let Some(hear) = hear {
            let mut heard = heard.lock().unwrap_or_else(PoisonError::into_inner);
            let news = std::mem::take(&mut heard.is_new).then(|| (heard.stage.clone(), heard.share));
            drop(heard);
            if let Some((stage, share)) = news {
                hear.call1(py, (stage, share))?;
            }
        }
        if over {
            return Ok(());
        }
        py.check_signals()?;
    }
}
