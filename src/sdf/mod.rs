//! Signed distance near the surface, counted in voxels, negative inside.
//!
//! The *robust* field (Bærentzen §3.3–3.4): the voted volume, estimates from the LDI points,
//! smoothing, gradient correction, and fast marching to a wanted band. The *exact* field: the distance to the
//! nearest triangle, at any point or over a lattice; over a lattice also by scan conversion, one polyhedron per feature. [`Levels`] tell
//! inside from outside alone, by the slice contours of each plane of voxels.

pub mod characteristics;
mod correct;
mod estimate;
pub mod exact;
mod levels;
mod march;
mod neighbours;
pub mod prism;
mod smooth;

pub use correct::correct;
pub use estimate::estimate;
pub use levels::{Levels, LevelsError, levels_memory};
pub use march::march;
pub use smooth::{FAR, smooth};

use crate::lattice::{DistanceField, Grid, Lattice};
use crate::ldi::Spans;
use crate::mesh::Plane;
use crate::progress::{Progress, Stopped};
use crate::vote::Votes;

/// The robust field in the active bricks of `votes`, counted in voxels of `lattice`: right near the surface, ±√3 elsewhere.
/// `planes` are those of the soup's triangles, in lattice coordinates.
pub fn robust(
    spans: &[Spans],
    planes: &[Plane],
    (votes, lattice): (&Grid<Votes>, &Lattice),
    options: &RobustOptions,
    progress: &Progress,
) -> Result<DistanceField, Stopped> {
    let estimates = estimate(spans, planes, &votes.bricks, progress)?;
    let grid = correct(smooth(votes, &estimates, options, progress)?, &estimates, options, progress)?;
    Ok(DistanceField::in_voxels(*lattice, grid))
}

/// Which voxels keep the side of their vote while the field is smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trust {
    /// All voxels: right for votes that end in the winding number, whose level ½ is a smooth lid over a hole.
    All,
    /// Voxels whose vote is not doubtful and that have points beside them; smoothing rounds the others.
    Sure,
    /// No voxel, as in the paper: walls of one voxel wear away.
    Nothing,
}

/// Options of the robust field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobustOptions {
    /// Rounds of smoothing; the paper's 15.
    pub smoothing_rounds: u32,
    /// Rounds of gradient correction; the paper's 10.
    pub correction_rounds: u32,
    /// Damping of the correction, 0 to 1; the paper's 0.5.
    pub damping: f32,
    /// Which voxels keep the side that the vote gave them.
    pub trust: Trust,
    /// Whether the correction also changes voxels that hold their estimate, as in the paper.
    pub correct_estimates: bool,
}

impl Default for RobustOptions {
    fn default() -> Self {
        Self { smoothing_rounds: 15, correction_rounds: 10, damping: 0.5, trust: Trust::All, correct_estimates: false }
    }
}
