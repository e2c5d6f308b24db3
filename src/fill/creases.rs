//! Sharp edges that run into a hole and out of it.
//!
//! A smooth lid would round such an edge off. Where two edges of the surface end at a rim that are bent alike, more than what is beside them, and point to each other, they are continued first, by a cubic curve that
//! has their directions at its ends. It divides the rim into two loops, each of which is closed by itself. Several such curves may divide a rim; none crosses another one.

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::boundary::{Boundary, normal};
use super::flat::Cover;
use super::minimal::of_loops;
use super::{Rim, Surroundings};

/// Radians, 30°: edges that are bent more are sharp.
const SHARP: f64 = 0.5236;

/// Radians, 15°: an edge that is bent by less is none that goes on through a hole.
const WEAK: f64 = 0.2618;

/// What edges beside the one that goes on are bent by at most, as a share of its bend.
const ALONE: f64 = 0.7;

/// What the edge before, or the one at the other side of the hole, is bent by at least, as a share.
const ALIKE: f64 = 0.5;

/// The least cosine between a sharp edge and the line to the other one.
const TOWARDS: f64 = 0.3;

/// Cosine of 30°: sharp edges that follow each other with a smaller bend are one curve.
const FOLLOWS: f64 = 0.866;

/// A curve goes through points of the rim that are nearer to it than this share of the rim's mean edge.
const NEAR: f64 = 0.35;

/// How far apart along a curve two of its points are at most for which an edge between them is ruled out.
const MOST_CHORDS: usize = 200;

/// The edges at a vertex that have a triangle on either side, as their other ends with the angles by which the triangles are bent, in order of their places. Angles are
/// positive where the surface is convex.
fn bends(around: &Surroundings<'_>, vertex: u32) -> Vec<(u32, f64)> {
    let mesh = around.mesh();
    let at = |v: u32| mesh.positions[v as usize];
    let mut ends: Vec<(u32, u32, DVec3)> = Vec::new();
    for &t in around.of(vertex) {
        let n = normal(mesh.corners(t as usize));
        let corners = mesh.triangles[t as usize];
        for &end in corners.iter().filter(|&&w| w != vertex) {
            let apex = corners.into_iter().find(|&w| w != vertex && w != end);
            ends.extend(apex.map(|apex| (end, apex, n)));
        }
    }
    ends.sort_by_key(|end| end.0);
    let mut found = Vec::new();
    for pair in ends.chunk_by(|a, b| a.0 == b.0) {
        if let &[(end, _, n), (_, apex, other)] = pair
            && n != DVec3::ZERO
            && other != DVec3::ZERO
        {
            let angle = n.dot(other).clamp(-1.0, 1.0).acos();
            found.push((end, if n.dot(at(apex) - at(vertex)) < 0.0 { angle } else { -angle }));
        }
    }
    let place = |v: u32| at(v).to_array();
    found.sort_by(|a, b| place(a.0).partial_cmp(&place(b.0)).unwrap_or(std::cmp::Ordering::Equal));
    found
}

/// Whether a sharp edge ends at a vertex.
pub(super) fn is_sharp(around: &Surroundings<'_>, vertex: u32) -> bool {
    bends(around, vertex).iter().any(|bend| bend.1.abs() > SHARP)
}

/// Where an edge of the surface ends at the rim.
struct End {
    /// The point of the rim.
    at: usize,
    /// The direction in which the edge goes on.
    way: DVec3,
    /// By how much the surface is bent there.
    bend: f64,
}

impl End {
    /// The edge that goes on through the hole from a point of the rim; `None` where it is not bent much more than all others, or is one edge alone, as noise makes them.
    fn new(around: &Surroundings<'_>, rim: &Rim, at: usize) -> Option<Self> {
        let vertex = rim.vertices[at];
        let place = |v: u32| around.mesh().positions[v as usize];
        let all = bends(around, vertex);
        let &(before, bend) = all.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let others = all.iter().filter(|other| other.0 != before);
        if bend.abs() < WEAK || others.map(|other| other.1.abs()).any(|other| other > ALONE * bend.abs()) {
            return None;
        }
        let last = (place(vertex) - place(before)).try_normalize()?;
        // The edge before follows best among those that are bent likewise.
        let likewise = bends(around, before).into_iter().filter(|&(v, other)| v != vertex && other / bend > ALIKE);
        let ways = likewise.filter_map(|(v, _)| (place(before) - place(v)).try_normalize());
        let first = ways.max_by(|a, b| a.dot(last).total_cmp(&b.dot(last)))?;
        if first.dot(last) < FOLLOWS {
            return None;
        }
        // The tangent at the end of a curve turns on from its last chord by half as much as the chords turn.
        Some(Self { at, way: (last * 1.5 - first * 0.5).try_normalize()?, bend })
    }
}

