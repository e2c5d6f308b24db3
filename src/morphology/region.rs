//! The part of space that a closing may change.

use glam::{DVec3, IVec3};

use super::corners;
use crate::lattice::Grid;

/// The voxels of some canals.
pub struct Region<'a> {
    /// For each voxel the number of its canal; 0 for none.
    pub(super) of: &'a Grid<u32>,
    /// For each number whether that canal is chosen.
    pub(super) chosen: Vec<bool>,
}

impl Region<'_> {
    /// Whether `voxel` belongs to one of the chosen canals.
    pub fn holds(&self, voxel: IVec3) -> bool {
        self.chosen[self.of.get(voxel) as usize]
    }

    /// Whether one of the voxels around `p` (lattice coordinates) belongs to one of the chosen canals.
    pub(super) fn is_beside(&self, p: DVec3) -> bool {
        let low = p.floor().as_ivec3();
        corners().any(|corner| self.holds(low + corner))
    }
}
