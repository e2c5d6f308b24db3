//! Polygons to triangles.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Point tests that ear clipping may spend on one file, about half a second. Real polygons take
/// n²/4 at most; beyond the allowance polygons are cut as fans.
pub(super) const ALLOWANCE: u64 = 1 << 26;

/// Cuts the polygon `corners` (at least three, indices into `positions`) into `corners.len() - 2`
/// triangles of the same sense of rotation, appended to `out`: a fan around the first corner, or
/// ears of the polygon seen along its normal when a triangle of the fan would turn over. Returns
/// false when `allowance` was used up and the cut is only a fan.
pub(super) fn triangulate(positions: &[DVec3], corners: &[u32], allowance: &mut u64, out: &mut Vec<[u32; 3]>) -> bool {
    if corners.len() > 3 {
        let normal = newell_normal(positions, corners);
        if !fan_keeps_its_side(positions, corners, normal) {
            return clip_ears(&flattened(positions, corners, normal), corners, allowance, out);
        }
    }
    fan(corners, out);
    true
}

/// A fan around the first corner.
pub(super) fn fan(corners: &[u32], out: &mut Vec<[u32; 3]>) {
    out.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
}

fn newell_normal(positions: &[DVec3], corners: &[u32]) -> DVec3 {
    let first = positions[corners[0] as usize];
    corners
        .windows(2)
        .map(|pair| (positions[pair[0] as usize] - first).cross(positions[pair[1] as usize] - first))
        .sum()
}

fn fan_keeps_its_side(positions: &[DVec3], corners: &[u32], normal: DVec3) -> bool {
    let first = positions[corners[0] as usize];
    // A normal that overflows or vanishes gives no side to keep: `<` is false for NaN.
    !corners
        .windows(2)
        .skip(1)
        .any(|pair| (positions[pair[0] as usize] - first).cross(positions[pair[1] as usize] - first).dot(normal) < 0.0)
}

/// The corners seen against `normal` along the axis closest to it, counter-clockwise as a whole.
/// Dropping an axis keeps coordinates exact, so the tests below are exact too.
fn flattened(positions: &[DVec3], corners: &[u32], normal: DVec3) -> Vec<DVec2> {
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = if normal[axis] >= 0.0 { (u, v) } else { (v, u) };
    corners.iter().map(|&c| positions[c as usize]).map(|p| DVec2::new(p[u], p[v])).collect()
}

/// Twice the signed area of (a, b, c), its sign exact.
fn side(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// A polygon being clipped: a ring of the corners that are left.
struct Ring<'a> {
    points: &'a [DVec2],
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Corners that were not convex to begin with; only these can lie in an ear, and clipping
    /// never makes a convex corner reflex.
    reflex: Vec<usize>,
    left: usize,
}

impl Ring<'_> {
    fn side_at(&self, corner: usize) -> f64 {
        side(self.points[self.previous[corner]], self.points[corner], self.points[self.next[corner]])
    }

    /// Whether no reflex corner lies in the triangle at the convex `corner`. Corners at the same
    /// place as one of the triangle's do not count: keyhole polygons pass a point twice.
    fn is_empty_ear(&self, corner: usize) -> bool {
        let [a, b, c] = [self.previous[corner], corner, self.next[corner]].map(|i| self.points[i]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        !self.reflex.iter().any(|&i| {
            let p = self.points[i];
            // Most are far away, and the exact tests are dear.
            p.cmpge(low).all()
                && p.cmple(high).all()
                && p != a
                && p != b
                && p != c
                && side(a, b, p) >= 0.0
                && side(b, c, p) >= 0.0
                && side(c, a, p) >= 0.0
        })
    }

    fn clip(&mut self, corner: usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        self.left -= 1;
        let convex_now = [before, after].map(|i| if self.side_at(i) > 0.0 { i } else { usize::MAX });
        self.reflex.retain(|i| *i != corner && !convex_now.contains(i));
    }
}

