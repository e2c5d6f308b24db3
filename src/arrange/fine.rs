//! The fine lattice: numbers of 30 bits that everything that crosses is computed in.

use glam::DVec3;

use crate::mesh::TriMesh;

/// Bits of a coordinate on the fine lattice.
pub(crate) const BITS: u32 = 30;

/// How far the approximate coordinates of a point may be off, steps of the fine lattice. The quotient of two numbers that are exact to
/// 2⁻⁵² each is off by less than 2⁻⁵⁰ of itself, and no coordinate exceeds 2³⁰.
pub(crate) const ERROR: f64 = 1.0 / (1 << 20) as f64;

/// A lattice around the origin of model space.
///
/// Its step is a power of two, and no coordinate of the model is more than 2³⁰ steps. An `f32` of at least 2²³ steps is a whole
/// number of steps, and a whole number of fewer than 2²⁴ steps is an `f32`: so single precision and the lattice go together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fine {
    /// Model units.
    pub(crate) step: f64,
    /// Whether coordinates are to be `f32` numbers, too.
    pub(crate) single: bool,
    /// For each axis the distance of the numbers that a coordinate of the result may have next to the largest one, steps.
    pub(crate) coarsest: DVec3,
}

impl Fine {
    /// The lattice for points whose coordinates have at most these sizes, model units.
    pub(crate) fn of(largest: DVec3, single: bool) -> Self {
        // Far from the ends of floating point, so that steps and their inverses are normal numbers.
        let exponent = largest.max_element().max(1e-250).log2().floor() as i32 + 1 - BITS as i32;
        let step = 2f64.powi(exponent);
        let mut fine = Self { step, single, coarsest: DVec3::ONE };
        fine.coarsest = DVec3::from_array((largest / step).to_array().map(|size| fine.step_at(size)));
        fine
    }

    /// The lattice for the vertices of a mesh.
    pub(crate) fn around(mesh: &TriMesh, single: bool) -> Self {
        Self::of(mesh.positions.iter().fold(DVec3::ZERO, |most, p| most.max(p.abs())), single)
    }

    /// The place nearest to a point.
    pub(crate) fn place(&self, p: DVec3) -> [i32; 3] {
        p.to_array().map(|x| (x / self.step).round() as i32)
    }

    /// The place for a point in steps, one whose coordinates the result may have.
    pub(crate) fn settled(&self, p: DVec3) -> [i32; 3] {
        p.to_array().map(|x| match self.single {
            true => (f64::from(x.round() as f32)) as i32,
            false => x.round() as i32,
        })
    }

    /// The point at a place, model units.
    pub(crate) fn point(&self, place: [i32; 3]) -> DVec3 {
        DVec3::from_array(place.map(f64::from)) * self.step
    }

    /// The distance of the numbers that a coordinate of this size may have, steps.
    pub(crate) fn step_at(&self, size: f64) -> f64 {
        let exponent = size.max(1.0).log2().floor() as i32 - 23;
        if self.single { 2f64.powi(exponent.max(0)) } else { 1.0 }
    }
}
