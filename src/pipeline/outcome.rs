//! What comes out of a pipeline.

use super::frame::Frame;
use super::kind::{TriangleCounts, kinds_of};
use super::{Operand, Report, colours, textures};
use crate::io::{Colours, TextureMap};
use crate::lattice::Lattice;
use crate::mesh::{Solid, SolidError, TriMesh};
use crate::progress::Progress;

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

/// Where a triangle of the result comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TriangleSource {
    /// It lies on a triangle of an operand.
    Operand {
        /// Number of the operand, from 0.
        operand: u32,
        /// Number of the triangle in it.
        triangle: u32,
    },
    /// It closes a hole, or morphology has made it: no triangle of an operand is there.
    Closed,
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
        let solid = Solid::check(mesh, progress)?;
        Ok(Self { mesh: TriMesh::default(), sources, lattice, report }.painted(solid, operands))
    }

    /// The result with its mesh as the solid that it was judged to be, and with what its operands look like.
    pub(super) fn painted(self, solid: Solid, operands: &[Operand<'_>]) -> Outcome {
        let Self { sources, lattice, report, .. } = self;
        let colours = colours::carry_colours(&solid, &sources, operands);
        let texture = textures::carry_texture(&solid, &sources, operands);
        Outcome { solid, sources, colours, texture, lattice, report }
    }
}

impl Outcome {
    /// The judged result without the judgement.
    pub(super) fn into_draft(self) -> Draft {
        let Self { solid, sources, lattice, report, .. } = self;
        Draft { mesh: solid.into_mesh(), sources, lattice, report }
    }
}
