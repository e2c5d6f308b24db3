//! The shells of a surface and the volumes they enclose.

use glam::DVec3;

use crate::mesh::TriMesh;
use crate::mesh::edges::Union;

/// For each vertex the lowest vertex of its shell.
pub(super) fn shells(mesh: &TriMesh) -> Vec<u32> {
    let mut sets = Union::of_triangles(mesh.positions.len(), mesh.triangles.iter().copied());
    (0..mesh.positions.len() as u32).map(|v| sets.root(v)).collect()
}

/// Adds six times the signed volume under each triangle to its shell's entry. Volumes are measured
/// from the lowest vertex of each shell, so that a small shell far from the origin keeps its digits.
pub(super) fn volumes(shells: &[u32], from: &[DVec3], triangles: impl Iterator<Item = (u32, [DVec3; 3])>) -> Vec<f64> {
    let mut volumes = vec![0.0; shells.len()];
    for (vertex, corners) in triangles {
        let shell = shells[vertex as usize] as usize;
        let [a, b, c] = corners.map(|p| p - from[shell]);
        volumes[shell] += a.dot(b.cross(c));
    }
    volumes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_are_told_apart_whatever_the_order_of_triangles() {
        let triangles = vec![[5, 2, 7], [0, 4, 6], [6, 5, 0], [1, 3, 8]];
        let mesh = TriMesh { positions: vec![DVec3::ZERO; 9], triangles };
        assert_eq!(shells(&mesh), [0, 1, 0, 1, 0, 0, 0, 0, 1]);
    }
}
