//! What a pipeline found and did, as data.

use serde::Serialize;

use super::{BackendReport, CanalReport, MorphologyReport, ThickenReport};

use crate::fit::FitReport;
use crate::orient::OrientReport;
use crate::vote::VoteReport;

/// The account of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z.
    pub dims: [i32; 3],
    /// Cleaning and orientation of each operand.
    pub orient: Vec<OrientReport>,
    /// The rays.
    pub ldi: LdiReport,
    /// The votes.
    pub vote: VoteReport,
    /// Walls and gaps near or below the voxel size.
    pub thin: ThinReport,
    /// Sharp edges and simplification; `None` without a fit.
    pub fit: Option<FitReport>,
    /// Dilation, erosion, closing or opening; `None` without.
    pub morphology: Option<MorphologyReport>,
    /// Walls that were too thin; `None` where none were looked for.
    pub thicken: Option<ThickenReport>,
    /// Canals that were listed; `None` where none were looked for.
    pub canals: Option<CanalReport>,
    /// Triangles of the result that close holes, or that morphology has made.
    pub closed_triangles: usize,
    /// Wall-clock time of each stage, in order.
    pub stages: Vec<StageTime>,
    /// Sentences a user should read, most important first.
    pub warnings: Vec<String>,
}

impl Report {
    /// Whether the surface is the operands' own, untouched by voxels.
    pub fn kept_all(&self) -> bool {
        self.fit.as_ref().is_some_and(|fit| fit.of > 0 && fit.kept == fit.of)
    }
}

/// Rays and crossings of all 13 directions.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct LdiReport {
    /// Rays that hit something.
    pub rays: usize,
    /// Of these, the ones that abstain because an operand's crossings do not balance.
    pub silent_rays: usize,
    /// Crossings.
    pub hits: usize,
    /// The most crossings on one ray.
    pub layers: usize,
    /// The processor that found them.
    pub made_by: BackendReport,
}

/// Evidence of walls and gaps that the voxel size may not hold.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
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
    /// A voxel size, model units, that would hold 99 % of the spans; `None` when all are held.
    pub voxel_that_keeps: Option<f64>,
}

/// Seconds a stage took.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageTime {
    /// Name of the stage.
    pub stage: &'static str,
    /// Wall-clock seconds.
    pub seconds: f64,
}
