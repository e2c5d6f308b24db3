//! `dilate`, `erode`, `open` and `close IN -o OUT --radius LEN`, `canals IN --max-diameter LEN`, and
//! `thicken IN -o OUT --min LEN`.

use std::path::Path;

use super::args::{CanalArgs, GrowArgs, MorphologyArgs, SolidArgs, ThickenArgs};
use super::change::Change;
use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
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
    sharp: Option<f64>,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let change = Change::Morphology { operation, radius: args.radius, sharp };
    changed(&args.input, &change, &args.solid, session, report)
}

/// Lists the canals of one file, or fills them.
pub fn canals(args: &CanalArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    if args.remove.is_none() && args.solid.output.is_some() {
        return Err(Failure::usage("without --remove the canals are only listed, and nothing is written to -o"));
    }
    let change = Change::Canals { max_diameter: args.max_diameter, remove: args.remove.clone() };
    changed(&args.input, &change, &args.solid, session, report)
}

/// Lets the thin walls of one file grow.
pub fn thicken(args: &ThickenArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let change = Change::Thicken { min: args.min, side: args.side.into() };
    changed(&args.input, &change, &args.solid, session, report)
}

fn changed(
    input: &Path,
    change: &Change,
    args: &SolidArgs,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let job =
        Job { paths: vec![input], names: Vec::new(), expression: Expression::Operand(0), change: Some(change), args };
    solid::run(&job, session, report)
}
