//! Flat lids: polygons triangulated in their planes, and lids that lie in the planes of what is beside.

use glam::{DVec2, DVec3};
use nalgebra::{Matrix3, Vector3};

use super::boundary::Boundary;
use super::polygon::{clip_ears, is_simple};

/// Triangles lie in one plane where their normals differ by less than this (one minus the cosine, 1°).
const SAME: f64 = 1.5e-4;

/// How far points may lie from the planes beside, as a share of the diameter.
const OFF: f64 = 1e-4;

/// Cosine of 20°: three or four planes that are bent less against each other are those of a round surface. Five have no common point by chance.
const BENT: f64 = 0.9397;

/// How far from the middle of the rim the point may be where its planes meet, in diameters.
const REACH: f64 = 1.0;

/// Triangles over a rim, and the vertices that they need beside those of the rim. New vertices are numbered after the rim's and one more,
/// as a [`Sheet`](super::sheet::Sheet) has them.
#[derive(Debug)]
pub(super) struct Cover {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) added: Vec<DVec3>,
}

/// The triangles of a polygon in space, seen along its normal; `None` where its edges cross or touch when seen so. The polygon is projected along the axis that
/// is nearest to the normal, which keeps its coordinates as they are: what is said of sides is exact.
pub(super) fn polygon(points: &[DVec3], numbers: &[u32], normal: DVec3) -> Option<Vec<[u32; 3]>> {
    let axis = normal.abs().max_position();
    let flip = normal[axis] < 0.0;
    let seen = |p: DVec3| {
        let [u, v] = [p[(axis + 1) % 3], p[(axis + 2) % 3]];
        if flip { DVec2::new(v, u) } else { DVec2::new(u, v) }
    };
    let flat: Vec<DVec2> = points.iter().map(|&p| seen(p)).collect();
    let around = |k: usize| (flat[k] - flat[0]).perp_dot(flat[(k + 1) % flat.len()] - flat[0]);
    let twice: f64 = (0..flat.len()).map(around).sum();
    if twice <= 0.0 || !is_simple(&flat) {
        return None;
    }
    let triangles = clip_ears(&flat)?;
    Some(triangles.into_iter().map(|t| t.map(|k| numbers[k as usize])).collect())
}

/// A part of a rim beside which the triangles lie in one plane.
struct Side {
    /// The first and the last point; the last is the first of the next side.
    ends: [usize; 2],
    normal: DVec3,
    /// A point of the plane.
    at: DVec3,
}

/// The lid that goes on with the planes beside the rim, where these are few: over two planes that meet in a line it is bent along that line, between the two points where the rim crosses it; over
/// three or more planes that meet in a point it has that point as a new vertex. So a missing piece of an edge or a corner of a box comes back as it was.
pub(super) fn by_planes(boundary: &Boundary, diameter: f64) -> Option<Cover> {
    let sides = sides(boundary, diameter)?;
    let count = boundary.len();
    let apex = match sides.len() {
        0 | 1 => return None,
        2 if boundary.is_joined(sides[0].ends[0] as u32, sides[1].ends[0] as u32) => return None,
        2 => None,
        3 | 4 if !sides.windows(2).all(|pair| pair[0].normal.dot(pair[1].normal) < BENT) => return None,
        _ => Some(meeting_point(&sides, diameter)?),
    };
    let mut cover = Cover { triangles: Vec::new(), added: apex.into_iter().collect() };
    for side in &sides {
        let [from, to] = side.ends;
        let length = (to + count - from) % count;
        let mut numbers: Vec<u32> = (0..=length).map(|k| ((from + k) % count) as u32).collect();
        let mut points: Vec<DVec3> = numbers.iter().map(|&v| boundary.points[v as usize]).collect();
        if let Some(apex) = apex {
            numbers.push(count as u32 + 1);
            points.push(apex);
        }
        if numbers.len() < 3 {
            return None;
        }
        cover.triangles.extend(polygon(&points, &numbers, side.normal)?);
    }
    Some(cover)
}

/// The sides of a rim; `None` where a side is not flat.
fn sides(boundary: &Boundary, diameter: f64) -> Option<Vec<Side>> {
    let count = boundary.len();
    let beside: Vec<DVec3> = (0..count).map(|edge| boundary.normal_beside(edge)).collect();
    let same = |a: usize, b: usize| 1.0 - beside[a].dot(beside[b]) < SAME;
    let start = (0..count).find(|&edge| !same((edge + count - 1) % count, edge))?;
    let mut sides: Vec<Side> = Vec::new();
    for edge in (0..count).map(|k| (start + k) % count) {
        let next = (edge + 1) % count;
        // A rim of many small bends has no planes to go on with.
        if sides.len() > 12 {
            return None;
        }
        match sides.last_mut() {
            Some(side) if same(side.ends[0], edge) => side.ends[1] = next,
            _ => sides.push(Side { ends: [edge, next], normal: beside[edge], at: boundary.points[edge] }),
        }
    }
    for side in &mut sides {
        let length = (side.ends[1] + count - side.ends[0]) % count;
        let edges = (0..length).map(|k| (side.ends[0] + k) % count);
        let area = |edge: usize| {
            let [a, b, c] = [boundary.points[edge], boundary.points[(edge + 1) % count], boundary.beside[edge]];
            (c - a).cross(b - a)
        };
        side.normal = edges.clone().map(area).sum::<DVec3>().normalize_or_zero();
        side.at = edges.clone().map(|edge| boundary.points[edge]).sum::<DVec3>() / length as f64;
        let off = |p: DVec3| side.normal.dot(p - side.at).abs() > OFF * diameter;
        let ends = boundary.points[side.ends[1]];
        if off(ends) || edges.into_iter().any(|edge| off(boundary.points[edge])) {
            return None;
        }
    }
    Some(sides)
}

/// The point where the planes of all sides meet.
fn meeting_point(sides: &[Side], diameter: f64) -> Option<DVec3> {
    let middle = sides.iter().map(|side| side.at).sum::<DVec3>() / sides.len() as f64;
    let mut matrix = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for side in sides {
        let n = Vector3::new(side.normal.x, side.normal.y, side.normal.z);
        matrix += n * n.transpose();
        right += n * side.normal.dot(side.at - middle);
    }
    let eigen = matrix.symmetric_eigen();
    // Planes that meet in a line or nearly so say nothing of a point.
    if eigen.eigenvalues.min() < 1e-2 {
        return None;
    }
    let step = eigen.eigenvectors * (eigen.eigenvectors.transpose() * right).component_div(&eigen.eigenvalues);
    let point = middle + DVec3::new(step.x, step.y, step.z);
    let meets = sides.iter().all(|side| side.normal.dot(point - side.at).abs() < OFF * diameter);
    (meets && point.distance(middle) < REACH * diameter).then_some(point)
}
