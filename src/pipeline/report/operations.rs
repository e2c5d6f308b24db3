//! What operations on a solid found and did.

use serde::{Deserialize, Serialize};

use crate::morphology::{Canal, Operation};

/// What was done to the solid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MorphologyReport {
    /// What was done.
    pub operation: Operation,
    /// The radius, model units.
    pub radius: f64,
    /// Volume of the solid before, cubic model units.
    pub volume_before: f64,
    /// Volume after.
    pub volume_after: f64,
    /// Triangles of the result that the operation made; the others lie on the solid's own.
    pub made: usize,
    /// The voxel of the offsets, model units: smaller than that of the solid where the radius or what is left asks for it.
    pub voxel: f64,
    /// Places where what is left is thinner than that voxel, and is not there, or not whole.
    pub too_thin: usize,
    /// One of them, model units.
    pub thin_place: Option<[f64; 3]>,
    /// Their part of the surface that there should be, 0 to 1.
    pub thin_share: f64,
    /// A voxel that would hold half of them, model units.
    pub voxel_that_holds: Option<f64>,
}

/// What was too thin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThickenReport {
    /// The least thickness, model units.
    pub least: f64,
    /// Area of the surface of the solid whose wall is thinner, square model units; both sides count.
    pub thin_area: f64,
    /// Area of the open sheets.
    pub sheet_area: f64,
    /// Volume of the solid before, cubic model units; 0 where there was none.
    pub volume_before: f64,
    /// Volume after.
    pub volume_after: f64,
}

/// What was hollowed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HollowReport {
    /// Thickness of the wall, model units.
    pub wall: f64,
    /// Volume of the solid before, cubic model units.
    pub volume_before: f64,
    /// Volume after.
    pub volume_after: f64,
    /// Cavities made.
    pub cavities: usize,
    /// Cavities of less than 64 voxels that were not made.
    pub left_out: usize,
    /// The drains.
    pub drains: Vec<DrainReport>,
}

/// A drain as it was made; model units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DrainReport {
    /// Where it begins, on the surface.
    pub at: [f64; 3],
    /// Its direction, inwards.
    pub direction: [f64; 3],
    /// Its diameter.
    pub diameter: f64,
    /// How long it is, from the surface to the cavity.
    pub depth: f64,
}

/// What was found of canals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CanalReport {
    /// The diameter that was asked for, model units.
    pub max_diameter: f64,
    /// The canals, the widest first.
    pub canals: Vec<Canal>,
    /// Shallow places that a closing would round besides: inner edges and dents.
    pub roundings: usize,
    /// Numbers of the canals that were filled.
    pub removed: Vec<u32>,
}
