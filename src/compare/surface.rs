//! A mesh's faces of non-zero area, in a space where both meshes are about as large as 1.

use glam::DVec3;
use rayon::prelude::*;

use super::sample::Samples;
use crate::mesh::{Bounds, ClosestTree, TriMesh};

/// The space in which two meshes are compared: model units times a power of two, so that scaling loses nothing and
/// neither areas nor squares overflow or vanish.
pub(super) struct Frame {
    /// The power of two.
    pub(super) scale: f64,
    /// Distances up to this are the rounding of coordinates and count as 0; scaled.
    pub(super) rounding: f64,
}

impl Frame {
    pub(super) fn around(a: &TriMesh, b: &TriMesh) -> Self {
        let farthest = |mesh: &TriMesh| mesh.bounds().map_or(0.0, |b| b.min.abs().max(b.max.abs()).max_element());
        let largest = farthest(a).max(farthest(b));
        let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        let scale = if largest > 0.0 { 2f64.powi((-exponent).clamp(-1000, 1000)) } else { 1.0 };
        Self { scale, rounding: 8.0 * f64::EPSILON * largest * scale }
    }

    /// The mesh in this space.
    pub(super) fn scaled(&self, mesh: &TriMesh) -> TriMesh {
        TriMesh {
            positions: mesh.positions.iter().map(|&p| p * self.scale).collect(),
            triangles: mesh.triangles.clone(),
        }
    }
}

/// The faces of a mesh that have an area, scaled.
pub(super) struct ScaledFaces {
    corners: Vec<[DVec3; 3]>,
    normals: Vec<DVec3>,
    /// Area of each face and of all before it.
    areas: Vec<f64>,
    /// The vertices that these faces use.
    pub(super) vertices: Vec<DVec3>,
    bounds: Option<Bounds>,
    /// Distances up to this count as 0.
    pub(super) rounding: f64,
}

impl ScaledFaces {
    /// The faces of a mesh that is already in `frame`.
    pub(super) fn new(mesh: &TriMesh, frame: &Frame) -> Self {
        let mut used = vec![false; mesh.positions.len()];
        let (mut corners, mut normals, mut areas) = (Vec::new(), Vec::new(), Vec::new());
        let mut total = 0.0;
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(t);
            let cross = (b - a).cross(c - a);
            let doubled = cross.length();
            if doubled > 0.0 {
                total += doubled / 2.0;
                corners.push([a, b, c]);
                normals.push(cross / doubled);
                areas.push(total);
                triangle.iter().for_each(|&v| used[v as usize] = true);
            }
        }
        let vertices: Vec<DVec3> =
            mesh.positions.iter().zip(&used).filter(|(_, used)| **used).map(|(p, _)| *p).collect();
        let bounds = Bounds::of(vertices.iter().copied());
        Self { corners, normals, areas, vertices, bounds, rounding: frame.rounding }
    }

    /// Area-uniform points and the faces they lie on, in order of the faces.
    pub(super) fn samples(&self, count: usize) -> impl IndexedParallelIterator<Item = (DVec3, u32)> + '_ {
        let samples = Samples { count };
        let total = self.areas.last().copied().unwrap_or(0.0);
        (0..count).into_par_iter().map(move |k| {
            let (pick, u, v) = samples.get(k);
            let face = self.areas.partition_point(|&area| area < pick * total).min(self.areas.len() - 1);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let [a, b, c] = self.corners[face];
            (a + u * (b - a) + v * (c - a), face as u32)
        })
    }

    /// The unit normal of a face.
    pub(super) fn normal(&self, face: u32) -> DVec3 {
        self.normals[face as usize]
    }

    /// For the nearest face; `None` without faces.
    pub(super) fn tree(&self) -> Option<ClosestTree<[DVec3; 3]>> {
        (!self.corners.is_empty()).then(|| ClosestTree::new(self.corners.clone()))
    }

    pub(super) fn diagonal(&self) -> f64 {
        self.bounds.map_or(0.0, |b| b.diagonal())
    }

    pub(super) fn longest_side(&self) -> f64 {
        self.bounds.map_or(0.0, |b| b.size().max_element())
    }
}
