//! Why there is no field.

use super::DistanceMethod;
use crate::mesh::IndexError;
use crate::pipeline::{LatticeError, LimitError, NothingEnclosed};
use crate::progress::Stopped;
use crate::sdf::LevelsError;
use crate::sdf::exact::ExactError;
use crate::survey::SoupError;

/// Why there is no field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DistanceError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There is no triangle with an area.
    #[error("there is no triangle with an area")]
    Empty,
    /// A triangle refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The method needs a closed, oriented surface, and this is none.
    #[error("a field by {} needs a closed, oriented surface. {problem}", method.word())]
    NotClosed {
        /// The method.
        method: DistanceMethod,
        /// What is wrong with the surface, as a sentence.
        problem: String,
    },
    /// The planes are not there, or the method makes no planes alone.
    #[error(
        "planes {from} to {to} cannot be made alone: they must lie in the lattice, which has {there}, the first must be a multiple of 8, and the method \
         exact, on the main processor"
    )]
    Planes {
        /// The first plane.
        from: u32,
        /// The one after the last.
        to: u32,
        /// Planes of the lattice.
        there: u32,
    },
    /// The voxel size, or the band, cannot be used with these coordinates.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// More memory would be needed than allowed.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The distance could not be found over this lattice.
    #[error(transparent)]
    Exact(ExactError),
    /// There is no memory for the slice contours.
    #[error(transparent)]
    Levels(LevelsError),
    /// The votes find no inside.
    #[error(transparent)]
    Nothing(#[from] NothingEnclosed),
    /// The graphics processor was asked for and cannot do it.
    #[error("{reason}")]
    Device {
        /// One sentence: why.
        reason: String,
        /// What to try.
        hint: String,
    },
}

impl From<ExactError> for DistanceError {
    fn from(error: ExactError) -> Self {
        match error {
            ExactError::Stopped(stopped) => Self::Stopped(stopped),
            ExactError::Empty => Self::Empty,
            other => Self::Exact(other),
        }
    }
}

impl From<LevelsError> for DistanceError {
    fn from(error: LevelsError) -> Self {
        match error {
            LevelsError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Levels(other),
        }
    }
}

impl From<SoupError> for DistanceError {
    fn from(error: SoupError) -> Self {
        match error {
            SoupError::Stopped(stopped) => Self::Stopped(stopped),
            SoupError::Empty { .. } => Self::Empty,
        }
    }
}
