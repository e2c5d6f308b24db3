//! The fractional part of the winding number, from the boundary alone.
//!
//! Two surfaces with the same boundary differ by closed ones, so their winding numbers differ by
//! whole numbers. In place of the soup stand the triangles between each boundary edge and one point
//! infinitely far away. Their solid angles need not be summed: exp(2πi w) is the product of one
//! complex number an edge (van Oosterom & Strackee 1983 give its tangent), without an arc tangent
//! and without a branch to choose. The gradient of the solid angle is the field of a current along
//! the boundary (Biot–Savart), closed form for straight edges; it does not depend on the point.

use glam::{DMat3, DVec2, DVec3};

use super::boundary::Loops;

/// Directions to the point far away, exactly of length 1; nothing in a model is likely to lie along
/// them. The later ones serve where a vertex lies opposite to an earlier one.
const AWAY: [DVec3; 3] = [
    DVec3::new(150.0 / 475.0, 366.0 / 475.0, -263.0 / 475.0),
    DVec3::new(-216.0 / 481.0, 288.0 / 481.0, 319.0 / 481.0),
    DVec3::new(48.0 / 397.0, -269.0 / 397.0, 288.0 / 397.0),
];
/// Squared size of an edge's factor below which another direction is tried.
const TOO_SMALL: f64 = 1e-16;
const FOUR_PI: f64 = 4.0 * std::f64::consts::PI;

/// The winding number at a point, but for a whole number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phase {
    /// w - ½ plus a whole number, in [-½, ½].
    pub above: f64,
    /// Of w, per model unit.
    pub gradient: DVec3,
}

impl Phase {
    /// From `turn`, in the direction of exp(2πi w), and the gradient of the solid angle.
    pub(super) fn new(turn: Product, currents: DVec3) -> Self {
        Self { above: turn.above(), gradient: currents / FOUR_PI }
    }
}

/// The product of complex numbers, as a vector of any length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Product(DVec2);

impl Product {
    const ONE: Self = Self(DVec2::X);

    #[inline]
    pub(super) fn times(&mut self, factor: DVec2) {
        self.0 = factor.rotate(self.0);
    }

    /// Brings the length to about 1. Factors are as long as areas, so that a few of them may be out of
    /// range: this must be called after every four or so.
    #[inline]
    fn shorten(&mut self) {
        self.0 /= self.0.abs().max_element().max(f64::MIN_POSITIVE);
    }

    /// The solid angle that it is turned by, but for whole turns.
    fn solid_angle(self) -> f64 {
        2.0 * self.0.y.atan2(self.0.x)
    }

    /// For a product in the direction of exp(2πi w): w - ½ plus a whole number, in [-½, ½].
    pub(super) fn above(self) -> f64 {
        (-self.0.y).atan2(-self.0.x) / std::f64::consts::TAU
    }
}

/// The way from a point to a vertex.
#[derive(Debug, Clone, Copy)]
struct Sight {
    way: DVec3,
    distance: f64,
}

impl Sight {
    #[inline]
    fn new(from: DVec3, to: DVec3) -> Self {
        let way = to - from;
        Self { way, distance: way.length() }
    }
}

/// What there is to an edge seen from a point.
#[derive(Debug, Clone, Copy)]
struct SeenEdge {
    ends: [Sight; 2],
    cross: DVec3,
    /// The product of the distances, and the same times one plus the cosine between the ways.
    product: f64,
    open: f64,
}

impl SeenEdge {
    #[inline]
    fn new(a: Sight, b: Sight) -> Self {
        let (cross, dot, product) = (a.way.cross(b.way), a.way.dot(b.way), a.distance * b.distance);
        // Near the edge itself the sum would be all rounding.
        let open = if dot < 0.0 { cross.length_squared() / (product - dot) } else { product + dot };
        Self { ends: [a, b], cross, product, open }
    }

