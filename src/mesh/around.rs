//! Which triangles are around a vertex.

use super::TriMesh;

/// The triangles around each vertex.
pub(crate) struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut triangles = vec![0; sum as usize];
        for (id, triangle) in mesh.triangles.iter().enumerate().rev() {
            for &v in triangle {
                starts[v as usize] -= 1;
                triangles[starts[v as usize] as usize] = id as u32;
            }
        }
        Self { starts, triangles }
    }

    pub(crate) fn of(&self, vertex: u32) -> &[u32] {
        &self.triangles[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}
