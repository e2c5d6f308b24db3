//! How far a collapse takes the surface away from where it was.
//!
//! Both the triangles around a vertex and those in their place after it has gone into a neighbour have the same border. Seen
//! along their mean normal they cover the same area, and the distance between them changes linearly where no edge passes: it is
//! largest at the vertex that goes, or where an edge of before and one of after cross. What a triangle stands for is what those
//! before that it lies over stood for, so distances add up along what became of each place, and not along what is beside it.

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
    vertex: DVec3,
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

/// A triangle that an edge only just passes over is not counted as being under it: shares from the ends of an edge.
const BESIDE: f64 = 1e-9;

/// Of the triangles that are there when the origin of `half_edge` has gone into its target, in the order of the ring, how far
/// each is from the surface that it stands for, at most, given (`off`) how far each triangle was before. Distances of less than
/// `nothing` from one to the other do not count. `None` when one is more than `most`. In the units of `at`.
pub(super) fn deviation(
    (edges, at, off): (&HalfEdges, &[DVec3], &[f32]),
    half_edge: u32,
    (nothing, most): (f64, f64),
    result: impl FnMut(f64),
) -> Option<()> {
    let count = edges.valence(edges.origin(half_edge));
    if (3..=USUAL).contains(&count) {
        Star::<USUAL>::new(edges, at, half_edge)?.offs((edges, off), half_edge, (nothing, most), result)
    } else if (3..=MOST_EDGES).contains(&count) {
        Star::<MOST_EDGES>::new(edges, at, half_edge)?.offs((edges, off), half_edge, (nothing, most), result)
    } else {
        None
    }
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
        Some(Self { count, vertex, ring, flat, before: before.map(cosine), after: after.map(cosine), normal })
    }

    /// See [`deviation`].
    fn offs(
        &self,
        (edges, off): (&HalfEdges, &[f32]),
        half_edge: u32,
        (nothing, most): (f64, f64),
        mut result: impl FnMut(f64),
    ) -> Option<()> {
        let mut old = [0.0; N];
        for (old, e) in old.iter_mut().zip(edges.ring(edges.origin(half_edge))) {
            *old = f64::from(off[e as usize / 3]);
        }
        let first = edges.ring(edges.origin(half_edge)).position(|e| e == half_edge)?;
        old[..self.count].rotate_left(first);
        // Of each triangle after: how far it is from those before that are over it, and how far these were already.
        let (mut own, mut before) = ([0.0f64; N], [0.0f64; N]);
        before[1..self.count - 1].copy_from_slice(&old[1..self.count - 1]);
        self.at_vertex(&old, &mut own, &mut before);
        self.at_crossings(&old, &mut own, &mut before);
        for k in 1..self.count - 1 {
            let after = if own[k] > nothing { before[k] + own[k] } else { before[k] };
            if own[k] > most || after > most {
                return None;
            }
            result(after);
        }
        Some(())
    }

    /// The triangles after that the vertex is nearest to stand for all around it.
    fn at_vertex(&self, old: &[f64; N], own: &mut [f64; N], before: &mut [f64; N]) {
        let all = old[..self.count].iter().copied().fold(0.0, f64::max);
        let triangle = |k: usize| [self.ring[0], self.ring[k], self.ring[k + 1]];
        let off = |k: usize| triangle(k).nearest(self.vertex).0.distance_squared(self.vertex);
        let apart: [f64; N] =
            std::array::from_fn(|k| if (1..self.count - 1).contains(&k) { off(k) } else { f64::INFINITY });
        let least = apart.iter().copied().fold(f64::INFINITY, f64::min);
        for k in (1..self.count - 1).filter(|&k| apart[k] <= least) {
            own[k] = own[k].max(least.sqrt());
            before[k] = all;
        }
    }

    /// Where an edge of before and one of after cross, the triangles on both sides of them lie over one another.
    fn at_crossings(&self, old: &[f64; N], own: &mut [f64; N], before: &mut [f64; N]) {
        for i in 1..self.count {
            let over = old[i].max(old[i - 1]);
            let steep = self.before[i].max(self.before[i - 1]);
            for k in (2..self.count - 1).filter(|&k| k != i) {
                let Some((s, t)) = crossing(self.flat[i], self.flat[0], self.flat[k]) else { continue };
                let apart = self.vertex.lerp(self.ring[i], s) - self.ring[0].lerp(self.ring[k], t);
                let gap = self.normal.dot(apart).abs() * steep.max(self.after[k]).max(self.after[k - 1]);
                for k in [k - 1, k] {
                    own[k] = own[k].max(gap);
                    before[k] = before[k].max(over);
                }
            }
        }
    }
}

/// Where the way from the origin to `to` crosses the one from `a` to `b`: the shares of both, each between 0 and 1.
fn crossing(to: DVec2, a: DVec2, b: DVec2) -> Option<(f64, f64)> {
    let way = b - a;
    let turn = to.perp_dot(way);
    let (s, t) = (a.perp_dot(way) / turn, a.perp_dot(to) / turn);
    let within = |share: f64| share > BESIDE && share < 1.0 - BESIDE;
    (within(s) && within(t)).then_some((s, t))
}
