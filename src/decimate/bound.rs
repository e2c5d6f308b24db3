//! How far a collapse of a vertex into a neighbour takes the surface away from where it was, at most.
//!
//! The triangles around the vertex and those in their place after it have the same border. Seen along their mean normal both must cover
//! the area within it once, without a fold; then each point of one has a mate in the other, above or below it. The distance of mates
//! changes linearly where no edge passes, so it is largest at the vertex that goes, or where an edge of before and one of after
//! cross. Neither surface is farther from the other than that. What a triangle stands for is what those that it lies over stood
//! for, so distances add up along what became of each place.

use glam::{DVec2, DVec3};

use crate::mesh::HalfEdges;

/// A crossing nearer than this to the end of an edge, as a share of it, is one of what is beside the edge, not over it.
const BESIDE: f64 = 1e-9;

/// Twice the area of a triangle, over the product of two sides, that shows that it is seen from the front.
const FRONT: f64 = 1e-9;

/// The star of a vertex, seen along its mean normal, from the vertex.
struct Star {
    /// The neighbours, counter-clockwise, the one that the vertex goes into first.
    flat: Vec<DVec2>,
    /// Their heights along the normal.
    high: Vec<f64>,
}

/// Of the triangles that are there when the origin of `half_edge` has gone into its target, in the order of the ring, how far each is
/// from the surface that it stands for, at most, given (`off`) how far each triangle was before. Less than `nothing` from one
/// to the other does not count. `None` when one is more than `most`, or when it cannot be told.
pub(super) fn moved(
    (edges, at, off): (&HalfEdges, &[DVec3], &[f32]),
    half_edge: u32,
    (nothing, most): (f64, f64),
) -> Option<Vec<f32>> {
    let star = Star::new(edges, at, half_edge)?;
    let mut old = Vec::with_capacity(star.flat.len());
    let mut e = half_edge;
    for _ in 0..star.flat.len() {
        old.push(f64::from(off[e as usize / 3]));
        e = edges.twin(edges.prev(e));
    }
    let gone = old.iter().copied().fold(0.0, f64::max);
    let count = star.flat.len();
    // Of each triangle after, which joins neighbours 0, k and k + 1: how far it is from those before, and how far these were already.
    let (mut own, mut before) = (vec![0.0f64; count], old.clone());
    let under = star.under_vertex()?;
    own[under.0] = under.1;
    before[under.0] = gone;
    for i in 1..count {
        for k in (2..count - 1).filter(|&k| k != i) {
            if let Some(apart) = star.apart_at_crossing(i, k) {
                for k in [k - 1, k] {
                    own[k] = own[k].max(apart);
                    before[k] = before[k].max(old[i]).max(old[i - 1]);
                }
            }
        }
    }
    let after = |k: usize| if own[k] > nothing { before[k] + own[k] } else { before[k] };
    let fits = (1..count - 1).all(|k| own[k] <= most && after(k) <= most);
    // Rounded up, so that sums stay bounds.
    fits.then(|| (1..count - 1).map(|k| (after(k) as f32).next_up()).collect())
}

impl Star {
    /// `None` where it is not seen without a fold.
    fn new(edges: &HalfEdges, at: &[DVec3], half_edge: u32) -> Option<Self> {
        let vertex = at[edges.origin(half_edge) as usize];
        let count = edges.valence(edges.origin(half_edge));
        let mut ring = Vec::with_capacity(count);
        let mut e = half_edge;
        for _ in 0..count {
            ring.push(at[edges.target(e) as usize] - vertex);
            e = edges.twin(edges.prev(e));
        }
        let unit = |n: DVec3| n.normalize_or_zero();
        let before = (0..count).map(|k| unit(ring[k].cross(ring[(k + 1) % count]))).sum::<DVec3>();
        let after = (1..count - 1).map(|k| unit((ring[k] - ring[0]).cross(ring[k + 1] - ring[0]))).sum::<DVec3>();
        let normal = (before + after).try_normalize()?;
        let (u, v) = normal.any_orthonormal_pair();
        let star = Self {
            flat: ring.iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect(),
            high: ring.iter().map(|p| p.dot(normal)).collect(),
        };
        star.is_seen_once().then_some(star)
    }

    fn is_seen_once(&self) -> bool {
        let count = self.flat.len();
        let front = |a: DVec2, b: DVec2| a.perp_dot(b) > FRONT * (a.length_squared() * b.length_squared()).sqrt();
        let next = |k: usize| self.flat[(k + 1) % count];
        let turns = (0..count).filter(|&k| self.flat[k].y < 0.0 && next(k).y >= 0.0).count();
        turns == 1
            && (0..count).all(|k| front(self.flat[k], next(k)))
            && (1..count - 1).all(|k| front(self.flat[k] - self.flat[0], next(k) - self.flat[0]))
    }

    /// The triangle after that lies under the vertex or over it, and how far from it.
    fn under_vertex(&self) -> Option<(usize, f64)> {
        // Shares of the corners: of the three, the least is largest where the vertex is inside.
        let shares = |k: usize| {
            let [a, b, c] = [self.flat[0], self.flat[k], self.flat[k + 1]];
            let whole = (b - a).perp_dot(c - a);
            [b.perp_dot(c) / whole, c.perp_dot(a) / whole, a.perp_dot(b) / whole]
        };
        let inside = |k: &usize| shares(*k).into_iter().fold(f64::INFINITY, f64::min);
        let k = (1..self.flat.len() - 1).max_by(|a, b| inside(a).total_cmp(&inside(b)))?;
        let [a, b, c] = shares(k);
        Some((k, (a * self.high[0] + b * self.high[k] + c * self.high[k + 1]).abs()))
    }

    /// How far the edge from the vertex to neighbour `i` and that from neighbour 0 to neighbour `k` are from each other where they
    /// cross.
    fn apart_at_crossing(&self, i: usize, k: usize) -> Option<f64> {
        let (to, a, b) = (self.flat[i], self.flat[0], self.flat[k]);
        let way = b - a;
        let turn = to.perp_dot(way);
        let (s, t) = (a.perp_dot(way) / turn, a.perp_dot(to) / turn);
        let within = |share: f64| share > BESIDE && share < 1.0 - BESIDE;
        let height = self.high[0] + t * (self.high[k] - self.high[0]);
        (within(s) && within(t)).then(|| (s * self.high[i] - height).abs())
    }
}
