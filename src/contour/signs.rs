//! The signs as bits: eight planes of 64 voxels a brick, and the bricks whose cells can be mixed.

use glam::IVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::lattice::{BRICK, BRICK_VOXELS, Grid, Lattice, Slot};

/// One plane for each z of a brick; bit `x + 8 y` is set where the voxel is inside.
pub(super) type Planes = [u64; BRICK as usize];

/// The first column (x = 0) of a plane.
const COLUMN: u64 = 0x0101_0101_0101_0101;
/// The first row (y = 0) of a plane.
const ROW: u64 = 0xff;

/// A brick as its neighbours see it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Neighbour {
    /// Number in the list of visited bricks.
    Visited(u32),
    /// Not visited; all voxels have this sign (true: inside).
    Uniform(bool),
}

/// One brick whose cells and edges are visited.
#[derive(Debug, Clone)]
pub(super) struct Brick {
    /// Coordinates, in bricks.
    pub at: IVec3,
    /// Where its distances are.
    pub slot: Slot,
    /// Itself and its upper neighbours; bits x, y, z of the index say where.
    pub around: [Neighbour; 8],
}

/// The signs of all bricks that own a cell with corners of both signs.
#[derive(Debug)]
pub(super) struct Signs {
    /// Visited bricks, sorted by (z, y, x).
    pub bricks: Vec<Brick>,
    planes: Vec<Planes>,
}

impl Signs {
    /// Reads the signs of the active bricks, and adds inactive bricks that own a mixed cell: those
    /// whose cells reach up into an active brick where that has the other sign.
    pub fn new(lattice: &Lattice, distance: &Grid<f32>) -> Self {
        let active = distance.bricks.active();
        let mut planes: Vec<Planes> =
            active.par_iter().zip(&distance.values).map(|(&b, values)| active_planes(lattice, b, values)).collect();
        let mut at: Vec<IVec3> = active.to_vec();
        let extra = lower_neighbours(lattice, distance, &planes);
        if !extra.is_empty() {
            let mut all: Vec<(IVec3, Planes)> = at.into_iter().zip(planes).collect();
            all.extend(extra.into_iter().map(|(b, inside)| (b, [if inside { u64::MAX } else { 0 }; 8])));
            all.sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
            (at, planes) = all.into_iter().unzip();
        }
        let numbers: FxHashMap<IVec3, u32> = at.iter().zip(0u32..).map(|(&b, n)| (b, n)).collect();
        let bricks = at
            .par_iter()
            .map(|&at| Brick {
                at,
                slot: distance.bricks.slot(at),
                around: std::array::from_fn(|k| {
                    let b = at + offset(k);
                    match numbers.get(&b) {
                        Some(&n) => Neighbour::Visited(n),
                        None => Neighbour::Uniform(uniform_sign(lattice, distance.bricks.slot(b), b)),
                    }
                }),
            })
            .collect();
        Self { bricks, planes }
    }

    /// The signs of a neighbour.
    #[inline]
    pub fn planes(&self, neighbour: Neighbour) -> &Planes {
        match neighbour {
            Neighbour::Visited(n) => &self.planes[n as usize],
            Neighbour::Uniform(true) => &[u64::MAX; 8],
            Neighbour::Uniform(false) => &[0; 8],
        }
    }

    /// The signs at the voxels of `brick` moved up by one along the axes of the bits of `k`.
    pub fn shifted(&self, brick: &Brick, k: usize) -> Planes {
        std::array::from_fn(|z| self.shifted_plane(brick, k & 3, z + (k >> 2)))
    }

    /// The plane at height `z` (0 to 8), moved up along x and y by the bits of `k`.
    pub fn shifted_plane(&self, brick: &Brick, k: usize, z: usize) -> u64 {
        let (up, z) = (z >> 3 << 2, z & 7);
        let plane = |k: usize| self.planes(brick.around[k | up])[z];
        let along_x = |p: u64, next: u64| (p >> 1) & !(COLUMN << 7) | (next & COLUMN) << 7;
        let along_y = |p: u64, next: u64| (p >> 8) | (next & ROW) << 56;
        match k {
            0 => plane(0),
            1 => along_x(plane(0), plane(1)),
            2 => along_y(plane(0), plane(2)),
            _ => along_y(along_x(plane(0), plane(1)), along_x(plane(2), plane(3))),
        }
    }
}

