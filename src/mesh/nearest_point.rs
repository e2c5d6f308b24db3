//! The nearest point of one triangle or one segment, robust for slivers and degenerate ones.

use glam::{DVec3, Vec3};

use super::Bounds;

/// Where on a triangle or a segment a point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// Off the corners of a segment; off the edges and corners of a triangle.
    Inside,
    /// On the edge of a triangle from this corner (0, 1, 2) to the next.
    Edge(u8),
    /// Exactly at this corner.
    Corner(u8),
}

/// What a [`ClosestTree`](super::ClosestTree) can hold: `[DVec3; 3]`, a triangle, or `[DVec3; 2]`, a segment.
pub trait Shape: Copy + Send + Sync {
    /// The box around it.
    fn bounds(&self) -> Bounds;
    /// Its point nearest to `p`, and where that lies. Never farther from `p` than a corner.
    fn nearest(&self, p: DVec3) -> (DVec3, Feature);
    /// The same shape with every coordinate multiplied by `factor`.
    fn scaled(&self, factor: f64) -> Self;
    /// Its corners in single precision, three always, moved by `-centre` and then multiplied by `shrink`.
    fn single(&self, centre: DVec3, shrink: f64) -> [Vec3; 3];
}

impl Shape for [DVec3; 2] {
    fn bounds(&self) -> Bounds {
        let [a, b] = *self;
        Bounds { min: a.min(b), max: a.max(b) }
    }

    #[inline]
    fn nearest(&self, p: DVec3) -> (DVec3, Feature) {
        let [a, b] = *self;
        let ab = b - a;
        let (along, whole) = ((p - a).dot(ab), ab.length_squared());
        // Written so that a segment without length, where both are zero, ends here too.
        if along <= 0.0 || whole <= 0.0 {
            (a, Feature::Corner(0))
        } else if along >= whole {
            (b, Feature::Corner(1))
        } else {
            (a + ab * (along / whole), Feature::Inside)
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        self.map(|p| p * factor)
    }

    fn single(&self, centre: DVec3, shrink: f64) -> [Vec3; 3] {
        [self[0], self[1], self[1]].map(|p| ((p - centre) * shrink).as_vec3())
    }
}

/// Below this squared sine of the angle at the first corner, a triangle's edges are tried even when
/// the foot of the perpendicular seems to lie inside: it is then only as good as the normal.
const SLIVER: f64 = 1e-6;

impl Shape for [DVec3; 3] {
    fn bounds(&self) -> Bounds {
        let [a, b, c] = *self;
        Bounds { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    #[inline]
    fn nearest(&self, p: DVec3) -> (DVec3, Feature) {
        let [a, b, c] = *self;
        let (ab, ac, ap) = (b - a, c - a, p - a);
        let normal = ab.cross(ac);
        let square = normal.length_squared();
        let mut best: Option<(DVec3, Feature)> = None;
        if square > 0.0 {
            let v = ap.cross(ac).dot(normal) / square;
            let w = ab.cross(ap).dot(normal) / square;
            if v > 0.0 && w > 0.0 && v + w < 1.0 {
                let foot = (a + ab * v + ac * w, Feature::Inside);
                if square > SLIVER * ab.length_squared() * ac.length_squared() {
                    return foot;
                }
                best = Some(foot);
            }
        }
        // Every candidate is a point of the triangle, so the nearest of them is never worse than
        // any one of them, however badly the others are conditioned.
        for (k, edge) in [[a, b], [b, c], [c, a]].iter().enumerate() {
            let (point, feature) = edge.nearest(p);
            let feature = match feature {
                Feature::Corner(end) => Feature::Corner(((k + usize::from(end)) % 3) as u8),
                _ => Feature::Edge(k as u8),
            };
            if best.is_none_or(|(held, _)| point.distance_squared(p) < held.distance_squared(p)) {
                best = Some((point, feature));
            }
        }
        best.unwrap_or((a, Feature::Corner(0)))
    }

    fn scaled(&self, factor: f64) -> Self {
        self.map(|p| p * factor)
    }

    fn single(&self, centre: DVec3, shrink: f64) -> [Vec3; 3] {
        self.map(|p| ((p - centre) * shrink).as_vec3())
    }
}
