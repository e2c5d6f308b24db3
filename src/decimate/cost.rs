//! What a collapse costs, and where its vertex goes: sums of squared distances from planes and lines around it.

use glam::DVec3;

/// A determinant below this part of the cube of the trace says that some direction is not determined.
const SINGULAR: f64 = 1e-30;

/// A sum of weighted squared distances as a function of a point, seen from a place near by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Form {
    /// xx, yy, zz and xy, yz, zx of the matrix.
    squares: DVec3,
    mixed: DVec3,
    linear: DVec3,
    constant: f64,
}

impl Form {
    /// Zero everywhere.
    pub(super) const ZERO: Self = Self { squares: DVec3::ZERO, mixed: DVec3::ZERO, linear: DVec3::ZERO, constant: 0.0 };

    /// Adds `weight` times (normal · p − offset)².
    #[inline]
    pub(super) fn add(&mut self, normal: DVec3, offset: f64, weight: f64) {
        let n = normal * weight;
        self.squares += n * normal;
        self.mixed += n * DVec3::new(normal.y, normal.z, normal.x);
        self.linear += n * offset;
        self.constant += weight * offset * offset;
    }

    /// Adds `weight` times the squared distance from the line through `at` along the unit vector `along`.
    pub(super) fn add_line(&mut self, at: DVec3, along: DVec3, weight: f64) {
        let (u, v) = along.any_orthonormal_pair();
        self.add(u, u.dot(at), weight);
        self.add(v, v.dot(at), weight);
    }

    /// Adds `weight` times the squared distance from a point.
    #[inline]
    pub(super) fn add_point(&mut self, at: DVec3, weight: f64) {
        self.squares += weight;
        self.linear += at * weight;
        self.constant += weight * at.length_squared();
    }

    /// The sum of both, the other one weighted.
    #[inline]
    pub(super) fn plus(&self, other: &Self, weight: f64) -> Self {
        Self {
            squares: self.squares + other.squares * weight,
            mixed: self.mixed + other.mixed * weight,
            linear: self.linear + other.linear * weight,
            constant: self.constant + other.constant * weight,
        }
    }

    /// The sum at `p`, never negative.
    #[inline]
    pub(super) fn at(&self, p: DVec3) -> f64 {
        let crossed = p * DVec3::new(p.y, p.z, p.x);
        (self.squares.dot(p * p) + 2.0 * (self.mixed.dot(crossed) - self.linear.dot(p)) + self.constant).max(0.0)
    }

    /// Where the sum is least, if it is at one place only.
    #[inline]
    pub(super) fn least(&self) -> Option<DVec3> {
        let (DVec3 { x: xx, y: yy, z: zz }, DVec3 { x: xy, y: yz, z: zx }) = (self.squares, self.mixed);
        let (a, b, c) = (DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
        let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
        let (determinant, trace) = (a.dot(bc), xx + yy + zz);
        if determinant.is_nan() || determinant <= SINGULAR * trace * trace * trace {
            return None;
        }
        let right = self.linear;
        let p = DVec3::new(right.dot(bc), right.dot(ca), right.dot(ab)) / determinant;
        p.is_finite().then_some(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_meet_where_the_sum_is_least() {
        let mut form = Form::ZERO;
        for (normal, offset) in [(DVec3::X, 1.0), (DVec3::new(0.6, 0.8, 0.0), 2.2), (DVec3::Z, -3.0)] {
            form.add(normal, offset, 2.0);
        }
        let p = form.least().expect("one point");
        assert!(p.distance(DVec3::new(1.0, 2.0, -3.0)) < 1e-12, "{p}");
        assert!(form.at(p) < 1e-12 && (form.at(p + DVec3::Z) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_line_and_planes_through_it_leave_one_direction_open() {
        let mut form = Form::ZERO;
        form.add(DVec3::X, 1.0, 1.0);
        form.add(DVec3::Y, 1.0, 1.0);
        assert_eq!(form.least(), None);
        form.add_line(DVec3::new(1.0, 1.0, 0.0), DVec3::Z, 1.0);
        assert_eq!(form.least(), None);
        assert!(form.at(DVec3::new(1.0, 1.0, 7.0)) < 1e-12);
        let mut pulled = Form::ZERO;
        pulled.add_point(DVec3::splat(5.0), 1.0);
        let p = form.plus(&pulled, 1e-6).least().expect("one point");
        assert!(p.distance(DVec3::new(1.0, 1.0, 5.0)) < 1e-4, "{p}");
    }
}
