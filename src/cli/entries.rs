//! What reports say of files, lattices, slices and graphics adapters.

use serde::{Deserialize, Serialize};

use crate::mesh::Validity;
use crate::pipeline::Report;

/// One input in the report.
#[derive(Debug, Clone, Serialize, Deserialize, schemars::JsonSchema)]
pub struct InputEntry {
    /// The path as given.
    pub path: String,
    /// Its name in the expression, for `csg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The format it was read as.
    pub format: String,
    /// Size of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// SHA-256 of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// The unit the file carries.
    pub unit: Option<String>,
    /// Its objects.
    pub parts: Vec<PartEntry>,
    /// Its objects that are taken away from the others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub negative_parts: Vec<PartEntry>,
    /// What the reader found odd.
    pub warnings: Vec<String>,
    /// Its state as read.
    pub validity: Option<Validity>,
}

/// An object within a file.
#[derive(Debug, Clone, Serialize, Deserialize, schemars::JsonSchema)]
pub struct PartEntry {
    /// Its name.
    pub name: String,
    /// Its triangles.
    pub triangles: usize,
}

/// The output in the report.
#[derive(Debug, Clone, Serialize, Deserialize, schemars::JsonSchema)]
pub struct OutputEntry {
    /// The path as given.
    pub path: String,
    /// The format it was written in.
    pub format: String,
    /// Size of the file; nothing of a result that stays in memory.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub bytes: u64,
    /// SHA-256 of the file.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sha256: String,
    /// The unit of its numbers, where known.
    pub unit: Option<String>,
    /// Its state, read back from the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validity: Option<Validity>,
}

fn is_nothing(bytes: &u64) -> bool {
    *bytes == 0
}

/// What `repair --each` has done to an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ObjectDone {
    /// It has a new mesh.
    Repaired,
    /// It was a solid that needed nothing, and has its mesh as it was.
    Kept,
    /// It could not be repaired, and has its mesh as it was.
    Left,
    /// `--part` did not pick it, and it has its mesh as it was.
    NotPicked,
}

/// An object of `repair --each` in the report, in its own coordinates.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct ObjectEntry {
    /// Its name.
    pub name: String,
    /// How often it is placed.
    pub places: usize,
    /// What was done to it.
    pub done: ObjectDone,
    /// Why it was left as it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// Its state as read; nothing where it was not picked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<Validity>,
    /// Its state, read back from the written file; nothing where it was left or not picked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<Validity>,
    /// What was found and done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pipeline: Option<Box<Report>>,
}

/// Something in a file that is no object to work on.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct AsideEntry {
    /// What it is.
    pub what: String,
    /// Its name.
    pub name: String,
}

/// A lattice in the report, in the unit of the run.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct GridEntry {
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Where the first voxel lies.
    pub origin: [f64; 3],
    /// From one voxel to the next.
    pub spacing: f64,
    /// Values are clamped to ± this, where the file says so.
    pub band: Option<f64>,
    /// The smallest and the largest value.
    pub range: [f64; 2],
    /// Voxels below zero, which is inside.
    pub inside: u64,
    /// Their volume.
    pub inside_volume: f64,
    /// Voxels whose values are stored one by one.
    pub stored: u64,
}

/// A slice in the report.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct SliceEntry {
    /// The input.
    pub path: String,
    /// The axis that the plane is across: `x`, `y` or `z`.
    pub axis: &'static str,
    /// Where on the axis, model units.
    pub at: f64,
    /// The smallest and the largest value seen, model units; nothing where the plane misses the grid.
    pub range: Option<[f64; 2]>,
    /// How far from zero colours are full, model units.
    pub full: f64,
    /// From one line to the next, model units.
    pub step: f64,
}

/// The adapters, and which ones would be taken.
#[derive(Debug, Default, Serialize, schemars::JsonSchema)]
pub struct DeviceReport {
    /// Whether the program was built with the feature `gpu`.
    pub built: bool,
    /// The adapters.
    #[cfg(feature = "gpu")]
    pub adapters: Vec<crate::gpu::AdapterEntry>,
    /// The adapters: a build without the feature `gpu` finds none.
    #[cfg(not(feature = "gpu"))]
    pub adapters: [(); 0],
    /// Name of the one that `--backend auto` takes for large jobs.
    pub auto: Option<String>,
    /// Name of the one that `--backend gpu` takes.
    pub gpu: Option<String>,
    /// Why, in a sentence.
    pub why: String,
}

/// Where triangles of a mesh cross each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct CrossingEntry {
    /// Straight pieces of the lines along which they do.
    pub segments: usize,
    /// The length of all of them, model units.
    pub length: f64,
}

/// Defects of one kind that hang together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct WorstEntry {
    /// Their kind: `open`, `self`, `nonmanifold`, `inconsistent`, `nonmanifold-vertex`, `duplicate` or `degenerate`.
    pub kind: String,
    /// How many there are.
    pub count: usize,
    /// The middle of the box around them, model units.
    pub at: [f64; 3],
    /// The diagonal of that box, model units.
    pub size: f64,
    /// The length of their edges together, model units; 0 of triangles and vertices.
    pub length: f64,
    /// What `repair` would do about them.
    pub repair: String,
}

/// Groups of defects of one kind that are not told one by one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct FurtherEntry {
    /// Their kind, as above.
    pub kind: String,
    /// How many groups.
    pub groups: usize,
    /// How many defects in all of them.
    pub count: usize,
}

/// Which way a repair goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WayEntry {
    /// Every surface stays as it is.
    AsItIs,
    /// Surfaces are cut exactly where they cross, and holes are closed from their rims.
    Exact,
    /// Surface is made anew from voxels where that is needed.
    Voxels,
}

/// What a repair would lose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct DetailEntry {
    /// Which way it goes.
    pub way: WayEntry,
    /// The size of its voxels, model units; nothing where none are made.
    pub voxel: Option<f64>,
    /// Shares of the walls and gaps, measured along rays, between which that lies which is under two voxels; nothing where it is not measured.
    pub thin: Option<[f64; 2]>,
    /// Whether no ray meets a wall: what there is encloses nothing.
    pub sheet: bool,
    /// A voxel of which 99 % of the walls and gaps are two thick, model units; nothing where it is not measured, or none is small enough.
    pub voxel_that_keeps: Option<f64>,
}

/// What to do next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct NextEntry {
    /// The command to type; nothing where there is nothing to do, or nothing to type it into.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// What it does, or why there is none.
    pub what: String,
}
