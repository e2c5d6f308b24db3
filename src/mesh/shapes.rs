//! Shapes for the tests of all modules.

use glam::DVec3;

use super::TriMesh;

/// The sides of a [`cuboid`], two triangles each: low z, high z, low y, high y, low x, high x.
const QUADS: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// A box along the axes, facing outwards; bits 0, 1 and 2 of a corner's number say where it is along x, y and z.
pub(crate) fn cuboid(min: DVec3, max: DVec3) -> TriMesh {
    let corner = |n: u32| {
        let pick = |bit: u32, low: f64, high: f64| if n >> bit & 1 == 1 { high } else { low };
        DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    };
    let triangles = QUADS.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { positions: (0..8).map(corner).collect(), triangles }
}

/// The simplest solid, facing outwards.
pub(crate) fn tetrahedron() -> TriMesh {
    TriMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    }
}

/// The same triangles with corners of their own.
pub(crate) fn taken_apart(mesh: &TriMesh) -> TriMesh {
    TriMesh {
        positions: mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect(),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}
