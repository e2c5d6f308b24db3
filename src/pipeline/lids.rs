//! Holes closed from their rims alone: without rays and voxels, so that all that is not a lid stays what it is.

use super::apart::Standing;
use super::exact::{Exact, Pile};
use super::holes::{Closed, closed};
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, TriangleSource};
use crate::arrange::ArrangeError;
use crate::progress::Stage;
use crate::survey::Soup;

impl Job<'_> {
    /// What lids over all rims of the one operand make of it, beside what stands. [`Exact::None`] where a rim has no lid that all agree on.
    pub(super) fn lidded(
        &self,
        rest: &Soup,
        standing: &Standing,
        stages: &mut Stages<'_>,
    ) -> Result<Exact, BooleanError> {
        stages.begin(Stage::Fill)?;
        let Some(Closed { mesh, holes }) = closed(rest, self.options, self.progress)? else {
            return Ok(Exact::None);
        };
        let source = |t: u32| match rest.source.get(t as usize) {
            Some(&triangle) => (t, TriangleSource::Operand { operand: 0, triangle }),
            None => (t, TriangleSource::Closed),
        };
        let mut pile = Pile::default();
        pile.add(&mesh, (0..mesh.triangles.len() as u32).map(source));
        stages.begin(Stage::Arrange)?;
        let mut draft = match self.arranged(&pile) {
            Ok(draft) => self.simplified(draft.cleaned(rest))?,
            Err(ArrangeError::Stopped(stopped)) => return Err(stopped.into()),
            Err(_) => return Ok(Exact::None),
        };
        draft.report.closed_triangles =
            draft.sources.iter().filter(|source| **source == TriangleSource::Closed).count();
        draft.report.holes = holes;
        self.beside_standing(draft, standing)
    }
}
