//! Walls and gaps near or below the voxel size.

use serde::{Deserialize, Serialize};

/// Evidence of walls and gaps that the voxel size may not hold.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThinReport {
    /// Spans (ray pieces inside the solid) along the three face directions.
    pub spans: usize,
    /// Of these, spans shorter than 2 h: walls too thin for the voxel size.
    pub thin_spans: usize,
    /// Spans that hold no voxel: a ray alone would lose them.
    pub lost_spans: usize,
    /// Gaps between spans shorter than 2 h.
    pub thin_gaps: usize,
    /// The 1st percentile of the span lengths, model units.
    pub thinnest: Option<f64>,
    /// A voxel size, model units, that would hold 99 % of the spans; `None` when all are held, and when no possible
    /// voxel is small enough.
    pub voxel_that_keeps: Option<f64>,
    /// Where walls and gaps are thinner than 2 h, the largest such places first.
    pub regions: Vec<ThinRegion>,
}

/// A place where walls or gaps are thinner than the lattice holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThinRegion {
    /// Whether it is a gap; else a wall.
    pub gap: bool,
    /// The smallest coordinates of the rays' pieces there, model units.
    pub min: [f64; 3],
    /// The largest.
    pub max: [f64; 3],
    /// How many pieces of rays there are.
    pub rays: usize,
    /// The shortest of them, model units.
    pub thinnest: f64,
}
