//! `batch`: one verb, or the jobs of a manifest, done to many files, each in a process of its own.

pub mod args;
mod bar;
mod check;
mod child;
mod class;
mod hash;
mod inputs;
mod job;
mod jobs;
mod log;
mod manifest;
pub mod options;
mod plan;
mod resume;
mod run;
mod shard;
mod signals;
mod summary;
mod verbs;

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Instant;

use clap::CommandFactory;

use super::exit::{Exit, Failure};
use super::say::print_failure;
use super::streams::plain_reason;
use super::{args as command_line, machine};
use crate::io::draft::folder_of;
use args::BatchArgs;
use bar::Bar;
use child::Interrupts;
use class::Class;
use job::Job;
use log::Log;
use plan::{Plan, work};
use run::Batch;
use summary::Summary;

/// Runs a batch.
pub fn run(args: &BatchArgs) -> Exit {
    go(args).unwrap_or_else(|failure| {
        print_failure(&failure);
        failure.exit
    })
}

fn go(args: &BatchArgs) -> Result<Exit, Failure> {
    let start = Instant::now();
    let (jobs, path) = jobs_and_log(args)?;
    run::make_folder(&args.out)?;
    run::make_folder(folder_of(&path))?;
    let interrupts = listen()?;
    let (mut log, before) = Log::open(&path, args.resume)?;
    let cores = args.threads.map(usize::from).or_else(|| available_parallelism().ok().map(usize::from)).unwrap_or(1);
    let done = resume::done_before(&jobs, &before, cores);
    let left: Vec<usize> = (0..jobs.len()).filter(|&n| done[n].is_none()).collect();
    let plan = Plan::new(&jobs, left.iter().copied(), cores, args.jobs.map(usize::from));
    let mut bar = Bar::new(left.len(), left.iter().map(|&n| work(&jobs[n])).sum(), args.quiet);
    let batch = Batch { jobs: &jobs, interrupts: &interrupts, verbose: args.verbose };
    let ended = batch.run(plan, &mut log, &mut bar);
    bar.clear();
    let ended = ended?;
    let (count, begun) = (jobs.len() - left.len(), ended.len());
    let mut entries: Vec<_> = done.into_iter().flatten().chain(ended).collect();
    entries.sort_by(|a, b| a.job.cmp(&b.job));
    let summary =
        Summary { entries: &entries, before: count, left: left.len() - begun, took: start.elapsed(), log: &path };
    summary.lines().iter().for_each(|line| bar.tell(line));
    Ok(match () {
        () if interrupts.any() => Exit::Interrupted,
        () if entries.iter().any(|entry| entry.class != Class::Done) => Exit::Limit,
        () => Exit::Done,
    })
}

/// The jobs of this run, and where their log goes.
fn jobs_and_log(args: &BatchArgs) -> Result<(Vec<Job>, PathBuf), Failure> {
    if args.out.exists() && !args.out.is_dir() {
        return Err(Failure::usage(format!("{} is no folder", args.out.display()))
            .hint("--out DIR is the folder of the outputs"));
    }
    let mut jobs = jobs::all(args, &command_line::Cli::command())?;
    let mut path = args.log.clone().unwrap_or_else(|| args.out.join("batch.jsonl"));
    if let Some(choice) = args.shard {
        let shard = choice.resolve(|name| std::env::var(name).ok())?;
        jobs.retain(|job| shard.has(&job.name));
        path = shard.log_name(&path);
    }
    Ok((jobs, path))
}

/// Counts interrupts from now on.
fn listen() -> Result<Arc<Interrupts>, Failure> {
    let interrupts = Arc::new(Interrupts::default());
    let heard = interrupts.clone();
    match ctrlc::set_handler(move || heard.add()) {
        Ok(()) => Ok(interrupts),
        Err(ctrlc::Error::System(error)) => Err(machine::no_threads(plain_reason(&error))),
        Err(error) => Err(Failure::internal(format!("cannot listen for Ctrl-C: {error}"))),
    }
}
