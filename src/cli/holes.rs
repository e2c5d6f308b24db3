//! Holes: which of them to leave open, and what there is to say of each.

use clap::Args;

use super::choices::FillChoice;
use super::exit::Failure;
use super::length::{Length, Scale};
use super::solid_args::SolidArgs;
use super::table::Row;
use super::words::{self, UnitName};
use crate::pipeline::{HoleClosing, HoleReport, LidShape, NotOpened, Opened, Outcome};

/// At most so many holes are listed one by one.
const LISTED: usize = 20;

/// Which holes `repair` leaves open.
#[derive(Debug, Clone, Default, Args)]
pub struct LeaveArgs {
    /// Leave holes open whose rim is wider than this (exit status 3 where there are some)
    #[arg(long, value_name = "LEN")]
    pub max_hole: Option<Length>,
    /// Close these holes alone, by the numbers that `inspect --holes` lists (exit status 3 where others are left open)
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub holes: Vec<usize>,
}

impl LeaveArgs {
    /// Whether holes may have to stay open.
    fn is_asked(&self) -> bool {
        self.max_hole.is_some() || !self.holes.is_empty()
    }
}

/// Refuses what contradicts itself. `leave`: of `repair` alone.
pub fn check(args: &SolidArgs, leave: Option<&LeaveArgs>) -> Result<(), Failure> {
    match (args.fill, leave) {
        (FillChoice::None, None) => Err(Failure::usage("--fill none leaves no solid to work with")
            .hint("only `meshwright repair` can leave holes open")),
        (FillChoice::None, Some(leave)) if leave.is_asked() => {
            Err(Failure::usage("--fill none leaves all holes open: --max-hole and --holes pick none")
                .hint("leave --fill none away"))
        }
        _ => Ok(()),
    }
}

/// The mesh in which the holes that are to be left open are open again; `None` where none is.
pub fn opened(
    args: &SolidArgs,
    leave: Option<&LeaveArgs>,
    outcome: &mut Outcome,
    scale: &Scale,
) -> Result<Option<Opened>, Failure> {
    let Some(leave) = leave else { return Ok(None) };
    if args.fill == FillChoice::None {
        let any = outcome.sources.iter().any(|source| source.is_made_up());
        return Ok(any.then(|| outcome.open_all()));
    }
    let holes = &outcome.report.holes;
    if let Some(&number) = leave.holes.iter().find(|&&number| !holes.iter().any(|hole| hole.number == number)) {
        return Err(refused(&NotOpened::NoHole { number, count: holes.len() }));
    }
    let widest = leave.max_hole.map(|length| length.resolve(scale)).transpose()?;
    let stays_open = |hole: &&HoleReport| {
        hole.closed_by != HoleClosing::LeftOut
            && (widest.is_some_and(|widest| hole.diameter > widest)
                || !leave.holes.is_empty() && !leave.holes.contains(&hole.number))
    };
    let left: Vec<usize> = holes.iter().filter(stays_open).map(|hole| hole.number).collect();
    if left.is_empty() {
        return Ok(None);
    }
    outcome.open(&left).map(Some).map_err(|error| refused(&error))
}

fn refused(error: &NotOpened) -> Failure {
    Failure::usage(error.to_string()).hint("`meshwright inspect --holes` lists the holes and what closes each")
}

/// A sentence for the holes that were left open.
pub fn left_open(holes: &[HoleReport]) -> String {
    let what = match holes.iter().filter(|hole| hole.closed_by == HoleClosing::LeftOpen).count() {
        // Where all surface is made from voxels they are not counted.
        0 => "holes are".into(),
        1 => "1 hole is".into(),
        open => format!("{} holes are", words::count(open)),
    };
    format!("{what} left open, as is asked for: the result is no solid")
}

/// One row for each hole.
pub fn rows(holes: &[HoleReport], unit: UnitName<'_>) -> Vec<Row> {
    let several = holes.iter().any(|hole| hole.operand > 0);
    let mut rows: Vec<Row> = holes.iter().take(LISTED).map(|hole| ("hole", told(hole, several, unit))).collect();
    if let Some(more) = holes.len().checked_sub(LISTED).filter(|&more| more > 0) {
        rows.push(("hole", format!("and {} more, which --json lists", words::count(more))));
    }
    rows
}

fn told(hole: &HoleReport, several: bool, unit: UnitName<'_>) -> String {
    let of = if several { format!(" of input {}", hole.operand + 1) } else { String::new() };
    let place = words::with_unit(&hole.centre.map(words::number).join(" "), unit);
    let [length, width, off] = [hole.perimeter, hole.diameter, hole.flatness].map(|x| words::length(x, unit));
    let rim = words::plural(hole.edges, "edge");
    let plane = if hole.flatness > 0.0 { format!("{off} off its plane") } else { "in one plane".into() };
    format!(
        "{}{of}: at {place}, {width} wide, a rim of {rim}, {length} long and {plane}: {}",
        hole.number,
        closing(hole)
    )
}

/// What closes a hole, in words.
pub(super) fn closing(hole: &HoleReport) -> String {
    let triangles = || words::plural(hole.triangles, "triangle");
    match hole.closed_by {
        HoleClosing::Lid(LidShape::Flat) => format!("flat, {}", triangles()),
        HoleClosing::Lid(LidShape::Smooth) => format!("smooth, {}", triangles()),
        HoleClosing::Lid(LidShape::Level) => format!("along the winding number ½, {}", triangles()),
        HoleClosing::Lid(LidShape::Band) => match hole.joined_with {
            Some(other) => format!("joined with hole {other}, {}", triangles()),
            None => format!("joined with another, {}", triangles()),
        },
        HoleClosing::Voxels(why) => format!("from voxels, since {why}"),
        HoleClosing::LeftOpen => "left open".into(),
        HoleClosing::LeftOut => "left out with its sheet, which encloses nothing".into(),
    }
}
