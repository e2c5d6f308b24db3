//! Points of a sheet, seen along an axis: what its triangulation asks of them.

use glam::DVec2;

use super::fine::ERROR;
use super::point::Points;
use super::wide::{Kept, sign_of_determinant};

/// A point by its exact coordinates across an axis.
#[derive(Debug, Clone, Copy)]
struct Flat {
    x: Kept,
    y: Kept,
    w: Kept,
    /// Whether it is a lattice point.
    whole: bool,
}

/// The points of a sheet by their places in a list.
#[derive(Debug, Default)]
pub(crate) struct FlatPoints {
    exact: Vec<Flat>,
    near: Vec<DVec2>,
}

impl FlatPoints {
    /// Points seen from the tip of `axis`.
    pub(crate) fn new(points: &Points, numbers: &[u32], axis: usize) -> Self {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let exact = |&id: &u32| {
            let exact = points.exact(id);
            Flat { x: exact.at[i], y: exact.at[j], w: exact.w, whole: points.vertex(id).is_some() }
        };
        let near = |&id: &u32| {
            let p = points.approximate(id);
            DVec2::new(p[i], p[j])
        };
        Self { exact: numbers.iter().map(exact).collect(), near: numbers.iter().map(near).collect() }
    }

    /// Adds a point of the plane beyond the lattice.
    pub(crate) fn push(&mut self, x: i64, y: i64) -> u32 {
        self.exact.push(Flat { x: Kept::from(x), y: Kept::from(y), w: Kept::from(1), whole: true });
        self.near.push(DVec2::new(x as f64, y as f64));
        self.near.len() as u32 - 1
    }

    pub(crate) fn len(&self) -> usize {
        self.near.len()
    }

    #[inline]
    pub(crate) fn near(&self, p: u32) -> DVec2 {
        self.near[p as usize]
    }

    /// 1 if `a`, `b`, `c` run counter-clockwise, -1 if clockwise, 0 on one line.
    pub(crate) fn turn(&self, a: u32, b: u32, c: u32) -> i32 {
        let [p, q, r] = [a, b, c].map(|v| self.near[v as usize]);
        let (u, v) = (q - p, r - p);
        let (left, right) = (u.x * v.y, u.y * v.x);
        let bound = (left.abs() + right.abs()) * 1e-15
            + (4.0 * ERROR) * (u.x.abs() + u.y.abs() + v.x.abs() + v.y.abs() + 2.0 * ERROR);
        if (left - right).abs() > bound {
            return if left > right { 1 } else { -1 };
        }
        let [a, b, c] = [a, b, c].map(|v| &self.exact[v as usize]);
        if a.whole && b.whole && c.whole {
            // Lattice coordinates are exact in floating point.
            let [u, v] = [q - p, r - p].map(|d| [d.x as i128, d.y as i128]);
            return (u[0] * v[1] - u[1] * v[0]).signum() as i32;
        }
        // Weights are positive, so that the determinant has the sign of the turn.
        sign_of_determinant(&[a, b, c].map(|p| [p.x.wide(), p.y.wide(), p.w.wide()]))
    }
}
