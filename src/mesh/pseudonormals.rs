//! Normals at faces, edges and vertices by which the side of a point is told (Bærentzen and Aanæs 2005).

use glam::DVec3;
use rayon::prelude::*;

use super::edges::Edges;
use super::nearest_point::Feature;
use super::weld::welded_triangles;
use super::{Closest, TriMesh};

/// Angle-weighted pseudonormals of a mesh; vertices of equal coordinates count as one. For a closed,
/// oriented mesh without self-intersections the side they tell is exact; for others it is the side of the
/// surface as seen from the nearest point.
pub struct Pseudonormals {
    faces: Vec<DVec3>,
    /// For each triangle the sums of the unit normals over its three edges.
    edges: Vec<[DVec3; 3]>,
    /// For each triangle the angle-weighted sums at its three corners.
    corners: Vec<[DVec3; 3]>,
}

impl Pseudonormals {
    /// The normals of `mesh`.
    pub fn of(mesh: &TriMesh) -> Self {
        let triangles = welded_triangles(mesh);
        Self::over(mesh, &triangles, &Edges::new(&triangles, mesh.positions.len()))
    }

    /// The same, given the welded triangles of `mesh` and their edges.
    pub(crate) fn over(mesh: &TriMesh, triangles: &[[u32; 3]], all_edges: &Edges<'_>) -> Self {
        let (faces, angles): (Vec<DVec3>, Vec<[f64; 3]>) =
            (0..triangles.len()).into_par_iter().map(|t| (normal(mesh.corners(t)), angles(mesh.corners(t)))).unzip();
        let mut at_vertices = vec![DVec3::ZERO; mesh.positions.len()];
        for (t, vertices) in triangles.iter().enumerate() {
            for k in 0..3 {
                at_vertices[vertices[k] as usize] += faces[t] * angles[t][k];
            }
        }
        let mut edges = vec![[DVec3::ZERO; 3]; triangles.len()];
        all_edges.each(|edge| {
            let sum = edge.halves().fold(DVec3::ZERO, |sum, half| sum + faces[half as usize / 3]);
            edge.halves().for_each(|half| edges[half as usize / 3][half as usize % 3] = sum);
        });
        let corners = triangles.iter().map(|t| t.map(|v| at_vertices[v as usize])).collect();
        Self { faces, edges, corners }
    }

    /// The signed distance of `p` (model units), of which `closest` is the nearest point on the mesh that these are
    /// the normals of: negative inside, where the normals point away.
    pub fn signed(&self, p: DVec3, closest: &Closest) -> f64 {
        let inside = (p - closest.point).normalize_or_zero().dot(self.sum(closest)) < 0.0;
        if inside { -closest.distance } else { closest.distance }
    }

    /// The unit pseudonormal at a point on the mesh; zero where the normals around it cancel.
    pub fn at(&self, closest: &Closest) -> DVec3 {
        self.sum(closest).normalize_or_zero()
    }

    fn sum(&self, closest: &Closest) -> DVec3 {
        let id = closest.id as usize;
        let normal = match closest.feature {
            Feature::Inside => self.faces.get(id).copied(),
            Feature::Edge(k) => self.edges.get(id).and_then(|edges| edges.get(usize::from(k)).copied()),
            Feature::Corner(k) => self.corners.get(id).and_then(|corners| corners.get(usize::from(k)).copied()),
        };
        normal.unwrap_or_default()
    }

    /// The sum over edge `k` (0, 1, 2) of a triangle, not of length 1.
    pub(crate) fn of_edge(&self, triangle: usize, k: usize) -> DVec3 {
        self.edges[triangle][k]
    }

    /// The sum at corner `k` of a triangle, not of length 1.
    pub(crate) fn of_corner(&self, triangle: usize, k: usize) -> DVec3 {
        self.corners[triangle][k]
    }
}

/// The unit normal, or zero for a triangle without area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The angles at the three corners.
fn angles(corners: [DVec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
        u.cross(v).length().atan2(u.dot(v))
    })
}
