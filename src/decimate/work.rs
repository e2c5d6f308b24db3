//! The surface while edges are collapsed, and what a collapse would cost.

use glam::DVec3;

use super::cost::Form;
use super::placed;
use crate::mesh::{HalfEdges, NotManifold, TriMesh};

/// Edges that turn by more than 40° are sharp: their cosine.
const SHARP: f64 = 0.766_044_443_118_978;

/// Weight of the squared distance from a sharp edge, against that from a plane of the square over it.
const CREASE: f64 = 1.0;

/// Weight of the pull towards the middle of the neighbours, against the planes: it decides where these say nothing.
const PULL: f64 = 1e-7;

/// Weight of short edges and of round surroundings, against the planes: they decide where nothing is lost by any collapse.
const SHORT: f64 = 1e-10;
const ROUND: f64 = 1e-12;

/// A vertex may go into its neighbour without further search where that costs less than this part of what it would if it were an edge
/// length off the surface.
const EXACT: f64 = 1e-13;

/// A vertex stays this near to the middle of its edge, squared, in edge lengths.
const NEAR: f64 = 4.0;

/// The least cosine between the normals of a triangle before and after.
const STILL_FACING: f64 = 0.3;

/// The least ratio of twice the area of a triangle to the square of its longest side, unless it was less before.
const LEAST_SHAPE: f64 = 1e-4;

/// The surface; lengths are those of the model times a power of two.
pub(super) struct Work {
    pub(super) edges: HalfEdges,
    pub(super) at: Vec<DVec3>,
    /// The unit normal of each triangle and twice its area.
    normals: Vec<(DVec3, f64)>,
    classes: Vec<u32>,
}

/// A way to collapse an edge: the origin of the half-edge goes, its target moves to the place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub(super) cost: f64,
    pub(super) half_edge: u32,
    pub(super) place: DVec3,
}

/// What the triangles around an edge say, seen from its middle.
struct Around {
    form: Form,
    /// Squared distances from the neighbours.
    neighbours: Form,
    /// Entries in `neighbours`.
    count: f64,
    /// Twice the mean area of the triangles.
    mean: f64,
}

impl Work {
    /// # Errors
    /// When the mesh is no closed manifold.
    pub(super) fn new(mesh: &TriMesh, scale: f64, classes: &[u32]) -> Result<Self, NotManifold> {
        let edges = HalfEdges::new(&mesh.triangles, mesh.positions.len())?;
        let at: Vec<DVec3> = mesh.positions.iter().map(|&p| p * scale).collect();
        let mut work = Self { edges, at, normals: Vec::new(), classes: classes.to_vec() };
        work.normals = (0..mesh.triangles.len() as u32).map(|t| normal(work.corners(t))).collect();
        Ok(work)
    }

    #[inline]
    pub(super) fn place(&self, vertex: u32) -> DVec3 {
        self.at[vertex as usize]
    }

    pub(super) fn corners(&self, t: u32) -> [DVec3; 3] {
        self.edges.triangle(t).map(|v| self.place(v))
    }

    /// The half-edges that start at the ends of an edge, one in each of the triangles around it, and whether that triangle goes with
    /// the edge.
    #[inline]
    pub(super) fn star(&self, half_edge: u32, mut visit: impl FnMut(u32, bool)) {
        let (left, right) = (half_edge / 3, self.edges.twin(half_edge) / 3);
        let goes = |h: u32| h / 3 == left || h / 3 == right;
        self.edges.ring(self.edges.origin(half_edge)).for_each(|h| visit(h, goes(h)));
        self.edges.ring(self.edges.target(half_edge)).filter(|&h| !goes(h)).for_each(|h| visit(h, false));
    }

    fn around(&self, half_edge: u32, middle: DVec3) -> Around {
        let (mut form, mut neighbours, mut count, mut size) = (Form::ZERO, Form::ZERO, 0.0, 0.0);
        let twin = self.edges.twin(half_edge);
        for (end, first) in [(half_edge, true), (twin, false)] {
            let origin = self.edges.origin(end);
            let own = self.place(origin) - middle;
            for h in self.edges.ring(origin) {
                let t = h / 3;
                let to = self.place(self.edges.target(h)) - middle;
                if first || t != half_edge / 3 && t != twin / 3 {
                    let (normal, area) = self.normals[t as usize];
                    form.add(normal, normal.dot(own), area);
                    neighbours.add_point(to, 1.0);
                    size += area;
                    count += 1.0;
                }
                if h != twin && self.is_sharp(h) {
                    let square = own.distance_squared(to);
                    form.add_line(own, (to - own) / square.sqrt(), CREASE * square);
                }
            }
        }
        Around { form, neighbours, count, mean: size / count }
    }

