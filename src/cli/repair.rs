//! `repair IN -o OUT`.

use super::args::RepairArgs;
use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use crate::ldi::Expression;

/// Repairs one file: all its shells are one operand.
pub fn run(args: &RepairArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let job = Job {
        paths: vec![&args.input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: None,
        args: &args.solid,
    };
    solid::run(&job, session, report)
}
