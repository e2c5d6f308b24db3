//! `repair IN -o OUT`, and with `--outer` the surface as a ball sees it.

use super::change::Change;
use super::each;
use super::exit::{Exit, Failure};
use super::holes::LeaveArgs;
use super::length::Length;
use super::maker::Maker;
use super::pick::PickArgs;
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
    /// The mesh to repair; all its shells together are one solid, unless --each keeps the objects of the file apart
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Keep the surface as a ball of this diameter sees it from outside: what is narrower is no way in, and what the ball does not come to goes [default of LEN: 1%]
    #[arg(long, value_name = "LEN", num_args = 0..=1, default_missing_value = "1%", conflicts_with = "holes")]
    pub outer: Option<Length>,
    /// How thick sheets become that the ball of --outer sees from both sides
    #[arg(long, value_name = "LEN", allow_hyphen_values = true, requires = "outer")]
    pub thickness: Option<Length>,
    /// Repair each object of a 3MF, glTF or OBJ file by itself, and keep names, places, colours, materials and all else
    #[arg(long, conflicts_with_all = ["map", "plan", "holes", "max_hole"])]
    pub each: bool,
    /// Which objects.
    #[command(flatten)]
    pub pick: PickArgs,
    /// Which holes are left open.
    #[command(flatten)]
    pub leave: LeaveArgs,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// Repairs one file: all its shells are one operand.
pub fn run(args: &RepairArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let thickness = args.thickness;
    let outer = args.outer.map(|ball| Change::Instead(Maker::Outer { ball, thickness }));
    let job = Job {
        paths: vec![&args.input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: outer.as_ref(),
        leave: Some(&args.leave),
        pick: Some(&args.pick),
        args: &args.solid,
    };
    if args.each {
        return each::run(&job, session, report);
    }
    solid::run(&job, session, report)
}
