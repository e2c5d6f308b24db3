//! The arguments of `field`.

use std::path::PathBuf;

use clap::Args;

use super::choices::{InsideChoice, OrientChoice};
use super::length::{BandChoice, Simplify, parse_size};
use super::shared_args::VoxelArgs;
use super::shared_args::{CommonArgs, EXIT_CODES, InputArgs, OutputArgs};
use super::volume::Volume;
use crate::field::language;

/// `field EXPR NAME=FILE... -o OUT`.
#[derive(Debug, Args)]
pub struct FieldArgs {
    /// The expression over the names
    #[arg(value_name = "EXPR", allow_hyphen_values = true)]
    pub expression: String,
    /// A mesh, or a lattice of values (.vti .nrrd .npy .vdb), and the name it goes by in the expression
    #[arg(value_name = "NAME=FILE")]
    pub operands: Vec<String>,
    /// Where to write the result: a mesh, or with .vti .nrrd .npy .vdb the values over a lattice
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The size of the voxels.
    #[command(flatten)]
    pub voxels: VoxelArgs,
    /// How far from zero a lattice has the values, or `full` for all of them [default: 4h, and full for what is no shape]
    #[arg(long, value_name = "LEN|full")]
    pub band: Option<BandChoice>,
    /// Write this many results, in which `t` goes from 0 to 1; their numbers are put into the name
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub frames: Option<u32>,
    /// Colour the vertices by the value of this expression over the same names
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true)]
    pub paint: Option<String>,
    /// Values of --paint from which on the first and the last colour stand [default: the least and the greatest there are]
    #[arg(long, value_name = "LOW,HIGH", value_parser = parse_span, allow_hyphen_values = true, requires = "paint")]
    pub paint_range: Option<(f64, f64)>,
    /// Keep the vertices of every voxel apart: more triangles
    #[arg(long)]
    pub no_collapse: bool,
    /// Leave edges and corners as the voxels have them, and all triangles
    #[arg(long)]
    pub no_fit: bool,
    /// How far flat parts may move while triangles are saved, or `off` to keep all [default: 0.002h]
    #[arg(long, value_name = "LEN|off", conflicts_with = "no_fit")]
    pub simplify: Option<Simplify>,
    /// Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3)
    #[arg(long, value_name = "VOLUME")]
    pub drop_smaller: Option<Volume>,
    /// Which side of the triangles of broken meshes is outside: find out, or trust the file
    #[arg(long, value_enum, default_value_t = OrientChoice::Auto)]
    pub orient: OrientChoice,
    /// Which part of space is inside where closed surfaces of a broken mesh lie in each other or overlap
    #[arg(long, value_enum, default_value_t = InsideChoice::Positive)]
    pub inside: InsideChoice,
    /// Refuse when more memory would be needed (500M, 2G) [default: what is free]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
    /// How the inputs are read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// How a mesh is written.
    #[command(flatten)]
    pub writing: OutputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Two different numbers, in any order.
fn parse_span(text: &str) -> Result<(f64, f64), String> {
    let numbers = text.split_once(',').and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    let usable = |(a, b): &(f64, f64)| a.is_finite() && b.is_finite() && a != b;
    numbers.filter(usable).ok_or_else(|| "two different numbers such as 0,1 are needed".into())
}

/// The functions of the language, and how the program ends.
pub(super) fn field_help() -> String {
    format!("{FIELD_HELP}\nFunctions (docs/field.md has more on each):\n{}\n{EXIT_CODES}", language::help())
}

const FIELD_HELP: &str = "\
Operators: -a (outside of a), a - b, a & b, a ^ b, a | b, from the one that binds tightest.
";
