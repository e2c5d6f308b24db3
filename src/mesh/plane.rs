//! Planes of triangles.

use glam::DVec3;

/// The plane `normal · p = offset`, in the space of the points it was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Unit normal; the triangle's own, counter-clockwise seen from its tip. Zero when the triangle
    /// has no area.
    pub normal: DVec3,
    /// Signed distance of the plane from the origin along the normal.
    pub offset: f64,
}

impl Plane {
    /// The plane through three points.
    pub fn through([a, b, c]: [DVec3; 3]) -> Self {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        // The corner nearest to the origin loses the fewest digits.
        let near = [a, b, c].into_iter().min_by(|p, q| p.length_squared().total_cmp(&q.length_squared()));
        Self { normal, offset: normal.dot(near.unwrap_or(a)) }
    }

    /// Signed distance of `p`: positive on the side of the normal.
    #[inline]
    pub fn distance(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }
}
