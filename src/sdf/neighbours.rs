//! The six neighbours of a voxel, fast within a brick.

use glam::IVec3;

use crate::lattice::{Bricks, Grid, Slot};

/// For each active brick the slots of its six face neighbours: -x, +x, -y, +y, -z, +z.
pub(super) struct Adjacency {
    slots: Vec<[Slot; 6]>,
}

const STEPS: [IVec3; 6] = [IVec3::NEG_X, IVec3::X, IVec3::NEG_Y, IVec3::Y, IVec3::NEG_Z, IVec3::Z];

impl Adjacency {
    pub(super) fn new(bricks: &Bricks) -> Self {
        Self { slots: bricks.active().iter().map(|&b| STEPS.map(|step| bricks.slot(b + step))).collect() }
    }

    /// Values of the neighbours of voxel `n` of active brick `brick`, in the order -x, +x, -y, +y,
    /// -z, +z.
    #[inline]
    pub(super) fn values(&self, grid: &Grid<f32>, brick: usize, n: usize) -> [f32; 6] {
        let own = &grid.values[brick];
        let mut values = [0.0; 6];
        for axis in 0..3 {
            let (shift, at) = (3 * axis, n >> (3 * axis) & 7);
            values[2 * axis] =
                if at > 0 { own[n - (1 << shift)] } else { self.across(grid, brick, 2 * axis, n + (7 << shift)) };
            values[2 * axis + 1] =
                if at < 7 { own[n + (1 << shift)] } else { self.across(grid, brick, 2 * axis + 1, n - (7 << shift)) };
        }
        values
    }

    /// Whether all six neighbours are stored.
    #[inline]
    pub(super) fn is_interior(&self, brick: usize, n: usize) -> bool {
        (0..3).all(|axis| {
            let at = n >> (3 * axis) & 7;
            let stored = |side: usize| matches!(self.slots[brick][side], Slot::Active(_));
            (at > 0 || stored(2 * axis)) && (at < 7 || stored(2 * axis + 1))
        })
    }

    fn across(&self, grid: &Grid<f32>, brick: usize, side: usize, n: usize) -> f32 {
        match self.slots[brick][side] {
            Slot::Active(other) => grid.values[other as usize][n],
            Slot::Inside => grid.inside,
            Slot::Outside => grid.outside,
        }
    }
}
