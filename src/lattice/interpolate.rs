//! Values between the voxels of a lattice: linear along each axis.

use glam::{DVec3, IVec3};

use super::Lattice;

/// A point this much beyond the outermost voxels, as a part of their number and in voxels, is still within the lattice:
/// the last voxel belongs to it, and rounding must not take it away.
const ROUNDING: f64 = 1e-9;

/// A value between voxels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interpolated {
    /// The value.
    pub value: f64,
    /// How it grows from one voxel to the next along x, y and z.
    pub slope: DVec3,
}

impl Lattice {
    /// Whether `p` (lattice coordinates) lies between voxels of the lattice.
    pub fn holds(&self, p: DVec3) -> bool {
        let last = (self.dims - 1).as_dvec3();
        p.cmpge(-last * ROUNDING - ROUNDING).all() && p.cmple(last * (1.0 + ROUNDING) + ROUNDING).all()
    }

    /// The point between voxels of the lattice that is nearest to `p`; both in lattice coordinates.
    #[inline]
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        p.clamp(DVec3::ZERO, (self.dims - 1).as_dvec3())
    }

    /// What `values` at voxels come to at `p` (lattice coordinates), or at the nearest point of the lattice.
    pub fn interpolate(&self, p: DVec3, values: impl Fn(IVec3) -> f64) -> Interpolated {
        let held = self.nearest(p);
        let last = self.dims - 1;
        let first = held.floor().as_ivec3().min(last - 1).max(IVec3::ZERO);
        let corner = |k: usize| values((first + step(k)).min(last));
        interpolated(&std::array::from_fn(corner), held - first.as_dvec3())
    }
}

/// From the lowest corner of a cell to corner `k`: bits 0, 1 and 2 are the steps along x, y and z.
fn step(k: usize) -> IVec3 {
    IVec3::new(k as i32 & 1, k as i32 >> 1 & 1, k as i32 >> 2)
}

#[inline]
fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The value at `part` of a cell (0 to 1 along each axis) with these values at its corners; bits 0, 1 and 2 of a corner's
/// number say where it is along x, y and z.
#[inline]
pub fn trilinear(corners: &[f64; 8], part: DVec3) -> f64 {
    let x = [0, 2, 4, 6].map(|k| mix(corners[k], corners[k + 1], part.x));
    mix(mix(x[0], x[1], part.y), mix(x[2], x[3], part.y), part.z)
}

/// [`trilinear`] with its slope.
fn interpolated(c: &[f64; 8], part: DVec3) -> Interpolated {
    let x = [0, 2, 4, 6].map(|k| mix(c[k], c[k + 1], part.x));
    let y = [mix(x[0], x[1], part.y), mix(x[2], x[3], part.y)];
    let along_x = [0, 2, 4, 6].map(|k| c[k + 1] - c[k]);
    let by_x = mix(mix(along_x[0], along_x[1], part.y), mix(along_x[2], along_x[3], part.y), part.z);
    let slope = DVec3::new(by_x, mix(x[1] - x[0], x[3] - x[2], part.z), y[1] - y[0]);
    Interpolated { value: mix(y[0], y[1], part.z), slope }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(dims: IVec3) -> Lattice {
        Lattice { origin: DVec3::new(1.0, 2.0, 3.0), h: 0.5, dims }
    }

    #[test]
    fn what_is_linear_between_voxels_is_met_exactly() {
        let lattice = lattice(IVec3::new(3, 4, 5));
        let slope = DVec3::new(1.0, -2.0, 3.0);
        let values = |voxel: IVec3| voxel.as_dvec3().dot(slope);
        for place in [[0.0; 3], [0.3, 1.7, 2.2], [2.0, 3.0, 4.0], [1.999, 0.0, 3.5]].map(DVec3::from) {
            assert!(lattice.holds(place));
            let found = lattice.interpolate(place, values);
            assert!((found.value - place.dot(slope)).abs() < 1e-12, "{place}: {found:?}");
            assert!(found.slope.distance(slope) < 1e-12, "{place}: {found:?}");
        }
        for place in [[-0.01, 1.0, 1.0], [1.0, 3.01, 1.0], [f64::NAN, 1.0, 1.0]].map(DVec3::from) {
            assert!(!lattice.holds(place));
        }
        // Beyond the lattice there is what is at its nearest point.
        assert_eq!(lattice.interpolate(DVec3::new(9.0, 1.0, -4.0), values).value, 0.0);
    }

    #[test]
    fn one_plane_of_voxels_is_a_lattice_too() {
        let flat = lattice(IVec3::new(3, 1, 2));
        let values = |voxel: IVec3| {
            assert_eq!(voxel.y, 0);
            f64::from(voxel.x + 10 * voxel.z)
        };
        let found = flat.interpolate(DVec3::new(0.5, 0.0, 0.5), values);
        assert_eq!(found, Interpolated { value: 5.5, slope: DVec3::new(1.0, 0.0, 10.0) });
    }

    #[test]
    fn products_of_the_coordinates_are_met_exactly_too() {
        let values = |p: DVec3| 1.0 + p.x * p.y - 2.0 * p.y * p.z + 4.0 * p.x * p.y * p.z;
        let corners = std::array::from_fn(|k| values(step(k).as_dvec3()));
        for part in [[0.25, 0.5, 0.125], [0.0, 1.0, 0.75]].map(DVec3::from) {
            assert_eq!(trilinear(&corners, part), values(part));
            assert_eq!(interpolated(&corners, part).value, values(part));
        }
    }
}
