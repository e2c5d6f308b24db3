//! Holes closed from their rims alone: without rays and voxels, so that all that is not a lid stays what it is.

use super::apart::{Apart, Standing};
use super::exact::{Exact, Pile};
use super::holes::Plan;
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, Draft, TriangleSource};
use crate::arrange::{ArrangeError, ArrangeReport};
use crate::mesh::Submesh;
use crate::progress::Stage;
use crate::shells::Shell;
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
        stages.begin(Stage::Arrange)?;
        let draft = match self.untouched(&closed)? {
            Some(draft) => Ok(draft),
            None => {
                let source = |t: u32| (t, TriangleSource::in_soup(&closed, t));
                let mut pile = Pile::default();
                pile.add(&closed.mesh, (0..closed.mesh.triangles.len() as u32).map(source));
                self.arranged(&pile)
            }
        };
        let mut draft = match draft {
            Ok(draft) => self.simplified(draft.cleaned(rest))?,
            Err(ArrangeError::Stopped(stopped)) => return Err(stopped.into()),
            Err(_) => return Ok(Exact::None),
        };
        draft.report.closed_triangles = draft.sources.iter().filter(|source| source.is_made_up()).count();
        draft.report.holes = plan.reports();
        draft.report.warnings.extend(plan.warning());
        self.beside_standing(draft, standing)
    }

    /// A closed soup of one operand as it is, facing outwards, where no triangle of it touches another one and all of it is the result's surface: then there is
    /// nothing to arrange.
    fn untouched(&self, closed: &Soup) -> Result<Option<Draft>, BooleanError> {
        let apart = Apart::find(closed, self.expression, self.options, self.progress)?;
        let Some(over) = apart.all_bound() else { return Ok(None) };
        let mut mesh = self.options.precision.of_mesh(&closed.mesh).into_owned();
        let turned: Vec<&Shell> =
            apart.shells.list.iter().zip(&over).filter(|entry| *entry.1).map(|entry| entry.0).collect();
        let turned_triangles = turned.iter().flat_map(|shell| &shell.triangles);
        turned_triangles.clone().for_each(|&t| mesh.triangles[t as usize].swap(1, 2));
        let report = ArrangeReport {
            triangles: mesh.triangles.len(),
            cells: apart.shells.list.len() + 1,
            turned: vec![turned.len()],
            turned_triangles: vec![turned_triangles.count()],
            ..ArrangeReport::default()
        };
        let sources = (0..mesh.triangles.len() as u32).map(|t| TriangleSource::in_soup(closed, t)).collect();
        let mesh = Submesh::of(&mesh.positions, mesh.triangles).mesh;
        let mut draft = Draft { mesh, sources, ..Draft::without_voxels(self.h) };
        draft.report.exact = Some(report);
        Ok(Some(draft))
    }
}
