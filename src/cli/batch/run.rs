//! The run of all jobs: begun as planned, each watched by a thread of its own, and written into the log when they have ended.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, Scope};
use std::time::Duration;

use serde_json::Value;

use super::super::exit::Failure;
use super::super::machine;
use super::super::streams::plain_reason;
use super::bar::Bar;
use super::child::{self, Ended, Interrupts};
use super::class::{Cause, Class};
use super::hash;
use super::job::Job;
use super::log::{Entry, Log};
use super::plan::{Plan, Running, Start, work};
use super::summary;
use crate::io::draft::folder_of;

/// How often the memory that is left is looked at while jobs wait for it.
const GLANCE: Duration = Duration::from_millis(100);

/// The jobs, and all that their run needs.
pub struct Batch<'a> {
    /// All of them.
    pub jobs: &'a [Job],
    /// How often it was interrupted.
    pub interrupts: &'a Interrupts,
    /// Whether every job is told.
    pub verbose: bool,
}

/// A job that has ended, with what its thread was begun with.
type Done = (Start, Entry);

/// Jobs that run, with what each holds.
type Beside = Vec<(Start, Arc<AtomicU64>)>;

impl Batch<'_> {
    /// Runs the jobs of the plan. Returns their entries; those of jobs that had not begun when the batch was interrupted are missing.
    pub fn run(&self, mut plan: Plan, log: &mut Log, bar: &mut Bar) -> Result<Vec<Entry>, Failure> {
        let (sender, ended) = channel();
        let sender = Mutex::new(sender);
        let outcome = std::thread::scope(|scope| {
            let outcome = self.steer(&mut plan, log, bar, scope, &sender, &ended);
            if outcome.is_err() {
                // Nothing can be logged any more, so that nothing must go on.
                self.interrupts.add();
            }
            outcome
        })?;
        log.flush()?;
        Ok(outcome)
    }

    fn steer<'s>(
        &'s self,
        plan: &mut Plan,
        log: &mut Log,
        bar: &mut Bar,
        scope: &'s Scope<'s, '_>,
        sender: &'s Mutex<Sender<Done>>,
        ended: &Receiver<Done>,
    ) -> Result<Vec<Entry>, Failure> {
        let (mut entries, mut beside) = (Vec::new(), Beside::new());
        // Jobs that ran beside others when they failed run once more, alone.
        let mut again = vec![false; self.jobs.len()];
        loop {
            self.begin(plan, &mut beside, scope, sender)?;
            if beside.is_empty() {
                return Ok(entries);
            }
            let (start, mut entry) = match ended.recv_timeout(GLANCE) {
                Ok(done) => done,
                Err(RecvTimeoutError::Timeout) => continue,
                Err(RecvTimeoutError::Disconnected) => return Err(Failure::internal("a job has got lost")),
            };
            let had_company = beside.len() > 1;
            beside.retain(|(other, _)| other.job != start.job);
            let job = &self.jobs[start.job];
            plan.learn(job, entry.peak_memory_bytes);
            let uncapped = entry.class == Class::Memory && job.each.max_memory.is_none();
            if uncapped && had_company && !again[start.job] && !self.interrupts.any() {
                again[start.job] = true;
                plan.again(self.jobs, start.job);
                continue;
            }
            entry.runs += usize::from(again[start.job]);
            log.add(&entry)?;
            bar.ended(work(job), entry.class != Class::Done);
            if self.verbose {
                bar.tell(&summary::line(&entry));
            }
            entries.push(entry);
        }
    }

    /// Begins all jobs that can begin now.
    fn begin<'s>(
        &'s self,
        plan: &mut Plan,
        beside: &mut Beside,
        scope: &'s Scope<'s, '_>,
        sender: &'s Mutex<Sender<Done>>,
    ) -> Result<(), Failure> {
        while !self.interrupts.any() {
            let holds = |(start, resident): &(Start, Arc<AtomicU64>)| Running {
                start: *start,
                resident: resident.load(Ordering::Relaxed),
            };
            let running: Vec<Running> = beside.iter().map(holds).collect();
            let Some(start) = plan.next(&running, machine::free_memory()) else { break };
            let resident = Arc::new(AtomicU64::new(0));
            let (held, sender) = (resident.clone(), sender.lock().unwrap_or_else(PoisonError::into_inner).clone());
            let work = move || {
                let entry = self.do_job(start, &held);
                let _ = sender.send((start, entry));
            };
            match Builder::new().name("job".into()).spawn_scoped(scope, work) {
                Ok(_) => beside.push((start, resident)),
                Err(error) if beside.is_empty() => return Err(machine::no_threads(plain_reason(&error))),
                Err(_) => {
                    plan.put_back(self.jobs, start.job);
                    break;
                }
            }
        }
        Ok(())
    }

    fn do_job(&self, start: Start, resident: &AtomicU64) -> Entry {
        let job = &self.jobs[start.job];
        let ended = match make_folders(job) {
            Ok(()) => child::run(job, start.threads, self.interrupts, resident),
            Err(why) => return entry(job, start.threads, Ended::default(), Some((Class::Write, why))),
        };
        entry(job, start.threads, ended, None)
    }
}

