//! The arguments of `convert`.

use std::path::PathBuf;

use clap::Args;

use super::keep::KeepArgs;
use super::shared_args::{CommonArgs, InputArgs, OutputArgs};
use super::transform::TransformArgs;

/// `convert IN -o OUT`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The mesh, or the grid (VTI, NRRD, NPY, VDB), to write again
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where to write it
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Another size and place.
    #[command(flatten)]
    pub transform: TransformArgs,
    /// How the input is read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// How the output is written.
    #[command(flatten)]
    pub writing: OutputArgs,
    /// Whether a result that is mostly lost is written.
    #[command(flatten)]
    pub keeping: KeepArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}
