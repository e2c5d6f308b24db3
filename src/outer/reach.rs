//! Where a ball can come to from outside, on a lattice.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use crate::lattice::{BRICK, BRICK_VOXELS, Bricks, Lattice, Slot, brick_of, index_in_brick};
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stopped};
use crate::sdf::exact::{Band, Cost, ExactError, ExactOptions, Sign, cost, exact};

/// Voxels to a diameter.
const VOXELS: f64 = 8.0;

/// The most voxels along the longest side of the box.
const MOST_ALONG: f64 = 30_000.0;

/// How far a centre has to be from the surface, voxels: so far that of two neighbours on either side of a hole's plane both are only where the hole is wider than the
/// ball. The root of 4² + ½².
const CLEAR: f64 = 4.031_128_874_149_275;

/// So far from the surface, voxels, is a chamber somewhere: what is as wide throughout hangs together on the lattice, whichever way it runs.
const DEEP: f64 = CLEAR + 0.87;

/// Voxels in the column of a slice of a brick where x is 0, and where it is 7.
const FIRST: u64 = 0x0101_0101_0101_0101;
const LAST: u64 = FIRST << 7;

/// A bit for each voxel of a brick: one number a slice, x fastest.
type Bits = [u64; BRICK as usize];

/// Where a ball is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sight {
    /// There is no room for it.
    Nowhere,
    /// In a space that it cannot leave.
    Chamber,
    /// Where it comes from far outside.
    Outside,
}

/// Why it cannot be known where a ball comes to.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReachError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There is no triangle.
    #[error("there is no triangle that a ball could touch")]
    Empty,
    /// The ball is no positive length, or too small against the model.
    #[error("a ball of {diameter} cannot be rolled around a model that is {longest} long: its diameter has to be at least {}", VOXELS * longest / MOST_ALONG)]
    Ball {
        /// The diameter, model units.
        diameter: f64,
        /// The longest side of the model's box.
        longest: f64,
    },
    /// The lattice would need more memory than allowed.
    #[error("a ball of {diameter} needs about {} MB, and {} MB are allowed: take a larger one", needed / 1_000_000, allowed / 1_000_000)]
    Memory {
        /// The diameter, model units.
        diameter: f64,
        /// Estimated peak, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
    },
}

/// Where the centre of a ball can be without the ball meeting a surface, on a lattice; and to which of these places it comes from far outside.
///
/// A step between two voxels is taken only where the whole ball passes: through no hole that is narrower than it. Through one that is wider by less than a quarter there may
/// be no way on the lattice; so what is no wider counts as no chamber either.
pub struct Reach {
    /// The lattice; eight voxels are as long as the ball.
    pub lattice: Lattice,
    /// Half of the diameter, model units.
    pub radius: f64,
    bricks: Arc<Bricks>,
    /// Of each active brick, where a centre can be.
    free: Vec<Bits>,
    outside: Marks,
    chambers: Marks,
    /// Bricks along x, y, z.
    dims: IVec3,
}

/// Some of the voxels of a lattice.
#[derive(Debug, Clone, Default)]
struct Marks {
    /// Of each active brick.
    near: Vec<Bits>,
    /// Of each brick of the lattice, whether it is not active and marked throughout.
    far: Vec<u64>,
}

impl Reach {
    /// Of a ball of this diameter around a mesh, model units. `max_memory`: bytes.
    ///
    /// # Errors
    /// See [`ReachError`].
    pub fn of(mesh: &TriMesh, diameter: f64, max_memory: Option<u64>, progress: &Progress) -> Result<Self, ReachError> {
        let (lattice, band, cost) = Self::plan(mesh, diameter)?;
        if let Some(allowed) = max_memory.filter(|&allowed| cost.memory > allowed) {
            return Err(ReachError::Memory { diameter, needed: cost.memory, allowed });
        }
        let options = ExactOptions { band: Band::Within(band), max_memory: None };
        let field = exact(mesh, &lattice, Sign::Pseudonormal, &options, progress).map_err(|error| match error {
            ExactError::Stopped(stopped) => ReachError::Stopped(stopped),
            ExactError::Empty => ReachError::Empty,
            _ => ReachError::Ball { diameter, longest: lattice.dims.max_element() as f64 * lattice.h },
        })?;
        let farther = |least: f64| -> Vec<Bits> {
            field.grid.values.par_iter().map(|values| bits(|n| f64::from(values[n].abs()) >= least)).collect()
        };
        let (free, deep) = (farther(CLEAR), farther(DEEP));
        let dims = brick_of(lattice.dims - 1) + 1;
        let words = dims.as_i64vec3().element_product() as usize / 64 + 1;
        let none = Marks { near: vec![Bits::default(); free.len()], far: vec![0; words] };
        let (mut outside, mut chambers) = (none.clone(), none);
        let bricks = field.grid.bricks.clone();
        let (radius, nothing) = (diameter / 2.0, Marks::default());
        let mut reach = Self { lattice, radius, bricks, free, dims, outside: nothing.clone(), chambers: nothing };
        let corner = std::array::from_fn(|z| u64::from(z == 0));
        reach.flood(&mut outside, vec![(IVec3::ZERO, corner)], progress)?;
        // Where a larger ball fits that the flood has not come to, and all that hangs together with it.
        let mut seeds = Vec::new();
        for (n, &brick) in reach.bricks.active().iter().enumerate() {
            seeds.push((brick, std::array::from_fn(|z| deep[n][z] & !outside.near[n][z])));
            for axis in IVec3::AXES {
                let beside =
                    [brick + axis, brick - axis].into_iter().filter(|&next| reach.is_far_and_new(&outside, next));
                seeds.extend(beside.map(|next| (next, [u64::MAX; 8])));
            }
        }
        reach.flood(&mut chambers, seeds, progress)?;
        (reach.outside, reach.chambers) = (outside, chambers);
        Ok(reach)
    }

