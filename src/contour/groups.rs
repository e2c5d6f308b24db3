//! Which vertices of the raw contour are to become one.
//!
//! The paper merges the vertices of each inside voxel's cube. Along a convex edge of the solid that
//! puts one vertex on the edge for each voxel; along a concave edge it does not, since the cubes on
//! either side have faces on one side only. There the cubes of the *outside* voxels have both, so
//! where an outside voxel's vertices lie on planes that meet at an angle, they are merged instead.
//! The sharpest groups choose first.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::{ContourVertex, Ground};
use crate::mesh::Plane;

/// One minus the cosine of the angle between planes from which they make an edge (20°). Curved
/// surfaces at usual resolutions stay below; from 30° on the judges of sharpness count.
const EDGE: f64 = 0.06;

/// Vertices that should become one: a range of the list of members, and the voxel, inside or
/// outside, whose cube they are faces of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub members: std::ops::Range<usize>,
    pub voxel: IVec3,
}

/// All faces of one voxel's cube.
struct Cube {
    voxel: IVec3,
    faces: std::ops::Range<usize>,
    sharpness: f64,
}

/// The list of members and the groups, at least two vertices each, no vertex in two of them.
pub(super) fn groups(
    vertices: &[ContourVertex],
    planes: &(impl Fn(Ground) -> Option<Plane> + Sync),
) -> (Vec<u32>, Vec<Candidate>) {
    let normals: Vec<Option<DVec3>> = vertices.par_iter().map(|vertex| outward(vertex, planes)).collect();
    let (inner, inner_cubes) = cubes(vertices, &normals, |vertex| vertex.voxel);
    let (outer, outer_cubes) = cubes(vertices, &normals, |vertex| vertex.outside);
    let sharp = |cubes: &[Cube]| -> Vec<usize> { (0..cubes.len()).filter(|&n| cubes[n].sharpness > EDGE).collect() };
    let mut order: Vec<(bool, usize)> = sharp(&inner_cubes).into_iter().map(|n| (false, n)).collect();
    order.extend(sharp(&outer_cubes).into_iter().map(|n| (true, n)));
    let of = |&(outside, n): &(bool, usize)| if outside { &outer_cubes[n] } else { &inner_cubes[n] };
    order.par_sort_by(|a, b| of(b).sharpness.total_cmp(&of(a).sharpness));
    // Then what is left, as in the paper.
    order.extend((0..inner_cubes.len()).map(|n| (false, n)));
    let mut taken = vec![false; vertices.len()];
    let (mut members, mut candidates) = (Vec::with_capacity(vertices.len()), Vec::new());
    for key in &order {
        let cube = of(key);
        let faces = if key.0 { &outer[cube.faces.clone()] } else { &inner[cube.faces.clone()] };
        let start = members.len();
        members.extend(faces.iter().copied().filter(|&v| !taken[v as usize]));
        // A sharp cube that has lost a face to a sharper one waits for the paper's turn.
        let whole = members.len() - start == faces.len();
        if members.len() - start < 2 || (cube.sharpness > EDGE && key.0 && !whole) {
            members.truncate(start);
            continue;
        }
        members[start..].iter().for_each(|&v| taken[v as usize] = true);
        candidates.push(Candidate { members: start..members.len(), voxel: cube.voxel });
    }
    (members, candidates)
}

/// The normal of what a vertex lies on, turned so that it looks from inside to outside.
fn outward(vertex: &ContourVertex, planes: &impl Fn(Ground) -> Option<Plane>) -> Option<DVec3> {
    let normal = planes(vertex.ground)?.normal;
    let along = normal.dot((vertex.outside - vertex.voxel).as_dvec3());
    Some(if along < 0.0 { -normal } else { normal })
}

/// The vertices sorted by voxel, and the cubes of these voxels.
fn cubes(
    vertices: &[ContourVertex],
    normals: &[Option<DVec3>],
    voxel: impl Fn(&ContourVertex) -> IVec3 + Sync,
) -> (Vec<u32>, Vec<Cube>) {
    let key = |v: u32| {
        let voxel = voxel(&vertices[v as usize]);
        [voxel.z, voxel.y, voxel.x]
    };
    let mut sorted: Vec<([i32; 3], u32)> = (0..vertices.len() as u32).into_par_iter().map(|v| (key(v), v)).collect();
    sorted.par_sort_unstable();
    let mut start = 0;
    let cubes = sorted.chunk_by(|a, b| a.0 == b.0).map(|run| {
        start += run.len();
        let [z, y, x] = run[0].0;
        Cube {
            voxel: IVec3::new(x, y, z),
            faces: start - run.len()..start,
            sharpness: sharpness(run.iter().filter_map(|&(_, v)| normals[v as usize])),
        }
    });
    let cubes = cubes.filter(|cube| cube.faces.len() > 1).collect();
    (sorted.into_iter().map(|(_, v)| v).collect(), cubes)
}

/// One minus the cosine of the largest angle between the normals.
fn sharpness(normals: impl Iterator<Item = DVec3>) -> f64 {
    let mut seen = [DVec3::ZERO; 6];
    let (mut count, mut least) = (0, 1.0f64);
    for normal in normals.take(seen.len()) {
        least = seen[..count].iter().map(|other| other.dot(normal)).fold(least, f64::min);
        seen[count] = normal;
        count += 1;
    }
    1.0 - least
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The planes of two sides that look along x and y.
    fn planes(ground: Ground) -> Option<Plane> {
        let normal = if ground == Ground::Triangle(0) { DVec3::X } else { DVec3::Y };
        Some(Plane { normal, offset: 0.0 })
    }

    /// Faces of voxels along the inner edge of an L, whose arms look along x and y.
    #[test]
    fn a_concave_edge_merges_around_the_outside_voxel() {
        let face = |n: u32, voxel: IVec3, step: IVec3| ContourVertex {
            ground: Ground::Triangle(n),
            voxel,
            outside: voxel + step,
        };
        let corner = IVec3::new(1, 1, 0); // outside
        let vertices = [face(0, IVec3::new(0, 1, 0), IVec3::X), face(1, IVec3::new(1, 0, 0), IVec3::Y)];
        let (members, candidates) = groups(&vertices, &planes);
        assert_eq!(members, [0, 1]);
        assert_eq!(candidates, [Candidate { members: 0..2, voxel: corner }]);
        // On one plane nothing speaks for the outside voxel.
        assert_eq!(groups(&vertices, &|_| Some(Plane { normal: DVec3::ONE.normalize(), offset: 0.0 })).1, []);
    }

    #[test]
    fn a_convex_edge_merges_around_the_inside_voxel() {
        let voxel = IVec3::new(3, 4, 5);
        let vertices = [
            ContourVertex { ground: Ground::Triangle(0), voxel, outside: voxel + IVec3::X },
            ContourVertex { ground: Ground::Triangle(1), voxel, outside: voxel + IVec3::Y },
        ];
        assert_eq!(groups(&vertices, &planes).1, [Candidate { members: 0..2, voxel }]);
    }
}
