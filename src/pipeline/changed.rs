//! What was made of a solid, and how it follows on what the solid came from.

use super::kind::kinds_of;
use super::{Operand, Outcome, Report, TriangleCounts, TriangleSource};
use crate::lattice::Lattice;
use crate::mesh::{Solid, SolidError, TriMesh};
use crate::progress::Progress;

/// What an operation has made of a solid. [`Outcome::followed_by`] puts it behind the repair or boolean that the solid came from.
#[derive(Debug, Clone)]
pub struct Changed {
    /// The result.
    pub solid: Solid,
    /// For each of its triangles the triangle of the given solid that it lies on; `None`: the operation has made it.
    pub own: Vec<Option<u32>>,
    /// The lattice on which surface was made.
    pub lattice: Lattice,
    /// What was done; only the parts that concern the operation are filled.
    pub report: Report,
}

impl Changed {
    /// The solid as it is.
    pub(super) fn unchanged(solid: &Solid, lattice: Lattice, report: Report) -> Self {
        let own = (0..solid.triangles.len() as u32).map(Some).collect();
        Self { solid: solid.clone(), own, lattice, report }
    }
}

impl Outcome {
    /// What an operation has made of this outcome's solid, as an outcome of the same operands: sources, colours and textures go back
    /// to them, and the report has both parts.
    ///
    /// # Errors
    /// [`SolidError::Stopped`].
    pub fn followed_by<'a>(
        self,
        changed: Changed,
        operands: impl IntoIterator<Item: Into<Operand<'a>>>,
        progress: &Progress,
    ) -> Result<Self, SolidError> {
        let operands: Vec<Operand<'_>> = operands.into_iter().map(Into::into).collect();
        let meshes: Vec<&TriMesh> = operands.iter().map(|operand| operand.mesh).collect();
        let Changed { solid, own, lattice, report } = changed;
        let source = |own: &Option<u32>| own.map_or(TriangleSource::Closed, |t| self.sources[t as usize]);
        let sources: Vec<TriangleSource> = own.iter().map(source).collect();
        let mut report = self.report.then(report);
        report.closed_triangles = sources.iter().filter(|source| source.is_made_up()).count();
        report.triangles = TriangleCounts::of(&kinds_of(&solid, &sources, &meshes));
        progress.check()?;
        Ok(Self::painted(solid, sources, lattice, report, &operands))
    }
}

impl From<Changed> for Outcome {
    /// Of something made out of nothing: no triangle has a source.
    fn from(changed: Changed) -> Self {
        let Changed { solid, own, lattice, mut report } = changed;
        report.closed_triangles = own.len();
        report.triangles.made_up = own.len();
        let sources = vec![TriangleSource::Closed; own.len()];
        Self { solid, sources, colours: None, texture: None, lattice, report }
    }
}

impl Report {
    /// The account of this run and of an operation after it.
    fn then(mut self, mut next: Self) -> Self {
        self.stages.append(&mut next.stages);
        self.warnings.append(&mut next.warnings);
        self.crumbs = self.crumbs.and(next.crumbs);
        if next.topology.is_some() {
            // The operation ended in a boolean, whose rays saw all of the result.
            let Self { orient, crumbs, stages, warnings, triangles, cut, .. } = self;
            let exact = next.exact.or(self.exact);
            return Self { orient, crumbs, stages, warnings, triangles, cut, exact, ..next };
        }
        if next.morphology.is_some() {
            self.fit = next.fit;
        }
        let Self { morphology, hollow, thicken, .. } = next;
        Self { morphology, hollow, thicken, ..self }
    }
}
