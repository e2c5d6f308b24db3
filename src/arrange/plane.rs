//! Planes through lattice points, exact.

use glam::DVec3;

use super::fine::ERROR;

/// The points p with `normal` · p = `offset`. At 28 bits a coordinate, normals have 59 bits and offsets 90.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) normal: [i64; 3],
    pub(crate) offset: i128,
    /// A point of the plane, and the normal, in floating point.
    anchor: DVec3,
    direction: DVec3,
}

impl Plane {
    fn new(normal: [i64; 3], at: [i32; 3]) -> Self {
        let direction = DVec3::from_array(normal.map(|x| x as f64));
        Self { normal, offset: product(normal, at), anchor: DVec3::from_array(at.map(f64::from)), direction }
    }

    /// The plane of a triangle; its normal is zero if the corners are on one line.
    pub(crate) fn through(corners: [[i32; 3]; 3]) -> Self {
        Self::new(normal(corners), corners[0])
    }

    /// The plane that holds the line from `a` to `b` and the direction of an axis; its normal points to the right of the line, seen from the
    /// tip of the axis.
    pub(crate) fn wall(a: [i32; 3], b: [i32; 3], axis: usize) -> Self {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut normal = [0; 3];
        normal[i] = i64::from(b[j]) - i64::from(a[j]);
        normal[j] = i64::from(a[i]) - i64::from(b[i]);
        Self::new(normal, a)
    }

    /// The axis along which the normal is longest.
    pub(crate) fn axis(&self) -> usize {
        let size = self.normal.map(i64::unsigned_abs);
        (0..3).max_by_key(|&k| (size[k], 3 - k)).unwrap_or(0)
    }

    /// Whether its normal points the same way as that of another one that holds the same points.
    pub(crate) fn faces_as(&self, other: &Self) -> bool {
        let axis = self.axis();
        (self.normal[axis] > 0) == (other.normal[axis] > 0)
    }

    /// `normal` · p - `offset` at a lattice point.
    #[inline]
    pub(crate) fn value(&self, p: [i32; 3]) -> i128 {
        product(self.normal, p) - self.offset
    }

    /// The side of a point where floating point is sure of it, else 0.
    #[inline]
    pub(crate) fn clear_side(&self, p: DVec3) -> i32 {
        let terms = self.direction * (p - self.anchor);
        let sum = terms.x + terms.y + terms.z;
        let bound = terms.abs().element_sum() * 1e-15 + self.direction.abs().element_sum() * (2.0 * ERROR);
        match sum.abs() > bound {
            true => sum.signum() as i32,
            false => 0,
        }
    }
}

#[inline]
fn product(normal: [i64; 3], p: [i32; 3]) -> i128 {
    (0..3).map(|k| i128::from(normal[k]) * i128::from(p[k])).sum()
}

/// The normal of a triangle, of twice its area.
#[inline]
pub(crate) fn normal([a, b, c]: [[i32; 3]; 3]) -> [i64; 3] {
    let from = |p: [i32; 3]| [0, 1, 2].map(|k| i64::from(p[k]) - i64::from(a[k]));
    let (u, v) = (from(b), from(c));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}
