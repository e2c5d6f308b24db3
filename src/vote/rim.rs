//! The fractional part of the winding number, from the boundary alone.
//!
//! Two surfaces with the same boundary differ by closed ones, so their winding numbers differ by
//! whole numbers. In place of the soup stand the triangles between each boundary edge and one point
//! infinitely far away. Their solid angles need not be summed: exp(2πi w) is the product of one
//! complex number an edge (van Oosterom & Strackee 1983 give its tangent), without an arc tangent
//! and without a branch to choose. The gradient of the solid angle is the field of a current along
//! the boundary (Biot–Savart), closed form for straight edges; it does not depend on the point.

use glam::{DVec2, DVec3};

use super::boundary::Loops;
use super::loop_tree::{LoopTree, Nearby};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// Up to so many boundary edges are summed one by one. 2048 take 10 µs for each point.
const MOST_EXACT: usize = 2048;
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
const TAU: f64 = std::f64::consts::TAU;

/// The boundary of one operand, ready to be asked.
#[derive(Debug, Clone)]
pub(super) enum Rim {
    /// There is none: the winding number is whole everywhere.
    Closed,
    /// Few edges: exact.
    Short(Loops),
    /// Many edges: what is far is summed in groups.
    Long(LoopTree),
}

/// The winding number at a point, but for a whole number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phase {
    /// w - ½ plus a whole number, in [-½, ½].
    pub above: f64,
    /// Of w, per model unit.
    pub gradient: DVec3,
}

/// A rim as seen from near one place.
pub(super) enum View<'r> {
    Short(&'r Loops),
    Long(Nearby<'r>),
}

impl Rim {
    /// Of the triangles `range` of `mesh`.
    pub(super) fn new(mesh: &TriMesh, range: std::ops::Range<usize>, progress: &Progress) -> Result<Self, Stopped> {
        let loops = Loops::around(mesh, range, progress)?;
        Ok(match loops.edges() {
            0 => Self::Closed,
            1..=MOST_EXACT => Self::Short(loops),
            _ => Self::Long(LoopTree::new(&loops, progress)?),
        })
    }

    /// Prepares for points within `radius` of `centre`, model units; `None` without a boundary.
    pub(super) fn view(&self, centre: DVec3, radius: f64) -> Option<View<'_>> {
        match self {
            Self::Closed => None,
            Self::Short(loops) => Some(View::Short(loops)),
            Self::Long(tree) => Some(View::Long(tree.around(centre, radius))),
        }
    }
}

impl View<'_> {
    /// The winding number at `p`, model units, but for a whole number.
    pub(super) fn at(&self, p: DVec3) -> Phase {
        match self {
            Self::Short(loops) => of_loops(loops, p),
            Self::Long(nearby) => nearby.at(p),
        }
    }
}

impl Phase {
    /// From `turn`, in the direction of exp(2πi w), and the sum of [`current`]s.
    pub(super) fn new(turn: DVec2, currents: DVec3) -> Self {
        Self { above: (-turn.y).atan2(-turn.x) / TAU, gradient: currents / FOUR_PI }
    }

    /// The winding number itself, given one that is less than ½ wrong.
    pub(super) fn complete(&self, rough: f64) -> f64 {
        let w = self.above + 0.5;
        w + (rough - w).round()
    }
}

/// The product of complex numbers, as a vector of any length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Product(DVec2);

impl Product {
    pub(super) const ONE: Self = Self(DVec2::X);

    #[inline]
    pub(super) fn times(&mut self, factor: DVec2) {
        self.0 = factor.rotate(self.0);
    }

    /// Brings the length to about 1. Factors are as long as areas, so that a few of them may be out of
    /// range: this must be called after every four or so.
    #[inline]
    pub(super) fn shorten(&mut self) {
        self.0 /= self.0.abs().max_element().max(f64::MIN_POSITIVE);
    }