    /// A complex number turned by half the solid angle of the edge and the point far off in
    /// direction `apex`.
    #[inline]
    fn turn(&self, apex: DVec3) -> DVec2 {
        let [a, b] = &self.ends;
        DVec2::new(self.open + apex.dot(a.way * b.distance + b.way * a.distance), apex.dot(self.cross))
    }

    /// Whether `turn` is so short that its direction is not good.
    #[inline]
    fn spoils(&self, turn: DVec2) -> bool {
        turn.length_squared() < TOO_SMALL * self.product * self.product
    }

    /// What the edge adds to the gradient of the solid angle.
    #[inline]
    fn current(&self) -> DVec3 {
        self.cross * self.strength()
    }

    #[inline]
    fn strength(&self) -> f64 {
        let [a, b] = &self.ends;
        let squared = self.product * self.open;
        if squared > 0.0 { (a.distance + b.distance) / squared } else { 0.0 }
    }

    /// What the edge adds to the second derivatives of the solid angle: those of [`Self::current`] by the point.
    fn bend(&self) -> DMat3 {
        let [a, b] = self.ends;
        let (strength, span) = (self.strength(), b.way - a.way);
        let [along_a, along_b] = [a, b].map(|end| -end.way / end.distance);
        let of_product = along_a * b.distance + along_b * a.distance;
        let dot = self.open - self.product;
        let of_squared = of_product * (2.0 * self.product + dot) - (a.way + b.way) * self.product;
        let of_strength = (along_a + along_b - of_squared * strength) / (self.product * self.open);
        let column = |axis: DVec3| span.cross(axis) * strength + self.cross * of_strength.dot(axis);
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }
}

impl Loops {
    /// The winding number at `p`, model units, of any surface over the loops, but for a whole number.
    pub(super) fn phase(&self, p: DVec3) -> Phase {
        let (turn, currents) = self.turn_and_currents(p);
        Phase::new(turn, currents)
    }

    /// What a phase is made of: the product of the edges' turns and the sum of their currents.
    pub(super) fn turn_and_currents(&self, p: DVec3) -> (Product, DVec3) {
        let mut currents = DVec3::ZERO;
        let turn = self.turn_with(p, |span| currents += span.current());
        (turn, currents)
    }

    /// The solid angle at `p`, but for whole turns, its gradient and its second derivatives. `p` is not on an edge.
    pub(super) fn solid_angle(&self, p: DVec3) -> (f64, DVec3, DMat3) {
        let (mut gradient, mut hessian) = (DVec3::ZERO, DMat3::ZERO);
        let turn = self.turn_with(p, |span| {
            gradient += span.current();
            hessian += span.bend();
        });
        (turn.solid_angle(), gradient, hessian)
    }

    /// The product alone.
    pub(super) fn turn(&self, p: DVec3) -> Product {
        self.turn_with(p, |_| ())
    }

    /// The product of the edges' turns; calls `once` with each edge.
    #[inline]
    fn turn_with(&self, p: DVec3, once: impl FnMut(&SeenEdge)) -> Product {
        let (mut turn, mut good) = self.turn_towards(AWAY[0], p, once);
        for &apex in &AWAY[1..] {
            if good {
                break;
            }
            (turn, good) = self.turn_towards(apex, p, |_| ());
        }
        turn
    }

