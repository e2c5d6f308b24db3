//! A field over a lattice, where its values are near zero.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::IVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{Ball, Field, Range};
use crate::lattice::{
    BRICK, BRICK_VOXELS, Bricks, DistanceField, Grid, Lattice, Slot, brick_of, index_in_brick, voxel_in_brick,
};
use crate::progress::{Progress, Stopped};

/// Bricks along a side of the blocks with which the search begins.
const FIRST: i32 = 8;
/// Voxels along a side of the smallest blocks that are left out.
const LEAST: i32 = 2;
/// Bytes of a stored brick: its values, and as much while they are put in order.
const BRICK_BYTES: u64 = 2 * 4 * BRICK_VOXELS as u64;

/// Options of [`fill`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FillOptions {
    /// Values up to this far from zero are found, model units; `None`: all.
    pub band: Option<f64>,
    /// Upper bound for the memory of the result, bytes; `None`: no bound.
    pub max_memory: Option<u64>,
}

/// Why a field cannot be filled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FillError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// More memory would be needed than allowed.
    #[error("about {} MB would be needed and {} MB are allowed: use a larger voxel, or a narrower band",
        needed / 1_000_000, allowed / 1_000_000)]
    Memory {
        /// For the bricks found, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
    },
}

/// The values of `field` at the voxels of `lattice`, in model units. Values beyond the band are ± the band in stored
/// bricks, and the bricks without any other value are not stored but have their side. Blocks of voxels are halved until
/// the field's range says that none of their values is in the band, so that time and memory follow the surface.
///
/// # Errors
/// See [`FillError`].
pub fn fill(
    field: &dyn Field,
    lattice: &Lattice,
    options: &FillOptions,
    progress: &Progress,
) -> Result<DistanceField, FillError> {
    let scope = Scope { field, lattice, band: options.band.unwrap_or(f64::INFINITY), progress };
    let found = scope.bricks()?;
    let needed = found.active.len() as u64 * BRICK_BYTES;
    if let Some(allowed) = options.max_memory.filter(|&allowed| needed > allowed) {
        return Err(FillError::Memory { needed, allowed });
    }
    let bricks = Arc::new(found.classified());
    let (done, all) = (AtomicUsize::new(0), bricks.active().len());
    let values = bricks.active().par_iter().map(|&brick| {
        progress.check()?;
        let values = scope.brick(brick);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(BETWEEN_SHARES) {
            progress.share(FILLED * done as f32 / all as f32);
        }
        Ok(values)
    });
    let values = values.collect::<Result<Vec<_>, Stopped>>()?;
    let far = if scope.band.is_finite() { scope.band as f32 } else { f32::INFINITY };
    Ok(DistanceField::in_model_units(*lattice, Grid { bricks, values, inside: -far, outside: far }))
}

/// The values are about this share of what a stage does with them, and it is told after so many bricks.
const FILLED: f32 = 0.6;
const BETWEEN_SHARES: usize = 32;

struct Scope<'a> {
    field: &'a dyn Field,
    lattice: &'a Lattice,
    band: f64,
    progress: &'a Progress,
}

/// The bricks that are stored, and blocks of bricks that lie inside.
#[derive(Default)]
struct Found {
    active: Vec<IVec3>,
    /// First brick, and bricks along a side.
    inside: Vec<(IVec3, i32)>,
}