/// A cubic curve: its ends, and the derivatives there.
#[derive(Clone, Copy)]
struct Curve {
    ends: [DVec3; 2],
    speeds: [DVec3; 2],
}

impl Curve {
    /// The continuation of two sharp edges into one. With this length of the derivatives the curve is nearly an arc where its ends lie on one.
    fn between(start: DVec3, out: DVec3, end: DVec3, back: DVec3) -> Self {
        let chord = end - start;
        let length = chord.length();
        let speed = length * 2.0 / (1.0 + (out.dot(chord) - back.dot(chord)) / length / 2.0);
        Self { ends: [start, end], speeds: [out * speed, -back * speed] }
    }

    fn at(&self, t: f64) -> DVec3 {
        let (t2, t3) = (t * t, t * t * t);
        let [start, end] = self.ends;
        let [first, second] = self.speeds;
        start + (end - start) * (3.0 * t2 - 2.0 * t3) + first * (t3 - 2.0 * t2 + t) + second * (t3 - t2)
    }

    fn derivative(&self, t: f64) -> DVec3 {
        let [first, second] = self.speeds;
        (self.ends[1] - self.ends[0]) * (6.0 * (t - t * t))
            + first * (3.0 * t * t - 4.0 * t + 1.0)
            + second * (3.0 * t * t - 2.0 * t)
    }
}

/// The lid while it is divided into loops.
struct Loops<'a> {
    boundary: &'a Boundary,
    /// Pairs of points, the smaller number first, between which there can be no edge: those that the mesh joins, and those of one curve, whose chords on both sides would cross each other.
    joined: FxHashSet<[u32; 2]>,
    /// All points: those of the rim, one that means nothing, those that were added.
    points: Vec<DVec3>,
    /// The numbers of the points of each loop, and the normals beside its edges.
    loops: Vec<(Vec<u32>, Vec<DVec3>)>,
}

impl Loops<'_> {
    /// Divides the loop that has two points along a curve between them. Nothing is known of what lies beyond the curve.
    fn divide(&mut self, from: u32, to: u32, added: &[DVec3]) -> bool {
        let place = |(numbers, _): &(Vec<u32>, Vec<DVec3>)| {
            let [a, b] = [from, to].map(|v| numbers.iter().position(|&n| n == v));
            Some([a?, b?])
        };
        let Some((which, [a, b])) = self.loops.iter().enumerate().find_map(|(k, part)| Some((k, place(part)?))) else {
            return false;
        };
        let (numbers, beside) = &self.loops[which];
        let count = numbers.len();
        let gap = a.abs_diff(b);
        let direct = added.is_empty() && (gap < 2 || count - gap < 2);
        if direct || gap == 0 || added.is_empty() && self.boundary.is_joined(from, to) {
            return false;
        }
        let first = self.points.len() as u32;
        let mut curve: Vec<u32> = (first..first + added.len() as u32).collect();
        self.points.extend(added);
        let whole: Vec<u32> = [from].into_iter().chain(curve.iter().copied()).chain([to]).collect();
        for (k, &v) in whole.iter().enumerate() {
            let later = whole.iter().skip(k + 2).take(MOST_CHORDS);
            self.joined.extend(later.map(|&w| [v.min(w), v.max(w)]));
        }
        if a > b {
            curve.reverse();
        }
        let (low, high) = (a.min(b), a.max(b));
        let part = |from: usize, to: usize, curve: &mut dyn Iterator<Item = u32>| {
            let mut loop_numbers: Vec<u32> = (from..=to).map(|k| numbers[k % count]).collect();
            let mut loop_beside: Vec<DVec3> = (from..to).map(|k| beside[k % count]).collect();
            loop_numbers.extend(curve);
            loop_beside.resize(loop_numbers.len(), DVec3::ZERO);
            (loop_numbers, loop_beside)
        };
        let parts =
            [part(low, high, &mut curve.iter().rev().copied()), part(high, low + count, &mut curve.iter().copied())];
        self.loops.swap_remove(which);
        self.loops.extend(parts);
        true
    }

    /// Divides along a curve that starts and ends at points of the rim, and touches others where it comes near.
    fn along(&mut self, curve: &Curve, from: usize, to: usize, step: f64) -> bool {
        let samples = 4 * pieces(curve.ends[0].distance(curve.ends[1]), step).min(1000);
        let nearest = |p: DVec3| {
            let near = (1..samples).map(|k| k as f64 / samples as f64).map(|t| (curve.at(t).distance(p), t));
            near.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let touched = (0..self.boundary.len()).filter(|&k| k != from && k != to);
        let mut stops: Vec<(f64, usize)> = touched
            .filter_map(|k| {
                nearest(self.boundary.points[k]).filter(|near| near.0 < NEAR * step).map(|near| (near.1, k))
            })
            .collect();
        stops.push((0.0, from));
        stops.push((1.0, to));
        stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut divided = false;
        for pair in stops.windows(2) {
            let [(t0, a), (t1, b)] = [pair[0], pair[1]];
            let gap = a.abs_diff(b);
            if gap < 2 || self.boundary.len() - gap < 2 {
                continue;
            }
            let part = Curve {
                ends: [a, b].map(|k| self.boundary.points[k]),
                speeds: [t0, t1].map(|t| curve.derivative(t) * (t1 - t0)),
            };
            let count = pieces(part.ends[0].distance(part.ends[1]), step);
            let added: Vec<DVec3> = (1..count).map(|k| part.at(k as f64 / count as f64)).collect();
            divided |= self.divide(a as u32, b as u32, &added);
        }
        divided
    }
}

