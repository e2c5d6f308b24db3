//! From spans to solid voxels: the 13 directions vote (Bærentzen §3.2), brick by brick, near the
//! surface only.

mod block;
mod boundary;
mod dipoles;
mod doubt;
mod expansion;
mod grow;
mod lid;
mod loop_tree;
mod phase;
mod rim;
mod tally;
mod winding;

pub use dipoles::WindingTree;
pub use doubt::doubts;
pub use grow::vote_near_surface;
pub use lid::Lid;
pub use tally::{Jury, Votes};
pub use winding::Winding;

use serde::{Deserialize, Serialize};

/// How the votes of the directions make a voxel inside or outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum VoteRule {
    /// Ten valid votes or more that all agree; else the generalised winding number of the
    /// soup: inside above ½.
    #[default]
    Winding,
    /// More than half of the valid votes; below five valid votes the half-rays decide.
    HalfRays,
    /// More than half of the valid votes.
    Majority,
    /// Bærentzen's rule: more than half of all 13; an abstaining direction counts as outside.
    Paper,
}

/// How sure the voxels near the surface are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VoteReport {
    /// Voxels that were voted on (those of the active bricks).
    pub voxels: usize,
    /// Voxels with fewer than five valid votes, or whose minority holds over a quarter of them.
    pub doubtful: usize,
    /// Boxes around the largest groups of doubtful voxels, model units, largest group first.
    pub doubtful_regions: Vec<DoubtfulRegion>,
}

/// A connected group of doubtful voxels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DoubtfulRegion {
    /// Smallest corner, model units.
    pub min: [f64; 3],
    /// Largest corner, model units.
    pub max: [f64; 3],
    /// Number of doubtful voxels.
    pub voxels: usize,
}
