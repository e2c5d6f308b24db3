//! Winding numbers by rays in floating point, which share nothing with the arrangement.

use glam::DVec3;
use meshwright::mesh::TriMesh;

use crate::common::exact::distance_to;

/// How often a mesh winds around a point, by one ray that passes no edge closely; `None` if no such ray was found.
pub fn winding(mesh: &TriMesh, p: DVec3) -> Option<i32> {
    // Directions of the cube's golden ratio: none of them lies along anything.
    let step = DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3);
    (1..=64).find_map(|n| {
        let direction = ((step * f64::from(n)).fract() - 0.5).normalize();
        crossings(mesh, p, direction)
    })
}

/// The sum of the triangles that a ray crosses from behind, less those from the front; `None` if it passes an edge closely.
fn crossings(mesh: &TriMesh, p: DVec3, direction: DVec3) -> Option<i32> {
    let mut sum = 0;
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t).map(|q| q - p);
        let [a, b, c] = corners;
        let sides = [(a, b), (b, c), (c, a)].map(|(u, v)| {
            let close = 1e-8 * (v - u).length() + 1e-13 * u.length() * v.length();
            let side = direction.dot(u.cross(v));
            if side.abs() > close { side.signum() as i32 } else { 0 }
        });
        if sides.contains(&1) && sides.contains(&-1) {
            continue;
        }
        if sides.contains(&0) {
            // Far behind the point, nothing is close.
            if corners.iter().all(|q| q.dot(direction) < -1e-6) {
                continue;
            }
            return None;
        }
        let total = direction.dot(a.cross(b) + b.cross(c) + c.cross(a));
        if a.dot(b.cross(c)) / total > 0.0 {
            sum += sides[0];
        }
    }
    Some(sum)
}

/// Whether a point is farther from a mesh than `room`.
pub fn is_clear(mesh: &TriMesh, p: DVec3, room: f64) -> bool {
    (0..mesh.triangles.len()).all(|t| distance_to(p, mesh.corners(t)) > room)
}
