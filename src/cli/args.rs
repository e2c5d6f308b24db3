//! The arguments of every verb.

use std::ffi::OsString;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use super::again::ReportArgs;
use super::batch::args::{BATCH_HELP, BatchArgs};
use super::batch::options::rearranged;
use super::boolean::BooleanArgs;
use super::compare::CompareArgs;
use super::convert_args::ConvertArgs;
use super::csg::{CSG_HELP, CsgArgs};
use super::decimate::DecimateArgs;
use super::devices::DevicesArgs;
use super::examples;
use super::field_args::{FieldArgs, field_help};
use super::hollow::HollowArgs;
use super::inspect_args::InspectArgs;
use super::morphology::{CanalArgs, GrowArgs, MorphologyArgs, ThickenArgs};
use super::render::RenderArgs;
use super::repair::RepairArgs;
use super::sdf_args::SdfArgs;
use super::shared_args::EXIT_CODES;
use super::solid_args::SolidArgs;
use super::split::SplitArgs;
use super::view::ViewArgs;

/// Repairs triangle meshes and does booleans on broken ones. Offline.
#[derive(Debug, Parser)]
#[command(name = "meshwright", version, after_help = EXIT_CODES, propagate_version = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Make one closed, oriented solid surface of a broken mesh
    #[command(after_help = examples::after("repair", EXIT_CODES), aliases = ["fix", "heal"])]
    Repair(RepairArgs),
    /// Everything inside at least one of the meshes
    #[command(after_help = examples::after("union", EXIT_CODES), aliases = ["add", "join", "merge", "combine"])]
    Union(BooleanArgs),
    /// Everything inside all of the meshes
    #[command(after_help = examples::after("intersection", EXIT_CODES), aliases = ["intersect", "common"])]
    Intersection(BooleanArgs),
    /// The first mesh without all the others
    #[command(after_help = examples::after("difference", EXIT_CODES), aliases = ["subtract", "minus"])]
    Difference(BooleanArgs),
    /// Any boolean expression, such as 'a - (b | c) & d'
    #[command(after_help = examples::after("csg", CSG_HELP))]
    Csg(CsgArgs),
    /// Grow a solid by a length on all sides
    #[command(after_help = examples::after("dilate", EXIT_CODES), aliases = ["grow", "inflate"])]
    Dilate(GrowArgs),
    /// Shrink a solid by a length on all sides
    #[command(after_help = examples::after("erode", EXIT_CODES), alias = "shrink")]
    Erode(GrowArgs),
    /// Take away what a ball inside cannot reach: whiskers, fins, thin walls
    #[command(after_help = examples::after("open", EXIT_CODES))]
    Open(MorphologyArgs),
    /// Fill what a ball outside cannot reach: cracks, canals, narrow gaps
    #[command(after_help = examples::after("close", EXIT_CODES))]
    Close(MorphologyArgs),
    /// List canals, pits and gaps that a closing would fill, and fill those that you choose
    #[command(after_help = examples::after("canals", EXIT_CODES))]
    Canals(CanalArgs),
    /// Let walls that are too thin, and open sheets, grow to a thickness
    #[command(after_help = examples::after("thicken", EXIT_CODES))]
    Thicken(ThickenArgs),
    /// Signed distance to a mesh over a lattice
    #[command(after_help = examples::after("sdf", EXIT_CODES), alias = "distance")]
    Sdf(SdfArgs),
    /// Combine, filter and morph shapes through their distance fields, by an expression
    #[command(after_help = examples::after("field", &field_help()))]
    Field(FieldArgs),
    /// Shell a solid out: a cavity in it, walls of one thickness, and holes to drain it
    #[command(after_help = examples::after("hollow", EXIT_CODES))]
    Hollow(HollowArgs),
    /// Leave fewer triangles of a solid: a number, a share, or as far as the surface may move
    #[command(after_help = examples::after("decimate", EXIT_CODES))]
    Decimate(DecimateArgs),
    /// Write every body of a file into a file of its own
    #[command(after_help = examples::after("split", EXIT_CODES))]
    Split(SplitArgs),
    /// Say what is in a mesh file and what is wrong with it
    #[command(after_help = examples::after("inspect", EXIT_CODES), aliases = ["info", "check"])]
    Inspect(InspectArgs),
    /// Measure how far two meshes are from each other
    #[command(after_help = examples::after("compare", EXIT_CODES), alias = "diff")]
    Compare(CompareArgs),
    /// Write the same triangles in another format, size or place, or a grid in another format; nothing is repaired
    #[command(after_help = examples::after("convert", EXIT_CODES))]
    Convert(ConvertArgs),
    /// Draw a mesh or a slice of a grid, or two of these for comparison, as a PNG picture
    #[command(after_help = examples::after("render", EXIT_CODES), alias = "draw")]
    Render(RenderArgs),
    /// Show meshes, maps and slices of grids in a browser
    #[command(after_help = examples::after("view", EXIT_CODES))]
    View(ViewArgs),
    /// Make a page of the report of a run, to read in a browser
    #[command(after_help = examples::after("report", EXIT_CODES))]
    Report(ReportArgs),
    /// List the graphics adapters, and what --backend would take
    #[command(after_help = examples::after("devices", EXIT_CODES))]
    Devices(DevicesArgs),
    /// Print the licences of the program and of all that it is built of
    #[command(after_help = examples::after("licenses", EXIT_CODES))]
    Licenses,
    /// Do one of the verbs to many files, each in a process of its own, with a log and a way to go on after a stop
    #[command(after_help = examples::after("batch", BATCH_HELP))]
    Batch(BatchArgs),
    /// Print the JSON schema of the reports that --json and --report write
    #[command(after_help = examples::after("schema", EXIT_CODES))]
    Schema,
}