    /// The product with the point far off in direction `apex`, and whether no vertex spoils it.
    #[inline]
    fn turn_towards(&self, apex: DVec3, p: DVec3, mut each: impl FnMut(&SeenEdge)) -> (Product, bool) {
        let (mut turn, mut spoilt) = (Product::ONE, false);
        for points in self.each() {
            let mut before = Sight::new(p, points[points.len() - 1]);
            for some in points.chunks(4) {
                for &point in some {
                    let here = Sight::new(p, point);
                    let span = SeenEdge::new(before, here);
                    let factor = span.turn(apex);
                    spoilt |= span.spoils(factor);
                    turn.times(factor);
                    each(&span);
                    before = here;
                }
                turn.shorten();
            }
        }
        (turn, !spoilt)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::mesh::TriMesh;
    use crate::progress::Progress;
    use crate::vote::dipoles::complete;
    use crate::vote::dipoles::tests::{places, sphere, sum_of_all};

    fn loops(mesh: &TriMesh) -> Loops {
        Loops::around(mesh, 0..mesh.triangles.len(), &Progress::none()).expect("not stopped")
    }

    /// The gradient by differences of the winding number, but for whole numbers.
    pub(in crate::vote) fn by_differences(above: impl Fn(DVec3) -> f64, p: DVec3, step: f64) -> DVec3 {
        let difference = |axis: DVec3| {
            let change = above(p + axis * step) - above(p - axis * step);
            (change - change.round()) / (2.0 * step)
        };
        DVec3::new(difference(DVec3::X), difference(DVec3::Y), difference(DVec3::Z))
    }

    #[test]
    fn the_boundary_knows_the_winding_number_but_for_a_whole_number() {
        // The hole of 300 triangles is bent in space; 1 leaves a triangle.
        for missing in [1, 300] {
            let mesh = sphere(40, missing);
            let loops = loops(&mesh);
            for p in places(200) {
                let (all, phase) = (sum_of_all(&mesh, p), loops.phase(p));
                assert!((complete(phase.above, all) - all).abs() < 1e-12, "{phase:?} for {all} at {p}");
                let gradient = by_differences(|q| loops.phase(q).above, p, 1e-5);
                let size = phase.gradient.length();
                assert!(phase.gradient.distance(gradient) < 1e-5 * (1.0 + size), "{phase:?} and {gradient} at {p}");
            }
        }
    }

    #[test]
    fn second_derivatives_are_those_of_the_gradient() {
        let loops = loops(&sphere(24, 150));
        for p in places(50) {
            let (angle, gradient, hessian) = loops.solid_angle(p);
            let phase = loops.phase(p);
            let turns = angle / FOUR_PI - 0.5 - phase.above;
            assert!((turns - turns.round()).abs() < 1e-12 && gradient.distance(phase.gradient * FOUR_PI) < 1e-9);
            for axis in DVec3::AXES {
                let at = |step: f64| loops.solid_angle(p + axis * step).1;
                let change = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!(change.distance(hessian * axis) < 1e-5 * (1.0 + change.length()), "{change} at {p}");
            }
        }
    }

    #[test]
    fn a_vertex_opposite_to_the_point_far_away_does_no_harm() {
        let mesh = sphere(24, 150);
        let loops = loops(&mesh);
        for (k, away) in AWAY.iter().enumerate() {
            for vertex in loops.each().flatten() {
                let p = *vertex + *away * (0.3 + 0.1 * k as f64);
                let all = sum_of_all(&mesh, p);
                assert!((complete(loops.phase(p).above, all) - all).abs() < 1e-9, "at {p}");
            }
        }
    }

    #[test]
    fn on_the_boundary_itself_nothing_is_infinite() {
        let square = TriMesh {
            positions: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let loops = loops(&square);
        for p in [DVec3::ZERO, DVec3::X * 0.5, DVec3::new(1.0, 1.0, 0.0)] {
            let phase = loops.phase(p);
            assert!(phase.above.abs() <= 0.5 && !phase.gradient.is_nan(), "{phase:?}");
        }
        // Around an edge it grows by one each turn, from 0 in the triangle's plane.
        for (way, expected) in [(DVec3::NEG_Z, 0.25), (DVec3::NEG_Y, 0.0), (DVec3::new(0.0, -1.0, -1.0), 0.125)] {
            let p = DVec3::X * 0.5 + way.normalize() * 1e-9;
            let w = complete(loops.phase(p).above, expected);
            assert!((w - expected).abs() < 1e-8, "{w} for {expected}");
        }
    }
}
