//! A field known at the voxels of a lattice, and what is made of it there: blurring, coarser sampling.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::{Ball, Extent, Field, Range, Sample};
use crate::io::{GridFile, GridValues, SparseValues};
use crate::lattice::{
    BRICK, BRICK_VOXELS, Bricks, DistanceField, Grid, Lattice, Slot, brick_of, index_in_brick, voxel_in_brick,
};
use crate::mesh::Bounds;
use crate::progress::{Progress, Stopped};

/// Bricks that a ball may meet, along an axis, for its range to be looked up in each; larger ones are bounded by the Lipschitz bound.
const MOST_BRICKS: i32 = 6;

/// Voxels along a side of a brick with those next to it.
const SIDE: i32 = BRICK + 1;

/// A field by its values at the voxels of a lattice, interpolated linearly along each axis. Beyond the lattice it is what it
/// is at the nearest point of it, and grows with the distance from there.
pub struct Sampled {
    /// Its values, in model units.
    field: DistanceField,
    /// For each stored brick the range of its values and those next to it.
    ranges: Vec<Range>,
    all: Range,
    lipschitz: f64,
    extent: Extent,
}

impl Sampled {
    /// The field that has these values at the voxels of their lattice.
    pub fn new(field: DistanceField) -> Self {
        let field = field.into_model_units();
        let mut sampled = Self { ranges: Vec::new(), all: Range::ALL, lipschitz: 0.0, extent: Extent::Empty, field };
        let parts: Vec<(Range, f32, Option<Bounds>)> =
            sampled.field.grid.bricks.active().par_iter().map(|&brick| sampled.describe(brick)).collect();
        let far = |values: &[f32]| Range::of(values.iter().filter(|v| v.is_finite()).map(|&v| f64::from(v)));
        sampled.all = parts
            .iter()
            .fold(far(&[sampled.field.grid.inside, sampled.field.grid.outside]), |all, part| all.or(part.0));
        // Along each axis the interpolated field is as steep as the steepest pair of voxels; beyond the lattice it rises by 1 besides.
        let steepest = parts.iter().fold(0.0, |most, part| f32::max(most, part.1));
        sampled.lipschitz = (f64::from(steepest) / sampled.field.lattice.h * 3f64.sqrt()).hypot(1.0);
        let boxes = parts.iter().filter_map(|part| part.2).reduce(|a, b| a.union(&b));
        sampled.extent = Extent::of(boxes);
        sampled.ranges = parts.into_iter().map(|part| part.0).collect();
        sampled
    }

    /// The field of a file, all its lengths times `factor`.
    pub fn of_file(file: &GridFile, factor: f64) -> Self {
        let lattice = file.lattice();
        let lattice = Lattice { origin: lattice.origin * factor, h: lattice.h * factor, ..lattice };
        let grid = match &file.values {
            GridValues::Dense(values) => dense(values, lattice.dims),
            GridValues::Sparse(values) => sparse(values),
        };
        let mut field = DistanceField::in_model_units(lattice, grid);
        field.change(|value| (f64::from(value) * factor) as f32);
        Self::new(field)
    }

    /// Bytes of memory that the field of a file takes, beside the file's own values.
    pub fn memory_of_file(file: &GridFile) -> u64 {
        let bricks = match &file.values {
            GridValues::Dense(_) => {
                file.dims.iter().fold(1u64, |all, &count| all.saturating_mul((count as u64).div_ceil(BRICK as u64)))
            }
            GridValues::Sparse(values) => values.blocks.len() as u64,
        };
        bricks.saturating_mul(Self::BYTES_OF_BRICK)
    }

    /// Bytes of memory that the field takes.
    pub fn memory(&self) -> u64 {
        self.field.grid.bricks.len() as u64 * Self::BYTES_OF_BRICK
    }

    /// Of a brick: its values, its range, its place in the table and twice in lists.
    const BYTES_OF_BRICK: u64 = (size_of::<[f32; BRICK_VOXELS]>() + size_of::<Range>() + 64) as u64;

    /// The values, in model units.
    pub fn values(&self) -> &DistanceField {
        &self.field
    }

