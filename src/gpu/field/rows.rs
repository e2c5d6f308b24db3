//! Features as the shaders read them: integers, so that each block can have them about its own centre.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::region::Region;
use crate::gpu::GpuError;
use crate::sdf::exact::{EdgeFeature, FaceFeature, Features, MARGIN, Region as _, Scope, VertexFeature};

/// Words of a row, and rows of a face, an edge and a vertex; as in the shader.
const ROW: usize = 4;
const FACE_ROWS: usize = 5;
const EDGE_ROWS: usize = 7;
const VERTEX_ROWS: usize = 11;
/// Components of normals, and heights, are counted in 2⁻³⁰.
const SCALE: f64 = (1u32 << 30) as f64;
/// Coordinates must stay below this, h.
pub(super) const FARTHEST: f64 = (1u32 << 29) as f64;

/// The voxels that a feature can be nearest to, within the band: low and high along each axis.
type VoxelBox = [[i16; 2]; 3];

/// All features of a mesh, and where they matter.
pub(super) struct Placed<'a> {
    features: &'a Features,
    faces: Vec<VoxelBox>,
    edges: Vec<VoxelBox>,
    vertices: Vec<VoxelBox>,
}

/// Numbers of some of them.
#[derive(Debug, Default, Clone)]
pub(super) struct Picked {
    pub faces: Vec<u32>,
    pub edges: Vec<u32>,
    pub vertices: Vec<u32>,
}

impl Picked {
    pub fn len(&self) -> usize {
        self.faces.len() + self.edges.len() + self.vertices.len()
    }

    /// Rows where edges and vertices begin, and of all.
    pub fn rows(&self) -> [usize; 3] {
        let edges = FACE_ROWS * self.faces.len();
        let vertices = edges + EDGE_ROWS * self.edges.len();
        [edges, vertices, vertices + VERTEX_ROWS * self.vertices.len()]
    }

    /// The signed distance, h, of a voxel from the nearest of features that are given as the device numbers them, in any order: of several at the
    /// same distance the first of the mesh, as on the main processor.
    pub fn signed(&self, features: &Features, voxel: IVec3, ids: &[u32]) -> Option<f64> {
        let mut ids = ids.to_vec();
        ids.sort_unstable();
        let (edges, vertices) = (self.faces.len() as u32, (self.faces.len() + self.edges.len()) as u32);
        let (faces, rest) = ids.split_at(ids.partition_point(|&id| id < edges));
        let (rest, last) = rest.split_at(rest.partition_point(|&id| id < vertices));
        let of = |list: &[u32], n: u32| list.get(n as usize).copied();
        features.signed(
            voxel.as_dvec3(),
            faces.iter().filter_map(|&id| of(&self.faces, id)),
            rest.iter().filter_map(|&id| of(&self.edges, id - edges)),
            last.iter().filter_map(|&id| of(&self.vertices, id - vertices)),
        )
    }
}

impl<'a> Placed<'a> {
    /// # Errors
    /// [`GpuError::Far`] where a feature is too far away for the device's integers.
    pub fn new(features: &'a Features, scope: &Scope) -> Result<Self, GpuError> {
        let far = |at: DVec3| at.is_nan() || at.abs().max_element() >= FARTHEST;
        if features.faces.par_iter().flat_map_iter(|face| face.corners).any(far)
            || features.edges.par_iter().any(|edge| far(edge.start) || far(edge.start + edge.along * edge.length))
        {
            return Err(GpuError::Far { most: FARTHEST });
        }
        let boxes = |[low, high]: [DVec3; 2]| {
            let low = (low - MARGIN).ceil().max(DVec3::ZERO).min(scope.end.as_dvec3()).as_ivec3();
            let high = (high + MARGIN).floor().max(DVec3::NEG_ONE).min((scope.end - 1).as_dvec3()).as_ivec3();
            // A lattice has at most 2¹⁵ voxels along an axis.
            std::array::from_fn(|k| [low[k].min(i32::from(i16::MAX)) as i16, high[k] as i16])
        };
        Ok(Self {
            features,
            faces: features.faces.par_iter().map(|face| boxes(face.bounds(scope.band))).collect(),
            edges: features.edges.par_iter().map(|edge| boxes(edge.bounds(scope.band))).collect(),
            vertices: features.vertices.par_iter().map(|vertex| boxes(vertex.bounds(scope.band))).collect(),
        })
    }

    /// Those that can be nearest to a voxel of `region`.
    pub fn pick(&self, region: &Region) -> Picked {
        let [low, high] = region.voxels();
        let along = |k: usize, [first, last]: [i16; 2]| {
            first <= last && i32::from(first) <= high[k] && i32::from(last) >= low[k]
        };
        let meets = |of: &VoxelBox| (0..3).all(|k| along(k, of[k]));
        let pick = |boxes: &[VoxelBox]| (0..boxes.len() as u32).filter(|&n| meets(&boxes[n as usize])).collect();
        Picked { faces: pick(&self.faces), edges: pick(&self.edges), vertices: pick(&self.vertices) }
    }

