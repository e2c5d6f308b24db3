//! What became of a surface: which triangles of a result are the input's, which are made anew, and which are made up.

use super::TriangleKind;
use glam::DVec3;
use rayon::prelude::*;

use super::TriangleSource;
use crate::mesh::TriMesh;

/// The kind of each triangle of a result, told by its corners and those of the operand's triangle that it lies on. Corners are the same also
/// after rounding to single precision, and when the triangle was turned over.
pub(super) fn kinds_of(mesh: &TriMesh, sources: &[TriangleSource], operands: &[&TriMesh]) -> Vec<TriangleKind> {
    let kind = |(t, source): (usize, &TriangleSource)| match *source {
        TriangleSource::Closed => TriangleKind::MadeUp,
        TriangleSource::Operand { operand, triangle } => match own(operands, operand, triangle) {
            Some(own) if same(mesh.corners(t), own).is_some() => TriangleKind::Kept,
            _ => TriangleKind::Rebuilt,
        },
    };
    sources.par_iter().enumerate().map(kind).collect()
}

fn own(operands: &[&TriMesh], operand: u32, triangle: u32) -> Option<[DVec3; 3]> {
    let mesh = operands.get(operand as usize)?;
    ((triangle as usize) < mesh.triangles.len()).then(|| mesh.corners(triangle as usize))
}

/// For each corner of `made` the number of the corner of `own` at the same place, if there is a different one for each.
pub(super) fn same(made: [DVec3; 3], own: [DVec3; 3]) -> Option<[usize; 3]> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    ORDERS.into_iter().find(|order| (0..3).all(|k| is_at(made[k], own[order[k]])))
}

/// Whether `made` is `own`, or that in single precision.
fn is_at(made: DVec3, own: DVec3) -> bool {
    // Half a step of single precision.
    const HALF_STEP: f64 = 1.0 / (1u32 << 24) as f64;
    made == own || (made - own).abs().cmple(own.abs() * HALF_STEP).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_the_same_in_any_order_and_in_single_precision() {
        let own = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.7, 0.0, -3.3), DVec3::new(5.0, 1e-9, 0.7)];
        for order in [[0, 1, 2], [1, 2, 0], [0, 2, 1]] {
            assert_eq!(same(order.map(|k| own[k]), own), Some(order));
            assert_eq!(same(order.map(|k| own[k].as_vec3().as_dvec3()), own), Some(order));
        }
        assert_eq!(same([own[0], own[1], own[1]], own), None);
        assert_eq!(same([own[0], own[1], own[2] * (1.0 + 1e-6)], own), None);
    }
}
