//! Sums of squared distances from planes (Garland & Heckbert 1997).

use std::ops::{AddAssign, SubAssign};

use glam::{DMat3, DVec3};

/// The sum of squared distances of a point from planes, as a function of the point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Quadric {
    /// n nᵀ: xx, yy, zz, xy, yz, zx.
    squares: [f64; 6],
    /// n d
    linear: DVec3,
    /// d²
    constant: f64,
}

impl Quadric {
    /// The squared distance from the plane through `p` with unit normal `n`.
    pub(super) fn plane(n: DVec3, p: DVec3) -> Self {
        let d = -n.dot(p);
        Self {
            squares: [n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.y * n.z, n.z * n.x],
            linear: n * d,
            constant: d * d,
        }
    }

    /// The sum at `p`, never negative.
    pub(super) fn at(&self, p: DVec3) -> f64 {
        let [xx, yy, zz, xy, yz, zx] = self.squares;
        let matrix = DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
        (p.dot(matrix * p) + 2.0 * self.linear.dot(p) + self.constant).max(0.0)
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, other: Self) {
        self.squares.iter_mut().zip(other.squares).for_each(|(a, b)| *a += b);
        self.linear += other.linear;
        self.constant += other.constant;
    }
}

impl SubAssign for Quadric {
    fn sub_assign(&mut self, other: Self) {
        self.squares.iter_mut().zip(other.squares).for_each(|(a, b)| *a -= b);
        self.linear -= other.linear;
        self.constant -= other.constant;
    }
}
