//! The process of one job: begun, watched, and ended when it must be.

use std::io::{ErrorKind, Read};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

use super::super::machine;
use super::super::streams::plain_reason;
use super::class::{Cause, Status};
use super::job::Job;
use super::signals;

/// How often a process is looked at.
const GLANCE: Duration = Duration::from_millis(20);

/// How long after its time, or after an interrupt, a process has to end by itself.
const GRACE: Duration = Duration::from_secs(5);

/// Of what a process says, so much of the end is kept, bytes.
const KEPT_WORDS: usize = 4096;

/// A process that has a cap of its own ends itself a little above it; one that holds this many times its cap did not.
const BEYOND_CAP: f64 = 1.4;

/// The same for the verbs that do not know the cap.
const BEYOND_UNKNOWN_CAP: f64 = 1.25;

/// A smaller cap is for the plan to refuse; the program itself is larger.
const LEAST_CAP: u64 = 64 << 20;

/// The system refuses memory from twice the cap and this on, bytes, of which stacks of threads that are never touched count, too.
const UNTOUCHED: u64 = 512 << 20;

/// How often the batch was interrupted.
#[derive(Debug, Default)]
pub struct Interrupts(AtomicUsize);

impl Interrupts {
    /// Once more.
    pub fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// Whether it was.
    pub fn any(&self) -> bool {
        self.count() > 0
    }

    fn count(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

/// How a process ended.
#[derive(Debug, Default)]
pub struct Ended {
    /// As the system tells it.
    pub status: Status,
    /// Why it was ended, if it did not end by itself.
    pub cause: Option<Cause>,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// The most memory it was seen to hold, bytes.
    pub peak: Option<u64>,
    /// The end of what it said on standard error.
    pub words: String,
}

/// Runs a job to its end. `resident` is kept at what its process holds, bytes.
pub fn run(job: &Job, threads: usize, interrupts: &Interrupts, resident: &AtomicU64) -> Ended {
    let start = Instant::now();
    let mut child = match begin(job, threads) {
        Ok(child) => child,
        Err(error) => {
            let wanting = matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::OutOfMemory);
            let why = format!("its process cannot be started: {}", plain_reason(&error));
            return Ended { cause: Some(Cause::NotBegun { why, wanting }), ..Ended::default() };
        }
    };
    if let Some(cap) = job.each.max_memory {
        signals::limit_memory(&child, cap.max(LEAST_CAP).saturating_mul(2).saturating_add(UNTOUCHED));
    }
    let words = listen(child.stderr.take());
    let mut watch = Watch { job, start, interrupts, resident, asked: None, ended: Ended::default() };
    let status = watch.wait(&mut child, &words);
    let mut ended = watch.ended;
    ended.status = Status { code: status.code(), signal: signals::of_status(status) };
    ended.seconds = start.elapsed().as_secs_f64();
    ended.words = words.recv_timeout(GLANCE).unwrap_or(ended.words);
    resident.store(0, Ordering::Relaxed);
    ended
}

fn begin(job: &Job, threads: usize) -> std::io::Result<Child> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(job.arguments(threads)).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command.env(machine::PARENT, std::process::id().to_string());
    signals::set_apart(&mut command);
    command.spawn()
}

/// Reads what a process says until nothing can come any more, and then hands over the end of it. Nothing comes, too, where no thread can be had.
fn listen(stream: Option<ChildStderr>) -> Receiver<String> {
    let (end, ended) = channel();
    let read = move || {
        let (mut kept, mut block) = (Vec::new(), [0; 4096]);
        let Some(mut stream) = stream else { return };
        while let Ok(count @ 1..) = stream.read(&mut block) {
            kept.extend_from_slice(&block[..count]);
            kept.drain(..kept.len().saturating_sub(KEPT_WORDS));
        }
        let _ = end.send(String::from_utf8_lossy(&kept).into_owned());
    };
    let _ = Builder::new().name("words of a job".into()).spawn(read);
    ended
}

struct Watch<'a> {
    job: &'a Job,
    start: Instant,
    interrupts: &'a Interrupts,
    resident: &'a AtomicU64,
    /// When it was asked to stop.
    asked: Option<Instant>,
    ended: Ended,
}

impl Watch<'_> {
    /// Waits for the process. That nothing more can come from it is the first sign that it has ended.
    fn wait(&mut self, child: &mut Child, words: &Receiver<String>) -> std::process::ExitStatus {
        let mut pause = GLANCE;
        let mut silent = false;
        loop {
            if silent {
                std::thread::sleep(pause);
                pause = (pause * 2).min(GLANCE);
            } else {
                match words.recv_timeout(pause) {
                    Err(RecvTimeoutError::Timeout) => {}
                    said => {
                        self.ended.words = said.unwrap_or_default();
                        (silent, pause) = (true, Duration::from_micros(50));
                    }
                }
            }
            match child.try_wait() {
                Ok(Some(status)) => return status,
                Ok(None) => self.look(child),
                // It cannot be waited for, so that it must not go on.
                Err(_) => signals::kill(child),
            }
        }
    }

    /// Ends the process when it must be.
    fn look(&mut self, child: &mut Child) {
        if let Some(memory) = machine::memory_of(child.id()) {
            self.resident.store(memory.resident, Ordering::Relaxed);
            self.ended.peak = self.ended.peak.max(Some(memory.peak));
            if self.job.each.max_memory.is_some_and(|cap| memory.resident > self.most(cap)) {
                return self.end(child, Cause::Memory(memory.resident));
            }
        }
        if self.job.each.timeout.is_some_and(|timeout| self.start.elapsed() > timeout + GRACE) {
            return self.end(child, Cause::Timeout);
        }
        match (self.interrupts.count(), self.asked) {
            (0, _) => {}
            (1, None) => {
                self.asked = Some(Instant::now());
                self.ended.cause.get_or_insert(Cause::Interrupted);
                signals::interrupt(child);
            }
            (1, Some(since)) if since.elapsed() < GRACE => {}
            _ => self.end(child, Cause::Interrupted),
        }
    }

    /// The most that a process with this cap may hold.
    fn most(&self, cap: u64) -> u64 {
        let beyond = if self.job.verb.caps_memory() { BEYOND_CAP } else { BEYOND_UNKNOWN_CAP };
        (beyond * cap.max(LEAST_CAP) as f64) as u64
    }

    fn end(&mut self, child: &mut Child, cause: Cause) {
        self.ended.cause.get_or_insert(cause);
        signals::kill(child);
    }
}
