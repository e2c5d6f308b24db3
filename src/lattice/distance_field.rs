//! Signed distances at the voxels of a lattice, with the unit that they are in.

use glam::DVec3;
use rayon::prelude::*;

use super::{Grid, Lattice};

/// What the values of a [`DistanceField`] are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DistanceUnit {
    /// Voxels: multiples of the lattice's spacing.
    Voxels,
    /// The model's own unit, as its coordinates are.
    Model,
}

/// Signed distances to a surface at the voxels of a lattice, negative inside.
///
/// Stages that work on the lattice itself count in voxels; fields that others are made of, and files, in model units. The
/// unit goes with the values, so that a field of the wrong one is converted and never taken for the other.
#[derive(Debug, Clone)]
pub struct DistanceField {
    /// Where the voxels lie.
    pub lattice: Lattice,
    /// The distances.
    pub grid: Grid<f32>,
    /// What they are counted in.
    pub unit: DistanceUnit,
}

impl DistanceField {
    /// A field whose distances are counted in voxels of `lattice`.
    pub fn in_voxels(lattice: Lattice, grid: Grid<f32>) -> Self {
        Self { lattice, grid, unit: DistanceUnit::Voxels }
    }

    /// A field whose distances are in model units.
    pub fn in_model_units(lattice: Lattice, grid: Grid<f32>) -> Self {
        Self { lattice, grid, unit: DistanceUnit::Model }
    }

    /// The same field, counted in voxels.
    pub fn into_voxels(mut self) -> Self {
        if self.unit == DistanceUnit::Model {
            let h = self.lattice.h as f32;
            self.change(|value| value / h);
            self.unit = DistanceUnit::Voxels;
        }
        self
    }

    /// The same field in model units.
    pub fn into_model_units(mut self) -> Self {
        if self.unit == DistanceUnit::Voxels {
            let h = self.lattice.h as f32;
            self.change(|value| value * h);
            self.unit = DistanceUnit::Model;
        }
        self
    }

    /// Adds `by`, counted as the values are, to all of them, so that another level of the field is where it is zero.
    pub fn shift(&mut self, by: f32) {
        self.change(|value| value + by);
    }

    /// Changes all values, also those of the inside and the outside.
    pub fn change(&mut self, change: impl Fn(f32) -> f32 + Sync) {
        self.grid.values.par_iter_mut().flatten().for_each(|value| *value = change(*value));
        (self.grid.inside, self.grid.outside) = (change(self.grid.inside), change(self.grid.outside));
    }

    /// A value of the field as a length in model units.
    #[inline]
    pub fn length(&self, value: f32) -> f64 {
        match self.unit {
            DistanceUnit::Voxels => f64::from(value) * self.lattice.h,
            DistanceUnit::Model => f64::from(value),
        }
    }

    /// The distance of voxels that lie inside and are not stored, model units.
    pub fn inside(&self) -> f64 {
        self.length(self.grid.inside)
    }

    /// The distance of voxels that lie outside and are not stored, model units.
    pub fn outside(&self) -> f64 {
        self.length(self.grid.outside)
    }

    /// The distance at a point, both in model units, linear between voxels; `None` beyond the lattice.
    pub fn at(&self, p: DVec3) -> Option<f64> {
        let place = self.lattice.to_lattice(p);
        let values = |voxel| self.length(self.grid.get(voxel));
        self.lattice.holds(place).then(|| self.lattice.interpolate(place, values).value)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::IVec3;

    use super::*;
    use crate::lattice::{BRICK_VOXELS, Bricks, voxel_in_brick};

    /// The distance to the plane x = 2.5, voxels, on a lattice of spacing 0.5.
    fn plane() -> DistanceField {
        let bricks = Arc::new(Bricks::new([IVec3::ZERO]));
        let values = vec![std::array::from_fn::<f32, BRICK_VOXELS, _>(|n| voxel_in_brick(n).x as f32 - 2.5)];
        let lattice = Lattice { origin: DVec3::splat(-1.0), h: 0.5, dims: IVec3::splat(8) };
        DistanceField::in_voxels(lattice, Grid { bricks, values, inside: -9.0, outside: 9.0 })
    }

    #[test]
    fn the_unit_changes_numbers_and_no_lengths() {
        let voxels = plane();
        let model = voxels.clone().into_model_units();
        assert_eq!(model.unit, DistanceUnit::Model);
        assert_eq!(model.grid.get(IVec3::new(4, 1, 1)), 0.75);
        assert_eq!((model.inside(), model.outside()), (-4.5, 4.5));
        assert_eq!((voxels.inside(), voxels.outside()), (-4.5, 4.5));
        let p = DVec3::new(0.7, 0.1, 2.4);
        assert_eq!(voxels.at(p).map(|d| (d * 1e6).round()), Some((0.7 - 0.25) * 1e6));
        assert_eq!(model.at(p).map(|d| (d * 1e6).round()), voxels.at(p).map(|d| (d * 1e6).round()));
        assert_eq!(voxels.at(DVec3::new(-1.1, 0.0, 0.0)), None);
        // There and back, and twice the same way.
        let back = model.clone().into_voxels();
        assert_eq!((back.unit, &back.grid.values), (DistanceUnit::Voxels, &voxels.grid.values));
        assert_eq!(model.clone().into_model_units().grid.values, model.grid.values);
    }

    #[test]
    fn a_shift_moves_the_level() {
        let mut field = plane();
        field.shift(1.5);
        assert_eq!(field.at(DVec3::new(-0.5, 0.0, 0.0)), Some(0.0));
        assert_eq!((field.inside(), field.outside()), (-3.75, 5.25));
    }
}
