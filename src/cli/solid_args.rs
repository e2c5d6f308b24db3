//! The flags of all verbs that make a solid.

use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args};

use super::backend::BackendChoice;
use super::choices::{FillChoice, InsideChoice, OrientChoice, SolidMethod, VoteChoice};
use super::exit::Failure;
use super::keep::KeepArgs;
use super::length::{Simplify, parse_size};
use super::preset::Preset;
use super::shared_args::{CommonArgs, InputArgs, OutputArgs, VoxelArgs};
use super::volume::Volume;
use crate::io::Unit;

/// Flags of `repair` and the booleans.
#[derive(Debug, Args)]
pub struct SolidArgs {
    /// Where to write the result
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Options that suit printing, scans or parts; those given by hand win
    #[arg(long, value_enum)]
    pub preset: Option<Preset>,
    /// How the result is made where surfaces touch or cross
    #[arg(long, value_enum, default_value_t = SolidMethod::Auto)]
    pub method: SolidMethod,
    /// The size of the voxels.
    #[command(flatten)]
    pub voxels: VoxelArgs,
    /// Which side of the triangles is outside: find out, or trust the file
    #[arg(long, value_enum, default_value_t = OrientChoice::Auto)]
    pub orient: OrientChoice,
    /// Which part of space is inside where closed surfaces lie in each other or overlap
    #[arg(long, value_enum, default_value_t = InsideChoice::Positive)]
    pub inside: InsideChoice,
    /// How far vertices at cracks may move so that these close before anything is called a hole, or `off` [default: 0.001%]
    #[arg(long, value_name = "LEN|off")]
    pub tolerance: Option<Simplify>,
    /// How holes are closed that a lid over their rim alone closes; others are closed from voxels
    #[arg(long, value_enum, default_value_t = FillChoice::Auto)]
    pub fill: FillChoice,
    /// How rays that disagree are settled
    #[arg(long, value_enum, default_value_t = VoteChoice::Winding)]
    pub vote: VoteChoice,
    /// Which processor finds the rays' crossings; the result is the same
    #[arg(long, value_enum, default_value_t = BackendChoice::Auto)]
    pub backend: BackendChoice,
    /// Keep the vertices of every voxel apart: more triangles
    #[arg(long)]
    pub no_collapse: bool,
    /// Leave edges and corners as the voxels have them, and all triangles
    #[arg(long)]
    pub no_fit: bool,
    /// Build the whole surface anew from the voxels, also where the input is right as it is
    #[arg(long, conflicts_with = "no_fit")]
    pub rebuild: bool,
    /// How far flat parts may move while triangles are saved, or `off` to keep all [default: 0.002h]
    #[arg(long, value_name = "LEN|off", conflicts_with = "no_fit")]
    pub simplify: Option<Simplify>,
    /// Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3)
    #[arg(long, value_name = "VOLUME")]
    pub drop_smaller: Option<Volume>,
    /// Write the result to this file, coloured by what is kept, cut, rebuilt and made up
    #[arg(long, value_name = "FILE.ply")]
    pub map: Option<PathBuf>,
    /// Refuse to start when more memory would be needed (500M, 2G) [default: what is free]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
    /// Say what the run would cost, and do nothing
    #[arg(long)]
    pub plan: bool,
    /// What --preset has set, as flags.
    #[arg(skip)]
    pub set_by_preset: Vec<String>,
    /// How the inputs are read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// How the output is written.
    #[command(flatten)]
    pub writing: OutputArgs,
    /// Whether a result that is mostly lost is written.
    #[command(flatten)]
    pub keeping: KeepArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

impl SolidArgs {
    /// Whether a result that is mostly lost is written.
    pub fn keeps_partial(&self) -> bool {
        self.keeping.keep_partial || self.writing.force
    }

    /// Refuses flags that contradict each other by their values, which the parser does not see.
    pub fn check(&self) -> Result<(), Failure> {
        let wants_voxels = [(self.rebuild, "--rebuild"), (self.no_fit, "--no-fit")];
        match wants_voxels.into_iter().find(|(given, _)| *given && self.method == SolidMethod::Exact) {
            Some((_, flag)) => Err(Failure::usage(format!(
                "--method exact cannot be used with {flag}, which builds the whole surface from voxels"
            ))
            .hint("leave one of the two away")),
            None => Ok(()),
        }
    }

    /// Fills in what the preset sets and was not given by hand.
    pub fn fill_in(&mut self, given: &ArgMatches) {
        let Some(preset) = self.preset else { return };
        let by_hand = |flag: &str| given.value_source(flag) == Some(ValueSource::CommandLine);
        for &(flag, value) in preset.settings() {
            if by_hand(flag) || excludes(flag).iter().any(|other| by_hand(other)) {
                continue;
            }
            match flag {
                "unit" => self.reading.unit = value.parse::<Unit>().ok(),
                "resolution" => self.voxels.resolution = value.parse().unwrap_or(self.voxels.resolution),
                _ => self.simplify = value.parse::<Simplify>().ok(),
            }
            self.set_by_preset.push(format!("--{flag} {value}"));
        }
    }

    /// What the preset has set, in words; `None` without one.
    pub fn preset_in_words(&self) -> Option<String> {
        let name = self.preset?.name();
        Some(match self.set_by_preset.is_empty() {
            true => format!("{name}: sets nothing, all of it was given by hand"),
            false => format!("{name}: {}", self.set_by_preset.join(" ")),
        })
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