    /// The lattice, the band in voxels, and what it would cost to fill it.
    ///
    /// # Errors
    /// [`ReachError::Empty`] and [`ReachError::Ball`].
    pub fn plan(mesh: &TriMesh, diameter: f64) -> Result<(Lattice, f64, Cost), ReachError> {
        let bounds = mesh.bounds().ok_or(ReachError::Empty)?;
        let longest = bounds.size().max_element();
        let h = diameter / VOXELS;
        if !(h > 0.0 && h.is_finite() && longest / h <= MOST_ALONG) {
            return Err(ReachError::Ball { diameter, longest });
        }
        // All around there is room for a centre.
        let margin = DVec3::splat((CLEAR + 2.0) * h);
        let bounds = Bounds { min: bounds.min - margin, max: bounds.max + margin };
        let dims = (bounds.size() / h).ceil().as_ivec3() + 1;
        let lattice = Lattice { origin: bounds.min, h, dims };
        let band = DEEP + 0.5;
        let cost = cost(mesh, &lattice, Band::Within(band));
        let bricks = (dims.as_dvec3() / f64::from(BRICK) + 1.0).element_product();
        Ok((lattice, band, Cost { memory: cost.memory + (bricks / 4.0) as u64 + cost.voxels / 2, ..cost }))
    }

    /// Marks what is joined to voxels of some bricks, over the sides of voxels where the centre can be.
    fn flood(&self, marks: &mut Marks, seeds: Vec<(IVec3, Bits)>, progress: &Progress) -> Result<(), Stopped> {
        let mut stack: Vec<IVec3> =
            seeds.into_iter().filter(|&(brick, bits)| self.enter(marks, brick, bits)).map(|seed| seed.0).collect();
        let mut steps = 0usize;
        while let Some(brick) = stack.pop() {
            steps += 1;
            if steps.is_multiple_of(4096) {
                progress.check()?;
            }
            let bits = match self.bricks.slot(brick) {
                Slot::Active(n) => filled(&mut marks.near[n as usize], &self.free[n as usize]),
                _ => [u64::MAX; 8],
            };
            for axis in 0..3 {
                for up in [false, true] {
                    let next = if up { brick + IVec3::AXES[axis] } else { brick - IVec3::AXES[axis] };
                    if self.enter(marks, next, across(&bits, axis, up)) {
                        stack.push(next);
                    }
                }
            }
        }
        Ok(())
    }

    /// Marks voxels of a brick where the centre can be; whether any is new.
    fn enter(&self, marks: &mut Marks, brick: IVec3, bits: Bits) -> bool {
        let Some(index) = self.index(brick).filter(|_| bits != Bits::default()) else { return false };
        match self.bricks.slot(brick) {
            Slot::Active(n) => {
                let (free, own) = (&self.free[n as usize], &mut marks.near[n as usize]);
                let before = *own;
                (0..8).for_each(|z| own[z] |= bits[z] & free[z]);
                *own != before
            }
            _ => {
                let (word, bit) = (index / 64, 1 << (index % 64));
                let is_new = marks.far[word] & bit == 0;
                marks.far[word] |= bit;
                is_new
            }
        }
    }

    /// Whether a brick is of the lattice, not active, and not marked.
    fn is_far_and_new(&self, marks: &Marks, brick: IVec3) -> bool {
        let is_far = !matches!(self.bricks.slot(brick), Slot::Active(_));
        is_far && self.index(brick).is_some_and(|index| marks.far[index / 64] >> (index % 64) & 1 == 0)
    }

    fn index(&self, brick: IVec3) -> Option<usize> {
        let within = brick.cmpge(IVec3::ZERO).all() && brick.cmplt(self.dims).all();
        let [x, y, z] = brick.to_array().map(|c| c as usize);
        within.then(|| x + self.dims.x as usize * (y + self.dims.y as usize * z))
    }

