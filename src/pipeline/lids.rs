//! Holes closed from their rims alone: without rays and voxels, so that all that is not a lid stays what it is.

use super::apart::Standing;
use super::exact::{Exact, Pile};
use super::holes::Plan;
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, TriangleSource};
use crate::arrange::ArrangeError;
use crate::progress::Stage;
use crate::survey::Soup;

impl Job<'_> {
    /// What lids over all rims of the one operand make of it, beside what stands. [`Exact::None`] where a rim has none.
    pub(super) fn lidded(
        &self,
        rest: &Soup,
        plan: &Plan,
        standing: &Standing,
        stages: &mut Stages<'_>,
    ) -> Result<Exact, BooleanError> {
        if !plan.is_whole() {
            return Ok(Exact::None);
        }
        let closed = plan.over(rest);
        let source = |t: u32| (t, TriangleSource::in_soup(&closed, t));
        let mut pile = Pile::default();
        pile.add(&closed.mesh, (0..closed.mesh.triangles.len() as u32).map(source));
        stages.begin(Stage::Arrange)?;
        let mut draft = match self.arranged(&pile) {
            Ok(draft) => self.simplified(draft.cleaned(rest))?,
            Err(ArrangeError::Stopped(stopped)) => return Err(stopped.into()),
            Err(_) => return Ok(Exact::None),
        };
        draft.report.closed_triangles = draft.sources.iter().filter(|source| source.is_made_up()).count();
        draft.report.holes = plan.reports();
        self.beside_standing(draft, standing)
    }
}
