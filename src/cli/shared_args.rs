//! The arguments that most verbs share: how inputs are read, how outputs are written, and how the program runs.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::choices::AnyFormat;
use super::exit::Failure;
use super::length::{Length, Scale, parse_duration, parse_resolution};
use crate::io::{Format, Unit};
use crate::pipeline::VoxelSize;

/// What every `--help` ends with.
pub const EXIT_CODES: &str = "\
Exit status:
  0    done, and verified on the written file
  1    internal error
  2    wrong usage
  3    a promise or a stated limit does not hold; a result that is mostly lost is written only with --keep-partial
  4    unreadable or empty input, one that the verb cannot take, or nothing is enclosed
  5    more memory or threads needed than can be had, or than --max-memory allows
  6    --timeout has passed
  7    a file or stream cannot be written
  130  interrupted

IN and OUT may be `-` for standard input and output.
LEN is 0.4mm, 1in, 1% (of the bounding box diagonal), 2h (voxels) or a plain number in the file's units.";

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
    /// Write a report of the run to this file: as JSON, or as a page to read in a browser
    #[arg(long, value_name = "FILE.json|FILE.html")]
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

/// Voxels along the longest side where nothing is said.
const USUAL: u32 = 256;

/// The size of voxels.
#[derive(Debug, Clone, Copy, Args)]
pub struct VoxelArgs {
    /// Voxels along the longest side of the bounding box
    #[arg(long, value_name = "N", default_value_t = USUAL, value_parser = parse_resolution, conflicts_with = "voxel")]
    pub resolution: u32,
    /// Size of a voxel, instead of --resolution
    #[arg(long, value_name = "LEN", allow_hyphen_values = true)]
    pub voxel: Option<Length>,
}

impl VoxelArgs {
    /// Whether another size is asked for than the usual one.
    pub fn is_set(&self) -> bool {
        self.voxel.is_some() || self.resolution != USUAL
    }

    /// The size that is asked for, for a model in `unit` whose bounding box has this diagonal, model units.
    pub fn size(&self, unit: Option<Unit>, diagonal: f64) -> Result<VoxelSize, Failure> {
        match self.voxel {
            Some(length) => Ok(VoxelSize::Length(length.resolve(&Scale { unit, diagonal, voxel: None })?)),
            None => Ok(VoxelSize::Along(self.resolution)),
        }
    }
}
