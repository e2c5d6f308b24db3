//! Where a ball can come to from outside, on a lattice.

use std::sync::Arc;

use glam::{DVec3, IVec3};

use crate::lattice::{BRICK, Bricks, Lattice, Slot, brick_of, index_in_brick};
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stopped};
use crate::sdf::exact::{Band, Cost, ExactError, ExactOptions, Sign, cost, exact};

/// Voxels to a diameter.
const VOXELS: f64 = 8.0;

/// The most voxels along the longest side of the box.
const MOST_ALONG: f64 = 30_000.0;

/// Voxels in the column of a slice of a brick where x is 0, and where it is 7.
const FIRST: u64 = 0x0101_0101_0101_0101;
const LAST: u64 = FIRST << 7;

/// A bit for each voxel of a brick: one number a slice, x fastest.
type Bits = [u64; BRICK as usize];

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
/// A step between two voxels is taken only where the whole ball passes: through no hole that is narrower than it. Through a hole that is wider by less than about a
/// quarter of the ball there may be no way on the lattice.
pub struct Reach {
    /// The lattice; eight voxels are as long as the ball.
    pub lattice: Lattice,
    /// Half of the diameter, model units.
    pub radius: f64,
    bricks: Arc<Bricks>,
    /// Of each active brick, where a centre can be.
    free: Vec<Bits>,
    /// Of each active brick, where it can be outside.
    outside: Vec<Bits>,
    /// Of each brick of the lattice, whether it is not active and outside.
    beyond: Vec<u64>,
    /// Bricks along x, y, z.
    dims: IVec3,
}

impl Reach {
    /// Of a ball of this diameter around a mesh, model units. `max_memory`: bytes.
    ///
    /// # Errors
    /// See [`ReachError`].
    pub fn of(
        mesh: &TriMesh,
        diameter: f64,
        max_memory: Option<u64>,
        progress: &Progress,
    ) -> Result<Self, ReachError> {
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
        let least = clear() as f32;
        let bits = |values: &[f32; 512]| {
            let mut bits = Bits::default();
            for (n, value) in values.iter().enumerate() {
                bits[n / 64] |= u64::from(value.abs() >= least) << (n % 64);
            }
            bits
        };
        let free: Vec<Bits> = field.grid.values.iter().map(bits).collect();
        let dims = brick_of(lattice.dims - 1) + 1;
        let count = dims.as_i64vec3().element_product() as usize;
        let mut reach = Self {
            lattice,
            radius: diameter / 2.0,
            bricks: field.grid.bricks.clone(),
            outside: vec![Bits::default(); free.len()],
            free,
            beyond: vec![0; count.div_ceil(64)],
            dims,
        };
        reach.flood(progress)?;
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
        let margin = DVec3::splat((clear() + 2.0) * h);
        let bounds = Bounds { min: bounds.min - margin, max: bounds.max + margin };
        let dims = (bounds.size() / h).ceil().as_ivec3() + 1;
        let lattice = Lattice { origin: bounds.min, h, dims };
        let band = clear() + 0.5;
        let cost = cost(mesh, &lattice, Band::Within(band));
        let bricks = (dims.as_dvec3() / f64::from(BRICK) + 1.0).element_product();
        Ok((lattice, band, Cost { memory: cost.memory + (bricks / 8.0) as u64 + cost.voxels / 4, ..cost }))
    }

    /// Fills what is joined to the corner of the lattice, over the sides of voxels.
    fn flood(&mut self, progress: &Progress) -> Result<(), Stopped> {
        let start = IVec3::ZERO;
        self.enter(start, std::array::from_fn(|z| u64::from(z == 0)));
        let mut stack = vec![start];
        let mut steps = 0usize;
        while let Some(brick) = stack.pop() {
            steps += 1;
            if steps.is_multiple_of(4096) {
                progress.check()?;
            }
            let bits = self.filled(brick);
            for axis in 0..3 {
                for up in [false, true] {
                    let next = if up { brick + IVec3::AXES[axis] } else { brick - IVec3::AXES[axis] };
                    if self.enter(next, across(&bits, axis, up)) {
                        stack.push(next);
                    }
                }
            }
        }
        Ok(())
    }

    /// What of a brick is outside, once all that hangs together in it is.
    fn filled(&mut self, brick: IVec3) -> Bits {
        let Slot::Active(n) = self.bricks.slot(brick) else { return [u64::MAX; 8] };
        let free = &self.free[n as usize];
        let bits = &mut self.outside[n as usize];
        loop {
            let before = *bits;
            for z in 0..8 {
                let own = bits[z];
                let beside = (own << 1 & !FIRST) | (own >> 1 & !LAST) | own << 8 | own >> 8;
                let below = if z > 0 { bits[z - 1] } else { 0 };
                let above = if z < 7 { bits[z + 1] } else { 0 };
                bits[z] |= (beside | below | above) & free[z];
            }
            if *bits == before {
                return before;
            }
        }
    }

    /// Marks voxels of a brick where they are free; whether any is new.
    fn enter(&mut self, brick: IVec3, bits: Bits) -> bool {
        let Some(index) = self.index(brick).filter(|_| bits != Bits::default()) else { return false };
        match self.bricks.slot(brick) {
            Slot::Active(n) => {
                let (free, own) = (&self.free[n as usize], &mut self.outside[n as usize]);
                let before = *own;
                (0..8).for_each(|z| own[z] |= bits[z] & free[z]);
                *own != before
            }
            _ => {
                let (word, bit) = (index / 64, 1 << (index % 64));
                let is_new = self.beyond[word] & bit == 0;
                self.beyond[word] |= bit;
                is_new
            }
        }
    }

    fn index(&self, brick: IVec3) -> Option<usize> {
        let within = brick.cmpge(IVec3::ZERO).all() && brick.cmplt(self.dims).all();
        let [x, y, z] = brick.to_array().map(|c| c as usize);
        within.then(|| x + self.dims.x as usize * (y + self.dims.y as usize * z))
    }

    /// Whether the centre of the ball can be at a voxel, and if so whether that is outside.
    pub fn at(&self, voxel: IVec3) -> Option<bool> {
        let brick = brick_of(voxel);
        let Some(index) = self.index(brick) else { return Some(true) };
        match self.bricks.slot(brick) {
            Slot::Active(n) => {
                let at = index_in_brick(voxel);
                let is = |bits: &[Bits]| bits[n as usize][at / 64] >> (at % 64) & 1 == 1;
                is(&self.free).then(|| is(&self.outside))
            }
            _ => Some(self.beyond[index / 64] >> (index % 64) & 1 == 1),
        }
    }
}

/// How far a centre has to be from the surface, voxels: so far that of two neighbours on either side of a hole's plane both are
/// only where the hole is wider than the ball.
fn clear() -> f64 {
    (VOXELS / 2.0).hypot(0.5)
}

/// What lies beside these voxels in the next brick along an axis, up or down.
fn across(bits: &Bits, axis: usize, up: bool) -> Bits {
    std::array::from_fn(|z| match (axis, up) {
        (0, true) => bits[z] >> 7 & FIRST,
        (0, false) => (bits[z] & FIRST) << 7,
        (1, true) => bits[z] >> 56,
        (1, false) => bits[z] << 56,
        (_, true) => if z == 0 { bits[7] } else { 0 },
        (_, false) => if z == 7 { bits[0] } else { 0 },
    })
}
