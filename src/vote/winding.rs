//! The generalised winding number of a soup (Jacobson et al. 2013). It decides the voxels that the
//! rays are not sure of: over a flat hole its level ½ is the flat lid, and it does not mind stray
//! triangles. What counts as inside of whole numbers counts for the nearest one here ([`Inside::holds_near`]).

use std::sync::OnceLock;

use glam::{DVec3, IVec3};

use super::block::Block;
use super::dipoles::WindingTree;
use super::rim::Rim;
use crate::lattice::Lattice;
use crate::ldi::{Expression, Inside, Operands};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

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
    /// The winding numbers of the operands of `soup` at the voxels of `lattice`.
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
    /// `k` of `wanted`, offsets in the block. An operand is inside where the whole number nearest to its winding number is.
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
        let operands = self.trees()?.iter().zip(self.rims()?);
        let rule = self.rule();
        let blocks: Vec<Block<'_>> = operands.map(|(tree, rim)| Block::new(tree, rim, centre, radius)).collect();
        let mut inside = vec![false; blocks.len()];
        for &offset in wanted {
            let p = model(offset.as_dvec3());
            inside.iter_mut().zip(&blocks).for_each(|(inside, block)| *inside = block.is_inside(p, rule));
            decide(offset, expression.evaluate(&inside));
        }
        Ok(())
    }

    /// Voxels along each axis of the lattice.
    pub(super) fn dims(&self) -> IVec3 {
        self.lattice.dims
    }

    /// Whether the operands reach beyond the lattice.
    pub(super) fn reaches_beyond(&self) -> bool {
        let last = (self.lattice.dims - 1).as_dvec3();
        self.soup.bounds().is_some_and(|bounds| {
            let [min, max] = [bounds.min, bounds.max].map(|p| self.lattice.to_lattice(p));
            min.cmplt(DVec3::ZERO).any() || max.cmpgt(last).any()
        })
    }

    /// What counts as inside of whole winding numbers.
    pub(super) fn rule(&self) -> Inside {
        self.operands.inside
    }

    pub(super) fn trees(&self) -> Result<&[WindingTree], Stopped> {
        let trees = self.trees.get_or_init(|| {
            // Not on all threads: one that waited for others here could be handed a brick that waits for it. The same holds for rims.
            let all = 0..self.operands.count();
            all.map(|n| WindingTree::on_one_thread(self.soup, self.operands.range(n), &self.progress)).collect()
        });
        trees.as_deref().map_err(|&stopped| stopped)
    }

    /// The boundaries of the operands.
    pub(super) fn rims(&self) -> Result<&[Rim], Stopped> {
        let rims = self.rims.get_or_init(|| {
            let all = 0..self.operands.count();
            all.map(|n| Rim::new(self.soup, self.operands.range(n), &self.progress)).collect()
        });
        rims.as_deref().map_err(|&stopped| stopped)
    }

    /// From lattice coordinates to those of the trees and the rims.
    pub(super) fn to_model(&self, p: DVec3) -> DVec3 {
        self.lattice.to_model(p)
    }
}
