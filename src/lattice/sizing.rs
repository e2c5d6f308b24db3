//! Where the lattice lies: a voxel size, a margin, and an offset that keeps flat sides off voxels.

use glam::{DVec3, IVec3};

use super::Lattice;
use crate::mesh::Bounds;

/// Voxels between the bounding box and the border of the lattice.
const MARGIN: i32 = 2;
/// Candidate positions, in h, of the box's smallest corner past a voxel; none is a simple fraction,
/// so that sides at simple fractions of the box do not fall on voxels either.
const OFFSETS: [f64; 6] = [0.414_213_562, 0.585_786_438, 0.309_016_994, 0.690_983_006, 0.236_067_977, 0.763_932_022];

impl Lattice {
    /// The lattice of spacing `h` (model units) that holds `bounds` with a margin of two voxels.
    /// On each axis it lies so that both sides of the box are as far as possible from voxels.
    pub fn around(bounds: &Bounds, h: f64) -> Self {
        let size = bounds.size() / h;
        let mut origin = DVec3::ZERO;
        let mut dims = IVec3::ZERO;
        for axis in 0..3 {
            let offset = best_offset(size[axis]);
            origin[axis] = bounds.min[axis] - (MARGIN as f64 + offset) * h;
            dims[axis] = (size[axis] + offset).floor() as i32 + 2 * MARGIN + 2;
        }
        Self { origin, h, dims }
    }
}

/// The offset for a box `size` voxels long.
fn best_offset(size: f64) -> f64 {
    let off_voxel = |x: f64| (x - x.round()).abs();
    let score = |offset: &f64| off_voxel(*offset).min(off_voxel(offset + size));
    OFFSETS.into_iter().rev().max_by(|a, b| score(a).total_cmp(&score(b))).unwrap_or(OFFSETS[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sides_of_the_box_stay_off_the_voxels() {
        for n in 1..200 {
            let max = DVec3::new(1.0, n as f64 / 200.0, 0.77);
            let lattice = Lattice::around(&Bounds { min: DVec3::ZERO, max }, 1.0 / 64.0);
            for corner in [DVec3::ZERO, max].map(|p| lattice.to_lattice(p)) {
                assert!(((corner - corner.round()).abs()).min_element() > 0.15, "{corner}");
                assert!(corner.min_element() > 2.0 && (lattice.dims.as_dvec3() - corner).min_element() > 2.0);
            }
        }
    }
}
