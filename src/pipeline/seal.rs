//! Operands with holes are made whole before the others cut them.

use super::boolean::Task;
use super::exact::Pile;
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, Draft, Method, Options, Report, TriangleSource};
use crate::arrange::ArrangeError;
use crate::lattice::Lattice;
use crate::ldi::Expression;
use crate::progress::Stage;

impl Task<'_> {
    /// The exact boolean of operands of which some have holes: those are repaired by themselves, as they would be alone; `None` where one
    /// encloses nothing by itself, or where there is no exact result of what they make.
    pub(super) fn sealed(&self, closed: &[bool], stages: &mut Stages<'_>) -> Result<Option<Draft>, BooleanError> {
        let Self { meshes, classes, expression, options, h, progress } = *self;
        if meshes.len() < 2 {
            return Ok(None);
        }
        let mut pile = Pile::default();
        let mut report: Option<(Report, Lattice)> = None;
        for (n, &mesh) in meshes.iter().enumerate() {
            let operand = n as u32;
            if closed[n] {
                let all =
                    (0..mesh.triangles.len() as u32).map(|t| (t, TriangleSource::Operand { operand, triangle: t }));
                pile.add(mesh, all);
                continue;
            }
            let alone = Options { method: Method::Voxel, ..*options };
            let task = Task {
                meshes: &meshes[n..=n],
                classes: &classes[n..=n],
                expression: &Expression::Operand(0),
                options: &alone,
                h,
                progress,
            };
            let whole = match task.draft() {
                Ok(whole) => whole,
                Err(BooleanError::Nothing(_)) => return Ok(None),
                Err(error) => return Err(error),
            };
            let own = |source: &TriangleSource| match *source {
                TriangleSource::Operand { triangle, .. } => TriangleSource::Operand { operand, triangle },
                TriangleSource::Closed => TriangleSource::Closed,
            };
            stages.took(&whole.report.stages);
            pile.add(&whole.mesh, (0..).zip(whole.sources.iter().map(own)));
            report = Some(match report {
                None => (whole.report, whole.lattice),
                Some((report, lattice)) => (report.with(whole.report), lattice),
            });
        }
        stages.begin(Stage::Arrange)?;
        let job = Job { expression, options, classes, h, progress };
        let cut = match job.arranged(&pile) {
            Ok(cut) if cut.mesh.triangles.is_empty() => {
                return Err(super::NothingEnclosed::NoCommonPart.into());
            }
            Ok(cut) => cut,
            Err(ArrangeError::Stopped(stopped)) => return Err(stopped.into()),
            Err(_) => return Ok(None),
        };
        Ok(Some(match report {
            Some((report, lattice)) => Draft { report: Report { exact: cut.report.exact, ..report }, lattice, ..cut },
            None => cut,
        }))
    }
}
