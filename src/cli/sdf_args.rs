//! The arguments of `sdf`.

use std::path::PathBuf;

use clap::Args;

use super::backend::BackendChoice;
use super::choices::{InsideChoice, MethodChoice, OrientChoice, SignChoice};
use super::length::{BandChoice, parse_size};
use super::shared_args::{CommonArgs, InputArgs, VoxelArgs};
use crate::io::GridFormat;

/// `sdf IN -o OUT`.
#[derive(Debug, Args)]
pub struct SdfArgs {
    /// The mesh; all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where to write the field: .vti, .nrrd, .npy or .vdb
    #[arg(short, long, value_name = "OUT", required_unless_present = "plan")]
    pub output: Option<PathBuf>,
    /// The size of the voxels.
    #[command(flatten)]
    pub voxels: VoxelArgs,
    /// How far from the surface distances are found, or `full` for everywhere; the lattice reaches as far
    #[arg(long, value_name = "LEN|full", default_value = "4h")]
    pub band: BandChoice,
    /// Only these planes of z of the lattice, from the first (a multiple of 8) on and before the second: the values are those of the whole
    #[arg(long, value_name = "FROM,TO", value_parser = parse_planes)]
    pub planes: Option<[u32; 2]>,
    /// How the distance is found
    #[arg(long, value_enum, default_value_t = MethodChoice::Exact)]
    pub method: MethodChoice,
    /// Which processor measures: `auto` is the main one; `gpu` a graphics adapter, for --method exact, the same but for rounding
    #[arg(long, value_enum, default_value_t = BackendChoice::Auto)]
    pub backend: BackendChoice,
    /// What tells inside from outside [default: pseudonormal for a valid solid, else votes]
    #[arg(long, value_enum)]
    pub sign: Option<SignChoice>,
    /// Which side of the triangles is outside, unless the sign is by pseudonormals: find out, or trust the file
    #[arg(long, value_enum, default_value_t = OrientChoice::Auto)]
    pub orient: OrientChoice,
    /// Which part of space is inside where closed surfaces lie in each other or overlap, unless the sign is by pseudonormals
    #[arg(long, value_enum, default_value_t = InsideChoice::Positive)]
    pub inside: InsideChoice,
    /// Format of the output, when its name should not decide
    #[arg(long, value_name = "FORMAT")]
    pub out_format: Option<GridFormat>,
    /// Refuse to start when more memory would be needed (500M, 2G) [default: what is free]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
    /// Say what the run would cost, and do nothing
    #[arg(long)]
    pub plan: bool,
    /// Write over an input file
    #[arg(long)]
    pub force: bool,
    /// How the input is read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Two whole numbers, the smaller one first.
fn parse_planes(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    numbers.filter(|[a, b]: &[u32; 2]| a < b).ok_or_else(|| "two numbers of planes such as 0,64 are needed".into())
}
