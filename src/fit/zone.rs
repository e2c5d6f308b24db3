//! Where simplified triangles have met, so that every step there is looked at when it is done again.

use glam::{DVec3, IVec3};
use rustc_hash::FxHashSet;

use crate::mesh::{Shape, TriMesh, self_intersections};
use crate::progress::{Progress, Stopped};

/// Edge of the cells of space that are watched, h, and how far around a place they are.
const CELL: f64 = 2.0;
const REACH: f64 = 2.0;

/// Points of an edge that lies in the plane of a triangle which it meets.
const MOST_POINTS: usize = 64;

/// A point nearer than this, h, to a triangle is on it.
const ON: f64 = 1e-3;

/// Cells of a triangle's box that are looked up; larger triangles are watched always.
const MOST_CELLS: i64 = 4096;

/// Part of space.
#[derive(Debug, Clone)]
pub(super) enum Zone {
    /// These cells, each of `size`, model units.
    Cells { size: f64, cells: FxHashSet<IVec3> },
    /// All of it.
    Everything,
}

impl Zone {
    /// No space at all.
    pub(super) fn nothing(h: f64) -> Self {
        Self::Cells { size: CELL * h, cells: FxHashSet::default() }
    }

    /// Whether it is no space at all.
    pub(super) fn is_nothing(&self) -> bool {
        matches!(self, Self::Cells { cells, .. } if cells.is_empty())
    }

    /// Adds what is around points.
    pub(super) fn add(&mut self, places: &[DVec3], h: f64) {
        let Self::Cells { size, cells } = self else { return };
        for &p in places {
            let (low, high) = ((p - REACH * h) / *size, (p + REACH * h) / *size);
            cells.extend(steps(low.floor().as_ivec3(), high.floor().as_ivec3()));
        }
    }

    /// Whether a triangle may reach into it.
    pub(super) fn touches(&self, corners: [DVec3; 3]) -> bool {
        let Self::Cells { size, cells } = self else { return true };
        if cells.is_empty() {
            return false;
        }
        let bounds = corners.bounds();
        let (low, high) = ((bounds.min / *size).floor().as_ivec3(), (bounds.max / *size).floor().as_ivec3());
        let counts = (high - low + 1).as_i64vec3();
        counts.x * counts.y * counts.z > MOST_CELLS || steps(low, high).any(|cell| cells.contains(&cell))
    }
}

/// The cells of a box, both corners among them.
fn steps(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    let along = move |axis: usize| low[axis]..=high[axis];
    let plane = move |z: i32| along(1).flat_map(move |y| along(0).map(move |x| IVec3::new(x, y, z)));
    along(2).flat_map(plane)
}

/// Points at which the triangles `bad` of a mesh meet others of them.
pub(super) fn meeting_places(mesh: &TriMesh, bad: &[u32], h: f64, progress: &Progress) -> Result<Vec<DVec3>, Stopped> {
    let part = mesh.submesh(bad).mesh;
    let mut places = Vec::new();
    for pair in self_intersections(&part, progress)? {
        let [a, b] = pair.map(|t| part.corners(t as usize));
        let before = places.len();
        places.extend(edges_on(a, b, h).chain(edges_on(b, a, h)));
        if places.len() == before {
            // They touch in a way that rounding hides.
            places.extend(a.into_iter().chain(b));
        }
    }
    Ok(places)
}

/// Points of the edges of `a` that lie on `b`.
fn edges_on(a: [DVec3; 3], b: [DVec3; 3], h: f64) -> impl Iterator<Item = DVec3> {
    let normal = (b[1] - b[0]).cross(b[2] - b[0]).normalize_or_zero();
    let edges = (0..3).map(move |k| [a[k], a[(k + 1) % 3]]);
    let points = edges.flat_map(move |[p, q]| {
        let (from, to) = (normal.dot(p - b[0]), normal.dot(q - b[0]));
        let flat = from.abs().max(to.abs()) < ON * h;
        let count = if flat { ((p.distance(q) / h).ceil() as usize).clamp(1, MOST_POINTS) } else { 0 };
        let crossing = (!flat && from * to <= 0.0).then(|| p.lerp(q, from / (from - to)));
        (0..=count).filter(move |_| flat).map(move |k| p.lerp(q, k as f64 / count as f64)).chain(crossing)
    });
    points.filter(move |&p| b.nearest(p).0.distance(p) < ON * h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_meet_where_an_edge_of_one_passes_through_the_other() {
        let positions = [[0, 0, 0], [90, 0, 0], [0, 90, 0], [20, 20, -5], [20, 20, 5], [21, 20, 5]];
        let positions = positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        let mesh = TriMesh { positions, triangles: vec![[0, 1, 2], [3, 4, 5]] };
        let places = meeting_places(&mesh, &[0, 1], 1.0, &Progress::none()).expect("not stopped");
        assert!(
            !places.is_empty() && places.iter().all(|p| p.distance(DVec3::new(20.0, 20.0, 0.0)) < 1.0),
            "{places:?}"
        );
        let mut zone = Zone::nothing(1.0);
        assert!(zone.is_nothing() && !zone.touches(mesh.corners(0)));
        zone.add(&places, 1.0);
        assert!(zone.touches(mesh.corners(0)) && zone.touches(mesh.corners(1)));
        assert!(!zone.touches([DVec3::splat(60.0), DVec3::splat(61.0), DVec3::new(60.0, 61.0, 60.0)]));
    }
}
