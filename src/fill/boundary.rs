//! One rim with what lies beside it, in numbers of its own.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashSet;

use super::{NoLid, Rim, Surroundings};
use crate::mesh::predicates::side_of_line;

/// The points of a rim, numbered along it, with the triangles beside it. Coordinates are scaled by a power of two, so that the largest is
/// between 1 and 2 and no product of a few of them leaves the range of numbers.
#[derive(Debug)]
pub(super) struct Boundary {
    /// The points of the rim.
    pub(super) points: Vec<DVec3>,
    /// For each edge, from its point to the next, the third corner of the triangle beside it.
    pub(super) beside: Vec<DVec3>,
    /// Pairs of points (the smaller number first) that the mesh joins by an edge which is not of this rim.
    pub(super) joined: FxHashSet<[u32; 2]>,
    /// What the coordinates of the mesh are multiplied by.
    pub(super) scale: f64,
}

impl Boundary {
    pub(super) fn new(around: &Surroundings<'_>, rim: &Rim) -> Result<Self, NoLid> {
        let mesh = around.mesh();
        let count = rim.vertices.len();
        let number: rustc_hash::FxHashMap<u32, u32> = rim.vertices.iter().copied().zip(0u32..).collect();
        if count < 3 || number.len() != count || rim.vertices.iter().any(|&v| v as usize >= mesh.positions.len()) {
            return Err(NoLid::NoLoop);
        }
        let corners = |t: u32| mesh.corners(t as usize);
        let points = rim.vertices.iter().map(|&v| mesh.positions[v as usize]);
        let near = rim.vertices.iter().flat_map(|&v| around.of(v)).flat_map(|&t| corners(t));
        let largest = points.clone().chain(near).fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        if !points.clone().all(DVec3::is_finite) || !largest.is_finite() || largest < f64::MIN_POSITIVE {
            return Err(NoLid::NoLoop);
        }
        // In two steps, since the scale of the smallest numbers is itself beyond the range.
        let scale = 2f64.powi(-(largest.log2().floor() as i32).clamp(-1000, 1000));
        let mut beside = Vec::with_capacity(count);
        let mut joined = FxHashSet::default();
        for k in 0..count {
            let (from, to) = (rim.vertices[k], rim.vertices[(k + 1) % count]);
            let mut apex = None;
            let mut open = 0;
            for &t in around.of(from) {
                let t = mesh.triangles[t as usize];
                let corner = (0..3).find(|&c| t[c] == to && t[(c + 1) % 3] == from);
                apex = apex.or(corner.map(|c| t[(c + 2) % 3]));
                open += i32::from(corner.is_some()) - i32::from((0..3).any(|c| t[c] == from && t[(c + 1) % 3] == to));
                for other in t.iter().filter_map(|v| number.get(v)).map(|&v| v as usize) {
                    let gap = other.abs_diff(k);
                    if gap > 1 && gap != count - 1 {
                        joined.insert([k.min(other) as u32, k.max(other) as u32]);
                    }
                }
            }
            let apex = apex.filter(|_| open > 0).ok_or(NoLid::NoLoop)?;
            beside.push(mesh.positions[apex as usize] * scale);
        }
        let points = points.map(|p| p * scale).collect();
        Ok(Self { points, beside, joined, scale })
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// The unit normal of the triangle beside an edge, zero where it has no area.
    pub(super) fn normal_beside(&self, edge: usize) -> DVec3 {
        let (from, to) = (self.points[edge], self.points[(edge + 1) % self.len()]);
        normal([to, from, self.beside[edge]])
    }

    /// Whether the mesh has an edge between two points already.
    pub(super) fn is_joined(&self, a: u32, b: u32) -> bool {
        self.joined.contains(&[a.min(b), a.max(b)])
    }
}

/// The unit normal of a triangle of any size, zero where it has no area.
pub(super) fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let size = u.abs().max(v.abs()).max_element();
    if size > 0.0 { (u / size).cross(v / size).normalize_or_zero() } else { DVec3::ZERO }
}

/// Whether three points lie on a line, exactly.
pub(super) fn on_a_line([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let size = u.abs().max(v.abs()).max_element();
    if u.cross(v).abs().max_element() > 16.0 * f64::EPSILON * size * size {
        return false;
    }
    let seen: [fn(DVec3) -> DVec2; 3] = [|p| DVec2::new(p.y, p.z), |p| DVec2::new(p.z, p.x), |p| DVec2::new(p.x, p.y)];
    seen.iter().all(|seen| side_of_line(seen(a), seen(b), seen(c)) == 0.0)
}