fn clip_ears(points: &[DVec2], corners: &[u32], allowance: &mut u64, out: &mut Vec<[u32; 3]>) -> bool {
    let n = points.len();
    let mut ring = Ring {
        points,
        next: (1..n).chain([0]).collect(),
        previous: std::iter::once(n - 1).chain(0..n - 1).collect(),
        reflex: Vec::new(),
        left: n,
    };
    ring.reflex = (0..n).filter(|&i| ring.side_at(i) <= 0.0).collect();
    let mut corner = 0;
    let mut misses = 0;
    while ring.left > 3 {
        let cost = ring.reflex.len() as u64 + 1;
        if *allowance < cost {
            fan_of_rest(&ring, corner, corners, out);
            return false;
        }
        *allowance -= cost;
        // After one round without an ear take a corner without area, after two rounds any corner:
        // the polygon then crosses itself and no cut is right.
        let turn = ring.side_at(corner);
        let clip = match misses / ring.left {
            0 => turn > 0.0 && ring.is_empty_ear(corner),
            1 => turn == 0.0,
            _ => true,
        };
        let after = ring.next[corner];
        if clip {
            out.push([ring.previous[corner], corner, after].map(|i| corners[i]));
            ring.clip(corner);
            misses = 0;
        } else {
            misses += 1;
        }
        corner = after;
    }
    fan_of_rest(&ring, corner, corners, out);
    true
}

fn fan_of_rest(ring: &Ring<'_>, first: usize, corners: &[u32], out: &mut Vec<[u32; 3]>) {
    let mut corner = ring.next[first];
    while ring.next[corner] != first {
        out.push([first, corner, ring.next[corner]].map(|i| corners[i]));
        corner = ring.next[corner];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(positions: &[DVec3], t: [u32; 3]) -> f64 {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        (b - a).cross(c - a).length() / 2.0
    }

    #[test]
    fn a_concave_quad_is_not_folded() {
        // An arrowhead whose fan around the first corner would turn a triangle over.
        let positions = [(0.0, 0.0), (1.0, 2.0), (0.0, 1.0), (-1.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 5.0));
        let corners = [1, 2, 3, 0];
        let mut out = Vec::new();
        assert!(triangulate(&positions, &corners, &mut ALLOWANCE.clone(), &mut out));
        let total: f64 = out.iter().map(|&t| area(&positions, t)).sum();
        assert_eq!(total, 1.0, "{out:?}");
    }

    #[test]
    fn a_spent_allowance_still_gives_all_triangles() {
        let spiky = |i: u32| DVec2::from_angle(f64::from(i) * 0.1 * std::f64::consts::PI) * f64::from(1 + 4 * (i % 2));
        let positions: Vec<DVec3> = (0..20).map(|i| spiky(i).extend(0.0)).collect();
        let corners: Vec<u32> = (0..20).collect();
        let mut out = Vec::new();
        assert!(!triangulate(&positions, &corners, &mut 30, &mut out));
        assert_eq!(out.len(), 18);
    }

    /// A star-shaped polygon around a point that is not one of its corners, tilted in space.
    fn star() -> impl Strategy<Value = (Vec<DVec3>, f64)> {
        (prop::collection::vec(0.05f64..1.0, 4..40), -3.0f64..3.0, -3.0f64..3.0).prop_map(|(radii, tilt, turn)| {
            let rotation = glam::DQuat::from_euler(glam::EulerRot::XYZ, tilt, turn, 0.3);
            let n = radii.len() as f64;
            let flat: Vec<DVec2> = radii
                .iter()
                .enumerate()
                .map(|(i, r)| DVec2::from_angle(std::f64::consts::TAU * i as f64 / n) * *r)
                .collect();
            let area = flat.iter().zip(flat.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0;
            (flat.iter().map(|p| rotation * p.extend(0.0)).collect(), area)
        })
    }

    proptest! {
        #[test]
        fn triangles_cover_the_polygon_once((positions, expected) in star()) {
            let corners: Vec<u32> = (0..positions.len() as u32).collect();
            let mut out = Vec::new();
            prop_assert!(triangulate(&positions, &corners, &mut ALLOWANCE.clone(), &mut out));
            prop_assert_eq!(out.len(), corners.len() - 2);
            // Areas add up only if no triangle turns over or overlaps another.
            let total: f64 = out.iter().map(|&t| area(&positions, t)).sum();
            prop_assert!((total - expected).abs() < 1e-9, "{} {}", total, expected);
        }

        #[test]
        fn any_corners_give_two_less_triangles(
            points in prop::collection::vec(prop::array::uniform3(-1e300f64..1e300), 1..6),
            picks in prop::collection::vec(any::<prop::sample::Index>(), 3..30),
        ) {
            let positions: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
            let corners: Vec<u32> = picks.iter().map(|i| i.index(positions.len()) as u32).collect();
            let mut out = Vec::new();
            triangulate(&positions, &corners, &mut ALLOWANCE.clone(), &mut out);
            prop_assert_eq!(out.len(), corners.len() - 2);
        }
    }
}
