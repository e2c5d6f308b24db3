//! Some triangles of a mesh as a mesh of their own.

use glam::DVec3;
use rayon::prelude::*;

use super::TriMesh;

/// The number of a vertex that the part does not use.
const UNUSED: u32 = u32::MAX;

/// Some triangles of a mesh, with the vertices that they use and no others.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Submesh {
    /// The triangles in the order in which they were asked for, and their vertices in the order of the whole mesh.
    pub mesh: TriMesh,
    /// For each vertex of the part its number in the whole mesh, ascending.
    pub vertices: Vec<u32>,
}

impl Submesh {
    /// The part that consists of these triangles over some of `positions`.
    pub(crate) fn of(positions: &[DVec3], mut triangles: Vec<[u32; 3]>) -> Self {
        let mut number = vec![UNUSED; positions.len()];
        triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
        let vertices: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] != UNUSED).collect();
        vertices.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
        triangles.par_iter_mut().for_each(|t| *t = t.map(|v| number[v as usize]));
        let positions = vertices.iter().map(|&v| positions[v as usize]).collect();
        Self { mesh: TriMesh { positions, triangles }, vertices }
    }
}

impl TriMesh {
    /// The part of the mesh that consists of the triangles with these numbers.
    pub fn submesh(&self, triangles: &[u32]) -> Submesh {
        Submesh::of(&self.positions, triangles.iter().map(|&t| self.triangles[t as usize]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_its_own_vertices_in_their_order() {
        let positions: Vec<DVec3> = (0..6).map(|n| DVec3::splat(f64::from(n))).collect();
        let mesh = TriMesh { positions, triangles: vec![[0, 1, 2], [5, 3, 1], [3, 4, 5], [2, 1, 3]] };
        let part = mesh.submesh(&[2, 1]);
        assert_eq!(part.vertices, [1, 3, 4, 5]);
        assert_eq!(part.mesh.triangles, [[1, 2, 3], [3, 1, 0]]);
        assert_eq!(part.mesh.positions, [1.0, 3.0, 4.0, 5.0].map(DVec3::splat));
        assert_eq!(mesh.submesh(&[]), Submesh::default());
    }
}
