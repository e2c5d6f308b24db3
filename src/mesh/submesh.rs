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

/// A part with fewer triangles than one in so many vertices of the whole is numbered by searching a sorted list, a larger one
/// by a table of all vertices: small parts of large meshes are asked for again and again.
const SMALL: usize = 16;

impl Submesh {
    /// The part that consists of these triangles over some of `positions`.
    pub(crate) fn of(positions: &[DVec3], mut triangles: Vec<[u32; 3]>) -> Self {
        let vertices = if SMALL * triangles.len() < positions.len() {
            let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            let number = |v: u32| vertices.partition_point(|&other| other < v) as u32;
            triangles.iter_mut().for_each(|t| *t = t.map(number));
            vertices
        } else {
            let mut number = vec![UNUSED; positions.len()];
            triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
            let vertices: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] != UNUSED).collect();
            vertices.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
            triangles.par_iter_mut().for_each(|t| *t = t.map(|v| number[v as usize]));
            vertices
        };
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

    #[test]
    fn a_small_part_of_a_large_mesh_is_numbered_alike() {
        let mut mesh = TriMesh { positions: vec![DVec3::ZERO; 100], triangles: vec![[90, 3, 57], [57, 3, 4]] };
        (0..100).for_each(|v| mesh.positions[v].x = v as f64);
        let part = mesh.submesh(&[0, 1]);
        assert_eq!(part.vertices, [3, 4, 57, 90]);
        assert_eq!(part.mesh.triangles, [[3, 0, 2], [2, 0, 1]]);
        mesh.positions.truncate(91);
        mesh.triangles.extend((0..20).map(|_| [3, 4, 57]));
        let table = mesh.submesh(&(0..22).collect::<Vec<u32>>());
        assert_eq!((&table.vertices, &table.mesh.positions), (&part.vertices, &part.mesh.positions));
        assert_eq!(table.mesh.triangles[..2], part.mesh.triangles);
    }
}
