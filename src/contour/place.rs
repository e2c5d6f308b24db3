//! Where the merged vertex of a voxel goes.

use glam::{DMat3, DVec3, IVec3};

use super::NO_TRIANGLE;
use crate::lattice::Lattice;

/// Weight of the pull towards the mean of the merged vertices, against 1 for a plane. Large enough
/// that planes a few degrees apart do not send the vertex along the line where they meet.
const PULL: f64 = 0.01;

/// What a vertex that lies on no known plane adds to the pull.
const PULL_WITHOUT_PLANE: f64 = 0.1;

/// How far from the mean the vertex may go, h.
const REACH: f64 = 0.5;

/// The place for the vertices of `voxel`, given with their source triangles, model units, and the
/// source triangle it belongs to: the point that minimises the squared distances to the different
/// planes of these triangles, pulled a little towards the mean, within [`REACH`] of it and within
/// the cells around the voxel. Every coordinate is an `f32`.
pub(super) fn place(
    vertices: impl ExactSizeIterator<Item = (DVec3, u32)> + Clone,
    voxel: IVec3,
    lattice: &Lattice,
    planes: &impl Fn(u32) -> Option<(DVec3, f64)>,
) -> (DVec3, u32) {
    let mean = vertices.clone().map(|(p, _)| p).sum::<DVec3>() / vertices.len().max(1) as f64;
    let mut known: [(u32, DVec3, f64); 6] = [(NO_TRIANGLE, DVec3::ZERO, 0.0); 6];
    let (mut count, mut pull) = (0, PULL);
    for (_, triangle) in vertices.clone() {
        if known[..count].iter().any(|k| k.0 == triangle) {
            continue;
        }
        match (triangle != NO_TRIANGLE).then(|| planes(triangle)).flatten() {
            Some((normal, offset)) if count < known.len() => {
                known[count] = (triangle, normal, (offset - normal.dot(mean)) / lattice.h);
                count += 1;
            }
            _ => pull += PULL_WITHOUT_PLANE,
        }
    }
    let known = &known[..count];
    let mut matrix = DMat3::from_diagonal(DVec3::splat(pull));
    let mut right = DVec3::ZERO;
    for &(_, n, distance) in known {
        matrix += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        right += n * distance;
    }
    let step = (matrix.inverse() * right).clamp_length_max(REACH);
    let step = if step.is_finite() { step } else { DVec3::ZERO };
    let near = lattice.to_lattice(mean) + step;
    let centre = voxel.as_dvec3();
    let at = lattice.to_model(near.clamp(centre - 1.0, centre + 1.0)).as_vec3().as_dvec3();
    let off = |k: &(u32, DVec3, f64)| (k.1.dot(step) - k.2).abs();
    let source = known.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    (at, source.map_or(NO_TRIANGLE, |k| k.0))
}
