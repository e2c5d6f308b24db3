//! Booleans of meshes as they really are, and repair: the boolean of one.

use super::apart::Apart;
use super::frame::Frame;
use super::order::Ordered;
use super::rebuild::Job;
use super::stages::Stages;
use super::{Draft, LatticeError, LimitError, NothingEnclosed, Operand, Options, Outcome, plan, report, sizing};
use crate::backend::BackendError;
use crate::ldi::Expression;
use crate::mesh::{IndexError, NotSolid, SolidError, TriMesh};
use crate::progress::{Progress, Stage, Stopped};
use crate::survey::{Soup, SoupError};

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

/// Repairs one mesh: all its shells together are one operand. A valid solid comes back as it is.
///
/// # Errors
/// See [`BooleanError`].
pub fn repair<'a>(
    operand: impl Into<Operand<'a>>,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, BooleanError> {
    boolean([operand], &Expression::Operand(0), options, progress)
}

/// Evaluates a boolean expression over operands, each of which may be broken. Shells that are closed and touch nothing stay as they
/// are; rays and voxels decide about the rest. The order of the operands does not matter: what says the same has the same result.
///
/// # Errors
/// See [`BooleanError`].
pub fn boolean<'a>(
    operands: impl IntoIterator<Item: Into<Operand<'a>>>,
    expression: &Expression,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, BooleanError> {
    let (operands, expression) = Operand::with_negatives(operands, expression);
    let (needed, given) = (expression.operand_count(), operands.len());
    if needed > given {
        return Err(BooleanError::MissingOperand { operand: needed - 1, given });
    }
    for (operand, given) in operands.iter().enumerate() {
        given.mesh.check().map_err(|error| BooleanError::Index { operand, error })?;
    }
    let ordered = Ordered::new(operands, &expression);
    evaluate(&ordered.operands, &ordered.expression, options, progress)
        .map(|outcome| ordered.back(outcome))
        .map_err(|error| ordered.error(error))
}

/// [`boolean`] for operands in their order.
fn evaluate(
    operands: &[Operand<'_>],
    expression: &Expression,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, BooleanError> {
    let given: Vec<&TriMesh> = operands.iter().map(|operand| operand.mesh).collect();
    let frame = Frame::of(&given, &options.surface());
    let local: Vec<_> = given.iter().map(|mesh| frame.local(mesh)).collect();
    let meshes: Vec<&TriMesh> = local.iter().map(AsRef::as_ref).collect();
    let classes: Vec<Vec<u32>> = operands.iter().map(Operand::classes).collect();
    let bounds = sizing::bounds(meshes.iter().copied()).map_err(|operand| BooleanError::Empty { operand })?;
    let h = sizing::spacing(&bounds, options.voxel)?;
    plan::check_standing(&meshes, options.max_memory)?;

    let mut stages = Stages::new(progress);
    stages.begin(Stage::Orient)?;
    let soup = Soup::of(&meshes, options.orient, progress)?;
    stages.begin(Stage::Shells)?;
    let mut apart = Apart::find(&soup, expression, options, progress)?;
    let standing = apart.surface(&soup, &meshes, (options, &classes), h, progress)?;
    let job = Job { expression, options, classes: &classes, h, progress };
    let draft = match apart.split(soup) {
        (rest, None) => job.alone(rest, h, &mut stages)?,
        (rest, Some(whole)) => match job.beside(rest, standing, &mut stages)? {
            Some(draft) => draft,
            None => {
                // What was made runs into what stands: all of it is made together.
                apart = apart.none_standing();
                job.alone(whole, h, &mut stages)?
            }
        },
    };
    let draft: Draft = report::finished(draft, &apart, stages);
    Ok(draft.counted(&meshes).global(&frame).judged(operands, progress)?)
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
