//! The lattice: where the voxels lie, which bricks of them are stored, the 13 directions, and distances at the voxels.

mod bricks;
mod directions;
mod distance_field;
mod domain;
mod interpolate;
mod sizing;

pub use bricks::{BRICK, BRICK_VOXELS, Bricks, Grid, Slot, brick_of, index_in_brick, voxel_in_brick};
pub use directions::{DIRECTIONS, Direction};
pub use distance_field::{DistanceField, DistanceUnit};
pub use domain::Domain;
pub use interpolate::{Interpolated, trilinear};

use glam::{DVec3, IVec3};

/// A regular lattice of voxels (points). Voxel `v` lies at `origin + h * v` in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Position of voxel (0,0,0), model units.
    pub origin: DVec3,
    /// Voxel spacing, model units.
    pub h: f64,
    /// Number of voxels along each axis.
    pub dims: IVec3,
}

impl Lattice {
    /// From model units to lattice coordinates (voxels).
    #[inline]
    pub fn to_lattice(&self, p: DVec3) -> DVec3 {
        (p - self.origin) / self.h
    }

    /// From lattice coordinates (voxels) to model units.
    #[inline]
    pub fn to_model(&self, p: DVec3) -> DVec3 {
        self.origin + p * self.h
    }
}
