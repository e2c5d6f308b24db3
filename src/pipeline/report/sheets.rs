//! What was made of sheets, and of surfaces as a ball sees them.

use serde::{Deserialize, Serialize};

/// A block under a sheet. Model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BlockReport {
    /// The axis across which the base lies: `x`, `y` or `z`.
    pub axis: String,
    /// Where on that axis.
    pub base: f64,
    /// Patches with rims: the sheets, or parts of them.
    pub sheets: usize,
    /// How many of them faced the base and were turned over.
    pub turned: usize,
    /// Open edges, from which walls go to the base.
    pub edges: usize,
    /// Triangles of the walls.
    pub wall_triangles: usize,
    /// Triangles of the base.
    pub base_triangles: usize,
    /// Volume of the block, cubic model units.
    pub volume: f64,
}

/// What a ball saw from outside. Model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OuterReport {
    /// Diameter of the ball.
    pub ball: f64,
    /// The voxel of the lattice on which its ways were found.
    pub voxel: f64,
    /// Triangles that were cut first, because they cross others; what follows counts their pieces.
    pub cut: usize,
    /// Triangles that are the outer surface.
    pub outer_triangles: usize,
    /// Triangles that went: inner skins, buried faces and parts, the walls of pinholes.
    pub inner_triangles: usize,
    /// Patches of which nothing is left.
    pub inner_patches: usize,
    /// Triangles that the ball sees from both sides.
    pub sheet_triangles: usize,
    /// Their area, square model units.
    pub sheet_area: f64,
    /// How thick they were made; `None` where there are none.
    pub thickness: Option<f64>,
}
