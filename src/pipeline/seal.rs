//! Operands with holes: cut first where they cross themselves, and made whole before others cut them.

use super::boolean::Task;
use super::exact::Pile;
use super::rebuild::Job;
use super::stages::Stages;
use super::{BooleanError, Draft, Method, Options, Precision, Report, TriangleSource};
use crate::arrange::{ArrangeError, cut};
use crate::lattice::Lattice;
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::progress::Stage;
use crate::survey::Soup;
use crate::zip::{ZipReport, Zipped, zip};

impl Task<'_> {
    /// The repair of an operand with holes that was cut first where it crosses itself: then its crossing curves are edges, and what lies on either
    /// side of them is judged by itself. `given`: the operand as it was cleaned. `None` where nothing crosses, or where nothing is enclosed then.
    pub(super) fn cut_first(&self, given: &Soup, stages: &mut Stages<'_>) -> Result<Option<Draft>, BooleanError> {
        let Self { meshes, options, progress, .. } = *self;
        let single = options.precision == Precision::Single;
        let pieces = match cut(meshes[0], single, progress) {
            Ok(pieces) if pieces.cut > 0 => pieces,
            Err(ArrangeError::Stopped(stopped)) => return Err(stopped.into()),
            _ => return Ok(None),
        };
        let inner = Options { method: Method::Voxel, ..*options };
        let mut draft = match self.of_pieces(&[(&pieces.mesh, &pieces.sources)], &inner, given) {
            Ok(draft) => draft,
            Err(BooleanError::Nothing(_)) => return Ok(None),
            Err(error) => return Err(error),
        };
        stages.took(&draft.report.stages);
        draft.report.cut = pieces.cut;
        Ok(Some(draft))
    }

    /// The boolean of operands whose cracks were closed first; `None` where none has any that closes. `given`: the operands as they were cleaned.
    pub(super) fn zipped(&self, given: &Soup, stages: &mut Stages<'_>) -> Result<Option<Draft>, BooleanError> {
        let Self { meshes, options, progress, .. } = *self;
        if options.tolerance == Some(0.0) {
            return Ok(None);
        }
        stages.begin(Stage::Zip)?;
        let zipped = meshes.iter().map(|mesh| zip(mesh, options.tolerance, progress));
        let zipped: Vec<Option<Zipped>> = zipped.collect::<Result<_, _>>()?;
        let Some(report) = zipped.iter().flatten().map(|one| one.report).reduce(ZipReport::with) else {
            return Ok(None);
        };
        let all: Vec<Vec<u32>> = meshes.iter().map(|mesh| (0..mesh.triangles.len() as u32).collect()).collect();
        let pieces = zipped.iter().zip(meshes).zip(&all).map(|((zipped, mesh), all)| match zipped {
            Some(zipped) => (&zipped.mesh, &zipped.sources),
            None => (*mesh, all),
        });
        let pieces: Vec<(&TriMesh, &Vec<u32>)> = pieces.collect();
        let mut draft = self.of_pieces(&pieces, &Options { tolerance: Some(0.0), ..*options }, given)?;
        draft.report.zip = Some(report);
        stages.took(&draft.report.stages);
        Ok(Some(draft))
    }

    /// The same boolean of pieces of the operands' triangles, each with the number of its triangle. `given`: the operands as they were cleaned.
    fn of_pieces(
        &self,
        pieces: &[(&TriMesh, &Vec<u32>)],
        options: &Options,
        given: &Soup,
    ) -> Result<Draft, BooleanError> {
        let meshes: Vec<&TriMesh> = pieces.iter().map(|(mesh, _)| *mesh).collect();
        let own = |(classes, (_, sources)): (&Vec<u32>, &(&TriMesh, &Vec<u32>))| match classes.is_empty() {
            true => Vec::new(),
            false => sources.iter().map(|&t| classes[t as usize]).collect(),
        };
        let classes: Vec<Vec<u32>> = self.classes.iter().zip(pieces).map(own).collect();
        let mut draft = Task { meshes: &meshes, classes: &classes, options, ..*self }.draft()?;
        for source in &mut draft.sources {
            if let TriangleSource::Operand { operand, triangle } = source {
                *triangle = pieces[*operand as usize].1[*triangle as usize];
            }
        }
        for (own, given) in draft.report.orient.iter_mut().zip(&given.reports) {
            // What was dropped is counted in the operand's own triangles, not in pieces.
            own.degenerate_dropped = given.degenerate_dropped;
            own.duplicates_dropped = given.duplicates_dropped;
            own.both_sided = given.both_sided;
        }
        Ok(draft)
    }

    /// The exact boolean of operands of which some have holes: those are repaired by themselves, as they would be alone; `None` where one
    /// encloses nothing by itself, or where there is no exact result of what they make. `given`: all of them as they were cleaned.
    pub(super) fn sealed(
        &self,
        closed: &[bool],
        given: &Soup,
        stages: &mut Stages<'_>,
    ) -> Result<Option<Draft>, BooleanError> {
        let Self { meshes, classes, expression, options, h, progress } = *self;
        let mut pile = Pile::default();
        let mut report: Option<(Report, Lattice)> = None;
        let mut orient = given.reports.clone();
        for (n, &mesh) in meshes.iter().enumerate() {
            let operand = n as u32;
            if closed[n] {
                // Which of its shells are turned over is found when it is cut.
                (orient[n].flipped_patches, orient[n].flipped_by_rays) = (0, 0);
                let all =
                    (0..mesh.triangles.len() as u32).map(|t| (t, TriangleSource::Operand { operand, triangle: t }));
                pile.add(mesh, all);
                continue;
            }
            let alone = Options { method: Method::Auto, ..*options };
            let task = Task {
                meshes: &meshes[n..=n],
                classes: &classes[n..=n],
                expression: &Expression::Operand(0),
                options: &alone,
                h,
                progress,
            };
            let mut whole = match task.draft() {
                Ok(whole) => whole,
                Err(BooleanError::Nothing(_)) => return Ok(None),
                Err(error) => return Err(error),
            };
            if let Some(own) = whole.report.orient.pop() {
                orient[n] = own;
            }
            stages.took(&whole.report.stages);
            whole.report.holes.iter_mut().for_each(|hole| hole.operand = n);
            pile.add(&whole.mesh, (0..).zip(whole.sources.iter().map(|source| source.of_operand(operand))));
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
            Some((report, lattice)) => {
                let report = Report { exact: cut.report.exact, ..report };
                Draft { report, lattice, ..cut }.oriented(orient)
            }
            None => cut.oriented(orient),
        }))
    }
}
