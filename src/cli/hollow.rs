//! `hollow IN -o OUT --wall LEN`: a solid shelled out.

use std::path::PathBuf;

use clap::Args;

use super::change::Change;
use super::drain::DrainChoice;
use super::exit::{Exit, Failure};
use super::length::Length;
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use super::solid_args::SolidArgs;
use crate::ldi::Expression;

/// `hollow IN -o OUT --wall LEN`.
#[derive(Debug, Args)]
pub struct HollowArgs {
    /// The mesh; it is repaired first, all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Thickness of the wall that stays, at least two voxels
    #[arg(short, long, value_name = "LEN")]
    pub wall: Length,
    /// Drill a round hole of diameter D into the cavity, from the place of the surface that is nearest to x,y,z; may be given again
    #[arg(long, value_name = "D@X,Y,Z")]
    pub drain: Vec<DrainChoice>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// Hollows one file.
pub fn run(args: &HollowArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let change = Change::Hollow { wall: args.wall, drains: args.drain.clone() };
    let job = Job {
        paths: vec![&args.input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: Some(&change),
        leave: None,
        pick: None,
        args: &args.solid,
    };
    solid::run(&job, session, report)
}
