//! Winding numbers of single points: exact for what is balanced, as solid angles for what is open.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Shell;
use crate::mesh::TriMesh;
use crate::mesh::predicates::{side_of_line, side_of_plane};

/// How often a balanced shell winds around `p`, which must not lie on it: crossings of the ray from `p` along +z, exact. The ray is
/// moved aside by (ε, ε²), so that it passes every edge on one side. `None` when `p` lies on a triangle after all.
///
/// `scale` is that of the mesh, see [`crate::mesh::predicates::scale_of_mesh`].
pub(super) fn around(mesh: &TriMesh, shell: &Shell, p: DVec3, scale: f64) -> Option<i32> {
    let outside = p.cmplt(shell.bounds.min).any() || p.cmpgt(shell.bounds.max).any();
    if outside {
        return Some(0);
    }
    let crossed = |&t: &u32| -> Option<i32> {
        let corners = mesh.corners(t as usize);
        let (low, high) = (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        if p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y || p.z > high.z {
            return Some(0);
        }
        let (corners, p) = (corners.map(|c| c * scale), p * scale);
        let flat = corners.map(DVec3::truncate);
        let turn = |k: usize| side_of_moved(flat[k], flat[(k + 1) % 3], p.truncate());
        let sides = [turn(0), turn(1), turn(2)];
        if sides[0] == 0 || sides.iter().any(|&side| side != sides[0]) {
            return Some(0);
        }
        // Seen from above, a triangle that faces up runs counter-clockwise, and what is below it is behind it.
        let height = side_of_plane(&corners, p) * f64::from(sides[0]);
        match height.partial_cmp(&0.0)? {
            std::cmp::Ordering::Less => Some(sides[0]),
            std::cmp::Ordering::Greater => Some(0),
            std::cmp::Ordering::Equal => None,
        }
    };
    shell.triangles.par_iter().with_min_len(4096).map(crossed).try_reduce(|| 0, |a, b| Some(a + b))
}

/// On which side of the line from `a` to `b` the point `p` + (ε, ε²) lies: 1 left, -1 right, 0 where the line is a point.
fn side_of_moved(a: DVec2, b: DVec2, p: DVec2) -> i32 {
    let sign = |x: f64| i32::from(x > 0.0) - i32::from(x < 0.0);
    match sign(side_of_line(a, b, p)) {
        0 if a.y != b.y => sign(a.y - b.y),
        0 => sign(b.x - a.x),
        side => side,
    }
}

/// An open shell that covers less than this part of what is seen from a point winds around it too little to count.
const SMALL: f64 = 1.0 / 16.0;

/// How far from its box an open shell winds around points at all, model units: beyond, its area over that of a ball of this radius is
/// less than [`SMALL`].
pub(super) fn reach(shell: &Shell) -> f64 {
    (shell.area / (4.0 * PI * SMALL)).sqrt()
}

/// The solid angle of a shell seen from `p`, as a part of the whole: the generalised winding number.
pub(super) fn solid_angle(mesh: &TriMesh, shell: &Shell, p: DVec3) -> f64 {
    let off = (shell.bounds.min - p).max(p - shell.bounds.max).max(DVec3::ZERO).length();
    if off > reach(shell) {
        return 0.0;
    }
    let angle = |t: u32| {
        let [a, b, c] = mesh.corners(t as usize).map(|q| q - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        a.dot(b.cross(c)).atan2(below)
    };
    // In pieces of fixed size, so that the sum does not depend on the threads.
    let sums: Vec<f64> = shell.triangles.par_chunks(4096).map(|piece| piece.iter().map(|&t| angle(t)).sum()).collect();
    sums.iter().sum::<f64>() / (2.0 * PI)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::ldi::Operands;
    use crate::mesh::shapes::cuboid;
    use crate::shells::shells;

    proptest! {
        #[test]
        fn boxes_wind_once_around_what_is_inside_them_also_where_the_ray_meets_edges_and_corners(
            low in prop::array::uniform3(-3i32..0), high in prop::array::uniform3(1i32..4),
            at in prop::array::uniform3(-8i32..9), inward in any::<bool>()
        ) {
            let point = |a: [i32; 3]| DVec3::from_array(a.map(f64::from));
            let mut mesh = cuboid(point(low), point(high));
            if inward {
                mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            let shell = &shells(&mesh, &Operands::new([12])).list[0];
            let p = point(at) / 2.0;
            let on = (p.cmpge(point(low)).all() && p.cmple(point(high)).all())
                && (p.cmpeq(point(low)).any() || p.cmpeq(point(high)).any());
            let inside = p.cmpgt(point(low)).all() && p.cmplt(point(high)).all();
            let expected = i32::from(inside) * if inward { -1 } else { 1 };
            let found = around(&mesh, shell, p, 1.0);
            if on {
                prop_assert!(found.is_none_or(|n| n.abs() <= 1));
            } else {
                prop_assert_eq!(found, Some(expected));
                prop_assert!((solid_angle(&mesh, shell, p) - f64::from(expected)).abs() < 1e-9);
            }
        }
    }
}
