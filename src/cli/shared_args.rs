//! The arguments that most verbs share: how inputs are read, how outputs are written, and how the program runs.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::choices::AnyFormat;
use super::length::parse_duration;
use crate::io::{Format, Unit};

/// How inputs are read.
#[derive(Debug, Clone, Args)]
pub struct InputArgs {
    /// Format of the input, when neither its content nor its name should decide
    #[arg(long, value_name = "FORMAT")]
    pub in_format: Option<Format>,
    /// Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF)
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<Unit>,
}

/// How the output is written.
#[derive(Debug, Clone, Args)]
pub struct OutputArgs {
    /// Format of the output, when its name should not decide
    #[arg(long, value_name = "FORMAT")]
    pub out_format: Option<AnyFormat>,
    /// Text instead of binary, where the format has both (STL, PLY)
    #[arg(long)]
    pub ascii: bool,
    /// Write over an input file
    #[arg(long)]
    pub force: bool,
}

/// Flags of every verb.
#[derive(Debug, Clone, Args)]
pub struct CommonArgs {
    /// Threads to use [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Give up after this time (30s, 5m)
    #[arg(long, value_name = "DUR", value_parser = parse_duration)]
    pub timeout: Option<Duration>,
    /// Write a report of the run, as JSON, to this file
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Write the report, as JSON, to standard output
    #[arg(long)]
    pub json: bool,
    /// Only errors on standard error
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// More on standard error
    #[arg(short, long)]
    pub verbose: bool,
}
