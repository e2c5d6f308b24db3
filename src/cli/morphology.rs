//! `dilate`, `erode`, `open` and `close IN -o OUT --radius LEN`.

use super::args::{GrowArgs, MorphologyArgs};
use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Change, Job};
use crate::ldi::Expression;
use crate::morphology::Operation;

/// Dilates or erodes one file.
pub fn grow(args: &GrowArgs, operation: Operation, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    run(&args.morphology, operation, args.sharp, session, report)
}

/// Does one operation on one file.
pub fn run(
    args: &MorphologyArgs,
    operation: Operation,
    mitre: Option<f64>,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let job = Job {
        paths: vec![&args.input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: Some(Change { operation, radius: args.radius, mitre }),
        args: &args.solid,
    };
    solid::run(&job, session, report)
}
