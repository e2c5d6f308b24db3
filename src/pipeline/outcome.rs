//! What comes out of a pipeline.

use glam::{DVec3, IVec3};

use super::frame::Frame;
use super::kind::kinds_of;
use super::{Operand, Report, TriangleCounts, TriangleKind, TriangleSource, colours, textures};
use crate::io::{Colours, TextureMap};
use crate::lattice::Lattice;
use crate::mesh::{Solid, SolidError, TriMesh};
use crate::orient::OrientReport;
use crate::progress::Progress;
use crate::survey::Soup;

/// A finished solid and how it came about.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The result; for its coordinates see [`Precision`](super::Precision).
    pub solid: Solid,
    /// Where each triangle comes from.
    pub sources: Vec<TriangleSource>,
    /// Its colours; `None` when no operand has any. What closes a hole, and what comes from an operand without colours, is grey.
    pub colours: Option<Colours>,
    /// Its textures; `None` when no operand has any.
    pub texture: Option<TextureMap>,
    /// The lattice on which surface was made; without voxels where none was, see [`Report::lattice`].
    pub lattice: Lattice,
    /// What was found and done.
    pub report: Report,
}

/// A result before it is judged.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub mesh: TriMesh,
    pub sources: Vec<TriangleSource>,
    pub lattice: Lattice,
    pub report: Report,
}

impl Draft {
    /// An empty one, made without voxels; `h`: those that there would have been, model units.
    pub(super) fn without_voxels(h: f64) -> Self {
        let lattice = Lattice { origin: DVec3::ZERO, h, dims: IVec3::ZERO };
        let report = Report { voxel: h, ..Report::default() };
        Self { mesh: TriMesh::default(), sources: Vec::new(), lattice, report }
    }

    /// The same with what cleaning did to the operands.
    pub(super) fn cleaned(self, soup: &Soup) -> Self {
        self.oriented(soup.reports.clone())
    }

    /// The same with what was done to each operand, beside the shells that were turned over when it was cut.
    pub(super) fn oriented(mut self, mut reports: Vec<OrientReport>) -> Self {
        if let Some(exact) = &self.report.exact {
            for ((report, shells), triangles) in reports.iter_mut().zip(&exact.turned).zip(&exact.turned_triangles) {
                report.flipped_patches += shells;
                report.flipped_by_rays += triangles;
            }
        }
        self.report.orient = reports;
        self
    }

    /// The same with the numbers of kinds in its report. `operands`: those that its sources name, in the same place.
    pub(super) fn counted(mut self, operands: &[&TriMesh]) -> Self {
        self.report.triangles = TriangleCounts::of(&kinds_of(&self.mesh, &self.sources, operands));
        self
    }

    /// The same where the operands are.
    pub(super) fn global(mut self, frame: &Frame) -> Self {
        frame.mesh(&mut self.mesh);
        self.lattice = frame.global_lattice(self.lattice);
        frame.report(&mut self.report);
        self
    }

    /// The judged result, with what its operands look like.
    pub(super) fn judged(self, operands: &[Operand<'_>], progress: &Progress) -> Result<Outcome, SolidError> {
        let Self { mesh, sources, lattice, report } = self;
        Ok(Outcome::painted(Solid::check(mesh, progress)?, sources, lattice, report, operands))
    }
}

impl Outcome {
    /// A solid with what its operands look like.
    pub(super) fn painted(
        solid: Solid,
        sources: Vec<TriangleSource>,
        lattice: Lattice,
        report: Report,
        operands: &[Operand<'_>],
    ) -> Self {
        let colours = colours::carry_colours(&solid, &sources, operands);
        let texture = textures::carry_texture(&solid, &sources, operands);
        Self { solid, sources, colours, texture, lattice, report }
    }

    /// What each triangle is: kept, cut, rebuilt or made up. `operands`: those that the outcome was made of, in the same order.
    pub fn kinds<'a>(&self, operands: impl IntoIterator<Item: Into<Operand<'a>>>) -> Vec<TriangleKind> {
        let operands: Vec<&TriMesh> = operands.into_iter().map(|operand| operand.into().mesh).collect();
        kinds_of(&self.solid, &self.sources, &operands)
    }

    /// The judged result without the judgement.
    pub(super) fn into_draft(self) -> Draft {
        let Self { solid, sources, lattice, report, .. } = self;
        Draft { mesh: solid.into_mesh(), sources, lattice, report }
    }
}