impl Scope<'_> {
    fn bricks(&self) -> Result<Found, Stopped> {
        let end = brick_of(self.lattice.dims - 1) + 1;
        let counts = (end + FIRST - 1) / FIRST;
        let block = |n: i32| IVec3::new(n % counts.x, n / counts.x % counts.y, n / counts.x / counts.y) * FIRST;
        let parts = (0..counts.element_product()).into_par_iter().map(|n| {
            self.progress.check()?;
            let mut found = Found::default();
            self.search(block(n), FIRST, end, &mut found);
            Ok(found)
        });
        let parts = parts.collect::<Result<Vec<_>, Stopped>>()?;
        Ok(parts.into_iter().fold(Found::default(), |mut all, part| {
            all.active.extend(part.active);
            all.inside.extend(part.inside);
            all
        }))
    }

    fn search(&self, first: IVec3, size: i32, end: IVec3, found: &mut Found) {
        if first.cmpge(end).any() {
            return;
        }
        let range = self.range(first * BRICK, size * BRICK);
        if range.max < -self.band {
            found.inside.push((first, size));
        } else if range.min > self.band {
        } else if size == 1 {
            found.active.push(first);
        } else {
            let half = size / 2;
            for k in 0..8 {
                self.search(first + IVec3::new(k & 1, k >> 1 & 1, k >> 2) * half, half, end, found);
            }
        }
    }

    /// The values at the voxels of a block.
    fn range(&self, first: IVec3, size: i32) -> Range {
        let half = f64::from(size - 1) / 2.0;
        let centre = self.lattice.to_model(first.as_dvec3() + half);
        self.field.range(&Ball { centre, radius: half * 3f64.sqrt() * self.lattice.h })
    }

    fn brick(&self, brick: IVec3) -> [f32; BRICK_VOXELS] {
        let mut values = [0.0; BRICK_VOXELS];
        let (mut points, mut found) = (Vec::with_capacity(8), [0.0; (LEAST * LEAST * LEAST) as usize]);
        for block in 0..64 {
            let first = BRICK * brick + IVec3::new(block & 3, block >> 2 & 3, block >> 4) * LEAST;
            let range = self.range(first, LEAST);
            let far =
                if range.max < -self.band { Some(-self.band) } else { (range.min > self.band).then_some(self.band) };
            points.clear();
            points.extend(voxels(first).map(|voxel| self.lattice.to_model(voxel.as_dvec3())));
            match far {
                Some(far) => found.fill(far),
                None => self.field.values(&points, &mut found),
            }
            for (voxel, value) in voxels(first).zip(found) {
                values[index_in_brick(voxel)] = value.clamp(-self.band, self.band) as f32;
            }
        }
        values
    }
}

/// The voxels of one of the smallest blocks.
fn voxels(first: IVec3) -> impl Iterator<Item = IVec3> {
    (0..LEAST * LEAST * LEAST).map(move |n| first + IVec3::new(n & 1, n >> 1 & 1, n >> 2))
}

impl Found {
    /// The stored bricks, and the class of the others: those that follow a stored one along x have the class of the
    /// block that begins there; those before any are set one by one.
    fn classified(self) -> Bricks {
        let rows =
            |&(first, size): &(IVec3, i32)| (0..size * size).map(move |n| first + IVec3::new(0, n % size, n / size));
        let begins: FxHashSet<IVec3> = self.inside.iter().flat_map(rows).collect();
        let mut bricks = Bricks::with_classes(self.active, |brick| begins.contains(&(brick + IVec3::X)));
        for (first, size) in self.inside {
            for row in rows(&(first, size)) {
                if bricks.slot(row) == Slot::Outside {
                    (0..size).for_each(|x| bricks.set_inside(row + IVec3::X * x));
                }
            }
        }
        bricks
    }
}

/// Whether a voxel on the border of the lattice is inside: what lies beyond it is cut off.
pub(super) fn touches_border(field: &DistanceField) -> bool {
    let (grid, last) = (&field.grid, field.lattice.dims - 1);
    let on_border = |voxel: IVec3| voxel.cmpeq(IVec3::ZERO).any() || voxel.cmpeq(last).any();
    let bricks = IVec3::ZERO;
    let end = brick_of(last);
    let mut faces = (bricks.z..=end.z).flat_map(|z| (bricks.y..=end.y).map(move |y| (y, z))).flat_map(|(y, z)| {
        let inner = y > 0 && y < end.y && z > 0 && z < end.z;
        let xs = if inner { vec![0, end.x] } else { (0..=end.x).collect() };
        xs.into_iter().map(move |x| IVec3::new(x, y, z))
    });
    faces.any(|brick| match grid.bricks.slot(brick) {
        Slot::Inside => true,
        Slot::Outside => false,
        Slot::Active(n) => (0..BRICK_VOXELS).any(|k| {
            let voxel = BRICK * brick + voxel_in_brick(k);
            on_border(voxel) && voxel.cmple(last).all() && grid.values[n as usize][k] < 0.0
        }),
    })
}
