//! `dilate`, `erode`, `open` and `close IN -o OUT --radius LEN`, `canals IN --max-diameter LEN`, and
//! `thicken IN -o OUT --min LEN`, or `--base LEN|PLANE`.

use clap::Args;
use std::path::Path;
use std::path::PathBuf;

use super::base::BaseChoice;
use super::change::{Change, RemoveChoice};
use super::choices::SideChoice;
use super::exit::{Exit, Failure};
use super::length::{Length, parse_radius};
use super::maker::Maker;
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use super::solid_args::SolidArgs;
use crate::ldi::Expression;
use crate::morphology::Operation;

/// `open IN -o OUT --radius LEN`, `close` too.
#[derive(Debug, Args)]
pub struct MorphologyArgs {
    /// The mesh; it is repaired first, all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Radius of the ball (0.4mm, 2h for two voxels, 1% of the diagonal)
    #[arg(short, long, value_name = "LEN", value_parser = parse_radius, allow_hyphen_values = true)]
    pub radius: Length,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// `dilate IN -o OUT --radius LEN`, `erode` too.
#[derive(Debug, Args)]
pub struct GrowArgs {
    /// What is grown and by how much.
    #[command(flatten)]
    pub morphology: MorphologyArgs,
    /// Keep edges sharp that would become round, up to LIMIT times the radius from where they were
    #[arg(long, value_name = "LIMIT", num_args = 0..=1, default_missing_value = "2", require_equals = true, value_parser = mitre_limit)]
    pub sharp: Option<f64>,
}

/// `canals IN --max-diameter LEN [--remove -o OUT]`.
#[derive(Debug, Args)]
pub struct CanalArgs {
    /// The mesh; it is repaired first, all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Canals that a ball of this diameter does not pass are listed, by number
    #[arg(short = 'd', long, value_name = "LEN", allow_hyphen_values = true)]
    pub max_diameter: Length,
    /// Fill these canals and write the rest as it was: `all`, or numbers such as 1,3
    #[arg(long, value_name = "all|N,N", num_args = 0..=1, default_missing_value = "all")]
    pub remove: Option<RemoveChoice>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// `thicken IN -o OUT --min LEN`, or `--base LEN|PLANE`.
#[derive(Debug, Args)]
pub struct ThickenArgs {
    /// The mesh; without --base it is repaired first, all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// The least thickness of walls, at least four voxels
    #[arg(short, long, value_name = "LEN", allow_hyphen_values = true, required_unless_present = "base")]
    pub min: Option<Length>,
    /// Where open sheets grow
    #[arg(long, value_enum, default_value_t = SideChoice::Both)]
    pub side: SideChoice,
    /// Make a block of an open sheet, such as terrain: walls from its rims down to a flat base so far below its lowest point, or in a plane (z=-5mm)
    #[arg(long, value_name = "LEN|PLANE", allow_hyphen_values = true, conflicts_with_all = ["min", "side"])]
    pub base: Option<BaseChoice>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// A number of at least 1.
fn mitre_limit(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(limit) if (1.0..=100.0).contains(&limit) => Ok(limit),
        _ => Err("a number from 1 to 100 is needed".into()),
    }
}

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
    let change = match (args.min, args.base) {
        (_, Some(base)) => Change::Instead(Maker::Block { base }),
        (Some(min), None) => Change::Thicken { min, side: args.side.into() },
        (None, None) => return Err(Failure::usage("how thick is not said: --min LEN, or --base LEN for a block")),
    };
    changed(&args.input, &change, &args.solid, session, report)
}

fn changed(
    input: &Path,
    change: &Change,
    args: &SolidArgs,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let job = Job {
        paths: vec![input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: Some(change),
        leave: None,
        pick: None,
        args,
    };
    solid::run(&job, session, report)
}
