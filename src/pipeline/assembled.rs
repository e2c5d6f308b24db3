//! Results of meshes that were put together from an operand's triangles and others, told in terms of the operand.

use super::kind::kinds_of;
use super::{Operand, Outcome, TriangleCounts, TriangleSource};
use crate::mesh::TriMesh;

/// A mesh put together for a pipeline.
#[derive(Debug, Clone, Default)]
pub(super) struct Assembled {
    pub mesh: TriMesh,
    /// Where each of its triangles comes from.
    pub own: Vec<TriangleSource>,
    /// How many holes the lids among them close, numbered from 1.
    pub holes: usize,
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

    /// The outcome of a pipeline whose first operand was this mesh, as one of the operands it was made for: sources, colours and textures are theirs, and the holes that the
    /// pipeline closed come after those that were closed before.
    pub(super) fn told(&self, outcome: Outcome, operands: &[Operand<'_>]) -> Outcome {
        let Outcome { solid, mut sources, lattice, mut report, .. } = outcome;
        for source in &mut sources {
            match source {
                TriangleSource::Operand { operand: 0, triangle } => {
                    *source = self.own.get(*triangle as usize).copied().unwrap_or(TriangleSource::Closed);
                }
                TriangleSource::Lid { operand: 0, hole } => *hole += self.holes as u32,
                _ => {}
            }
        }
        report.holes.iter_mut().filter(|hole| hole.operand == 0).for_each(|hole| hole.number += self.holes);
        let meshes: Vec<&TriMesh> = operands.iter().map(|operand| operand.mesh).collect();
        report.closed_triangles = sources.iter().filter(|source| source.is_made_up()).count();
        report.triangles = TriangleCounts::of(&kinds_of(&solid, &sources, &meshes));
        Outcome::painted(solid, sources, lattice, report, operands)
    }
}
