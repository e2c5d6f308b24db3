//! Where the merged vertex of a voxel goes.

use glam::{DVec3, IVec3};

use super::Ground;
use crate::lattice::Lattice;
use crate::mesh::Plane;
use crate::mesh::least_squares::least_squares;

/// Weight of the pull towards the mean of the merged vertices, against 1 for a plane.
const PULL: f64 = 1e-7;

/// Directions whose eigenvalue is below this part of the largest are left alone: two planes make an
/// edge from 11° on.
const CUT: f64 = 0.02;

/// What a vertex that lies on no known plane adds to the pull.
const PULL_WITHOUT_PLANE: f64 = 0.1;

/// How far from the mean the vertex may go, h: as far as the corner of a box may lie from the mean of
/// its three faces' vertices, nearly.
const REACH: f64 = 1.0;

/// The place for the vertices of `voxel`, given with what they lie on, model units, and what the place itself lies on: the
/// point that minimises the squared distances to the different planes of these grounds, pulled a little towards the mean, within [`REACH`] of it and within
/// the cells around the voxel. Every coordinate is an `f32`.
pub(super) fn place(
    vertices: impl Iterator<Item = (DVec3, Ground)> + Clone,
    voxel: IVec3,
    lattice: &Lattice,
    planes: &impl Fn(Ground) -> Option<Plane>,
) -> (DVec3, Ground) {
    let mean = vertices.clone().map(|(p, _)| p).sum::<DVec3>() / vertices.clone().count().max(1) as f64;
    let mut known = [(Ground::Unknown, DVec3::ZERO, 0.0); 6];
    let (mut count, mut pull) = (0, PULL);
    for (_, ground) in vertices.clone() {
        if known[..count].iter().any(|k| k.0 == ground) {
            continue;
        }
        match planes(ground) {
            Some(plane) if count < known.len() => {
                known[count] = (ground, plane.normal, -plane.distance(mean) / lattice.h);
                count += 1;
            }
            _ => pull += PULL_WITHOUT_PLANE,
        }
    }
    let known = &known[..count];
    let step = least_squares(known.iter().map(|&(_, n, distance)| (n, distance)), CUT, pull).clamp_length_max(REACH);
    let step = if step.is_finite() { step } else { DVec3::ZERO };
    let near = lattice.to_lattice(mean) + step;
    let centre = voxel.as_dvec3();
    let at = lattice.to_model(near.clamp(centre - 1.0, centre + 1.0)).as_vec3().as_dvec3();
    let off = |k: &(Ground, DVec3, f64)| (k.1.dot(step) - k.2).abs();
    let source = known.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    (at, source.map_or(Ground::Unknown, |k| k.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LATTICE: Lattice = Lattice { origin: DVec3::new(3.0, -1.0, 2.0), h: 0.25, dims: IVec3::splat(9) };

    /// Merges points given in lattice coordinates, one plane through each, around voxel (4,4,4).
    fn placed(points: &[(DVec3, DVec3)]) -> DVec3 {
        let planes = |ground: Ground| {
            let Ground::Plane(k) = ground else { return None };
            let (point, normal) = points[k as usize];
            Some(Plane { normal, offset: normal.dot(LATTICE.to_model(point)) })
        };
        let vertices = points.iter().zip(0..).map(|(p, k)| (LATTICE.to_model(p.0), Ground::Plane(k)));
        LATTICE.to_lattice(place(vertices, IVec3::splat(4), &LATTICE, &planes).0)
    }

    #[test]
    fn three_sides_meet_in_their_corner() {
        let at = |axis: usize| DVec3::splat(4.0) + DVec3::AXES[axis] * 0.4;
        let p = placed(&[0, 1, 2].map(|axis| (at(axis), DVec3::AXES[axis])));
        assert!(p.distance(DVec3::splat(4.4)) < 0.01, "{p}");
    }

    #[test]
    fn nearly_parallel_sides_do_not_send_the_vertex_away() {
        let tilted = DVec3::new(0.03, 0.0, 1.0).normalize();
        let points = [(DVec3::new(4.4, 4.0, 4.3), DVec3::Z), (DVec3::new(4.0, 4.4, 4.31), tilted)];
        let p = placed(&points);
        assert!(p.distance((points[0].0 + points[1].0) / 2.0) < 0.1, "{p}");
    }

    #[test]
    fn planes_far_away_do_not_pull_it_out_of_reach() {
        let p = placed(&[(DVec3::splat(4.0), DVec3::X), (DVec3::new(60.0, 4.0, 4.0), DVec3::Y)]);
        assert!((p - 4.0).abs().max_element() <= 1.0 + 1e-6, "{p}");
    }
}
