//! The arguments of `batch`.

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::super::choices::AnyFormat;
use super::super::length::{parse_duration, parse_size};
use super::shard::ShardChoice;

/// What `batch --help` ends with.
pub const BATCH_HELP: &str = "\
The options of the verb stand among those of batch or behind `--`; `meshwright VERB --help` lists them.
Every job is a process of its own. The log has one line of JSON for each job that has ended (docs/cli.md).

Exit status:
  0    all jobs are done
  2    wrong usage; no job has begun
  3    some jobs have failed; the summary and the log say which and why
  7    the log cannot be written
  130  interrupted; --resume goes on";

/// `batch VERB IN... --out DIR [OPTIONS of the verb]`.
#[derive(Debug, Args)]
pub struct BatchArgs {
    /// What is done to every input: repair, dilate, erode, open, close, canals, thicken, hollow, decimate, convert, sdf, render or inspect
    #[arg(value_name = "VERB", required_unless_present = "manifest")]
    pub verb: Option<String>,
    /// Files, folders (all meshes in and below them) and patterns such as 'parts/**/*.stl'
    #[arg(value_name = "IN")]
    pub inputs: Vec<PathBuf>,
    /// The folder of the outputs, which keep the folders of the inputs; it is made if need be
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Jobs from a file: in each line one, as JSON with `verb`, `input` or `inputs`, `output` and `options`
    #[arg(long, value_name = "FILE.jsonl")]
    pub manifest: Option<PathBuf>,
    /// What each job may take, and what it writes.
    #[command(flatten)]
    pub each: EachArgs,
    /// Jobs side by side, at most [default: as many as cores and memory allow]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Threads of all jobs together, at most [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Where the log goes [default: DIR/batch.jsonl]
    #[arg(long, value_name = "FILE.jsonl")]
    pub log: Option<PathBuf>,
    /// Go on with an earlier batch: leave out what its log says is done, as long as input, options and output are the same
    #[arg(long)]
    pub resume: bool,
    /// Do one share of the jobs, such as 1/4 to 4/4, or the one that the array of jobs of Slurm says
    #[arg(long, value_name = "I/N|slurm")]
    pub shard: Option<ShardChoice>,
    /// Only errors on standard error
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// A line for every job that has ended
    #[arg(short, long)]
    pub verbose: bool,
    /// Options of the verb
    #[arg(last = true, value_name = "OPTIONS", allow_hyphen_values = true)]
    pub options: Vec<OsString>,
}

/// What each job may take, and what it writes.
#[derive(Debug, Clone, Default, Args)]
pub struct EachArgs {
    /// Format of the outputs, which changes their extension [default: that of the input; vdb for sdf]
    #[arg(long, value_name = "FORMAT")]
    pub out_format: Option<AnyFormat>,
    /// End a job after this time (30s, 5m)
    #[arg(long, value_name = "DUR", value_parser = parse_duration)]
    pub timeout: Option<Duration>,
    /// End a job that takes more memory (500M, 2G), and refuse one that would
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
}

impl EachArgs {
    /// With the values of `all` where there are none here.
    pub fn or(self, all: &Self) -> Self {
        Self {
            out_format: self.out_format.or(all.out_format),
            timeout: self.timeout.or(all.timeout),
            max_memory: self.max_memory.or(all.max_memory),
        }
    }
}
