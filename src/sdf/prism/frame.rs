//! A triangle in its own frame, and the distance to it as a fragment finds it (Sigg et al. 2003, §4, Figures 5 and 6).

use glam::{DVec3, IVec3, Vec3};

use crate::mesh::Pseudonormals;

/// A triangle of the surface in a frame of its own: the longest side lies on the r-axis, the third corner on the s-axis, and t
/// is the height over its plane. Lattice coordinates, from `base`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleFrame {
    /// A voxel near it: differences from there are exact where coordinates are large.
    pub base: IVec3,
    /// Origin of the frame, from `base`.
    pub origin: Vec3,
    /// The unit vectors along r, s and t; t is the normal.
    pub axes: [Vec3; 3],
    /// The corners are (a, 0), (0, h) and (−b, 0); these are a, h, b.
    pub sizes: [f32; 3],
    /// Unit pseudonormals, in the frame: of the sides from (−b, 0), from (a, 0) and from (0, h), then of these corners.
    pub normals: [Vec3; 6],
}

impl TriangleFrame {
    /// Of triangle `t`, whose `corners` (lattice coordinates) are not in line.
    pub(super) fn new(t: usize, corners: [DVec3; 3], normal: DVec3, normals: &Pseudonormals) -> Self {
        let length = |k: usize| corners[k].distance_squared(corners[(k + 1) % 3]);
        let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
        let [from, to, apex] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
        let r = (to - from).normalize();
        let s = normal.cross(r);
        let origin = from + r * r.dot(apex - from);
        let base = origin.round();
        let local = |n: DVec3| DVec3::new(n.dot(r), n.dot(s), n.dot(normal)).normalize_or_zero().as_vec3();
        let edge = |k: usize| local(normals.of_edge(t, (longest + k) % 3));
        let corner = |k: usize| local(normals.of_corner(t, (longest + k) % 3));
        Self {
            base: base.as_ivec3(),
            origin: (origin - base).as_vec3(),
            axes: [r, s, normal].map(|axis| axis.as_vec3()),
            sizes: [r.dot(to - origin), s.dot(apex - origin), r.dot(origin - from)].map(|size| size as f32),
            normals: [edge(0), edge(1), edge(2), corner(0), corner(1), corner(2)],
        }
    }

    /// How far a point, lattice coordinates, is from the triangle at least, h: from the ball around its longest side that holds it.
    #[inline]
    pub(super) fn at_least(&self, point: Vec3) -> f32 {
        let [a, h, b] = self.sizes;
        let middle = (a - b) / 2.0;
        let radius = ((a + b) / 2.0).max(middle.hypot(h));
        (point - self.base.as_vec3() - self.origin - self.axes[0] * middle).length() - radius
    }

    /// The signed distance of `voxel`, h. The paper takes the side of the triangle's plane for the sign; here it is that of the
    /// pseudonormal at the nearest point, which holds beyond the half-angle planes, too.
    #[inline]
    pub fn signed(&self, voxel: IVec3) -> f32 {
        let from = (voxel - self.base).as_vec3() - self.origin;
        let [across, s, t] = self.axes.map(|axis| axis.dot(from));
        // The half with r < 0 is mirrored, as in the paper.
        let left = across < 0.0;
        let [a, h, b] = self.sizes;
        let (r, a) = (across.abs(), if left { b } else { a });
        let square = a * a + h * h;
        // Along the slanted side from the apex to the r-axis, 0 to 1, and outwards from it.
        let along = (a * r - h * s + h * h) / square;
        let out = (h * r + a * s - a * h) / square;
        let corner = if left { 3 } else { 4 };
        let (off, feature) = if s < 0.0 {
            if r <= a { ([0.0, s], Some(0)) } else { ([r - a, s], Some(corner)) }
        } else if out <= 0.0 {
            ([0.0, 0.0], None)
        } else if along <= 0.0 {
            ([r, s - h], Some(5))
        } else if along >= 1.0 {
            ([r - a, s], Some(corner))
        } else {
            ([out * h, out * a], Some(if left { 2 } else { 1 }))
        };
        let way = Vec3::new(if left { -off[0] } else { off[0] }, off[1], t);
        let side = feature.map_or(t, |n: usize| self.normals[n].dot(way));
        if side < 0.0 { -way.length() } else { way.length() }
    }
}