/// Makes the folders of what a job writes, and takes away the report of an earlier run.
fn make_folders(job: &Job) -> Result<(), String> {
    for file in [&job.output, &job.report] {
        let folder = folder_of(file);
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("cannot make the folder {}: {}", folder.display(), plain_reason(&error)))?;
    }
    match std::fs::remove_file(&job.report) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(format!("cannot remove the old {}: {}", job.report.display(), plain_reason(&error)))
        }
        _ => Ok(()),
    }
}

/// What the log says of a job that has ended.
fn entry(job: &Job, threads: usize, ended: Ended, unready: Option<(Class, String)>) -> Entry {
    let report = std::fs::read(&job.report).ok().and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok());
    let told = |pointer: &str| report.as_ref().and_then(|report| report.pointer(pointer));
    let text = |pointer: &str| told(pointer).and_then(Value::as_str).map(str::to_owned);
    let class = unready.as_ref().map_or_else(|| Class::of(ended.status, ended.cause.as_ref()), |(class, _)| *class);
    let message = match unready {
        Some((_, why)) => Some(why),
        None if class == Class::Done => None,
        None => text("/error/message").or_else(|| Some(why(class, &ended))),
    };
    let read = |n: usize| text(&format!("/inputs/{n}/sha256"));
    let hashes = job.inputs.iter().enumerate().map(|(n, path)| read(n).or_else(|| hash::of_file(path)));
    // Of what was there before a job that wrote nothing there is nothing to say.
    let wrote = told("/result/output/path").is_some() && matches!(class, Class::Done | Class::Limit);
    let output_sha256 = match job.verb.only_reports() {
        true => report.as_ref().and_then(|_| hash::of_file(&job.report)),
        false => text("/result/output/sha256").filter(|_| wrote),
    };
    Entry {
        job: job.name.clone(),
        verb: job.verb.name.to_owned(),
        class,
        status: ended.status.code,
        signal: ended.status.signal,
        error: text("/error/class"),
        message,
        seconds: (ended.seconds * 1000.0).round() / 1000.0,
        peak_memory_bytes: told("/peak_memory_bytes").and_then(Value::as_u64).max(ended.peak),
        threads,
        runs: 1,
        inputs: job.input_words(),
        input_sha256: hashes.collect(),
        options: job.option_words(),
        output: job.output.display().to_string(),
        output_sha256,
        report: report.is_some().then(|| job.report.display().to_string()),
    }
}

/// Why a job failed of which there is no report.
fn why(class: Class, ended: &Ended) -> String {
    let said = ended.words.lines().find_map(|line| line.strip_prefix("error: "));
    match (&ended.cause, class) {
        (Some(Cause::NotBegun { why, .. }), _) => why.clone(),
        (Some(Cause::Timeout), _) => "its time has passed, and it did not stop; it was ended".into(),
        (Some(Cause::Memory(bytes)), _) => {
            let bytes = super::super::words::bytes(*bytes);
            format!("it has taken {bytes} of memory, more than --max-memory allows; it was ended")
        }
        (_, Class::Killed) => {
            let signal = ended.status.signal.unwrap_or_default();
            let by_system = if signal == 9 { ", or the system for want of memory" } else { "" };
            format!("signal {signal} has ended it: somebody has killed it{by_system}")
        }
        (_, Class::Crashed) if ended.status.signal.is_some() => {
            let said = said.map_or(String::new(), |said| format!(": {said}"));
            format!("the program has a bug, and signal {} has ended it{said}", ended.status.signal.unwrap_or_default())
        }
        _ => said.map_or_else(|| "it ended without saying why".into(), str::to_owned),
    }
}

/// Whether a file that a batch is to write can be where it is to be.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| super::super::streams::unwritable(folder, &error))
}
