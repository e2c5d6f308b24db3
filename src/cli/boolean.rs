//! `union`, `intersection` and `difference`.

use super::args::BooleanArgs;
use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use crate::ldi::Expression;

/// Combines the files by `expression`, made for their number.
pub fn run(
    args: &BooleanArgs,
    expression: fn(usize) -> Expression,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let paths: Vec<_> = args.inputs.iter().map(AsRef::as_ref).collect();
    let expression = expression(paths.len());
    solid::run(&Job { paths, names: Vec::new(), change: None, expression, args: &args.solid }, session, report)
}