/// The command line as a whole, for what is made of it: manual pages, completions.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Parses the arguments of the program, and fills in what a preset sets.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let command = Cli::command();
    let arguments = rearranged(arguments.into_iter().collect(), &command);
    let matches = command.try_get_matches_from(arguments)?;
    let mut cli = Cli::from_arg_matches(&matches)?;
    if let (Some(args), Some((_, given))) = (solid(&mut cli.verb), matches.subcommand()) {
        args.fill_in(given);
    }
    Ok(cli)
}

/// The flags that presets are about, of the verbs that have them.
pub fn solid(verb: &mut Verb) -> Option<&mut SolidArgs> {
    Some(match verb {
        Verb::Repair(args) => &mut args.solid,
        Verb::Union(args) | Verb::Intersection(args) | Verb::Difference(args) => &mut args.solid,
        Verb::Csg(args) => &mut args.solid,
        Verb::Dilate(args) | Verb::Erode(args) => &mut args.morphology.solid,
        Verb::Open(args) | Verb::Close(args) => &mut args.solid,
        Verb::Canals(args) => &mut args.solid,
        Verb::Thicken(args) => &mut args.solid,
        Verb::Hollow(args) => &mut args.solid,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::preset::Preset;
    use super::*;
    use crate::io::Unit;
    use clap::ValueEnum;

    #[test]
    fn the_command_is_well_formed() {
        Cli::command().debug_assert();
    }

    fn parsed(line: &str) -> SolidArgs {
        let arguments = line.split(' ').map(OsString::from);
        match parse(arguments).expect("it parses").verb {
            Verb::Repair(args) => args.solid,
            _ => panic!("no repair"),
        }
    }

    #[test]
    fn every_setting_is_understood_and_told() {
        for preset in Preset::value_variants() {
            let args = parsed(&format!("meshwright repair a.stl -o b.stl --preset {}", preset.name()));
            for (flag, value) in preset.settings() {
                let set = match *flag {
                    "unit" => args.reading.unit.map(|unit| unit.to_string()),
                    "resolution" => Some(args.voxels.resolution.to_string()),
                    "simplify" => args.simplify.map(|simplify| simplify.to_string()),
                    other => panic!("nothing sets --{other}"),
                };
                assert_eq!(set.as_deref(), Some(*value), "--{flag}");
                assert!(args.preset_in_words().expect("a preset").contains(&format!("--{flag} {value}")));
            }
        }
    }

    #[test]
    fn what_is_given_by_hand_wins_also_where_it_is_the_default() {
        let args = parsed("meshwright repair a.stl -o b.stl --preset print --resolution 256 --unit in");
        assert_eq!((args.voxels.resolution, args.reading.unit), (256, Some(Unit::Inch)));
        assert_eq!(args.set_by_preset, ["--simplify 0.02h"]);
        let args = parsed("meshwright repair a.stl -o b.stl --preset cad --voxel 1 --no-fit");
        assert_eq!((args.voxels.resolution, args.simplify), (256, None));
        assert_eq!(args.set_by_preset, ["--unit mm"]);
        assert_eq!(parsed("meshwright repair a.stl -o b.stl").preset_in_words(), None);
    }
}