    /// Whether an edge is to be kept: it turns sharply or lies between triangles of different classes.
    fn is_sharp(&self, half_edge: u32) -> bool {
        let [s, t] = [half_edge, self.edges.twin(half_edge)].map(|h| h as usize / 3);
        let ((a, of_a), (b, of_b)) = (self.normals[s], self.normals[t]);
        a.dot(b) < SHARP && of_a > 0.0 && of_b > 0.0
            || !self.classes.is_empty() && self.classes.get(s) != self.classes.get(t)
    }

    /// The ways to collapse an edge, the cheapest first, unused ones at the end without a cost. `free`: a vertex may go anywhere,
    /// not only into the other one; where coordinates are to be `f32`, `single` is the scale.
    pub(super) fn ways(&self, half_edge: u32, free: bool, single: Option<f64>) -> [Way; 3] {
        let twin = self.edges.twin(half_edge);
        let [u, v] = [half_edge, twin].map(|h| self.place(self.edges.origin(h)));
        let middle = u.midpoint(v);
        let around = self.around(half_edge, middle);
        let square = u.distance_squared(v);
        let (Around { form, neighbours, count, mean }, scale) = (&around, around.mean);
        let cost = |p: DVec3| {
            let p = p - middle;
            form.at(p) + scale * (SHORT * square + ROUND * neighbours.at(p) / count)
        };
        let way = |half_edge: u32, place: DVec3| Way { cost: cost(place), half_edge, place };
        let none = Way { cost: f64::INFINITY, half_edge, place: middle };
        let mut ways = [way(half_edge, v), way(twin, u), none];
        if free && ways.iter().all(|way| form.at(way.place - middle) >= EXACT * scale * square) {
            let best = form.plus(neighbours, PULL * mean / count).least();
            if let Some(p) = best.filter(|p| p.length_squared() < NEAR * square) {
                ways[2] = way(half_edge, placed(p + middle, single));
            }
        }
        ways.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        ways
    }

    /// Whether all triangles keep facing the way they did, and none becomes a needle.
    pub(super) fn fits(&self, way: &Way) -> bool {
        let mut fits = true;
        self.star(way.half_edge, |h, gone| {
            if gone || !fits {
                return;
            }
            let [a, b, c] =
                [self.edges.origin(h), self.edges.target(h), self.edges.apex(h)].map(|vertex| self.place(vertex));
            let ((before, was), (after, is)) = (self.normals[h as usize / 3], normal([way.place, b, c]));
            let longest = |p: DVec3| p.distance_squared(b).max(p.distance_squared(c)).max(b.distance_squared(c));
            let shape = is / longest(way.place);
            let good = shape > LEAST_SHAPE || shape > was / longest(a);
            fits = good && before.dot(after) > STILL_FACING;
        });
        fits && self.edges.can_collapse(way.half_edge)
    }

    /// Does a collapse for which [`Work::fits`] holds. Returns the vertex that stays.
    pub(super) fn collapse(&mut self, way: &Way) -> u32 {
        let vertex = self.edges.collapse_unchecked(way.half_edge);
        self.at[vertex as usize] = way.place;
        for h in self.edges.ring(vertex) {
            self.normals[h as usize / 3] = normal(self.edges.triangle(h / 3).map(|v| self.at[v as usize]));
        }
        vertex
    }

    /// The surface in model units, and for each triangle its number at the beginning.
    pub(super) fn finish(self, mesh: &TriMesh, scale: f64) -> (TriMesh, Vec<u32>) {
        let compacted = self.edges.compacted();
        let live = (0..self.edges.triangle_ids() as u32).filter(|&t| self.edges.is_live_triangle(t));
        let origins = live.collect();
        // What has not moved keeps its coordinates to the last bit.
        let position = |&v: &u32| {
            let old = mesh.positions[v as usize];
            if self.place(v) == old * scale { old } else { self.place(v) / scale }
        };
        let positions = compacted.vertices.iter().map(position).collect();
        (TriMesh { positions, triangles: compacted.triangles }, origins)
    }
}

/// The unit normal, or zero, and twice the area.
fn normal([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let length = normal.length();
    if length > 0.0 { (normal / length, length) } else { (DVec3::ZERO, 0.0) }
}