    /// The range of a brick with the voxels beyond its upper sides, its steepest step, and where it is not positive.
    fn describe(&self, brick: IVec3) -> (Range, f32, Option<Bounds>) {
        let (mut range, mut steepest) = (Range::of([]), 0.0f32);
        let (mut low, mut high) = (IVec3::MAX, IVec3::MIN);
        let last = (self.field.lattice.dims - 1 - BRICK * brick).min(IVec3::splat(BRICK));
        let values = self.with_neighbours(brick);
        let value = |at: IVec3| values[(at.x + SIDE * (at.y + SIDE * at.z)) as usize];
        for n in 0..SIDE.pow(3) {
            let at = IVec3::new(n % SIDE, n / SIDE % SIDE, n / SIDE.pow(2));
            if at.cmpgt(last).any() {
                continue;
            }
            let own = value(at);
            range = range.or(Range::of([f64::from(own)]));
            if own <= 0.0 {
                (low, high) = (low.min(BRICK * brick + at), high.max(BRICK * brick + at));
            }
            for axis in (0..3).filter(|&axis| at[axis] < last[axis]) {
                steepest = steepest.max((value(at + IVec3::AXES[axis]) - own).abs());
            }
        }
        let model = |voxel: IVec3| self.field.lattice.to_model(voxel.as_dvec3());
        (range, steepest, low.cmple(high).all().then(|| Bounds { min: model(low - 1), max: model(high + 1) }))
    }

    /// The values of a brick and of the voxels beyond its upper sides.
    fn with_neighbours(&self, brick: IVec3) -> Vec<f32> {
        let slots: [Slot; 8] = std::array::from_fn(|k| {
            self.field.grid.bricks.slot(brick + (IVec3::splat(k as i32) >> IVec3::new(0, 1, 2) & 1))
        });
        let value = |n: i32| {
            let at = IVec3::new(n % SIDE, n / SIDE % SIDE, n / SIDE.pow(2));
            let [x, y, z] = (at / BRICK).to_array();
            match slots[(x + 2 * y + 4 * z) as usize] {
                Slot::Active(n) => self.field.grid.values[n as usize][index_in_brick(at)],
                Slot::Inside => self.field.grid.inside,
                Slot::Outside => self.field.grid.outside,
            }
        };
        (0..SIDE.pow(3)).map(value).collect()
    }

    fn at(&self, p: DVec3) -> Sample {
        let DistanceField { lattice, grid, .. } = &self.field;
        let own = lattice.to_lattice(p);
        let within = lattice.interpolate(own, |voxel| f64::from(grid.get(voxel)));
        let inside = Sample { value: within.value, gradient: within.slope / lattice.h };
        let beyond = own - lattice.nearest(own);
        if beyond == DVec3::ZERO {
            return inside;
        }
        let along = DVec3::select(beyond.cmpeq(DVec3::ZERO), inside.gradient, DVec3::ZERO);
        Sample { value: inside.value + beyond.length() * lattice.h, gradient: along + beyond.normalize() }
    }
}

impl Field for Sampled {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        values.iter_mut().zip(points).for_each(|(value, &p)| *value = self.at(p).value);
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        samples.iter_mut().zip(points).for_each(|(sample, &p)| *sample = self.at(p));
    }

    fn range(&self, ball: &Ball) -> Range {
        let by_bound = Range::around(self.at(ball.centre).value, self.lipschitz * ball.radius);
        let reach = DVec3::splat(ball.radius);
        let [low, high] = [ball.centre - reach, ball.centre + reach].map(|p| self.field.lattice.to_lattice(p));
        let last = (self.field.lattice.dims - 1).as_dvec3();
        let whole = low.cmpge(DVec3::ZERO).all() && high.cmple(last).all();
        let (low, high) = (brick_of(low.floor().as_ivec3()), brick_of(high.floor().as_ivec3()));
        if !whole || (high - low).max_element() >= MOST_BRICKS {
            return by_bound.and(if whole { self.all } else { Range { max: f64::INFINITY, ..self.all } });
        }
        let mut range = Range::of([]);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    range = range.or(self.of_brick(IVec3::new(x, y, z)));
                }
            }
        }
        by_bound.and(range)
    }

    fn lipschitz(&self) -> f64 {
        self.lipschitz
    }

    fn extent(&self) -> Extent {
        self.extent
    }
}

impl Sampled {
    /// The range of the values between the voxels of a brick and the next ones.
    fn of_brick(&self, brick: IVec3) -> Range {
        match self.field.grid.bricks.slot(brick) {
            Slot::Active(n) => self.ranges[n as usize],
            // Its upper neighbours may be stored; neighbouring values are on the same side.
            Slot::Inside => Range { min: self.all.min, max: 0.0 },
            Slot::Outside => Range { min: 0.0, max: self.all.max },
        }
    }
}

/// Reach of the Gaussian, in standard deviations: what lies beyond has a part of 5e-4 of it.
const REACH: f64 = 3.5;

/// How far from the surface a field must be known, model units, for [`blurred`] to be right at its zero level.
pub fn blur_band(sigma: f64) -> f64 {
    2.0 * REACH * sigma
}

