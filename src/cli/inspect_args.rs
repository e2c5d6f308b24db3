//! The arguments of `inspect`.

use std::path::PathBuf;

use clap::Args;

use super::choices::{Defect, FillChoice};
use super::shared_args::{CommonArgs, InputArgs, VoxelArgs};

/// The help of --resolution, where no voxel is made.
const OF_REPAIR: &str =
    "Voxels along the longest side of the bounding box, of --thickness and of the repair that is foretold";

/// `inspect IN`.
#[derive(Debug, Args)]
#[command(mut_arg("resolution", |flag| flag.help(OF_REPAIR)))]
pub struct InspectArgs {
    /// The mesh, or the grid (VTI, NRRD, NPY, VDB), to look at
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Surface that faces down and is steeper than this against the vertical hangs over, degrees; z is up
    #[arg(long, value_name = "DEG", default_value_t = 45.0, value_parser = overhang_angle)]
    pub overhang: f64,
    /// Also measure the thickness of walls and gaps along the rays of a lattice
    #[arg(long)]
    pub thickness: bool,
    /// Also list the holes, with what `repair` would do over each
    #[arg(long)]
    pub holes: bool,
    /// How the holes would be closed
    #[arg(long, value_enum, default_value_t = FillChoice::Auto, requires = "holes")]
    pub fill: FillChoice,
    /// The size of the voxels of --thickness, and of the repair that is foretold.
    #[command(flatten)]
    pub voxels: VoxelArgs,
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

/// Degrees between level and upright.
fn overhang_angle(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('°').parse::<f64>() {
        Ok(degrees) if (0.0..90.0).contains(&degrees) => Ok(degrees),
        _ => Err("an angle from 0 to less than 90 degrees is needed".into()),
    }
}
