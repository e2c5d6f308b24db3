//! The generalised winding number of a soup (Jacobson et al. 2013). It decides the voxels that the
//! rays are not sure of: over a flat hole its level ½ is the flat lid, and it does not mind stray
//! triangles.

use std::sync::OnceLock;

use glam::{DVec3, IVec3};

use super::dipoles::{Local, WindingTree};
use super::rim::{Rim, View};
use crate::lattice::Lattice;
use crate::ldi::{Expression, Operands};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// How far from ½ the tree may put a voxel that is on the other side of it, and more: it errs by
/// up to 0.02.
const UNSURE: f64 = 0.05;

/// The winding numbers of all operands at voxels. The trees are made when they are first needed:
/// the voxels of a closed mesh need none.
pub struct Winding<'a> {
    soup: &'a TriMesh,
    operands: &'a Operands,
    lattice: Lattice,
    progress: Progress,
    trees: OnceLock<Result<Vec<WindingTree>, Stopped>>,
    rims: OnceLock<Result<Vec<Rim>, Stopped>>,
}

impl<'a> Winding<'a> {
    /// Of the operands of `soup`, at the voxels of `lattice`.
    pub fn new(soup: &'a TriMesh, operands: &'a Operands, lattice: &Lattice, progress: &Progress) -> Self {
        Self {
            soup,
            operands,
            lattice: *lattice,
            progress: progress.clone(),
            trees: OnceLock::new(),
            rims: OnceLock::new(),
        }
    }

    /// Decides voxels of the block of 4³ voxels from `base` on: calls `decide(k, inside)` for each
    /// `k` of `wanted`, offsets in the block. An operand is inside above a winding number of ½.
    pub fn decide(
        &self,
        base: IVec3,
        wanted: &[IVec3],
        expression: &Expression,
        mut decide: impl FnMut(IVec3, bool),
    ) -> Result<(), Stopped> {
        let model = |p: DVec3| self.lattice.to_model(base.as_dvec3() + p);
        let centre = model(DVec3::splat(1.5));
        let radius = 1.5 * 3f64.sqrt() * self.lattice.h;
        let mut local: Vec<Block<'_>> =
            self.trees()?.iter().map(|tree| Block::new(tree.around(centre, radius))).collect();
        let mut inside = vec![false; local.len()];
        for &offset in wanted {
            let p = model(offset.as_dvec3());
            for (operand, block) in local.iter_mut().enumerate() {
                let mut w = block.dipoles.winding(p);
                if (w - 0.5).abs() < UNSURE {
                    w = block.refine(w, p, || Ok(self.rims()?[operand].view(centre, radius)))?;
                }
                inside[operand] = w > 0.5;
            }
            decide(offset, expression.evaluate(&inside));
        }
        Ok(())
    }

    pub(super) fn trees(&self) -> Result<&[WindingTree], Stopped> {
        let trees = self.trees.get_or_init(|| {
            // Without rayon: a thread that waits for others here could be handed a brick that waits for it.
            let all = 0..self.operands.count();
            all.map(|operand| WindingTree::new(self.soup, self.operands.range(operand), &self.progress)).collect()
        });
        trees.as_deref().map_err(|&stopped| stopped)
    }

    /// The boundaries of the operands.
    pub(super) fn rims(&self) -> Result<&[Rim], Stopped> {
        let rims = self.rims.get_or_init(|| {
            let all = 0..self.operands.count();
            all.map(|operand| Rim::new(self.soup, self.operands.range(operand), &self.progress)).collect()
        });
        rims.as_deref().map_err(|&stopped| stopped)
    }

    /// From lattice coordinates to those of the trees and the rims.
    pub(super) fn to_model(&self, p: DVec3) -> DVec3 {
        self.lattice.to_model(p)
    }
}

/// One operand near a block of voxels.
struct Block<'w> {
    dipoles: Local<'w>,
    /// Looked for when first needed; none for a closed operand.
    rim: Option<Option<View<'w>>>,
}

impl<'w> Block<'w> {
    fn new(dipoles: Local<'w>) -> Self {
        Self { dipoles, rim: None }
    }

    /// The winding number at `p`, `rough` by the dipoles, by the boundary.
    fn refine(
        &mut self,
        rough: f64,
        p: DVec3,
        rim: impl FnOnce() -> Result<Option<View<'w>>, Stopped>,
    ) -> Result<f64, Stopped> {
        let view = match &self.rim {
            Some(view) => view,
            None => self.rim.insert(rim()?),
        };
        Ok(view.as_ref().map_or(rough, |view| view.at(p).complete(rough)))
    }
}
