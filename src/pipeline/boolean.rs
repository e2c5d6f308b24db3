//! Booleans of meshes as they really are, and repair: the boolean of one.

use super::apart::Apart;
use super::exact::Exact;
use super::frame::Frame;
use super::holes::{Plan, planned};
use super::order::Ordered;
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, Draft, Operand, Options, Outcome, account, plan, sizing};
use crate::arrange::ArrangeError;
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
        BooleanError::check(operand, given.mesh)?;
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

    let task = Task { meshes: &meshes, classes: &classes, expression, options, h, progress };
    let mut draft = task.draft().map_err(|error| moved(error, &frame))?;
    draft.report.inside = options.inside;
    Ok(draft.global(&frame).counted(&given).judged(operands, progress)?)
}

/// An error whose place is where the operands are.
fn moved(mut error: BooleanError, frame: &Frame) -> BooleanError {
    if let BooleanError::NotExact(ArrangeError::Open { first, .. }) = &mut error {
        first.ends.iter_mut().for_each(|end| frame.place(end));
    }
    error
}

/// A boolean of operands near the origin.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub meshes: &'a [&'a TriMesh],
    /// For each operand a number for each of its triangles, or nothing: what has different numbers is kept apart.
    pub classes: &'a [Vec<u32>],
    pub expression: &'a Expression,
    pub options: &'a Options,
    /// The voxel size, model units.
    pub h: f64,
    pub progress: &'a Progress,
}

impl Task<'_> {
    /// Shells that touch nothing stay; what touches is cut exactly, or, with holes, made from voxels; of several operands those with
    /// holes are made whole first.
    pub(super) fn draft(&self) -> Result<Draft, BooleanError> {
        let Self { meshes, classes, expression, options, h, progress } = *self;
        let mut stages = Stages::new(progress);
        stages.begin(Stage::Orient)?;
        let soup = Soup::of(meshes, options.orient, progress)?.with_inside(options.inside);
        stages.begin(Stage::Shells)?;
        let mut apart = Apart::find(&soup, expression, options, progress)?;
        let standing = apart.surface(&soup, meshes, (options, classes), h, progress)?;
        let job = Job { expression, options, classes, h, progress };
        let (rest, whole) = apart.split(soup);
        if rest.mesh.triangles.is_empty() {
            let draft = job.nothing_beside(&rest, standing)?;
            return Ok(account::finished(draft, &apart, stages));
        }
        let exact = job.exact(meshes, (&rest, &apart), &standing, &mut stages)?;
        if let Exact::Done(draft) = exact {
            return Ok(account::finished(*draft, &apart, stages));
        }
        let mut holes = Plan::default();
        if let Exact::Open { closed, crosses } = exact {
            if let Some(mut draft) = self.zipped(&rest, &mut stages)? {
                draft.report.stages = stages.finish();
                return Ok(draft);
            }
            if meshes.len() > 1 {
                if let Some(draft) = self.sealed(&closed, &rest, &mut stages)? {
                    return Ok(account::finished(draft, &apart, stages));
                }
            } else {
                stages.begin(Stage::Fill)?;
                holes = planned(&rest, options, progress)?;
                if let Exact::Done(draft) = job.lidded(&rest, &holes, &standing, &mut stages)? {
                    return Ok(account::finished(*draft, &apart, stages));
                }
                if let Some(mut draft) = job.within_window(&rest, &holes, &standing, &mut stages)? {
                    draft.report.holes = holes.reports();
                    return Ok(account::finished(draft, &apart, stages));
                }
                if crosses && let Some(mut draft) = self.cut_first(&rest, &mut stages)? {
                    draft.report.stages = stages.finish();
                    return Ok(draft);
                }
            }
        }
        // Of the holes those that have no lid are closed from voxels.
        let lidded = holes.over(&rest);
        let mut draft = match job.beside(&lidded, standing, &mut stages)? {
            Some(draft) => draft,
            None => {
                // What was made runs into what stands: all of it is made together.
                apart = apart.none_standing();
                holes = Plan::default();
                job.alone(whole.unwrap_or(rest), h, &mut stages)?
            }
        };
        draft.report.holes = holes.reports();
        draft.report.warnings.extend(holes.warning());
        Ok(account::finished(draft, &apart, stages))
    }
}
