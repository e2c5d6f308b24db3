//! The arguments of every verb.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::backend::BackendChoice;
use super::change::RemoveChoice;
use super::choices::{Defect, EdgeChoice, MethodChoice, OrientChoice, SideChoice, SignChoice, VoteChoice};
use super::decimate::DecimateArgs;
use super::devices::DevicesArgs;
use super::field_args::{FieldArgs, field_help};
use super::hollow::HollowArgs;
use super::keep::KeepArgs;
use super::length::{BandChoice, Length, Simplify, parse_radius, parse_resolution, parse_size};
use super::preset::Preset;
use super::render::{ViewChoice, parse_view};
use super::slice::SliceChoice;
use super::split::SplitArgs;
use super::transform::TransformArgs;
use super::volume::Volume;
use crate::io::GridFormat;

pub use super::shared_args::{CommonArgs, InputArgs, OutputArgs};

pub(super) const EXIT_CODES: &str = "\
Exit status:
  0    done, and verified on the written file
  1    internal error
  2    wrong usage
  3    a promise or a stated limit does not hold; a result that is mostly lost is written only with --keep-partial
  4    unreadable or empty input, one that the verb cannot take, or nothing is enclosed
  5    more memory or threads needed than can be had, or than --max-memory allows
  6    --timeout has passed
  7    a file or stream cannot be written
  130  interrupted

IN and OUT may be `-` for standard input and output.
LEN is 0.4mm, 1in, 1% (of the bounding box diagonal), 2h (voxels) or a plain number in the file's units.";

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
    #[command(after_help = EXIT_CODES, aliases = ["fix", "heal"])]
    Repair(RepairArgs),
    /// Everything inside at least one of the meshes
    #[command(after_help = EXIT_CODES, aliases = ["add", "join", "merge", "combine"])]
    Union(BooleanArgs),
    /// Everything inside all of the meshes
    #[command(after_help = EXIT_CODES, aliases = ["intersect", "common"])]
    Intersection(BooleanArgs),
    /// The first mesh without all the others
    #[command(after_help = EXIT_CODES, aliases = ["subtract", "minus"])]
    Difference(BooleanArgs),
    /// Any boolean expression, such as 'a - (b | c) & d'
    #[command(after_help = CSG_HELP)]
    Csg(CsgArgs),
    /// Grow a solid by a length on all sides
    #[command(after_help = EXIT_CODES, aliases = ["grow", "inflate"])]
    Dilate(GrowArgs),
    /// Shrink a solid by a length on all sides
    #[command(after_help = EXIT_CODES, alias = "shrink")]
    Erode(GrowArgs),
    /// Take away what a ball inside cannot reach: whiskers, fins, thin walls
    #[command(after_help = EXIT_CODES)]
    Open(MorphologyArgs),
    /// Fill what a ball outside cannot reach: cracks, canals, narrow gaps
    #[command(after_help = EXIT_CODES)]
    Close(MorphologyArgs),
    /// List canals, pits and gaps that a closing would fill, and fill those that you choose
    #[command(after_help = EXIT_CODES)]
    Canals(CanalArgs),
    /// Let walls that are too thin, and open sheets, grow to a thickness
    #[command(after_help = EXIT_CODES)]
    Thicken(ThickenArgs),
    /// Signed distance to a mesh over a lattice
    #[command(after_help = EXIT_CODES, alias = "distance")]
    Sdf(SdfArgs),
    /// Combine, filter and morph shapes through their distance fields, by an expression
    #[command(after_help = field_help())]
    Field(FieldArgs),
    /// Shell a solid out: a cavity in it, walls of one thickness, and holes to drain it
    #[command(after_help = EXIT_CODES)]
    Hollow(HollowArgs),
    /// Leave fewer triangles of a solid: a number, a share, or as far as the surface may move
    #[command(after_help = EXIT_CODES)]
    Decimate(DecimateArgs),
    /// Write every body of a file into a file of its own
    #[command(after_help = EXIT_CODES)]
    Split(SplitArgs),
    /// Say what is in a mesh file and what is wrong with it
    #[command(after_help = EXIT_CODES, aliases = ["info", "check"])]
    Inspect(InspectArgs),
    /// Measure how far two meshes are from each other
    #[command(after_help = EXIT_CODES, alias = "diff")]
    Compare(CompareArgs),
    /// Write the same triangles in another format, size or place, or a grid in another format; nothing is repaired
    #[command(after_help = EXIT_CODES)]
    Convert(ConvertArgs),
    /// Draw a mesh or a slice of a grid, or two of these for comparison, as a PNG picture
    #[command(after_help = EXIT_CODES, aliases = ["view", "draw"])]
    Render(RenderArgs),
    /// List the graphics adapters, and what --backend would take
    #[command(after_help = EXIT_CODES)]
    Devices(DevicesArgs),
    /// Print the JSON schema of the reports that --json and --report write
    #[cfg(feature = "schema")]
    #[command(after_help = EXIT_CODES)]
    Schema,
}

