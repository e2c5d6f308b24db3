//! Second-order fast marching (Sethian 1999; Bærentzen 2001), from the transition region outwards.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::IVec3;

use super::smooth::FAR;
use crate::lattice::{BRICK, Bricks, DistanceField, Grid, Lattice, Slot, brick_of, index_in_brick, voxel_in_brick};
use crate::progress::{Progress, Stopped};

/// A voxel on the front; the heap gives the nearest first, ties in lattice order.
#[derive(PartialEq)]
struct Front {
    distance: f32,
    voxel: IVec3,
}

impl Eq for Front {}

impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |f: &Self| (f.voxel.z, f.voxel.y, f.voxel.x);
        other.distance.total_cmp(&self.distance).then_with(|| key(other).cmp(&key(self)))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Extends `near`, counted in voxels, of which the voxels with a neighbour of the other sign are right, to all voxels of its
/// lattice within `band` (voxels) of the surface. Voxels farther away get ±`band`.
pub fn march(near: &DistanceField, band: f32, progress: &Progress) -> Result<DistanceField, Stopped> {
    let (lattice, near) = (near.lattice, &near.grid);
    let band = band.max(FAR);
    let bricks = Arc::new(dilated(&near.bricks, (band / BRICK as f32).ceil() as i32, &lattice));
    let mut grid = Grid::filled(bricks.clone(), band, -band, band);
    for (values, &brick) in grid.values.iter_mut().zip(bricks.active()) {
        for (n, value) in values.iter_mut().enumerate() {
            *value = band.copysign(near.get(brick * BRICK + voxel_in_brick(n)));
        }
    }
    let mut state = Marching { done: Grid::filled(bricks, false, false, false), heap: BinaryHeap::new(), grid, band };
    state.start(near);
    let mut count = 0u32;
    while let Some(Front { distance, voxel }) = state.heap.pop() {
        count += 1;
        if count.is_multiple_of(1 << 14) {
            progress.check()?;
        }
        if state.done.get(voxel) || distance > state.grid.get(voxel).abs() {
            continue;
        }
        set(&mut state.done, voxel, true);
        for step in STEPS {
            state.relax(voxel + step);
        }
    }
    Ok(DistanceField::in_voxels(lattice, state.grid))
}

const STEPS: [IVec3; 6] = [IVec3::NEG_X, IVec3::X, IVec3::NEG_Y, IVec3::Y, IVec3::NEG_Z, IVec3::Z];

struct Marching {
    grid: Grid<f32>,
    done: Grid<bool>,
    heap: BinaryHeap<Front>,
    band: f32,
}

impl Marching {
    /// Takes over the transition region and puts its neighbours on the front.
    fn start(&mut self, near: &Grid<f32>) {
        let mut frozen = Vec::new();
        for (values, &brick) in near.values.iter().zip(near.bricks.active()) {
            for (n, &value) in values.iter().enumerate() {
                let voxel = brick * BRICK + voxel_in_brick(n);
                if STEPS.iter().any(|&step| (near.get(voxel + step) < 0.0) != (value < 0.0)) {
                    set(&mut self.grid, voxel, value);
                    set(&mut self.done, voxel, true);
                    frozen.push(voxel);
                }
            }
        }
        for voxel in frozen {
            for step in STEPS {
                self.relax(voxel + step);
            }
        }
    }

    /// Computes a voxel anew from its accepted neighbours.
    fn relax(&mut self, voxel: IVec3) {
        if !matches!(self.grid.bricks.slot(brick_of(voxel)), Slot::Active(_)) || self.done.get(voxel) {
            return;
        }
        let old = self.grid.get(voxel);
        let new = self.solve(voxel, old < 0.0);
        if new < old.abs() && new <= self.band {
            set(&mut self.grid, voxel, new.copysign(old));
            self.heap.push(Front { distance: new, voxel });
        }
    }

    /// Solves |∇d| = 1 with one-sided differences of second order where two accepted neighbours
    /// lie in line, of first order elsewhere.
    fn solve(&self, voxel: IVec3, inside: bool) -> f32 {
        let mut terms: [(f32, f32); 3] = [(0.0, f32::MAX); 3];
        for (axis, term) in terms.iter_mut().enumerate() {
            for step in [STEPS[2 * axis], STEPS[2 * axis + 1]] {
                let Some(one) = self.accepted(voxel + step, inside) else { continue };
                let two = self.accepted(voxel + step * 2, inside).filter(|&two| two <= one);
                // a (d - b)² with a = 9/4, b = (4 one - two) / 3, or a = 1, b = one
                let (a, b) = two.map_or((1.0, one), |two| (2.25, (4.0 * one - two) / 3.0));
                if b < term.1 {
                    *term = (a, b);
                }
            }
        }
        terms.sort_unstable_by(|p, q| p.1.total_cmp(&q.1));
        let (mut a, mut b, mut c) = (0.0f32, 0.0f32, -1.0f32);
        let mut best = f32::MAX;
        for (weight, value) in terms.into_iter().filter(|t| t.0 > 0.0) {
            if value >= best {
                break;
            }
            a += weight;
            b += weight * value;
            c += weight * value * value;
            let root = b * b - a * c;
            if root < 0.0 {
                break;
            }
            best = (b + root.sqrt()) / a;
        }
        best
    }

    /// Distance of an accepted voxel on the same side, or its negative on the other side.
    fn accepted(&self, voxel: IVec3, inside: bool) -> Option<f32> {
        self.done.get(voxel).then(|| self.grid.get(voxel)).map(|d| if inside { -d } else { d })
    }
}

fn set<T: Copy>(grid: &mut Grid<T>, voxel: IVec3, value: T) {
    if let Slot::Active(n) = grid.bricks.slot(brick_of(voxel)) {
        grid.values[n as usize][index_in_brick(voxel)] = value;
    }
}

/// The bricks within `reach` bricks of an active one that meet the lattice.
fn dilated(bricks: &Bricks, reach: i32, lattice: &Lattice) -> Bricks {
    let last = brick_of(lattice.dims - 1);
    let mut all: Vec<IVec3> = bricks.active().to_vec();
    for axis in 0..3 {
        // Cut to the lattice before anything is made: the band may be wider than the lattice.
        let along = |b: IVec3| b[axis].saturating_sub(reach).max(0)..=b[axis].saturating_add(reach).min(last[axis]);
        let moved = |mut b: IVec3, k: i32| {
            b[axis] = k;
            b
        };
        all = all.iter().flat_map(|&b| along(b).map(move |k| moved(b, k))).collect();
        all.sort_unstable_by_key(|b| b.to_array());
        all.dedup();
    }
    Bricks::with_classes(all, |brick| bricks.slot(brick + IVec3::X) == Slot::Inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_band_wider_than_the_lattice_takes_its_bricks_and_no_more() {
        let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: IVec3::new(20, 16, 9) };
        let bricks = Bricks::new([IVec3::new(1, 0, 1), IVec3::new(-1, 0, 0)]);
        assert_eq!(dilated(&bricks, i32::MAX, &lattice).len(), 3 * 2 * 2);
        assert_eq!(dilated(&bricks, 1, &lattice).len(), 3 * 2 * 2);
        assert_eq!(dilated(&bricks, 0, &lattice).active(), [IVec3::new(1, 0, 1)]);
    }
}
