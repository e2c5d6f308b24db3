//! `--preset`: a handful of options for those who print, scan or construct.

use std::ffi::OsString;

use clap::parser::ValueSource;
use clap::{ArgMatches, CommandFactory, FromArgMatches, ValueEnum};

use super::args::{Cli, SolidArgs, Verb};
use super::length::Simplify;
use crate::io::Unit;

/// `--preset`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// For a slicer: millimetres, fine voxels, few triangles
    Print,
    /// For measured surfaces: finer voxels, and no measured point is simplified away
    Scan,
    /// For constructed parts: millimetres, finer voxels, flat faces of few triangles and edges where they were
    Cad,
}

/// A flag and what a preset gives it.
type Setting = (&'static str, &'static str);

impl Preset {
    /// What it sets. A flag is left as it is where it, or one that excludes it, was given.
    fn settings(self) -> &'static [Setting] {
        match self {
            Self::Print => &[("unit", "mm"), ("resolution", "384"), ("simplify", "0.02h")],
            Self::Scan => &[("resolution", "512"), ("simplify", "off")],
            Self::Cad => &[("unit", "mm"), ("resolution", "512"), ("simplify", "0.002h")],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Print => "print",
            Self::Scan => "scan",
            Self::Cad => "cad",
        }
    }
}

/// Flags that exclude one another.
fn excludes(flag: &str) -> &'static [&'static str] {
    match flag {
        "resolution" => &["voxel"],
        "simplify" => &["no_fit"],
        _ => &[],
    }
}

/// Parses the arguments of the program, and fills in what a preset sets.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let matches = Cli::command().try_get_matches_from(arguments)?;
    let mut cli = Cli::from_arg_matches(&matches)?;
    if let (Some(args), Some((_, given))) = (solid(&mut cli.verb), matches.subcommand()) {
        fill(args, given);
    }
    Ok(cli)
}

/// The flags that presets are about, of the verbs that have them.
fn solid(verb: &mut Verb) -> Option<&mut SolidArgs> {
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

fn fill(args: &mut SolidArgs, given: &ArgMatches) {
    let Some(preset) = args.preset else { return };
    let by_hand = |flag: &str| given.value_source(flag) == Some(ValueSource::CommandLine);
    for &(flag, value) in preset.settings() {
        if by_hand(flag) || excludes(flag).iter().any(|other| by_hand(other)) {
            continue;
        }
        match flag {
            "unit" => args.reading.unit = value.parse::<Unit>().ok(),
            "resolution" => args.resolution = value.parse().unwrap_or(args.resolution),
            _ => args.simplify = value.parse::<Simplify>().ok(),
        }
        args.set_by_preset.push(format!("--{flag} {value}"));
    }
}

/// What a preset has set, in words; `None` without one.
pub fn words(args: &SolidArgs) -> Option<String> {
    let name = args.preset?.name();
    Some(match args.set_by_preset.is_empty() {
        true => format!("{name}: sets nothing, all of it was given by hand"),
        false => format!("{name}: {}", args.set_by_preset.join(" ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
                    "resolution" => Some(args.resolution.to_string()),
                    "simplify" => args.simplify.map(|simplify| simplify.to_string()),
                    other => panic!("nothing sets --{other}"),
                };
                assert_eq!(set.as_deref(), Some(*value), "--{flag}");
                assert!(words(&args).expect("a preset").contains(&format!("--{flag} {value}")));
            }
        }
    }

    #[test]
    fn what_is_given_by_hand_wins_also_where_it_is_the_default() {
        let args = parsed("meshwright repair a.stl -o b.stl --preset print --resolution 256 --unit in");
        assert_eq!((args.resolution, args.reading.unit), (256, Some(Unit::Inch)));
        assert_eq!(args.set_by_preset, ["--simplify 0.02h"]);
        let args = parsed("meshwright repair a.stl -o b.stl --preset cad --voxel 1 --no-fit");
        assert_eq!((args.resolution, args.simplify), (256, None));
        assert_eq!(args.set_by_preset, ["--unit mm"]);
        assert_eq!(words(&parsed("meshwright repair a.stl -o b.stl")), None);
    }
}