const CSG_HELP: &str = "\
Operators, from the one that binds tightest, grouping from the left as in Python:
  a - b   inside a and not inside b
  a & b   inside both
  a ^ b   inside exactly one
  a | b   inside at least one
Parentheses group. A name is letters, digits and _, and begins with no digit.

Example:
  meshwright csg 'a - (b | c)' a=block.stl b=hole.obj c=slot.ply -o part.3mf";

/// `repair IN -o OUT`.
#[derive(Debug, Args)]
pub struct RepairArgs {
    /// The mesh to repair; all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

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

/// `thicken IN -o OUT --min LEN`.
#[derive(Debug, Args)]
pub struct ThickenArgs {
    /// The mesh; it is repaired first, all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// The least thickness of walls, at least four voxels
    #[arg(short, long, value_name = "LEN", allow_hyphen_values = true)]
    pub min: Length,
    /// Where open sheets grow
    #[arg(long, value_enum, default_value_t = SideChoice::Both)]
    pub side: SideChoice,
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

/// `union A B... -o OUT` and its sisters.
#[derive(Debug, Args)]
pub struct BooleanArgs {
    /// The meshes, two or more; each may be broken
    #[arg(value_name = "IN", num_args = 2.., required = true)]
    pub inputs: Vec<PathBuf>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// `csg EXPR NAME=FILE... -o OUT`.
#[derive(Debug, Args)]
pub struct CsgArgs {
    /// The expression over the names
    #[arg(value_name = "EXPR")]
    pub expression: String,
    /// A mesh and the name it goes by in the expression
    #[arg(value_name = "NAME=FILE", required = true)]
    pub operands: Vec<String>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// `sdf IN -o OUT`.
#[derive(Debug, Args)]
pub struct SdfArgs {
    /// The mesh; all its shells together are one solid
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where to write the field: .vti, .nrrd, .npy or .vdb
    #[arg(short, long, value_name = "OUT", required_unless_present = "plan")]
    pub output: Option<PathBuf>,
    /// Voxels along the longest side of the bounding box
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = parse_resolution, conflicts_with = "voxel")]
    pub resolution: u32,
    /// Size of a voxel, instead of --resolution
    #[arg(long, value_name = "LEN", allow_hyphen_values = true)]
    pub voxel: Option<Length>,
    /// How far from the surface distances are found, or `full` for everywhere; the lattice reaches as far
    #[arg(long, value_name = "LEN|full", default_value = "4h")]
    pub band: BandChoice,
    /// How the distance is found
    #[arg(long, value_enum, default_value_t = MethodChoice::Exact)]
    pub method: MethodChoice,
    /// Which processor draws the slices of --method prism
    #[arg(long, value_enum, default_value_t = BackendChoice::Auto)]
    pub backend: BackendChoice,
    /// What tells inside from outside [default: pseudonormal for a valid solid, else votes]
    #[arg(long, value_enum)]
    pub sign: Option<SignChoice>,
    /// Which side of the triangles is outside, unless the sign is by pseudonormals: find out, or trust the file
    #[arg(long, value_enum, default_value_t = OrientChoice::Auto)]
    pub orient: OrientChoice,
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

/// `inspect IN`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The mesh, or the grid (VTI, NRRD, NPY, VDB), to look at
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Surface that faces down and is steeper than this against the vertical hangs over, degrees; z is up
    #[arg(long, value_name = "DEG", default_value_t = 45.0, value_parser = super::inspect::overhang_angle)]
    pub overhang: f64,
    /// Also measure the thickness of walls and gaps along the rays of a lattice
    #[arg(long)]
    pub thickness: bool,
    /// Voxels along the longest side of the bounding box, for --thickness
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = parse_resolution, conflicts_with = "voxel", requires = "thickness")]
    pub resolution: u32,
    /// Size of a voxel, instead of --resolution
    #[arg(long, value_name = "LEN", requires = "thickness", allow_hyphen_values = true)]
    pub voxel: Option<Length>,
    /// Exit with 3 when the mesh has one of these defects
    #[arg(long, value_name = "DEFECT", value_delimiter = ',', value_enum)]
    pub fail_on: Vec<Defect>,
    /// How the input is read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// `compare A B`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The reference
    #[arg(value_name = "A")]
    pub a: PathBuf,
    /// The mesh that is judged
    #[arg(value_name = "B")]
    pub b: PathBuf,
    /// Write B, coloured by its signed distance from A, to this file
    #[arg(long, value_name = "FILE.ply")]
    pub map: Option<PathBuf>,
    /// Points on each mesh at which distances are taken, besides all vertices
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub samples: u32,
    /// How near a sharp edge of the other mesh must be to count as found [default: 1/1024 of A's longest side]
    #[arg(long, value_name = "LEN")]
    pub tolerance: Option<Length>,
    /// Exit with 3 when a point of one mesh is farther than this from the other
    #[arg(long, value_name = "LEN")]
    pub fail_on_max: Option<Length>,
    /// How the inputs are read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// `convert IN -o OUT`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The mesh, or the grid (VTI, NRRD, NPY, VDB), to write again
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where to write it
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Another size and place.
    #[command(flatten)]
    pub transform: TransformArgs,
    /// How the input is read.
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

/// `render IN [AFTER] -o PNG`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The mesh to draw, or the grid (VTI, NRRD, NPY, VDB) of which to draw a slice
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// A second mesh or grid, drawn beside the first: meshes from the same point of view, slices of the same plane
    #[arg(value_name = "AFTER")]
    pub after: Option<PathBuf>,
    /// Where to write the PNG
    #[arg(short, long, value_name = "PNG")]
    pub output: PathBuf,
    /// Width of the picture (of each, for two), pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1200, value_parser = clap::value_parser!(u32).range(16..=16384))]
    pub width: u32,
    /// Height, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 900, value_parser = clap::value_parser!(u32).range(16..=16384))]
    pub height: u32,
    /// From where: iso, front, back, left, right, top, bottom, or the direction to the viewer as X,Y,Z
    #[arg(long, value_name = "VIEW", default_value = "iso", value_parser = parse_view, allow_hyphen_values = true)]
    pub view: ViewChoice,
    /// The y axis points up, not z
    #[arg(long)]
    pub y_up: bool,
    /// Draw a slice: z (through the middle), x=50%, y=1.5 or z=2mm; of meshes, where no grid is given, through their
    /// signed distance [default: z, for grids]
    #[arg(long, value_name = "AXIS[=AT]", allow_hyphen_values = true)]
    pub slice: Option<SliceChoice>,
    /// Which edges of triangles are drawn
    #[arg(long, value_enum, default_value_t = EdgeChoice::Sharp)]
    pub edges: EdgeChoice,
    /// Do not colour defects
    #[arg(long)]
    pub no_defects: bool,
    /// Refuse grids that would take more memory (500M, 2G)
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
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

/// Flags of `repair` and the booleans.
#[derive(Debug, Args)]
pub struct SolidArgs {
    /// Where to write the result
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Options that suit printing, scans or parts; those given by hand win
    #[arg(long, value_enum)]
    pub preset: Option<Preset>,
    /// Voxels along the longest side of the bounding box
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = parse_resolution, conflicts_with = "voxel")]
    pub resolution: u32,
    /// Size of a voxel, instead of --resolution
    #[arg(long, value_name = "LEN", allow_hyphen_values = true)]
    pub voxel: Option<Length>,
    /// Which side of the triangles is outside: find out, or trust the file
    #[arg(long, value_enum, default_value_t = OrientChoice::Auto)]
    pub orient: OrientChoice,
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
    /// Write the result to this file, coloured by what is kept, rebuilt and made up
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_is_well_formed() {
        Cli::command().debug_assert();
    }
}
