//! Where the surface bends between two vertices: the point of the crease that an edge of the mesh
//! cuts off.

use glam::DVec3;

use super::facets::{Facets, Side, Sides};
use crate::mesh::Plane;
use crate::mesh::least_squares::least_squares;

/// Planes that turn by less (cosine, 3°) are no crease.
pub(super) const FLAT: f64 = 0.9986;

/// How far a point may lie beyond the ends of its facets, h, and still count as being on the source.
const BEYOND: f64 = 0.05;

/// Rounds of walking to the facets under the point and taking their planes.
const ROUNDS: usize = 4;

/// Directions whose eigenvalue is below this part of the largest are left alone.
const CUT: f64 = 1e-4;

/// A vertex: where it is and the facets it lies on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    pub at: DVec3,
    pub sides: Sides,
}

/// A point of a crease.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crease {
    /// The point and the facets that meet there.
    pub spot: Spot,
    /// Its distance from the edge that cuts it off, model units.
    pub sag: f64,
    /// Whether it lies on all its facets, and not only on their planes.
    pub on_source: bool,
    /// Cosine of the angle between the facets.
    pub cosine: f64,
}

/// The crease that the edge between `x` and `y` cuts off; `None` when their facets are one smooth
/// piece, or nothing is known. Of several creases it is the one over which the way from `x` to `y` is the
/// shortest, and one that lies on its facets before one that does not. `h` in model units.
pub(super) fn crease(facets: &Facets<'_>, h: f64, x: &Spot, y: &Spot) -> Option<Crease> {
    let normal = |side: Side| facets.plane(side).normal;
    let pairs = || x.sides.iter().flat_map(|p| y.sides.iter().map(move |q| (p, q)));
    let cosine = pairs().map(|(p, q)| normal(p).dot(normal(q))).max_by(f64::total_cmp)?;
    if cosine > FLAT {
        return None;
    }
    let found = pairs().filter_map(|(p, q)| between(facets, h, (x.at, p), (y.at, q)));
    let way = |c: &Crease| c.spot.at.distance(x.at) + c.spot.at.distance(y.at);
    let best = found.min_by(|a, b| b.on_source.cmp(&a.on_source).then(way(a).total_cmp(&way(b))))?;
    facets.is_on_target(best.spot.at, h).then_some(Crease { cosine, ..best })
}

/// The crease between the smooth pieces of two facets.
fn between(facets: &Facets<'_>, h: f64, (x, p): (DVec3, Side), (y, q): (DVec3, Side)) -> Option<Crease> {
    let (mut p, mut q) = (p, q);
    let (mut at, mut beyond) = (DVec3::ZERO, f64::INFINITY);
    for _ in 0..ROUNDS {
        let (on, other) = (facets.plane(p), facets.plane(q));
        at = match crossing(&on, &other, x, y) {
            Some(at) => at,
            // Both ways lead to one facet between those of the two.
            None if p == q => {
                let middle = (x + y) / 2.0;
                middle - on.normal * on.distance(middle)
            }
            None => return None,
        };
        let (on_p, on_q) = (facets.walk(p, at), facets.walk(q, at));
        beyond = on_p.1.max(on_q.1);
        if (on_p.0, on_q.0) == (p, q) {
            break;
        }
        (p, q) = (on_p.0, on_q.0);
    }
    let cosine = facets.plane(p).normal.dot(facets.plane(q).normal);
    let edge = y - x;
    let along = ((at - x).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    let sag = at.distance(x + edge * along);
    let spot = Spot { at, sides: Sides::of([p, q]) };
    at.is_finite().then_some(Crease { spot, sag, on_source: beyond <= BEYOND * h, cosine })
}

/// Where the straight way over two planes from `x`, on `p`, to `y`, on `q`, crosses their line.
fn crossing(p: &Plane, q: &Plane, x: DVec3, y: DVec3) -> Option<DVec3> {
    let onto = |from: DVec3| {
        let cosine = p.normal.dot(q.normal);
        let sine = 1.0 - cosine * cosine;
        let (a, b) = (p.distance(from), q.distance(from));
        (sine > 1e-9).then(|| from - p.normal * ((a - cosine * b) / sine) - q.normal * ((b - cosine * a) / sine))
    };
    let (x_on, y_on) = (onto(x)?, onto(y)?);
    let (a, b) = (x.distance(x_on), y.distance(y_on));
    Some(if a + b > 0.0 { (x_on * b + y_on * a) / (a + b) } else { x_on })
}

/// The point nearest to `from` that is on all planes, in the least squares' sense.
pub(super) fn nearest(planes: impl Iterator<Item = Plane>, from: DVec3) -> Option<DVec3> {
    let at = from + least_squares(planes.map(|plane| (plane.normal, -plane.distance(from))), CUT, 0.0);
    at.is_finite().then_some(at)
}
