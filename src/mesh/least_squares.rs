//! The point nearest to several planes.

use glam::DVec3;
use nalgebra::{Matrix3, Vector3};

/// The point nearest to planes (unit normal, distance from the origin) that stays at the origin in the
/// directions they say little of, with weight `pull` for staying there in the others: directions
/// whose eigenvalue is below `cut` of the largest are left alone.
pub(crate) fn least_squares(planes: impl Iterator<Item = (DVec3, f64)>, cut: f64, pull: f64) -> DVec3 {
    let mut matrix = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for (n, distance) in planes {
        let n = Vector3::new(n.x, n.y, n.z);
        matrix += n * n.transpose();
        right += n * distance;
    }
    let eigen = matrix.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut step = Vector3::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > cut * largest {
            step += vector * (vector.dot(&right) / (value + pull));
        }
    }
    DVec3::new(step.x, step.y, step.z)
}