    /// What a voxel is for the centre of the ball.
    pub fn at(&self, voxel: IVec3) -> Sight {
        let brick = brick_of(voxel);
        let Some(index) = self.index(brick) else { return Sight::Outside };
        let is = |marks: &Marks| match self.bricks.slot(brick) {
            Slot::Active(n) => {
                let at = index_in_brick(voxel);
                marks.near[n as usize][at / 64] >> (at % 64) & 1 == 1
            }
            _ => marks.far[index / 64] >> (index % 64) & 1 == 1,
        };
        match (is(&self.outside), is(&self.chambers)) {
            (true, _) => Sight::Outside,
            (false, true) => Sight::Chamber,
            (false, false) => Sight::Nowhere,
        }
    }
}

/// The voxels of a brick for which something holds.
fn bits(holds: impl Fn(usize) -> bool) -> Bits {
    let mut bits = Bits::default();
    (0..BRICK_VOXELS).for_each(|n| bits[n / 64] |= u64::from(holds(n)) << (n % 64));
    bits
}

/// Marks all that hangs together with what is marked in a brick.
fn filled(marks: &mut Bits, free: &Bits) -> Bits {
    loop {
        let before = *marks;
        for z in 0..8 {
            let own = marks[z];
            let beside = (own << 1 & !FIRST) | (own >> 1 & !LAST) | own << 8 | own >> 8;
            let below = if z > 0 { marks[z - 1] } else { 0 };
            let above = if z < 7 { marks[z + 1] } else { 0 };
            marks[z] |= (beside | below | above) & free[z];
        }
        if *marks == before {
            return before;
        }
    }
}

/// What lies beside these voxels in the next brick along an axis, up or down.
fn across(bits: &Bits, axis: usize, up: bool) -> Bits {
    std::array::from_fn(|z| match (axis, up) {
        (0, true) => bits[z] >> 7 & FIRST,
        (0, false) => (bits[z] & FIRST) << 7,
        (1, true) => bits[z] >> 56,
        (1, false) => bits[z] << 56,
        (_, true) if z == 0 => bits[7],
        (_, false) if z == 7 => bits[0],
        _ => 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::cuboid;

    /// A box around a cube, with a square hole of some width in the middle of one of its sides.
    fn chest(width: f64) -> TriMesh {
        let mut mesh = cuboid(DVec3::splat(-2.0), DVec3::splat(2.0));
        mesh.triangles.retain(|t| !t.iter().all(|&v| mesh.positions[v as usize].z == 2.0));
        let square = |half: f64| [[-half, -half], [half, -half], [half, half], [-half, half]];
        let ring = [square(2.0), square(width / 2.0)].concat();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(ring.into_iter().map(|[x, y]| DVec3::new(x, y, 2.0)));
        for k in 0..4 {
            let next = (k + 1) % 4;
            let quad = [[k, next, next + 4], [k, next + 4, k + 4]];
            mesh.triangles.extend(quad.map(|t| t.map(|v| first + v)));
        }
        mesh
    }

    #[test]
    fn a_ball_comes_through_what_is_wider_by_a_quarter_and_through_nothing_that_is_narrower() {
        for shift in [0.0, 0.013, 0.027, 0.041, 0.055] {
            for (width, comes) in [(0.3, false), (0.49, false), (0.499, false), (0.63, true), (0.9, true)] {
                let mut mesh = chest(width);
                mesh.positions.iter_mut().for_each(|p| *p += DVec3::new(shift, -shift, 2.0 * shift));
                let reach = Reach::of(&mesh, 0.5, None, &Progress::none()).expect("a lattice");
                let middle = reach.lattice.to_lattice(DVec3::ZERO).round().as_ivec3();
                let expected = if comes { Sight::Outside } else { Sight::Chamber };
                assert_eq!(reach.at(middle), expected, "{width} at {shift}");
                assert_eq!(reach.at(IVec3::ZERO), Sight::Outside);
                let wall = reach.lattice.to_lattice(DVec3::new(2.0, 0.0, 0.0)).round().as_ivec3();
                assert_eq!(reach.at(wall), Sight::Nowhere);
            }
        }
    }

    /// Between two plates that are less than a quarter farther apart than the ball is wide, there is neither outside for sure nor a chamber.
    #[test]
    fn what_is_hardly_wider_than_the_ball_is_no_chamber() {
        for gap in [0.51, 0.53, 0.56, 0.6] {
            let mut mesh = cuboid(DVec3::ZERO, DVec3::new(3.0, 3.0, gap));
            let turn = glam::DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.4);
            mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
            let reach = Reach::of(&mesh, 0.5, None, &Progress::none()).expect("a lattice");
            let inside = |t: f64| turn * DVec3::new(t, 1.3, gap / 2.0);
            for k in 0..200 {
                let voxel = reach.lattice.to_lattice(inside(0.4 + 0.01 * f64::from(k))).round().as_ivec3();
                assert_eq!(reach.at(voxel), Sight::Nowhere, "{gap}");
            }
        }
    }
}
