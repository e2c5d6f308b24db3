//! A lid while it is edited.

use glam::DVec3;

use super::NoLid;
use super::boundary::{Boundary, normal};
use crate::mesh::HalfEdges;

/// An edge is turned only where the two angles opposite to it are larger together than 180° by more than this (as the sum of their cotangents).
const GAIN: f64 = 1e-9;

/// Edges bent by more than this (cosine of 30°) are left as they are, and none is made.
const CREASE: f64 = 0.866;

/// The triangles over a rim, closed below by a fan around one vertex more, so that the topology is that of a sphere. The points of the rim come first, then that
/// vertex (see [`Sheet::below`]), then the vertices that were added.
#[derive(Debug, Clone)]
pub(super) struct Sheet<'a> {
    boundary: &'a Boundary,
    topology: HalfEdges,
    /// How many of the vertices that come after the one below stay where they are, with the edges between those that follow each other.
    pub(super) held: usize,
    /// Positions of all vertices; that of the vertex below means nothing.
    pub(super) points: Vec<DVec3>,
}

impl<'a> Sheet<'a> {
    /// The sheet of these triangles, with the vertices that were added to those of the rim.
    pub(super) fn new(boundary: &'a Boundary, triangles: &[[u32; 3]], added: &[DVec3]) -> Result<Self, NoLid> {
        let count = boundary.len() as u32;
        let mut all = triangles.to_vec();
        all.extend((0..count).map(|k| [(k + 1) % count, k, count]));
        let topology = HalfEdges::new(&all, boundary.len() + 1 + added.len()).map_err(|_| NoLid::Folded)?;
        let mut points = boundary.points.clone();
        points.push(DVec3::ZERO);
        points.extend(added);
        Ok(Self { boundary, topology, held: added.len(), points })
    }

    /// The number of the vertex that is not part of the lid, which is also that of the points of the rim.
    pub(super) fn below(&self) -> u32 {
        self.boundary.len() as u32
    }

    /// The triangles of the lid.
    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        let below = self.below();
        self.topology.to_triangles().into_iter().filter(|t| !t.contains(&below)).collect()
    }

    /// How many triangles there are, with those below.
    pub(super) fn triangle_ids(&self) -> u32 {
        self.topology.triangle_ids() as u32
    }

    /// A triangle, unless it is one below.
    pub(super) fn triangle(&self, t: u32) -> Option<[u32; 3]> {
        Some(self.topology.triangle(t)).filter(|t| !t.contains(&self.below()))
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, t: [u32; 3]) -> [DVec3; 3] {
        t.map(|v| self.points[v as usize])
    }

    /// Divides a triangle into three around a new vertex.
    pub(super) fn divide(&mut self, triangle: u32, at: DVec3) {
        // A new vertex on an edge, and the edge restored across it in the triangle beside.
        let edge = 3 * triangle;
        let beside = self.topology.apex(self.topology.twin(edge));
        let new = self.topology.split(edge);
        self.points.push(at);
        let spoke = self.topology.ring(new).find(|&half| self.topology.target(half) == beside);
        spoke.map(|half| self.topology.flip(half));
    }

    /// Divides every edge that joins two points of the rim across the lid: where such an edge runs, the lid could not be bent.
    pub(super) fn divide_chords(&mut self) {
        for half in 0..3 * self.triangle_ids() {
            let (from, to) = (self.topology.origin(half), self.topology.target(half));
            let (one, other) = (self.topology.apex(half), self.topology.apex(self.topology.twin(half)));
            let below = self.below();
            if from < below && to < below && one != below && other != below {
                self.topology.split(half);
                self.points.push((self.points[from as usize] + self.points[to as usize]) / 2.0);
            }
        }
    }

    /// Turns edges until the lid is Delaunay, as far as its bends allow, or each has been turned a few times.
    pub(super) fn turn_edges(&mut self) {
        let halves = 0..3 * self.triangle_ids();
        let mut stack: Vec<u32> = halves.filter(|&h| h < self.topology.twin(h)).rev().collect();
        let mut budget = 20 * stack.len();
        while let Some(half) = stack.pop() {
            if budget == 0 {
                return;
            }
            if !self.should_turn(half) || !self.topology.flip(half) {
                continue;
            }
            budget -= 1;
            let twin = self.topology.twin(half);
            for h in [half, twin] {
                stack.extend([self.topology.next(h), self.topology.prev(h)]);
            }
        }
    }

    /// Whether a vertex is one of those that were added first and stay.
    fn is_held(&self, v: u32) -> bool {
        let below = self.below() as usize;
        (below + 1..=below + self.held).contains(&(v as usize))
    }

    fn should_turn(&self, half: u32) -> bool {
        let twin = self.topology.twin(half);
        let quad = [
            self.topology.origin(half),
            self.topology.target(half),
            self.topology.apex(half),
            self.topology.apex(twin),
        ];
        if quad.contains(&self.below())
            || (self.is_held(quad[0]) && self.is_held(quad[1]))
            || self.boundary.is_joined(quad[2], quad[3])
        {
            return false;
        }
        let [a, b, c, d] = quad.map(|v| self.points[v as usize]);
        let cotangent = |at: DVec3| {
            let (u, v) = (a - at, b - at);
            u.dot(v) / u.cross(v).length().max(f64::MIN_POSITIVE)
        };
        if cotangent(c) + cotangent(d) >= -GAIN {
            return false;
        }
        let [old, other] = [normal([a, b, c]), normal([b, a, d])];
        let [new, beside] = [normal([d, c, a]), normal([c, d, b])];
        let whole = ((b - a).cross(c - a) + (d - a).cross(b - a)).normalize_or_zero();
        let flat = old == DVec3::ZERO || other == DVec3::ZERO;
        (flat || old.dot(other) > CREASE) && new.dot(beside) > CREASE && new.dot(whole) > 0.5 && beside.dot(whole) > 0.5
    }
}
