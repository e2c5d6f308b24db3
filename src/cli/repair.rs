//! `repair IN -o OUT`.

use super::exit::{Exit, Failure};
use super::holes::LeaveArgs;
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use super::solid_args::SolidArgs;
use crate::ldi::Expression;
use clap::Args;
use std::path::PathBuf;

/// `repair IN -o OUT`.
#[derive(Debug, Args)]
pub struct RepairArgs {
    /// The mesh to repair; all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Which holes are left open.
    #[command(flatten)]
    pub leave: LeaveArgs,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// Repairs one file: all its shells are one operand.
pub fn run(args: &RepairArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let job = Job {
        paths: vec![&args.input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: None,
        leave: Some(&args.leave),
        args: &args.solid,
    };
    solid::run(&job, session, report)
}