    /// The rows of the features picked.
    pub fn rows(&self, picked: &Picked) -> Vec<u32> {
        let [edges, vertices, all] = picked.rows();
        let mut words = vec![0u32; ROW * all];
        let (faces, rest) = words.split_at_mut(ROW * edges);
        let (edges, vertices) = rest.split_at_mut(ROW * (vertices - edges));
        fill(faces, FACE_ROWS, &picked.faces, |n, rows| face(&self.features.faces[n], rows));
        fill(edges, EDGE_ROWS, &picked.edges, |n, rows| edge(&self.features.edges[n], rows));
        fill(vertices, VERTEX_ROWS, &picked.vertices, |n, rows| vertex(&self.features.vertices[n], rows));
        words
    }

    /// The boxes of the features picked, two numbers to a word.
    pub fn boxes(&self, picked: &Picked) -> Vec<u32> {
        let word = |[low, high]: [i16; 2]| u32::from(low as u16) | u32::from(high as u16) << 16;
        let of = |boxes: &'_ [VoxelBox], ids: &'_ [u32]| -> Vec<u32> {
            ids.par_iter().flat_map_iter(|&n| boxes[n as usize].map(word)).collect()
        };
        [of(&self.faces, &picked.faces), of(&self.edges, &picked.edges), of(&self.vertices, &picked.vertices)].concat()
    }
}

fn fill(words: &mut [u32], rows: usize, ids: &[u32], write: impl Fn(usize, &mut [u32]) + Sync) {
    words.par_chunks_exact_mut(ROW * rows).zip(ids).for_each(|(words, &n)| write(n as usize, words));
}

/// Writes row number `n`.
fn row(rows: &mut [u32], n: usize, words: [i32; 4]) {
    rows[ROW * n..ROW * (n + 1)].copy_from_slice(&words.map(|word| word as u32));
}

/// The normal of a plane, and its height above the first voxel in two words.
fn plane(normal: DVec3, at: DVec3) -> ([i32; 3], [i32; 2]) {
    // The height is that of the exact normal: an error of the rounded one grows with the distance from the first voxel, not with that from `at`.
    let height = (normal.dot(at) * SCALE).round() as i64;
    ((normal * SCALE).round().as_ivec3().to_array(), [height as i32, (height >> 32) as i32])
}

/// Writes planes, but for the higher words of their heights, which it returns.
fn planes<const N: usize>(rows: &mut [u32], planes: [(DVec3, DVec3); N]) -> [i32; N] {
    let mut high = [0; N];
    for (n, (normal, at)) in planes.into_iter().enumerate() {
        let ([x, y, z], [low, rest]) = plane(normal, at);
        row(rows, n, [x, y, z, low]);
        high[n] = rest;
    }
    high
}

/// The plane, and those of the three sides; then the higher words of all heights.
fn face(face: &FaceFeature, rows: &mut [u32]) {
    let ([a, b, c], [u, v, w]) = (face.corners, face.inner);
    let high = planes(rows, [(face.normal, a), (u, a), (v, b), (w, c)]);
    row(rows, 4, high);
}

/// Two planes along the edge, one across it, those of its faces, the higher words of all heights, the length in two words, and whether the normal
/// says nothing.
fn edge(edge: &EdgeFeature, rows: &mut [u32]) {
    let [a, b] = edge.across();
    let [s, t] = edge.sides;
    let [p, q, r, u, v] = planes(rows, [a, b, edge.along, -s, -t].map(|normal| (normal, edge.start)));
    row(rows, 5, [p, q, r, u]);
    let length = (edge.length * SCALE).round() as i64;
    row(rows, 6, [v, length as i32, (length >> 32) as i32, edge.is_blind().into()]);
}

/// The voxel nearest to it and the number of its sides, the rest of the way as bits of f32, the plane of the normal, and those of the sides; heights
/// above that voxel, in one word.
fn vertex(vertex: &VertexFeature, rows: &mut [u32]) {
    let sides = vertex.sides.iter().take_while(|&&side| side != DVec3::ZERO);
    let base = vertex.at.round();
    let rest = vertex.at - base;
    let [x, y, z] = base.as_ivec3().to_array();
    row(rows, 0, [x, y, z, sides.clone().count() as i32]);
    let [x, y, z] = rest.as_vec3().to_array().map(|part| part.to_bits() as i32);
    row(rows, 1, [x, y, z, 0]);
    for (n, normal) in std::iter::once(vertex.normal).chain(sides.map(|&side| -side)).enumerate() {
        let ([x, y, z], [height, _]) = plane(normal, rest);
        row(rows, n + 2, [x, y, z, height]);
    }
}