/// Into how many edges a curve is divided.
fn pieces(length: f64, step: f64) -> usize {
    (length / step).round().clamp(1.0, 10_000.0) as usize
}

/// Pairs of ends that are continuations of each other: both point to the other one and are bent alike. The best go first: those that point straight and are bent much. None goes twice, and none across
/// another one.
fn pairs(boundary: &Boundary, ends: &[End]) -> Vec<[usize; 2]> {
    let mut all: Vec<(f64, usize, usize)> = Vec::new();
    for (j, b) in ends.iter().enumerate() {
        for (i, a) in ends[..j].iter().enumerate() {
            let Some(chord) = (boundary.points[b.at] - boundary.points[a.at]).try_normalize() else { continue };
            let towards = [a.way.dot(chord), -b.way.dot(chord)];
            let likeness = (a.bend / b.bend).min(b.bend / a.bend);
            if towards[0].min(towards[1]) > TOWARDS && likeness > ALIKE {
                all.push((towards[0] + towards[1] + a.bend.abs().min(b.bend.abs()), i, j));
            }
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut chosen: Vec<[usize; 2]> = Vec::new();
    for (_, i, j) in all {
        let between = |k: usize| i < k && k < j;
        let free = |&[a, b]: &[usize; 2]| ![a, b].contains(&i) && ![a, b].contains(&j) && between(a) == between(b);
        if chosen.iter().all(free) {
            chosen.push([i, j]);
        }
    }
    chosen
}

/// The lid over a rim into which sharp edges run and out of which they come, divided along these. The new vertices are those on the edges.
pub(super) fn along_creases(boundary: &Boundary, around: &Surroundings<'_>, rim: &Rim) -> Option<Cover> {
    let count = boundary.len();
    let ends: Vec<End> = (0..count).filter_map(|at| End::new(around, rim, at)).collect();
    let step = rim.perimeter * boundary.scale / count as f64;
    let mut points = boundary.points.clone();
    points.push(DVec3::ZERO);
    let all: Vec<u32> = (0..count as u32).collect();
    let beside: Vec<DVec3> = (0..count).map(|edge| boundary.normal_beside(edge)).collect();
    let mut loops = Loops { boundary, joined: boundary.joined.clone(), points, loops: vec![(all, beside)] };
    let mut divided = false;
    for [a, b] in pairs(boundary, &ends).into_iter().map(|pair| pair.map(|k| &ends[k])) {
        let curve = Curve::between(boundary.points[a.at], a.way, boundary.points[b.at], b.way);
        divided |= loops.along(&curve, a.at, b.at, step);
    }
    if !divided {
        return None;
    }
    let triangles = of_loops(loops.joined, &loops.points, &loops.loops);
    Some(Cover { triangles, added: loops.points.split_off(count + 1) })
}
