//! What a pipeline found and did, as data. The functions that fill it are beside the pipelines, in `account.rs`.

mod holes;
mod join;
mod nothing;
mod operations;
mod sheets;
mod thin;
mod topology;
mod triangles;
mod warning;

pub use holes::{HoleClosing, HoleReport, LidShape, NotLidded};
pub use nothing::NothingEnclosed;
pub use operations::{CanalReport, DrainReport, HollowReport, MorphologyReport, ThickenReport};
pub use sheets::{BlockReport, OuterReport};
pub use thin::{ThinRegion, ThinReport};
pub use topology::{LostBody, Topology, TopologyReport};
pub use triangles::{Dropped, StandingReport, TriangleCounts, TriangleKind};
pub use warning::Warning;

use serde::{Deserialize, Serialize};

use crate::arrange::ArrangeReport;
use crate::backend::BackendReport;
use crate::fit::FitReport;
use crate::ldi::Inside;
use crate::orient::OrientReport;
use crate::progress::Stage;
use crate::vote::VoteReport;
use crate::zip::ZipReport;

/// The account of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Report {
    /// Which winding numbers of an operand were inside.
    pub inside: Inside,
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z; zero without a lattice.
    pub dims: [i32; 3],
    /// Whether there was a lattice: not where all of the result stands as it is.
    pub lattice: bool,
    /// What stayed as it is, without rays and voxels.
    pub standing: StandingReport,
    /// What was cut exactly; `None` where nothing was.
    pub exact: Option<ArrangeReport>,
    /// Triangles of operands with holes that were cut where they cross each other, before rays were cast.
    pub cut: usize,
    /// What was done to close cracks of operands with open edges before anything was called a hole; `None` where none could be closed.
    pub zip: Option<ZipReport>,
    /// The holes of each operand, the longest first, and what closes them; none are listed where all surface is made from voxels as is asked for.
    pub holes: Vec<HoleReport>,
    /// Bodies, voids and tunnels before and after; `None` where an operation changes them.
    pub topology: Option<TopologyReport>,
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
    /// The cavity and its drains; `None` where none was to be made.
    pub hollow: Option<HollowReport>,
    /// Walls that were too thin; `None` where none were looked for.
    pub thicken: Option<ThickenReport>,
    /// The block under a sheet; `None` where none was to be made.
    pub block: Option<BlockReport>,
    /// What a ball saw from outside; `None` where none was rolled around the surface.
    pub outer: Option<OuterReport>,
    /// Canals that were listed; `None` where none were looked for.
    pub canals: Option<CanalReport>,
    /// Surfaces under eight voxels that no operand asked for; they are not in the result.
    pub crumbs: Dropped,
    /// Surfaces smaller than the caller wants, see [`drop_smaller`](super::drop_smaller).
    pub smaller: Dropped,
    /// Triangles of the result that close holes, or that morphology has made.
    pub closed_triangles: usize,
    /// How many triangles of the result are kept, rebuilt and made up.
    pub triangles: TriangleCounts,
    /// Wall-clock time of each stage, in order. Not written with the rest: a whole run has stages besides these, and tells all of
    /// them in one list; so it is with warnings.
    #[serde(skip)]
    pub stages: Vec<StageTime>,
    /// What a user should know, most important first.
    #[serde(skip)]
    pub warnings: Vec<Warning>,
}

impl Report {
    /// Triangles of the operands that stayed as they are, before simplification.
    pub fn kept(&self) -> usize {
        let uncut = self.exact.as_ref().map_or(0, |exact| exact.triangles - exact.cut.min(exact.triangles));
        self.standing.triangles + uncut + self.fit.as_ref().map_or(0, |fit| fit.kept)
    }

    /// Triangles of the operands that could have: all but those of shells that were left out as a whole.
    pub fn of(&self) -> usize {
        let exact = self.exact.as_ref().map_or(0, |exact| exact.triangles);
        self.standing.triangles + exact + self.fit.as_ref().map_or(0, |fit| fit.of)
    }

    /// Whether the surface is the operands' own, untouched by voxels.
    pub fn kept_all(&self) -> bool {
        self.kept() > 0 && self.kept() == self.of()
    }
}

/// Rays and crossings of all 13 directions.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// Seconds a stage took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StageTime {
    /// The stage.
    pub stage: Stage,
    /// Wall-clock seconds.
    pub seconds: f64,
}
