//! A field that is made slab by slab: eight slices at a time, of which only what lies in the band is kept.

use glam::IVec3;

use super::descend::Filled;
use super::{ExactError, ExactOptions, Sign, assemble, checked_scope, cost, sides, tiles};
use crate::lattice::{BRICK, BRICK_VOXELS, DistanceField, Lattice};
use crate::mesh::TriMesh;
use crate::progress::Progress;

/// Eight slices of a lattice: signed distances counted in voxels, infinite where none is known.
pub struct Slab {
    end: IVec3,
    low: i32,
    values: Vec<f32>,
}

impl Slab {
    /// An empty slab for slices `low` to `low` + 7 of a lattice of `end` voxels.
    pub fn new(end: IVec3, low: i32) -> Self {
        Self { end, low, values: vec![f32::INFINITY; (end.x * end.y * BRICK) as usize] }
    }

    /// The slices of the slab, each row by row.
    pub fn planes(&mut self) -> std::slice::ChunksMut<'_, f32> {
        self.values.chunks_mut((self.end.x * self.end.y) as usize)
    }
}

/// A field in the making: the bricks of the slabs that were added.
pub struct Slabs {
    scope: tiles::Scope,
    filled: Vec<Filled>,
}

impl Slabs {
    /// A field without any slab yet, for the distance to `mesh`.
    ///
    /// # Errors
    /// See [`ExactError`].
    pub fn new(mesh: &TriMesh, lattice: &Lattice, options: &ExactOptions) -> Result<Self, ExactError> {
        Ok(Self {
            scope: checked_scope(mesh, lattice, options, cost(mesh, lattice, options.band).memory)?,
            filled: Vec::new(),
        })
    }

    /// The width of the band, h; finite even for the whole lattice.
    pub fn band(&self) -> f64 {
        self.scope.band
    }

    /// The number of voxels along x, y and z, a multiple of eight each.
    pub fn end(&self) -> IVec3 {
        self.scope.end
    }

    /// Keeps the bricks of a slab that reach into the band.
    pub fn add(&mut self, slab: &Slab) {
        let counts = slab.end / BRICK;
        let band = self.scope.band as f32;
        for (y, x) in (0..counts.y).flat_map(|y| (0..counts.x).map(move |x| (y, x))) {
            let mut values = Box::new([f32::INFINITY; BRICK_VOXELS]);
            for (n, row) in values.chunks_mut(BRICK as usize).enumerate() {
                let (j, k) = (n as i32 % BRICK, n as i32 / BRICK);
                let from = ((k * slab.end.y + BRICK * y + j) * slab.end.x + BRICK * x) as usize;
                row.copy_from_slice(&slab.values[from..from + BRICK as usize]);
            }
            values.iter_mut().filter(|value| value.abs() > band).for_each(|value| *value = f32::INFINITY);
            if values.iter().any(|value| value.is_finite()) {
                self.filled.push(Filled { brick: IVec3::new(x, y, slab.low / BRICK), values });
            }
        }
    }

    /// The whole field, in which voxels beyond the band are told inside from outside, too.
    ///
    /// # Errors
    /// See [`ExactError`].
    pub fn finish(self, mesh: &TriMesh, lattice: &Lattice, progress: &Progress) -> Result<DistanceField, ExactError> {
        let mut raw = assemble(self.filled, &self.scope);
        sides::settle(&mut raw, mesh, lattice, Sign::Pseudonormal, progress)?;
        Ok(DistanceField::in_voxels(*lattice, raw.grid))
    }
}
