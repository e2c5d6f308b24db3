//! The meshes that a field is made of, as one soup.

use crate::field::SourceTriangle;
use crate::mesh::TriMesh;
use crate::pipeline::TriangleSource;

/// Meshes one after another, and where their triangles come from.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    /// All triangles.
    pub mesh: TriMesh,
    /// For each mesh the number of its first triangle.
    starts: Vec<u32>,
    /// For each triangle what it is of an operand.
    origins: Vec<TriangleSource>,
}

impl Sources {
    /// Adds a mesh with the origins of its triangles, and returns its number.
    pub fn add(&mut self, mesh: &TriMesh, origins: impl IntoIterator<Item = TriangleSource>) -> u32 {
        self.starts.push(self.mesh.triangles.len() as u32);
        self.mesh.append(mesh);
        self.origins.extend(origins);
        self.starts.len() as u32 - 1
    }

    /// The number of a triangle among all.
    pub fn number(&self, triangle: SourceTriangle) -> Option<u32> {
        self.starts.get(triangle.source as usize).map(|start| start + triangle.triangle)
    }

    /// What a triangle of the result comes from that lies on this one of all.
    pub fn origin(&self, number: Option<u32>) -> TriangleSource {
        number.and_then(|n| self.origins.get(n as usize).copied()).unwrap_or(TriangleSource::Closed)
    }
}