/// The values of `field` under a Gaussian of standard deviation `sigma`, model units (Payne and Toga 1992,
/// "Surface blurring and compression"), one axis after the other, in the stored bricks. With values up to
/// [`blur_band`] from the surface the zero level is that of the whole field blurred.
pub fn blurred(field: &DistanceField, sigma: f64, progress: &Progress) -> Result<DistanceField, Stopped> {
    let weights = gaussian(sigma / field.lattice.h);
    let mut blurred = field.grid.clone();
    for axis in 0..3 {
        let from = blurred;
        let values = from.bricks.active().par_iter().map(|&brick| {
            progress.check()?;
            Ok(along(&from, brick, axis, &weights))
        });
        let values = values.collect::<Result<Vec<_>, Stopped>>()?;
        blurred = Grid { bricks: from.bricks, values, inside: from.inside, outside: from.outside };
    }
    Ok(DistanceField { grid: blurred, ..*field })
}

/// The weights of the voxels from −n to n, which add up to 1.
fn gaussian(sigma: f64) -> Vec<f32> {
    let reach = (REACH * sigma).ceil() as i32;
    let weight = |k: i32| (-0.5 * (f64::from(k) / sigma).powi(2)).exp();
    let sum: f64 = (-reach..=reach).map(weight).sum();
    (-reach..=reach).map(|k| (weight(k) / sum) as f32).collect()
}

/// One brick, blurred along one axis.
fn along(grid: &Grid<f32>, brick: IVec3, axis: usize, weights: &[f32]) -> [f32; BRICK_VOXELS] {
    let reach = (weights.len() / 2) as i32;
    let step = [1, BRICK as usize, (BRICK * BRICK) as usize];
    let [u, v] = [step[(axis + 1) % 3], step[(axis + 2) % 3]];
    let mut values = [0.0; BRICK_VOXELS];
    // The bricks that the kernel reaches, once for all rows.
    let around = (reach + BRICK - 1) / BRICK;
    let slots: Vec<Slot> = (-around..=around).map(|k| grid.bricks.slot(brick + IVec3::AXES[axis] * k)).collect();
    let mut row = vec![0.0f32; ((2 * around + 1) * BRICK) as usize];
    for n in 0..BRICK as usize * BRICK as usize {
        let start = n % BRICK as usize * u + n / BRICK as usize * v;
        for (slot, part) in slots.iter().zip(row.chunks_exact_mut(BRICK as usize)) {
            match slot {
                Slot::Active(brick) => {
                    let of = &grid.values[*brick as usize];
                    part.iter_mut().enumerate().for_each(|(k, value)| *value = of[start + k * step[axis]]);
                }
                Slot::Inside => part.fill(grid.inside),
                Slot::Outside => part.fill(grid.outside),
            }
        }
        for k in 0..BRICK as usize {
            let first = (around * BRICK - reach) as usize + k;
            let sum = row[first..].iter().zip(weights).map(|(value, weight)| value * weight).sum();
            values[start + k * step[axis]] = sum;
        }
    }
    values
}

/// A grid from blocks; what lies between them has the sign of its tile, and the value of the background.
fn sparse(values: &SparseValues) -> Grid<f32> {
    let far = values.background.abs();
    let inside = |brick: IVec3| values.at(brick * BRICK) < 0.0;
    let stored = values.blocks.iter().map(|block| block.corner / BRICK);
    let bricks = Bricks::with_classes(stored, |brick| inside(brick + IVec3::X));
    // The blocks are sorted as the bricks are.
    let values = values.blocks.iter().map(|block| *block.values).collect();
    Grid { bricks: Arc::new(bricks), values, inside: -far, outside: far }
}

/// A grid from the values of all voxels of a lattice, x fastest, then y.
fn dense(values: &[f32], dims: IVec3) -> Grid<f32> {
    let ends = (dims + BRICK - 1) / BRICK;
    let brick = |n: i32| IVec3::new(n % ends.x, n / ends.x % ends.y, n / ends.x / ends.y);
    let bricks = Bricks::new((0..ends.element_product()).map(brick));
    let of = |&brick: &IVec3| {
        std::array::from_fn(|n| {
            // Voxels of the last bricks beyond the lattice repeat its border.
            let voxel = (BRICK * brick + voxel_in_brick(n)).min(dims - 1);
            let [x, y, z] = voxel.to_array().map(|k| k as usize);
            let [width, height, _] = dims.to_array().map(|k| k as usize);
            values.get(x + width * (y + height * z)).copied().unwrap_or(f32::INFINITY)
        })
    };
    let values = bricks.active().par_iter().map(of).collect();
    Grid { bricks: Arc::new(bricks), values, inside: f32::NEG_INFINITY, outside: f32::INFINITY }
}
