//! Results of meshes that were put together from an operand's triangles and others, told in terms of the operand.

use super::kind::kinds_of;
use super::{Operand, Outcome, TriangleCounts, TriangleSource};
use crate::mesh::TriMesh;

/// A mesh put together for a pipeline.
#[derive(Debug, Clone, Default)]
pub(super) struct Assembled {
    pub mesh: TriMesh,
    /// For each of its triangles the operand's that it is, or is a piece of; `None`: it was made.
    pub own: Vec<Option<u32>>,
}

impl Assembled {
    /// For each triangle whether a result has any that lies on it. `sources`: those of a pipeline whose first operand was this mesh.
    pub(super) fn left(&self, sources: &[TriangleSource]) -> Vec<bool> {
        let mut left = vec![false; self.mesh.triangles.len()];
        for source in sources {
            if let TriangleSource::Operand { operand: 0, triangle } = *source {
                left[triangle as usize] = true;
            }
        }
        left
    }

    /// The outcome of a pipeline whose first operand was this mesh, as one of the operands it was made for: sources, colours and textures are theirs.
    pub(super) fn told(&self, outcome: Outcome, operands: &[Operand<'_>]) -> Outcome {
        let Outcome { solid, mut sources, lattice, mut report, .. } = outcome;
        for source in &mut sources {
            if let TriangleSource::Operand { operand: 0, triangle } = source {
                let own = self.own.get(*triangle as usize).copied().flatten();
                *source = own.map_or(TriangleSource::Closed, |triangle| TriangleSource::Operand { operand: 0, triangle });
            }
        }
        let meshes: Vec<&TriMesh> = operands.iter().map(|operand| operand.mesh).collect();
        report.closed_triangles = sources.iter().filter(|source| **source == TriangleSource::Closed).count();
        report.triangles = TriangleCounts::of(&kinds_of(&solid, &sources, &meshes));
        Outcome::painted(solid, sources, lattice, report, operands)
    }
}
