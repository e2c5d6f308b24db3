//! What a user should know of a result, although it is one.

use std::fmt;

use serde::{Serialize, Serializer};

use super::ThinReport;
use super::nothing::{NothingEnclosed, keeping_voxel};
use crate::digits;

/// One thing that a user should know. Its words are those of `Display`, and in JSON too.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Much of the walls lies between the voxels.
    ThinWalls {
        /// Share of the walls that hold no voxel, 0 to 1.
        share: f64,
        /// How thin they are.
        thin: ThinReport,
    },
    /// Many rays cannot tell inside from outside.
    SilentRays {
        /// Their share of the rays that meet anything, 0 to 1.
        share: f64,
    },
    /// The graphics processor was to work and did not.
    Fallback {
        /// Why not.
        reason: String,
    },
    /// Rounding to the numbers that a file holds has changed the volume of an exact result.
    Rounded {
        /// The part of the volume by which it has changed.
        share: f64,
    },
    /// Beside the shells that stay as they are, the rest of the input encloses nothing.
    NothingMore(NothingEnclosed),
    /// Sheets beside a body were left out: they enclose nothing.
    SheetsLeftOut {
        /// Their triangles.
        triangles: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ThinWalls { share, thin } => write!(
                f,
                "{:.0} % of the walls that rays meet fall between the voxels and may be missing{}",
                100.0 * share,
                keeping_voxel(thin)
            ),
            Self::SilentRays { share } => write!(
                f,
                "{:.0} % of the test rays meet an open or doubled surface and cannot tell inside from outside: \
                 look whether the result is what you want (-v lists the doubtful places)",
                100.0 * share
            ),
            Self::Fallback { reason } => {
                write!(f, "the graphics processor failed, so the main one did its work: {reason}")
            }
            Self::Rounded { share } => write!(
                f,
                "the result is exact but for the numbers that files hold: rounding to them has changed the volume by {} %",
                digits::number(100.0 * share)
            ),
            Self::SheetsLeftOut { triangles } => write!(
                f,
                "{triangles} triangles are left out: sheets beside the rest, which enclose nothing (`thicken` gives sheets a thickness)"
            ),
            Self::NothingMore(why) => write!(f, "beside what stays as it is, nothing more is enclosed: {why}"),
        }
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
