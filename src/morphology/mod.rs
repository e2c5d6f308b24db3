//! Morphology of solids: dilate, erode, close and open, on exact distance fields (Bærentzen §5.2).
//!
//! An offset is a level of the exact signed distance to a valid solid, contoured like any other field: on each lattice
//! edge the level is found exactly, and there the tangent plane is known exactly, too, so that the fit has facets to
//! put creases between ([`offset`]). Closing dilates and erodes that again, opening erodes and dilates ([`closed`]).
//! What a closing does not change stays as it was: where the second field agrees with the first solid's own distance, the
//! surface goes back to it, and triangles all of which a ball of the radius reaches from outside are kept by the fit.
//! [`canals`] lists what a closing would fill, and lets it fill only some of that.

mod balls;
mod canals;
mod closed;
mod gauge;
mod offset;
mod region;
mod remains;
mod thin;

pub use balls::{Balls, Centres, places};
pub use canals::{Canal, CanalKind, Canals, canals};
pub use closed::{Closed, Reached, closed, reached};
pub use gauge::Gauge;
pub use offset::{Offset, offset};
pub use region::Region;
pub use remains::Remain;
pub use thin::middles;

use glam::IVec3;

use crate::progress::Stopped;
use crate::sdf::exact::ExactError;

/// What is done to a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Operation {
    /// All points within the radius of the solid.
    Dilate,
    /// All points of the solid farther than the radius from its outside.
    Erode,
    /// Dilate, then erode: what a ball outside cannot reach is filled.
    Close,
    /// Erode, then dilate: what a ball inside cannot reach is taken away.
    Open,
}

impl Operation {
    /// The number of offsets that the operation takes.
    pub fn offsets(self) -> u32 {
        match self {
            Self::Dilate | Self::Erode => 1,
            Self::Close | Self::Open => 2,
        }
    }
}

/// Why there is no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OffsetError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The distance could not be found.
    #[error(transparent)]
    Distance(ExactError),
}

impl From<ExactError> for OffsetError {
    fn from(error: ExactError) -> Self {
        match error {
            ExactError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Distance(other),
        }
    }
}

/// The 26 voxels around one.
fn around(voxel: IVec3) -> impl Iterator<Item = IVec3> {
    (0..27).filter(|&n| n != 13).map(move |n| voxel + IVec3::new(n % 3, n / 3 % 3, n / 9) - 1)
}

/// From the lowest corner of a cell to all eight.
fn corners() -> impl Iterator<Item = IVec3> {
    (0..8).map(|n| IVec3::new(n & 1, n >> 1 & 1, n >> 2))
}
