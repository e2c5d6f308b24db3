//! Values over a lattice without an end, cube by cube, where they are asked for.

use std::sync::Arc;

use glam::IVec3;

use crate::sdf::exact::BlockDistance;

/// The values of a field over a lattice without an end.
pub trait Cubes: Send + Sync {
    /// The values, model units, at the 32³ points from `29 cube - 1` on, lattice coordinates, x fastest, then y; they may be off by 1e-3 of the spacing. `None` where they
    /// are not known. What they are depends on nothing that was asked before.
    fn cube(&self, cube: IVec3) -> Option<Vec<f32>>;
}

/// Distances in voxels, not in model units.
impl Cubes for BlockDistance {
    fn cube(&self, cube: IVec3) -> Option<Vec<f32>> {
        Self::cube(self, cube)
    }
}

/// Values that are made larger.
pub(super) struct Scaled {
    pub cubes: Arc<dyn Cubes>,
    pub scale: f64,
}

impl Cubes for Scaled {
    fn cube(&self, cube: IVec3) -> Option<Vec<f32>> {
        let mut values = self.cubes.cube(cube)?;
        values.iter_mut().for_each(|value| *value = (f64::from(*value) * self.scale) as f32);
        Some(values)
    }
}
