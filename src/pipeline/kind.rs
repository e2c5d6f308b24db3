//! What became of a surface: which triangles of a result are the input's, which are pieces of them, which are made anew, and which are made up.

use super::TriangleKind;
use glam::DVec3;
use rayon::prelude::*;

use super::TriangleSource;
use crate::mesh::TriMesh;

/// The kind of each triangle of a result, told by its corners and those of the operand's triangle that it lies on. Corners are the same also
/// after rounding to single precision, and when the triangle was turned over; and they lie in a plane if they do within that rounding.
pub(super) fn kinds_of(mesh: &TriMesh, sources: &[TriangleSource], operands: &[&TriMesh]) -> Vec<TriangleKind> {
    let off = rounding(mesh);
    let kind = |(t, source): (usize, &TriangleSource)| match *source {
        TriangleSource::Lid { .. } | TriangleSource::Closed => TriangleKind::MadeUp,
        TriangleSource::Operand { operand, triangle } => match own(operands, operand, triangle) {
            Some(own) if same(mesh.corners(t), own).is_some() => TriangleKind::Kept,
            Some(own) if lies_in_plane(mesh.corners(t), own, off) => TriangleKind::Cut,
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

/// How many steps of single precision a vertex may lie beside the plane that it was made in: where pieces would cross once rounded, vertices are put on
/// a grid of a few steps.
const STEPS: f64 = 16.0;

/// Far from the origin the numbers of a result are those of one at most this many times its longest side away.
const FAR: f64 = 16.0;

/// How far rounding may have moved vertices of a result off the planes that they were made in, model units.
fn rounding(mesh: &TriMesh) -> f64 {
    let Some(bounds) = mesh.bounds() else { return 0.0 };
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let is_single = |p: &DVec3| p.as_vec3().as_dvec3() == *p;
    let largest = match mesh.positions.par_iter().all(is_single) {
        true => farthest,
        false => farthest.min(FAR * bounds.size().max_element()),
    };
    STEPS * largest * f64::from(f32::EPSILON)
}

/// Whether all corners of `made` lie in the plane of `own`, but for `off`. A triangle without an area has no plane.
fn lies_in_plane(made: [DVec3; 3], own: [DVec3; 3], off: f64) -> bool {
    let [a, b, c] = own;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal != DVec3::ZERO && made.iter().all(|p| (p - a).dot(normal).abs() <= off)
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

    #[test]
    fn pieces_of_a_triangle_and_of_its_plane_are_cut_and_what_leaves_it_is_rebuilt() {
        let own = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.7, 0.0, -3.3), DVec3::new(5.0, 1.0, 0.7)];
        let operand = TriMesh { positions: own.to_vec(), triangles: vec![[0, 1, 2]] };
        let within = |u: f64, v: f64| own[0] + (own[1] - own[0]) * u + (own[2] - own[0]) * v;
        let normal = (own[1] - own[0]).cross(own[2] - own[0]).normalize();
        let kind = |corners: [DVec3; 3]| {
            let made = TriMesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]] };
            kinds_of(&made, &[TriangleSource::Operand { operand: 0, triangle: 0 }], &[&operand])[0]
        };
        let piece = [own[0], within(0.5, 0.0), within(0.2, 0.3)];
        let wider = [within(-0.5, 0.0), within(1.0, 1.0), own[2]];
        for corners in [piece, wider] {
            assert_eq!(kind(corners), TriangleKind::Cut);
            assert_eq!(kind(corners.map(|p| p.as_vec3().as_dvec3())), TriangleKind::Cut);
            let [a, b, c] = corners;
            assert_eq!(kind([a, b, c + normal * 1e-4]), TriangleKind::Rebuilt);
        }
        assert_eq!(kind(own), TriangleKind::Kept);
        // Far away, where the result keeps what the numbers of operands hold.
        let far = |p: DVec3| p + DVec3::splat(1e6);
        let operand = TriMesh { positions: own.map(far).to_vec(), ..operand };
        let made =
            TriMesh { positions: [piece[0], piece[1], piece[2] + normal * 1e-3].map(far).to_vec(), ..operand.clone() };
        let kinds = kinds_of(&made, &[TriangleSource::Operand { operand: 0, triangle: 0 }], &[&operand]);
        assert_eq!(kinds, [TriangleKind::Rebuilt]);
    }
}
