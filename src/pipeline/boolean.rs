//! Booleans of meshes as they really are, and repair: the boolean of one.

use super::apart::Apart;
use super::frame::Frame;
use super::order::Ordered;
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, Draft, Operand, Options, Outcome, account, plan, sizing};
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stage};
use crate::survey::Soup;

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
        if let Some(triangle) = given.mesh.first_not_finite() {
            return Err(BooleanError::NotFinite { operand, triangle });
        }
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
    let soup = Soup::of(&meshes, options.orient, progress)?.with_inside(options.inside);
    stages.begin(Stage::Shells)?;
    let mut apart = Apart::find(&soup, expression, options, progress)?;
    let standing = apart.surface(&soup, &meshes, (options, &classes), h, progress)?;
    let job = Job { expression, options, classes: &classes, h, progress };
    let draft = match apart.split(soup) {
        (rest, _) if rest.mesh.triangles.is_empty() => job.nothing_beside(&rest, standing)?,
        (rest, whole) => {
            match job.exact(&meshes, (&rest, &apart), &standing, &mut stages).map_err(|error| frame.error(error))? {
                Some(draft) => draft,
                None => match (job.beside(&rest, standing, &mut stages)?, whole) {
                    (Some(draft), _) => draft,
                    (None, whole) => {
                        // What was made runs into what stands: all of it is made together.
                        apart = apart.none_standing();
                        job.alone(whole.unwrap_or(rest), h, &mut stages)?
                    }
                },
            }
        }
    };
    let mut draft: Draft = account::finished(draft, &apart, stages);
    draft.report.inside = options.inside;
    Ok(draft.global(&frame).counted(&given).judged(operands, progress)?)
}
