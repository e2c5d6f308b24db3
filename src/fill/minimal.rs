//! Triangles over one loop without new vertices, of least weight.
//!
//! Barequet and Sharir (Filling gaps in the boundary of a polyhedron, 1995) triangulate a loop in space as one triangulates a polygon: the best way for the part from
//! point i to point j is a triangle over the chord from i to j with a point m between them, and the best ways for the parts from i to m and from m to j. All parts are done by
//! growing length, in time of the third power of the number of points. Liepa (Filling holes in meshes, 2003) judges by the largest angle by which two triangles that share an
//! edge are bent against each other, also across the rim, and between equals by the area. That is [`Rule::Bend`].
//!
//! The largest angle alone would cut a corner off: over a missing piece of an edge of a box it prefers a bevel of two bends of 45° to the true edge of one bend of 90°.
//! [`Rule::Planes`] sums over the edges their length times the bend, where every bend above 20° counts as the same, so that triangles lie in the planes of their neighbours and are
//! bent along as few edges as possible.
//!
//! Loops that are too long for the third power are done in two steps: some points, evenly chosen along the loop, are triangulated first, and then
//! every part of the loop between two of them against its chord. For n points that are √n parts of √n points each, and the time is that of the second power of n.

use glam::DVec3;

use super::boundary::{Boundary, normal, on_a_line};

/// Loops of up to so many points are done at once.
pub(super) const AT_ONCE: usize = 160;

/// Steps of (1 − cosine) in which bends are told apart, so that rounding does not decide between flat triangles: 0.8° near zero.
const STEP: f64 = 1e-4;

/// The bend, as 1 − cosine, from which bends count as equal under [`Rule::Planes`]: 20°.
const SHARP: f64 = 0.06;

/// The share of the squares of the edges beside the area: it decides where all ways have the same area.
const SHAPE: f64 = 0.01;

/// What the best triangulation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// The least of the largest bends, then the least area.
    Bend,
    /// The fewest and shortest bent edges.
    Planes,
}

/// How bad a triangulation is: the parts count in their order.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Weight {
    /// Triangles without an area, and edges that the mesh has already.
    wrong: u32,
    /// The largest bend, in steps.
    bend: u32,
    /// Area and shape, or bent length.
    sum: f64,
}

/// Nothing to object.
const NOTHING: Weight = Weight { wrong: 0, bend: 0, sum: 0.0 };

impl Weight {
    fn and(self, other: Self) -> Self {
        Self { wrong: self.wrong + other.wrong, bend: self.bend.max(other.bend), sum: self.sum + other.sum }
    }
}

/// The best way over the part of a loop between two points.
#[derive(Debug, Clone, Copy)]
struct Part {
    weight: Weight,
    /// The third corner of the triangle over the chord.
    apex: u32,
    /// Unit normal of that triangle, or of the one beside the rim.
    normal: DVec3,
}

/// The triangles over the rim, in numbers of its points. They may be wrong (without an area, or over an edge that the mesh has) only where the loop leaves no other
/// way, or where it is too long to try all.
pub(super) fn triangulate(boundary: &Boundary, rule: Rule) -> Vec<[u32; 3]> {
    let beside: Vec<DVec3> = (0..boundary.len()).map(|edge| boundary.normal_beside(edge)).collect();
    let mut triangles = Vec::with_capacity(boundary.len() - 2);
    let all: Vec<u32> = (0..boundary.len() as u32).collect();
    of_points(boundary, &boundary.points, rule, &all, &beside, &mut triangles);
    triangles
}

/// Appends the triangles over a loop of some points, which may be others than those of the rim; `beside` has the normal across each edge, zero where none is known.
pub(super) fn of_points(
    boundary: &Boundary,
    places: &[DVec3],
    rule: Rule,
    points: &[u32],
    beside: &[DVec3],
    triangles: &mut Vec<[u32; 3]>,
) {
    of_loop(&Task { boundary, places, rule }, points, beside, triangles);
}

/// What is asked of all loops of a rim.
#[derive(Clone, Copy)]
struct Task<'a> {
    boundary: &'a Boundary,
    /// Where all points are.
    places: &'a [DVec3],
    rule: Rule,
}

