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
    let given = (edges, off);
    match edges.valence(edges.origin(half_edge)) {
        ..3 => None,
        few if few <= USUAL => {
            Star::<USUAL>::new(edges, at, half_edge)?.offs(given, half_edge, (nothing, most), result)
        }
        many if many <= MOST_EDGES => {
            Star::<MOST_EDGES>::new(edges, at, half_edge)?.offs(given, half_edge, (nothing, most), result)
        }
        _ => None,
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
        let mut apart = [f64::INFINITY; N];
        for (k, apart) in apart.iter_mut().enumerate().take(self.count - 1).skip(1) {
            *apart = triangle(k).nearest(self.vertex).0.distance_squared(self.vertex);
        }
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

#[cfg(test)]
mod tests {
    use super::super::simplify::simplified;
    use super::super::source::own_sides;
    use super::super::{Facets, FitOptions, Surface};
    use super::*;
    use crate::mesh::{Plane, TriMesh};
    use crate::progress::Progress;

    /// A block of squares, each in two, with a step in it: its top is lower where x is above 6.
    fn stepped(n: i32) -> TriMesh {
        let solid = |c: [i32; 3]| c.iter().all(|&k| (0..n).contains(&k)) && (c[0] < 6 || c[2] < n / 2);
        let mut mesh = TriMesh::default();
        let mut ids = rustc_hash::FxHashMap::default();
        for cell in (0..n * n * n).map(|k| [k % n, k / n % n, k / n / n]).filter(|&c| solid(c)) {
            for (axis, up) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
                let mut next = cell;
                next[axis] += 2 * up - 1;
                if solid(next) {
                    continue;
                }
                let (u, v) = if up == 1 { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
                let quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                    let mut p = cell;
                    (p[axis], p[u], p[v]) = (p[axis] + up, p[u] + a, p[v] + b);
                    *ids.entry(p).or_insert_with(|| {
                        mesh.positions.push(DVec3::from_array(p.map(f64::from)));
                        mesh.positions.len() as u32 - 1
                    })
                });
                mesh.triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
        }
        mesh
    }

    /// The largest distance from corners and middles of the triangles of one mesh to the other.
    fn farthest(a: &TriMesh, b: &TriMesh) -> f64 {
        let off = |p: DVec3| {
            (0..b.triangles.len()).map(|t| b.corners(t).nearest(p).0.distance(p)).fold(f64::INFINITY, f64::min)
        };
        let points = (0..a.triangles.len()).flat_map(|t| {
            let [p, q, r] = a.corners(t);
            [p, (p + q + r) / 3.0, (p + q) / 2.0]
        });
        points.map(off).fold(0.0, f64::max)
    }

    /// The surface that a mesh is when it is its own source, and simplified.
    fn simple(mesh: &TriMesh, tolerance: f64) -> TriMesh {
        let facets = Facets::new(mesh, std::iter::empty::<Plane>());
        let surface = Surface::new(mesh.clone(), own_sides(mesh));
        let options = FitOptions { simplify: tolerance, ..FitOptions::default() };
        let off = vec![0.0; mesh.triangles.len()];
        simplified((&surface, &off), &facets, 1.0, &options, &Progress::none())
            .expect("not stopped")
            .expect("a solid")
            .surface
            .mesh
    }

    #[test]
    fn what_is_simplified_stays_within_the_tolerance_both_ways_and_corners_stay() {
        let block = stepped(12);
        for tolerance in [0.002, 0.1, 0.4] {
            let found = simple(&block, tolerance);
            assert!(farthest(&block, &found) <= tolerance && farthest(&found, &block) <= tolerance, "{tolerance}");
            assert!(found.triangles.len() <= 40, "{tolerance}: {}", found.triangles.len());
        }
        let mut wavy = stepped(12);
        for p in &mut wavy.positions {
            p.z += 0.3 * (0.7 * p.x).sin() * (0.5 * p.y).cos();
        }
        let mut last = wavy.triangles.len();
        for tolerance in [0.02, 0.1, 0.4] {
            let found = simple(&wavy, tolerance);
            let off = farthest(&wavy, &found).max(farthest(&found, &wavy));
            assert!(off <= tolerance, "{off} for {tolerance}");
            assert!(found.triangles.len() <= last, "{} after {last} for {tolerance}", found.triangles.len());
            last = found.triangles.len();
        }
    }
}
