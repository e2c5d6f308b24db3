//! Exact signs of orientation determinants, with cheap filters in front.
//!
//! The adaptive predicates behind these are exact as long as no product of three coordinate
//! differences leaves the range of an `f64`. [`scale_of`] gives the power of two that brings a mesh
//! where this holds for coordinates up to 1e180 times smaller than the largest one.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

use super::TriMesh;

/// Half a unit in the last place of 1.
const EPS: f64 = f64::EPSILON / 2.0;

/// The power of two by which coordinates of magnitude at most `largest` are multiplied, exactly,
/// before a predicate sees them: their cubes then neither overflow nor underflow.
pub(super) fn scale_of(largest: f64) -> f64 {
    if largest <= 0.0 || !largest.is_finite() {
        return 1.0;
    }
    let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    2f64.powi((300 - exponent).clamp(-1000, 1000))
}

/// [`scale_of`] for all used vertices of a mesh.
pub(crate) fn scale_of_mesh(mesh: &TriMesh) -> f64 {
    scale_of(mesh.bounds().map_or(0.0, |b| b.min.abs().max(b.max.abs()).max_element()))
}

/// On which side of the plane through `a`, `b`, `c` (seen counter-clockwise from its positive side)
/// `p` lies: positive, negative, or 0 for exactly in the plane. Exact sign.
pub(crate) fn side_of_plane([a, b, c]: &[DVec3; 3], p: DVec3) -> f64 {
    let (u, v, w) = (*a - p, *b - p, *c - p);
    let (bc, cb) = (v.x * w.y, w.x * v.y);
    let (ca, ac) = (w.x * u.y, u.x * w.y);
    let (ab, ba) = (u.x * v.y, v.x * u.y);
    let size =
        (bc.abs() + cb.abs()) * u.z.abs() + (ca.abs() + ac.abs()) * v.z.abs() + (ab.abs() + ba.abs()) * w.z.abs();
    // Planes along two axes, the most common ones by far: every product is exactly zero.
    if size == 0.0 {
        return 0.0;
    }
    let det = u.z * (bc - cb) + v.z * (ca - ac) + w.z * (ab - ba);
    if det.abs() > 8.0 * EPS * size {
        return -det;
    }
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    -robust::orient3d(coord(*a), coord(*b), coord(*c), coord(p))
}

/// On which side of the line from `a` to `b` the point `p` lies: positive (left), negative, or 0 for
/// exactly on the line. Exact sign.
pub(crate) fn side_of_line(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(p))
}

/// [`side_of_line`] where the sign is beyond doubt in plain arithmetic, 0 where it is not.
#[inline]
pub(super) fn clear_side_of_line(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let (left, right) = ((a.x - p.x) * (b.y - p.y), (a.y - p.y) * (b.x - p.x));
    let det = left - right;
    if det.abs() > 4.0 * EPS * (left.abs() + right.abs()) { det } else { 0.0 }
}

/// The coordinates of `p` but `axis` (0, 1, 2): a projection along that axis.
#[inline]
pub(super) fn without(axis: u8, p: DVec3) -> DVec2 {
    match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

/// A triangle with what its predicates need again and again. Its coordinates are scaled by
/// [`scale_of`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// The three corners.
    pub(super) corners: [DVec3; 3],
    /// Cross product of two edges, as rounded; only its direction and rough size count.
    normal: DVec3,
    /// Rounding error of the signed volume by `normal`, for each unit of distance.
    error: f64,
    /// An axis along which the triangle surely projects to a triangle with an area.
    pub(super) axis: u8,
}

impl Face {
    /// `None` when the corners are exactly collinear.
    pub(super) fn new(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        let size = u.abs().max(v.abs()).max_element();
        let strength = normal.abs();
        let strongest = strength.max_position() as u8;
        let certain = strength.max_element() > 16.0 * EPS * size * size;
        let has_area = |&axis: &u8| side_of_line(without(axis, a), without(axis, b), without(axis, c)) != 0.0;
        let axis = if certain { Some(strongest) } else { [0, 1, 2].iter().copied().find(has_area) };
        axis.map(|axis| Self { corners, normal, error: 64.0 * EPS * size * size, axis })
    }

    /// [`side_of_plane`] of the face where the sign is beyond doubt in plain arithmetic, 0 where it
    /// is not.
    #[inline]
    pub(super) fn clear_side(&self, p: DVec3) -> f64 {
        // Derivation of the 64: each component of the normal errs by at most 8 EPS size², the
        // three products of the dot product by another 8 EPS each, summed over three axes.
        let away = p - self.corners[0];
        let det = self.normal.dot(away);
        if det.abs() > self.error * away.abs().max_element() { det } else { 0.0 }
    }

    /// The exact side of the face's plane.
    pub(super) fn side(&self, p: DVec3) -> f64 {
        match self.clear_side(p) {
            0.0 => side_of_plane(&self.corners, p),
            clear => clear,
        }
    }

    /// The corners projected along `axis`.
    #[inline]
    pub(super) fn flat(&self, axis: u8) -> [DVec2; 3] {
        self.corners.map(|p| without(axis, p))
    }
}
