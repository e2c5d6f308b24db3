//! `union`, `intersection` and `difference`.

use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use super::solid_args::SolidArgs;
use crate::ldi::Expression;
use clap::Args;
use std::path::PathBuf;

/// `union A B... -o OUT` and its sisters.
#[derive(Debug, Args)]
pub struct BooleanArgs {
    /// The meshes, two or more; each may be broken
    #[arg(value_name = "IN", num_args = 2.., required = true)]
    pub inputs: Vec<PathBuf>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// Combines the files by `expression`, made for their number.
pub fn run(
    args: &BooleanArgs,
    expression: fn(usize) -> Expression,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let paths: Vec<_> = args.inputs.iter().map(AsRef::as_ref).collect();
    let expression = expression(paths.len());
    solid::run(
        &Job { paths, names: Vec::new(), change: None, leave: None, pick: None, expression, args: &args.solid },
        session,
        report,
    )
}
