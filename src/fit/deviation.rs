//! How far a collapse takes the surface away from where it was.
//!
//! Both the triangles around a vertex and those in their place after it has gone into a neighbour have the same border. Seen
//! along their mean normal they cover the same area, and the distance between them changes linearly where no edge passes: it is
//! largest at the vertex that goes, or where an edge of before and one of after cross.

use glam::{DVec2, DVec3};

use super::surface::shape;
use crate::mesh::{HalfEdges, Shape};

/// Edges at most vertices.
const USUAL: usize = 12;

/// Most edges at a vertex that can go: of more, nothing is known and it stays.
pub(super) const MOST_EDGES: usize = 128;

/// The triangles around a vertex of at most N edges, before and after.
struct Star<const N: usize> {
    count: usize,
    /// The neighbours, counter-clockwise, the one that the vertex goes into first.
    ring: [DVec3; N],
    /// The same seen along the mean normal, from the vertex.
    flat: [DVec2; N],
    /// Cosine between the mean normal and that of the triangle from neighbour k to the next, before.
    before: [f64; N],
    /// The same after; triangle k joins neighbours 0, k and k + 1.
    after: [f64; N],
    normal: DVec3,
}

/// The largest distance between the triangles around the origin of `half_edge` and those that are there when it has gone into
/// the target, both ways; `None` when it is more than `most`. In the units of `at`.
pub(super) fn deviation(edges: &HalfEdges, at: &[DVec3], half_edge: u32, most: f64) -> Option<f64> {
    match edges.valence(edges.origin(half_edge)) {
        3..=USUAL => within(&Star::<USUAL>::new(edges, at, half_edge)?, at[edges.origin(half_edge) as usize], most),
        3..=MOST_EDGES => {
            within(&Star::<MOST_EDGES>::new(edges, at, half_edge)?, at[edges.origin(half_edge) as usize], most)
        }
        _ => None,
    }
}

fn within<const N: usize>(star: &Star<N>, vertex: DVec3, most: f64) -> Option<f64> {
    let (to, count) = (star.ring[0], star.count);
    let triangle = |k: usize| [to, star.ring[k], star.ring[k + 1]];
    let square = |k: usize| triangle(k).nearest(vertex).0.distance_squared(vertex);
    let mut worst = (1..count - 1).map(square).fold(f64::INFINITY, f64::min).sqrt();
    if worst > most {
        return None;
    }
    for i in 1..count {
        let steepness = star.before[i].max(star.before[i - 1]);
        for k in (2..count - 1).filter(|&k| k != i) {
            let Some((s, t)) = crossing(star.flat[i], star.flat[0], star.flat[k]) else { continue };
            let apart = vertex.lerp(star.ring[i], s) - to.lerp(star.ring[k], t);
            let steepness = steepness.max(star.after[k]).max(star.after[k - 1]);
            worst = worst.max(star.normal.dot(apart).abs() * steepness);
        }
        if worst > most {
            return None;
        }
    }
    Some(worst)
}

impl<const N: usize> Star<N> {
    /// `None` for a star that has no side to be seen from.
    fn new(edges: &HalfEdges, at: &[DVec3], half_edge: u32) -> Option<Self> {
        let vertex = at[edges.origin(half_edge) as usize];
        let count = edges.valence(edges.origin(half_edge));
        let mut ring = [DVec3::ZERO; N];
        let mut e = half_edge;
        for neighbour in &mut ring[..count] {
            *neighbour = at[edges.target(e) as usize];
            e = edges.twin(edges.prev(e));
        }
        let normal = |corners: [DVec3; 3]| shape(corners).0.normalize_or_zero();
        let (mut before, mut after) = ([DVec3::ZERO; N], [DVec3::ZERO; N]);
        for k in 0..count {
            before[k] = normal([vertex, ring[k], ring[(k + 1) % count]]);
        }
        for k in 1..count - 1 {
            after[k] = normal([ring[0], ring[k], ring[k + 1]]);
        }
        let normal = (before[..count].iter().sum::<DVec3>() + after[..count].iter().sum::<DVec3>()).try_normalize()?;
        let (u, v) = normal.any_orthonormal_pair();
        let flat = ring.map(|p| DVec2::new((p - vertex).dot(u), (p - vertex).dot(v)));
        let cosine = |n: DVec3| n.dot(normal).abs();
        Some(Self { count, ring, flat, before: before.map(cosine), after: after.map(cosine), normal })
    }
}

/// Where the way from the origin to `to` crosses the one from `a` to `b`: the shares of both, each between 0 and 1.
fn crossing(to: DVec2, a: DVec2, b: DVec2) -> Option<(f64, f64)> {
    let way = b - a;
    let turn = to.perp_dot(way);
    let (s, t) = (a.perp_dot(way) / turn, a.perp_dot(to) / turn);
    (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0).then_some((s, t))
}