fn of_loop(task: &Task<'_>, points: &[u32], beside: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    let count = points.len();
    if count <= AT_ONCE {
        Table { task: *task, points, parts: Vec::new() }.fill(beside, triangles);
        return;
    }
    let parts = ((count as f64).sqrt().ceil() as usize).clamp(3, AT_ONCE);
    let starts: Vec<usize> = (0..=parts).map(|k| k * count / parts).collect();
    let chosen: Vec<u32> = starts[..parts].iter().map(|&k| points[k]).collect();
    let over = |k: usize| beside[starts[k]..starts[k + 1]].iter().sum::<DVec3>().normalize_or_zero();
    let chords: Vec<DVec3> = (0..parts).map(over).collect();
    let first = triangles.len();
    of_loop(task, &chosen, &chords, triangles);
    let mut across = vec![DVec3::ZERO; parts];
    let place: rustc_hash::FxHashMap<u32, usize> = chosen.iter().copied().zip(0..).collect();
    for t in &triangles[first..] {
        for k in 0..3 {
            let (from, to) = (place[&t[k]], place[&t[(k + 1) % 3]]);
            if (from + 1) % parts == to {
                across[from] = normal(t.map(|v| task.places[v as usize]));
            }
        }
    }
    for k in 0..parts {
        let part: Vec<u32> = (starts[k]..=starts[k + 1]).map(|at| points[at % count]).collect();
        if part.len() > 2 {
            let mut beside = beside[starts[k]..starts[k + 1]].to_vec();
            beside.push(across[k]);
            of_loop(task, &part, &beside, triangles);
        }
    }
}

/// The best ways over all parts of a loop.
struct Table<'a> {
    task: Task<'a>,
    points: &'a [u32],
    parts: Vec<Part>,
}

impl Table<'_> {
    fn at(&self, from: usize, to: usize) -> &Part {
        &self.parts[from * self.points.len() + to]
    }

    fn place(&self, k: usize) -> DVec3 {
        self.task.places[self.points[k] as usize]
    }

    /// Finds the best ways and appends the triangles.
    fn fill(&mut self, beside: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
        let count = self.points.len();
        self.parts = vec![Part { weight: NOTHING, apex: 0, normal: DVec3::ZERO }; count * count];
        for (k, &normal) in beside[..count - 1].iter().enumerate() {
            self.parts[k * count + k + 1].normal = normal;
        }
        for length in 2..count {
            for from in 0..count - length {
                let to = from + length;
                let closing = (length == count - 1).then_some(beside[count - 1]);
                self.parts[from * count + to] = self.best(from, to, closing);
            }
        }
        let mut open = vec![[0, count - 1]];
        while let Some([from, to]) = open.pop() {
            if to - from > 1 {
                let apex = self.at(from, to).apex as usize;
                triangles.push([self.points[from], self.points[apex], self.points[to]]);
                open.extend([[apex, to], [from, apex]]);
            }
        }
    }

    /// The best way over the part from one point to another; `closing` is the normal across its chord, if that is known.
    fn best(&self, from: usize, to: usize, closing: Option<DVec3>) -> Part {
        let known = closing.is_none() && self.task.boundary.is_joined(self.points[from], self.points[to]);
        let (a, c) = (self.place(from), self.place(to));
        let mut best: Option<Part> = None;
        for apex in from + 1..to {
            let parts = self.at(from, apex).weight.and(self.at(apex, to).weight);
            if best.is_some_and(|best| parts >= best.weight) {
                continue;
            }
            let b = self.place(apex);
            let cross = (b - a).cross(c - a);
            let length = cross.length();
            let normal = if length > 0.0 { cross / length } else { DVec3::ZERO };
            let mut weight = parts;
            weight.wrong += u32::from(known) + u32::from(on_a_line([a, b, c]));
            let mut bend = |other: DVec3, edge: DVec3| {
                if other != DVec3::ZERO {
                    self.bend(&mut weight, normal.dot(other), edge);
                }
            };
            bend(self.at(from, apex).normal, b - a);
            bend(self.at(apex, to).normal, c - b);
            if let Some(other) = closing {
                bend(other, c - a);
            }
            let squares = (b - a).length_squared() + (c - b).length_squared() + (c - a).length_squared();
            weight.sum += match self.task.rule {
                Rule::Bend => length / 2.0 + SHAPE * squares,
                Rule::Planes => 1e-4 * (length / 2.0 + SHAPE * squares) / squares.sqrt().max(f64::MIN_POSITIVE),
            };
            if best.is_none_or(|best| weight < best.weight) {
                best = Some(Part { weight, apex: apex as u32, normal });
            }
        }
        best.unwrap_or(Part { weight: NOTHING, apex: from as u32, normal: DVec3::ZERO })
    }

    /// Adds a bend along an edge to a weight.
    fn bend(&self, weight: &mut Weight, cosine: f64, edge: DVec3) {
        let bend = (1.0 - cosine).max(0.0);
        match self.task.rule {
            Rule::Bend => weight.bend = weight.bend.max((bend / STEP).round() as u32),
            Rule::Planes => weight.sum += edge.length() * (bend / SHARP).min(1.0).sqrt(),
        }
    }
}
