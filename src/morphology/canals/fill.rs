//! The voxels that a closing fills, and their connected parts.

use glam::IVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::lattice::{BRICK, BRICK_VOXELS, Grid, Lattice, Slot, brick_of, index_in_brick, voxel_in_brick};
use crate::mesh::edges::Union;
use crate::morphology::closed::{own_distance, unchanged};
use crate::morphology::{Balls, Gauge, OffsetError, around};
use crate::progress::Progress;

/// The number of no voxel.
const NONE: u32 = u32::MAX;

/// The filled voxels of a lattice.
pub(super) struct Fill {
    /// Distance to the solid, counted in voxels.
    own: Grid<f32>,
    /// The filled voxels, brick by brick.
    voxels: Vec<IVec3>,
    /// Where each of them stands in that list; [`NONE`] for others.
    index: Grid<u32>,
}

/// Filled voxels that touch each other by faces, edges or corners.
pub(super) struct FilledPart {
    /// The voxels, brick by brick.
    pub voxels: Vec<IVec3>,
    /// Distance of each from the solid, h.
    pub clearance: Vec<f64>,
    /// Whether each borders on the open.
    pub mouth: Vec<bool>,
    index: FxHashMap<IVec3, u32>,
}

impl Fill {
    /// Those outside of `original` and, by more than a closing takes for unchanged, within the closing.
    pub(super) fn new(
        original: &Gauge<'_>,
        balls: &Balls<'_>,
        lattice: &Lattice,
        progress: &Progress,
    ) -> Result<Self, OffsetError> {
        let own = own_distance(original, balls.radius, lattice, progress)?;
        let closing = balls.field(&own, progress)?.grid;
        let own = own.grid;
        let least = (unchanged(balls.radius, lattice.h) / lattice.h) as f32;
        let of_brick = |(values, &brick): (&[f32; BRICK_VOXELS], &IVec3)| {
            let voxels = values.iter().enumerate().filter(|(_, own)| **own > 0.0);
            let voxels = voxels.map(|(n, _)| BRICK * brick + voxel_in_brick(n));
            voxels.filter(|&voxel| closing.get(voxel) <= -least).collect::<Vec<IVec3>>()
        };
        let bricks: Vec<Vec<IVec3>> = own.values.par_iter().zip(own.bricks.active()).map(of_brick).collect();
        progress.check()?;
        let voxels = bricks.concat();
        let mut index = Grid::filled(own.bricks.clone(), NONE, NONE, NONE);
        for (n, &voxel) in (0..).zip(&voxels) {
            set(&mut index, voxel, n);
        }
        Ok(Self { own, voxels, index })
    }

    /// Whether `voxel` lies in the solid.
    pub(super) fn is_solid(&self, voxel: IVec3) -> bool {
        self.own.get(voxel) <= 0.0
    }

    /// The connected parts, in the order of their first voxels.
    pub(super) fn parts(&self) -> Vec<FilledPart> {
        let mut sets = Union::new(self.voxels.len());
        for (n, &voxel) in (0..).zip(&self.voxels) {
            for near in around(voxel).map(|v| self.index.get(v)).filter(|&near| near < n) {
                sets.join(n, near);
            }
        }
        let mut members: Vec<Vec<IVec3>> = Vec::new();
        let mut number = vec![NONE; self.voxels.len()];
        for (n, &voxel) in (0..).zip(&self.voxels) {
            let root = sets.root(n) as usize;
            if number[root] == NONE {
                number[root] = members.len() as u32;
                members.push(Vec::new());
            }
            members[number[root] as usize].push(voxel);
        }
        members.into_par_iter().map(|voxels| self.part(voxels)).collect()
    }

    fn part(&self, voxels: Vec<IVec3>) -> FilledPart {
        let open = |v: IVec3| self.own.get(v) > 0.0 && self.index.get(v) == NONE;
        FilledPart {
            clearance: voxels.iter().map(|&v| f64::from(self.own.get(v))).collect(),
            mouth: voxels.iter().map(|&v| sides(v).any(open)).collect(),
            index: voxels.iter().copied().zip(0..).collect(),
            voxels,
        }
    }

    /// For each voxel of `parts`, and for those outside of the solid beside them, the number of its part, from 1.
    pub(super) fn numbered<'a>(&self, parts: impl Iterator<Item = &'a FilledPart>) -> Grid<u32> {
        let mut numbers = Grid::filled(self.own.bricks.clone(), 0, 0, 0);
        let parts: Vec<&FilledPart> = parts.collect();
        for (number, part) in (1..).zip(&parts) {
            part.voxels.iter().for_each(|&voxel| set(&mut numbers, voxel, number));
        }
        for (number, part) in (1..).zip(&parts) {
            for beside in part.voxels.iter().flat_map(|&voxel| around(voxel)) {
                if numbers.get(beside) == 0 && !self.is_solid(beside) {
                    set(&mut numbers, beside, number);
                }
            }
        }
        numbers
    }
}

impl FilledPart {
    /// The member at `voxel`.
    pub(super) fn at(&self, voxel: IVec3) -> Option<u32> {
        self.index.get(&voxel).copied()
    }

    /// Members beside member `n`, by faces, edges or corners.
    pub(super) fn beside(&self, n: u32) -> impl Iterator<Item = u32> + '_ {
        around(self.voxels[n as usize]).filter_map(|voxel| self.at(voxel))
    }
}

/// Sets an active voxel.
fn set(grid: &mut Grid<u32>, voxel: IVec3, value: u32) {
    if let Slot::Active(n) = grid.bricks.slot(brick_of(voxel)) {
        grid.values[n as usize][index_in_brick(voxel)] = value;
    }
}

/// The 6 voxels that share a face with one.
pub(super) fn sides(voxel: IVec3) -> impl Iterator<Item = IVec3> {
    IVec3::AXES.into_iter().flat_map(move |axis| [voxel - axis, voxel + axis])
}
