//! Distances over lattices.

use glam::IVec3;
use meshwright::lattice::{DistanceField, voxel_in_brick};

/// Voxel number `n` of brick `brick`.
pub fn voxel(brick: IVec3, n: usize) -> IVec3 {
    brick * 8 + voxel_in_brick(n)
}

/// The largest difference in the band, voxels with other sides, and voxels of the band.
pub fn apart(truth: &DistanceField, found: &DistanceField, band: f64) -> (f64, usize, usize) {
    let (truth, found) = (&truth.grid, &found.grid);
    let (mut most, mut wrong, mut count) = (0.0f64, 0, 0);
    for (n, &brick) in truth.bricks.active().iter().enumerate() {
        for k in 0..512 {
            let (a, b) = (f64::from(truth.values[n][k]), f64::from(found.get(voxel(brick, k))));
            if a.abs() < band - 1e-4 {
                count += 1;
                most = most.max((a.abs() - b.abs()).abs());
            }
            wrong += usize::from((a < 0.0) != (b < 0.0) && a.abs() > 1e-4);
        }
    }
    for &brick in found.bricks.active() {
        let ends = [voxel(brick, 0), voxel(brick, 511)];
        wrong += ends.iter().filter(|&&v| (truth.get(v) < 0.0) != (found.get(v) < 0.0)).count();
    }
    (most, wrong, count)
}