/// The step of the bits of `k`.
pub(super) fn offset(k: usize) -> IVec3 {
    IVec3::new(k as i32 & 1, k as i32 >> 1 & 1, k as i32 >> 2 & 1)
}

fn active_planes(lattice: &Lattice, brick: IVec3, values: &[f32; BRICK_VOXELS]) -> Planes {
    let mut planes = [0; 8];
    for (plane, values) in planes.iter_mut().zip(values.chunks_exact(64)) {
        for (k, &d) in values.iter().enumerate() {
            *plane |= u64::from(d < 0.0) << k;
        }
    }
    let low = brick * BRICK;
    if low.cmplt(IVec3::ZERO).any() || (low + BRICK).cmpgt(lattice.dims).any() {
        clip(lattice, low, &mut planes);
    }
    planes
}

/// Clears the voxels outside the lattice.
fn clip(lattice: &Lattice, low: IVec3, planes: &mut Planes) {
    for (z, plane) in planes.iter_mut().enumerate() {
        for k in 0..64 {
            let v = low + IVec3::new(k & 7, k >> 3, z as i32);
            if v.cmplt(IVec3::ZERO).any() || v.cmpge(lattice.dims).any() {
                *plane &= !(1 << k);
            }
        }
    }
}

/// The sign of an inactive brick; outside the lattice everything is outside.
fn uniform_sign(lattice: &Lattice, slot: Slot, brick: IVec3) -> bool {
    let low = brick * BRICK;
    slot == Slot::Inside && low.cmpge(IVec3::ZERO).all() && low.cmplt(lattice.dims).all()
}

/// Inactive bricks below an active one (in any of the 7 directions) that see the other sign in it.
fn lower_neighbours(lattice: &Lattice, distance: &Grid<f32>, planes: &[Planes]) -> Vec<(IVec3, bool)> {
    let mut found: Vec<(IVec3, bool)> = distance
        .bricks
        .active()
        .par_iter()
        .zip(planes)
        .flat_map_iter(|(&at, planes)| {
            (1..8).filter_map(move |k| {
                let below = at - offset(k);
                let slot = distance.bricks.slot(below);
                if matches!(slot, Slot::Active(_)) {
                    return None;
                }
                let inside = uniform_sign(lattice, slot, below);
                let rim = [u64::MAX, COLUMN, ROW, COLUMN & ROW][k & 3];
                let heights = if k >> 2 == 1 { &planes[..1] } else { &planes[..] };
                let other = |plane: &u64| (if inside { !plane } else { *plane }) & rim != 0;
                heights.iter().any(other).then_some((below, inside))
            })
        })
        .collect();
    found.sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
    found.dedup();
    found
}

/// The lattice edges with ends of different sign that a brick owns (whose lower voxel it holds),
/// and their numbers within it: by voxel, then by axis.
#[derive(Debug, Clone, Default)]
pub(super) struct Crossed {
    /// For each axis, a bit per voxel: whether the edge from there is crossed.
    pub masks: [Planes; 3],
    before: [u16; 8],
    /// How many lattice edges are crossed.
    pub count: u32,
}

impl Crossed {
    /// Finds the crossed edges that a brick owns.
    pub fn new(signs: &Signs, brick: &Brick) -> Self {
        let own = signs.shifted(brick, 0);
        let masks = [1, 2, 4].map(|k| {
            let upper = signs.shifted(brick, k);
            std::array::from_fn(|z| own[z] ^ upper[z])
        });
        let mut crossed = Self { masks, ..Self::default() };
        for z in 0..8 {
            crossed.before[z] = crossed.count as u16;
            crossed.count += masks.iter().map(|m| m[z].count_ones()).sum::<u32>();
        }
        crossed
    }

    /// The number of the edge along `axis` from voxel `k` = `x + 8 y` of plane `z`.
    #[inline]
    pub fn number(&self, axis: usize, k: u32, z: usize) -> u32 {
        let below = (1u64 << k) - 1;
        let mut n = u32::from(self.before[z]);
        for (a, mask) in self.masks.iter().enumerate() {
            n += (mask[z] & below).count_ones();
            n += u32::from(a < axis) & (mask[z] >> k) as u32;
        }
        n
    }
}
