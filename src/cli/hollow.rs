//! `hollow IN -o OUT --wall LEN`: a solid shelled out.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use super::args::SolidArgs;
use super::change::Change;
use super::exit::{Exit, Failure};
use super::length::{Length, Scale};
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use super::transform::Shift;
use super::words::{self, UnitName};
use crate::ldi::Expression;
use crate::pipeline::{Drain, DrainReport, HollowReport};

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

/// One `--drain`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrainChoice {
    diameter: Length,
    at: Shift,
}

impl FromStr for DrainChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || "a diameter and a place are needed, such as 3mm@10,0,-5".to_string();
        let (diameter, at) = text.split_once('@').ok_or_else(wanted)?;
        let diameter = diameter.parse().map_err(|error: super::length::QuantityError| error.to_string())?;
        Ok(Self { diameter, at: at.parse()? })
    }
}

impl DrainChoice {
    /// In model units.
    pub fn resolve(&self, scale: &Scale) -> Result<Drain, Failure> {
        Ok(Drain { diameter: self.diameter.resolve(scale)?, at: self.at.resolve(scale)? })
    }
}

/// Hollows one file.
pub fn run(args: &HollowArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let change = Change::Hollow { wall: args.wall, drains: args.drain.clone() };
    let job = Job {
        paths: vec![&args.input],
        names: Vec::new(),
        expression: Expression::Operand(0),
        change: Some(&change),
        args: &args.solid,
    };
    solid::run(&job, session, report)
}

/// What was done, in words.
pub fn done(found: &HollowReport, unit: UnitName<'_>) -> Vec<String> {
    let (wall, cavities) = (words::length(found.wall, unit), words::plural(found.cavities, "cavity"));
    let saved = words::volume(found.volume_before - found.volume_after, unit);
    let share = words::percent_change(found.volume_before, found.volume_after);
    let mut parts = vec![format!("{cavities} with walls of {wall}: {saved} saved (volume {share})")];
    if found.left_out > 0 {
        parts.push(format!("{} of under 64 voxels not made", words::plural(found.left_out, "cavity")));
    }
    let drain = |drain: &DrainReport| {
        let place = |p: [f64; 3]| p.map(words::number).join(" ");
        let (diameter, depth) = (words::length(drain.diameter, unit), words::length(drain.depth, unit));
        format!("a drain of {diameter}, {depth} deep, from {} along {}", place(drain.at), place(drain.direction))
    };
    parts.extend(found.drains.iter().map(drain));
    if !found.drains.is_empty() {
        parts.push("what the drains cut of the surface was built anew, the rest is as said above".into());
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drains_are_a_diameter_at_a_place() {
        let scale = Scale { unit: None, diagonal: 10.0, voxel: Some(0.5) };
        let drain: DrainChoice = "4h@1,-2.5,0".parse().expect("a drain");
        let expected = Drain { diameter: 2.0, at: glam::DVec3::new(1.0, -2.5, 0.0) };
        assert_eq!(drain.resolve(&scale).expect("lengths"), expected);
        for text in ["", "3", "3@", "3@1,2", "@1,2,3", "0@1,2,3", "-1@1,2,3", "3@a,b,c"] {
            assert!(text.parse::<DrainChoice>().is_err(), "{text}");
        }
    }
}
