//! What comes out of a pipeline.

use super::frame::Frame;
use super::kind::kinds_of;
use super::{Operand, Report, TriangleCounts, TriangleKind, TriangleSource, colours, textures};
use crate::io::{Colours, TextureMap};
use crate::lattice::Lattice;
use crate::mesh::{Solid, SolidError, TriMesh};
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
    /// The same with what cleaning did to the operands.
    pub(super) fn cleaned(mut self, soup: &Soup) -> Self {
        self.report.orient = soup.reports.clone();
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
