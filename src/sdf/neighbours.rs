//! The six neighbours of a voxel, fast within a brick, and the voxels whose neighbours differ.

use glam::IVec3;
use rayon::prelude::*;

use crate::lattice::{Bricks, Grid, Slot};

/// For each active brick the slots of its six face neighbours: -x, +x, -y, +y, -z, +z.
pub(super) struct Adjacency {
    slots: Vec<[Slot; 6]>,
}

const STEPS: [IVec3; 6] = [IVec3::NEG_X, IVec3::X, IVec3::NEG_Y, IVec3::Y, IVec3::NEG_Z, IVec3::Z];

/// One bit a voxel of a brick: plane z, bit x + 8 y.
type Bits = [u64; 8];

/// The voxels x = 0 of a plane.
const COLUMN: u64 = 0x0101_0101_0101_0101;

impl Adjacency {
    pub(super) fn new(bricks: &Bricks) -> Self {
        Self { slots: bricks.active().par_iter().map(|&b| STEPS.map(|step| bricks.slot(b + step))).collect() }
    }

    /// Values of the neighbours of voxel `n` of active brick `brick`, in the order -x, +x, -y, +y,
    /// -z, +z.
    #[inline]
    pub(super) fn values(&self, grid: &Grid<f32>, brick: usize, n: usize) -> [f32; 6] {
        let own = &grid.values[brick];
        let mut values = [0.0; 6];
        for axis in 0..3 {
            let (shift, at) = (3 * axis, n >> (3 * axis) & 7);
            let (low, high) = (2 * axis, 2 * axis + 1);
            values[low] = if at > 0 { own[n - (1 << shift)] } else { self.across(grid, brick, low, n + (7 << shift)) };
            values[high] =
                if at < 7 { own[n + (1 << shift)] } else { self.across(grid, brick, high, n - (7 << shift)) };
        }
        values
    }

    fn across(&self, grid: &Grid<f32>, brick: usize, side: usize, n: usize) -> f32 {
        match self.slots[brick][side] {
            Slot::Active(other) => grid.values[other as usize][n],
            Slot::Inside => grid.inside,
            Slot::Outside => grid.outside,
        }
    }

    /// The six neighbours of voxel `n`, as (active brick, number in it); `None` for those in
    /// inactive bricks.
    pub(super) fn voxels(&self, brick: usize, n: usize) -> [Option<(usize, usize)>; 6] {
        std::array::from_fn(|side| {
            let (shift, at) = (3 * (side / 2), n >> (3 * (side / 2)) & 7);
            let up = side % 2 == 1;
            match (up, at) {
                (true, 7) => self.active(brick, side).map(|other| (other, n - (7 << shift))),
                (false, 0) => self.active(brick, side).map(|other| (other, n + (7 << shift))),
                (true, _) => Some((brick, n + (1 << shift))),
                (false, _) => Some((brick, n - (1 << shift))),
            }
        })
    }

    fn active(&self, brick: usize, side: usize) -> Option<usize> {
        match self.slots[brick][side] {
            Slot::Active(other) => Some(other as usize),
            _ => None,
        }
    }

    /// For each active brick, the voxels that have a neighbour of the other sign, in order.
    pub(super) fn transition(&self, grid: &Grid<f32>) -> Vec<Vec<u16>> {
        let bits: Vec<Bits> = grid.values.par_iter().map(|values| negative(values)).collect();
        (0..bits.len()).into_par_iter().map(|brick| listed(&self.differing(&bits, brick))).collect()
    }

    fn differing(&self, bits: &[Bits], brick: usize) -> Bits {
        let own = &bits[brick];
        let side = |side: usize| match self.slots[brick][side] {
            Slot::Active(other) => bits[other as usize],
            Slot::Inside => [u64::MAX; 8],
            Slot::Outside => [0; 8],
        };
        let [left, right, front, back, below, above] = std::array::from_fn(side);
        std::array::from_fn(|z| {
            let plane = own[z];
            let before_x = (plane << 1) & !COLUMN | (left[z] >> 7) & COLUMN;
            let after_x = (plane >> 1) & !(COLUMN << 7) | (right[z] & COLUMN) << 7;
            let before_y = plane << 8 | front[z] >> 56;
            let after_y = plane >> 8 | back[z] << 56;
            let before_z = if z > 0 { own[z - 1] } else { below[7] };
            let after_z = if z < 7 { own[z + 1] } else { above[0] };
            let around = [before_x, after_x, before_y, after_y, before_z, after_z];
            around.into_iter().fold(0, |differs, other| differs | (other ^ plane))
        })
    }
}

fn negative(values: &[f32]) -> Bits {
    let plane = |z: usize| {
        let values = &values[64 * z..64 * z + 64];
        values.iter().enumerate().fold(0u64, |bits, (n, &v)| bits | ((v < 0.0) as u64) << n)
    };
    std::array::from_fn(plane)
}

fn listed(bits: &Bits) -> Vec<u16> {
    let count = bits.iter().map(|plane| plane.count_ones()).sum::<u32>();
    let mut list = Vec::with_capacity(count as usize);
    for (z, &plane) in bits.iter().enumerate() {
        let mut rest = plane;
        while rest != 0 {
            list.push(64 * z as u16 + rest.trailing_zeros() as u16);
            rest &= rest - 1;
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn the_transition_is_where_a_neighbour_differs() {
        let bricks = Arc::new(Bricks::new((0..8).map(|n| IVec3::new(n & 1, n >> 1 & 1, n >> 2))));
        let mut grid = Grid::filled(bricks.clone(), 1.0f32, -1.0, 1.0);
        for (values, &brick) in grid.values.iter_mut().zip(bricks.active()) {
            for (n, value) in values.iter_mut().enumerate() {
                let p = brick * 8 + crate::lattice::voxel_in_brick(n);
                if (p.as_vec3() - 7.6).length() < 4.3 || p.x % 5 == 0 {
                    *value = -1.0;
                }
            }
        }
        let adjacency = Adjacency::new(&bricks);
        let lists = adjacency.transition(&grid);
        for (brick, list) in lists.iter().enumerate() {
            let slow: Vec<u16> = (0..512u16)
                .filter(|&n| {
                    let value = grid.values[brick][n as usize];
                    adjacency.values(&grid, brick, n as usize).iter().any(|v| (*v < 0.0) != (value < 0.0))
                })
                .collect();
            assert_eq!(*list, slow, "brick {brick}");
        }
    }
}