    pub(super) fn direction(self) -> DVec2 {
        self.0
    }
}

/// The way from a point to a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    way: DVec3,
    distance: f64,
}

impl Sight {
    #[inline]
    pub(super) fn new(from: DVec3, to: DVec3) -> Self {
        let way = to - from;
        Self { way, distance: way.length() }
    }

    /// Towards the vertex, of length 1, or 0 at it.
    pub(super) fn direction(&self) -> DVec3 {
        self.way / self.distance.max(f64::MIN_POSITIVE)
    }
}

/// What there is to an edge seen from a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    ends: [Sight; 2],
    cross: DVec3,
    /// The product of the distances, and the same times one plus the cosine between the ways.
    product: f64,
    open: f64,
}

impl Span {
    #[inline]
    pub(super) fn new(a: Sight, b: Sight) -> Self {
        let (cross, dot, product) = (a.way.cross(b.way), a.way.dot(b.way), a.distance * b.distance);
        // Near the edge itself the sum would be all rounding.
        let open = if dot < 0.0 { cross.length_squared() / (product - dot) } else { product + dot };
        Self { ends: [a, b], cross, product, open }
    }

    /// A complex number turned by half the solid angle of the edge and the point far off in
    /// direction `apex`.
    #[inline]
    pub(super) fn turn(&self, apex: DVec3) -> DVec2 {
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
    pub(super) fn current(&self) -> DVec3 {
        let [a, b] = &self.ends;
        let squared = self.product * self.open;
        self.cross * if squared > 0.0 { (a.distance + b.distance) / squared } else { 0.0 }
    }
}

fn of_loops(loops: &Loops, p: DVec3) -> Phase {
    let (mut phase, mut good) = of_loops_with(loops, p, AWAY[0]);
    for apex in &AWAY[1..] {
        if good {
            break;
        }
        (phase, good) = of_loops_with(loops, p, *apex);
    }
    phase
}

/// The phase with the point far off in direction `apex`, and whether no vertex spoils it.
fn of_loops_with(loops: &Loops, p: DVec3, apex: DVec3) -> (Phase, bool) {
    let (mut turn, mut currents, mut spoilt) = (Product::ONE, DVec3::ZERO, false);
    for points in loops.each() {
        let mut before = Sight::new(p, points[points.len() - 1]);
        for some in points.chunks(4) {
            for &point in some {
                let here = Sight::new(p, point);
                let span = Span::new(before, here);
                let factor = span.turn(apex);
                spoilt |= span.spoils(factor);
                turn.times(factor);
                currents += span.current();
                before = here;
            }
            turn.shorten();
        }
    }
    (Phase::new(turn.direction(), currents), !spoilt)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
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
                let (all, phase) = (sum_of_all(&mesh, p), of_loops(&loops, p));
                assert!((phase.complete(all) - all).abs() < 1e-12, "{phase:?} for {all} at {p}");
                let gradient = by_differences(|q| of_loops(&loops, q).above, p, 1e-5);
                let size = phase.gradient.length();
                assert!(phase.gradient.distance(gradient) < 1e-5 * (1.0 + size), "{phase:?} and {gradient} at {p}");
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
                assert!((of_loops(&loops, p).complete(all) - all).abs() < 1e-9, "at {p}");
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
            let phase = of_loops(&loops, p);
            assert!(phase.above.abs() <= 0.5 && !phase.gradient.is_nan(), "{phase:?}");
        }
        // Around an edge it grows by one each turn, from 0 in the triangle's plane.
        for (way, expected) in [(DVec3::NEG_Z, 0.25), (DVec3::NEG_Y, 0.0), (DVec3::new(0.0, -1.0, -1.0), 0.125)] {
            let p = DVec3::X * 0.5 + way.normalize() * 1e-9;
            let w = of_loops(&loops, p).complete(expected);
            assert!((w - expected).abs() < 1e-8, "{w} for {expected}");
        }
    }
}
