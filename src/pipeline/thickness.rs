//! How thick the walls of a mesh are, and how wide the gaps between them.

use serde::{Deserialize, Serialize};

use super::frame::Frame;
use super::sizing::{self, MAX_RESOLUTION, TYPED};
use super::{LatticeError, LimitError, Options, plan};
use crate::ldi::{Expression, THIN};
use crate::mesh::{IndexError, TriMesh};
use crate::progress::{Progress, Stage, Stopped};
use crate::survey::{Cast, Soup, SoupError, Survey};

/// The widths of walls and gaps, and the voxel that holds them. Model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThicknessReport {
    /// Voxel spacing of the rays.
    pub voxel: f64,
    /// Walls: pieces of rays inside the solid whose ends both look along the ray.
    pub walls: LengthsReport,
    /// Gaps between two walls.
    pub gaps: LengthsReport,
    /// Share of the rays that abstain because they meet an open surface.
    pub silent: f64,
    /// A voxel of which 99 % of the walls and of the gaps are two or more thick; `None` without any, and when no
    /// possible voxel is small enough.
    pub voxel_that_keeps: Option<f64>,
    /// The voxels along the longest side that this makes.
    pub resolution_that_keeps: Option<u32>,
    /// The smallest voxel that is possible.
    pub finest: f64,
}

/// How some lengths are distributed, model units.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LengthsReport {
    /// How many there are.
    pub count: usize,
    /// The smallest.
    pub least: f64,
    /// 1, 5, 25, 50, 75 and 95 % are not longer than these.
    pub percentiles: [f64; 6],
    /// The longest.
    pub most: f64,
    /// Share that is under two voxels of the rays.
    pub thin: f64,
}

/// The percentiles of a [`LengthsReport`].
pub const PERCENTILES: [usize; 6] = [1, 5, 25, 50, 75, 95];

/// Why walls and gaps could not be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ThicknessError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There is no triangle with an area.
    #[error("there is no triangle with an area")]
    Empty,
    /// A triangle refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The voxel size cannot be used with these coordinates.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// More memory or larger numbers would be needed than there are.
    #[error(transparent)]
    Limit(#[from] LimitError),
}

/// Measures the walls and gaps of `input` along the rays of all 13 directions.
///
/// # Errors
/// See [`ThicknessError`].
pub fn thickness(input: &TriMesh, options: &Options, progress: &Progress) -> Result<ThicknessReport, ThicknessError> {
    input.check()?;
    let frame = Frame::of(&[input], &options.surface());
    let mesh = frame.local(input);
    let bounds = sizing::bounds([&*mesh]).map_err(|_| ThicknessError::Empty)?;
    let lattice = sizing::lattice(&bounds, options.voxel)?;
    plan::check_limits(&[&mesh], &lattice, &options.surface(), plan::Offsets::default())?;
    progress.stage(Stage::Orient)?;
    let soup = Soup::of(&[&mesh], options.orient, progress)?.with_inside(options.inside);
    progress.stage(Stage::Ldi)?;
    let cast = Cast::on_cpu(soup, &lattice, options.orient, progress)?;
    progress.stage(Stage::Spans)?;
    let survey = Survey::of(cast, &Expression::Operand(0), progress)?;
    let found = survey.widths();
    let walls = LengthsReport::of(&found.spans, lattice.h);
    let gaps = LengthsReport::of(&found.gaps, lattice.h);
    let thinnest = [&walls, &gaps].into_iter().filter(|l| l.count > 0).map(|l| l.percentiles[0]).reduce(f64::min);
    let finest = sizing::finest(&bounds);
    let voxel_that_keeps = thinnest.map(|width| width / THIN).filter(|&voxel| voxel >= TYPED * finest);
    let along = |voxel: f64| (bounds.size().max_element() / voxel).ceil() as u32;
    let resolution_that_keeps = voxel_that_keeps.map(|voxel| along(voxel).min(MAX_RESOLUTION));
    let silent = survey.silent_share();
    Ok(ThicknessReport { voxel: lattice.h, walls, gaps, silent, voxel_that_keeps, resolution_that_keeps, finest })
}

impl From<SoupError> for ThicknessError {
    fn from(error: SoupError) -> Self {
        match error {
            SoupError::Stopped(stopped) => Self::Stopped(stopped),
            SoupError::Empty { .. } => Self::Empty,
        }
    }
}

impl LengthsReport {
    /// Of sorted lengths in h.
    fn of(sorted: &[f64], h: f64) -> Self {
        let (Some(&least), Some(&most)) = (sorted.first(), sorted.last()) else { return Self::default() };
        let at = |percent: usize| sorted[(sorted.len() * percent / 100).min(sorted.len() - 1)] * h;
        Self {
            count: sorted.len(),
            least: least * h,
            percentiles: PERCENTILES.map(at),
            most: most * h,
            thin: sorted.partition_point(|&length| length < THIN) as f64 / sorted.len() as f64,
        }
    }
}
