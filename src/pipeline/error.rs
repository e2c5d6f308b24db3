//! The errors of booleans and of operations on solids, and of the limits that both have.

use super::{LatticeError, NothingEnclosed};
use crate::backend::BackendError;
use crate::digits;
use crate::ldi::MAX_TRIANGLES;
use crate::mesh::{IndexError, NotSolid, SolidError, TriMesh};
use crate::morphology::OffsetError;
use crate::progress::Stopped;
use crate::sdf::exact::ExactError;
use crate::survey::SoupError;

/// Why a run would be beyond what there is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// There are more triangles or vertices than can be numbered.
    #[error(
        "{triangles} triangles over {vertices} vertices are more than the {MAX_TRIANGLES} triangles that are possible: \
         repair the parts one by one"
    )]
    Triangles {
        /// Triangles of all operands.
        triangles: usize,
        /// Their vertices.
        vertices: usize,
    },
    /// The rays would cross the surface more often than can be numbered.
    #[error(
        "the surface would be crossed {crossings:.1e} times, more than can be numbered: \
         use a larger voxel, or look for faces that lie on one another in thousands"
    )]
    Crossings {
        /// How often, about.
        crossings: f64,
    },
    /// More memory would be needed than allowed.
    #[error("about {} MB would be needed and {} MB are allowed{}", needed / 1_000_000, allowed / 1_000_000, fits(voxel_that_fits))]
    Memory {
        /// Estimated peak, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
        /// A voxel size that fits, model units; `None` when no size does.
        voxel_that_fits: Option<f64>,
    },
}

fn fits(voxel: &Option<f64>) -> String {
    voxel.as_ref().map_or_else(
        || "; no voxel size would fit".into(),
        |h| format!("; a voxel of {} would fit", digits::rounded_up(*h)),
    )
}

/// Why a boolean, or a repair, gave no solid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BooleanError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// An operand has no triangles with area.
    #[error("operand {operand} has no triangle with an area")]
    Empty {
        /// Number of the operand, from 0.
        operand: usize,
    },
    /// A triangle of an operand refers to a vertex that is not there.
    #[error("operand {operand}: {error}")]
    Index {
        /// Number of the operand, from 0.
        operand: usize,
        /// Which triangle and which vertex.
        error: IndexError,
    },
    /// A corner of a triangle is NaN or infinite.
    #[error(
        "operand {operand}: triangle {triangle} has a corner whose coordinates are no numbers; leave such triangles out, as the readers of files do"
    )]
    NotFinite {
        /// Number of the operand, from 0.
        operand: usize,
        /// Number of the first such triangle.
        triangle: usize,
    },
    /// The expression names an operand that was not given.
    #[error("the expression names operand {operand}, but only {given} were given")]
    MissingOperand {
        /// Number of the operand, from 0.
        operand: usize,
        /// Operands given.
        given: usize,
    },
    /// The voxel size cannot be used with these coordinates.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// More memory or larger numbers would be needed than there are.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The result encloses nothing.
    #[error(transparent)]
    Nothing(#[from] NothingEnclosed),
    /// An exact result was asked for, and there is none.
    #[error("there is no exact result: {0}")]
    NotExact(crate::arrange::ArrangeError),
    /// The graphics processor was asked for and cannot do it.
    #[error("{reason}")]
    Device {
        /// One sentence: why.
        reason: String,
        /// What to try.
        hint: String,
    },
    /// What was made is not a valid solid. The fit sees to it that it is; without one, it may not be.
    #[error(transparent)]
    NotSolid(Box<NotSolid>),
}

impl BooleanError {
    /// Refuses an operand whose triangles have corners that are not there, or are no numbers.
    pub(super) fn check(operand: usize, mesh: &TriMesh) -> Result<(), Self> {
        mesh.check().map_err(|error| Self::Index { operand, error })?;
        match mesh.first_not_finite() {
            Some(triangle) => Err(Self::NotFinite { operand, triangle }),
            None => Ok(()),
        }
    }
}

impl From<SoupError> for BooleanError {
    fn from(error: SoupError) -> Self {
        match error {
            SoupError::Stopped(stopped) => Self::Stopped(stopped),
            SoupError::Empty { operand } => Self::Empty { operand },
        }
    }
}

impl From<BackendError> for BooleanError {
    fn from(error: BackendError) -> Self {
        match error {
            BackendError::Stopped(stopped) => Self::Stopped(stopped),
            BackendError::Device { reason, hint } => Self::Device { reason, hint },
        }
    }
}

impl From<SolidError> for BooleanError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Stopped(stopped) => Self::Stopped(stopped),
            SolidError::Index(error) => Self::Index { operand: 0, error },
            SolidError::NotSolid(what) => Self::NotSolid(what),
        }
    }
}

/// Why an operation on a solid gave none. Lengths are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MorphologyError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The radius is no positive number.
    #[error("a radius of {} cannot be used; it must be above zero", digits::number(*radius))]
    Radius {
        /// The radius that was asked for.
        radius: f64,
    },
    /// The voxel size cannot be used with these coordinates.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// More memory or larger numbers would be needed than there are.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The distance to the solid could not be found.
    #[error(transparent)]
    Distance(ExactError),
    /// Nothing of the solid is left.
    #[error("nothing is left{}", thinner_than.map_or(String::new(), |t| format!(": the solid is nowhere thicker than {}", digits::number(t))))]
    NothingLeft {
        /// The solid is nowhere thicker than this; `None` where it is not that.
        thinner_than: Option<f64>,
    },
    /// What is left is too thin for the voxels.
    #[error("what is left is thinner than a voxel of {} everywhere: a smaller voxel shows it", digits::number(*voxel))]
    AllTooThin {
        /// The smallest voxel that was tried.
        voxel: f64,
    },
    /// What was made refers to a vertex that is not there.
    #[error(transparent)]
    Index(IndexError),
    /// What was made is not a valid solid. The fit sees to it that it is; without one, it may not be.
    #[error(transparent)]
    NotSolid(Box<NotSolid>),
}

impl From<OffsetError> for MorphologyError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Stopped(stopped) => Self::Stopped(stopped),
            OffsetError::Distance(error) => Self::Distance(error),
        }
    }
}

impl From<SolidError> for MorphologyError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Stopped(stopped) => Self::Stopped(stopped),
            SolidError::Index(error) => Self::Index(error),
            SolidError::NotSolid(what) => Self::NotSolid(what),
        }
    }
}
