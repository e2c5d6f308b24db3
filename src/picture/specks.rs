//! Which sharp edges mean something: those that lead to others.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::line::{DrawnEdge, Style};
use crate::mesh::Bounds;

/// Sharp edges are not drawn that hang together over less than these parts of the mesh's diagonal: around something, as the rim of a hole; as a branch of
/// others, which ends; alone, with two ends or as the rim of a sliver. Surfaces that are made anew, and scans, are full of short edges that end somewhere,
/// and closed cracks of slivers: with these lengths none are left of the crack of `testdata/broken_mug.obj`.
const LEAST: Lengths = Lengths { round: 0.03, branch: 0.03, alone: 0.06 };

/// What is less wide than this part of the diagonal, and than half its length, is a line, though it may go around something.
const WIDE: f64 = 0.01;

struct Lengths {
    round: f64,
    branch: f64,
    alone: f64,
}

/// A branch may hold others, which go before it: so often branches are looked for.
const ROUNDS: usize = 4;

/// Edges that are drawn with less than this strength do not make a way of those that are drawn with more.
const FAINT: f32 = 0.25;

/// Makes plain edges of sharp ones that hang together over too short a way to mean anything: of all, then of those that are more than faint.
pub(super) fn without_specks(mut edges: Vec<DrawnEdge>, positions: &[DVec3]) -> Vec<DrawnEdge> {
    let diagonal = Bounds::of(positions.iter().copied()).map_or(0.0, |bounds| bounds.diagonal());
    for least in [0.0, FAINT] {
        let counts = |edge: &DrawnEdge| matches!(edge.style, Style::Sharp { strength } if strength >= least);
        let sharp: Vec<usize> = (0..edges.len()).filter(|&n| counts(&edges[n])).collect();
        let mut net = Net::new(sharp.iter().map(|&n| edges[n].ends).collect(), positions);
        for _ in 0..ROUNDS {
            let branches = net.branches(LEAST.branch * diagonal, LEAST.alone * diagonal);
            if branches.is_empty() {
                break;
            }
            net.remove(&branches);
        }
        net.remove(&net.small(diagonal, positions));
        for &n in sharp.iter().zip(&net.left).filter(|(_, left)| !**left).map(|(n, _)| n) {
            edges[n].style = Style::Plain { strength: 1.0 };
        }
    }
    edges
}

/// Edges over their vertices.
struct Net {
    ends: Vec<[u32; 2]>,
    lengths: Vec<f64>,
    /// Which edges are left.
    left: Vec<bool>,
    /// The edges at each vertex that are left, ascending.
    at: FxHashMap<u32, Vec<u32>>,
}

impl Net {
    fn new(ends: Vec<[u32; 2]>, positions: &[DVec3]) -> Self {
        let length = |[a, b]: &[u32; 2]| positions[*a as usize].distance(positions[*b as usize]);
        let mut at: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (k, ends) in (0..).zip(&ends) {
            ends.iter().for_each(|&v| at.entry(v).or_default().push(k));
        }
        Self { lengths: ends.iter().map(length).collect(), left: vec![true; ends.len()], at, ends }
    }

    fn remove(&mut self, edges: &[u32]) {
        for &edge in edges.iter().filter(|&&edge| std::mem::replace(&mut self.left[edge as usize], false)) {
            for v in self.ends[edge as usize] {
                if let Some(list) = self.at.get_mut(&v) {
                    list.retain(|&other| other != edge);
                }
            }
        }
    }

    fn edges_at(&self, v: u32) -> &[u32] {
        self.at.get(&v).map_or(&[], Vec::as_slice)
    }

    /// The edges of ways from an end to the next fork that are shorter than `branch`, or to another end and shorter than `alone`.
    fn branches(&self, branch: f64, alone: f64) -> Vec<u32> {
        let mut found = Vec::new();
        for (k, &[a, b]) in self.ends.iter().enumerate().filter(|&(k, _)| self.left[k]) {
            for (end, next) in [(a, b), (b, a)] {
                if self.edges_at(end).len() == 1 {
                    let (way, length, last) = self.way(k as u32, next, alone.max(branch));
                    let most = if self.edges_at(last).len() == 1 { alone } else { branch };
                    if length < most {
                        found.extend(way);
                    }
                }
            }
        }
        found
    }

    /// The way that begins with an edge and leads through vertices of two edges, as far as `most`: its edges, its length, its last vertex.
    fn way(&self, first: u32, next: u32, most: f64) -> (Vec<u32>, f64, u32) {
        let (mut way, mut length, mut v) = (vec![first], self.lengths[first as usize], next);
        while let (&[a, b], true) = (self.edges_at(v), length < most) {
            let edge = if Some(&a) == way.last() { b } else { a };
            let [from, to] = self.ends[edge as usize];
            v = if from == v { to } else { from };
            length += self.lengths[edge as usize];
            way.push(edge);
        }
        (way, length, v)
    }

    /// The edges of pieces that are too short, in a mesh of such a `diagonal`.
    fn small(&self, diagonal: f64, positions: &[DVec3]) -> Vec<u32> {
        let [round, alone, wide] = [LEAST.round, LEAST.alone, WIDE].map(|part| part * diagonal);
        let mut seen = FxHashSet::default();
        let mut found = Vec::new();
        for first in (0..self.ends.len() as u32).filter(|&k| self.left[k as usize]) {
            if !seen.insert(first) {
                continue;
            }
            let (mut piece, mut next, mut length) = (vec![first], 0, 0.0);
            while let Some(&edge) = piece.get(next) {
                next += 1;
                length += self.lengths[edge as usize];
                let around = self.ends[edge as usize].into_iter().flat_map(|v| self.edges_at(v));
                piece.extend(around.filter(|&&other| seen.insert(other)));
            }
            let size = || size(piece.iter().flat_map(|&k| self.ends[k as usize]).map(|v| positions[v as usize]));
            let is_short_line = |[long, across]: [f64; 2]| long < alone && across < wide.min(long / 2.0);
            if length < round || size().is_some_and(is_short_line) {
                found.extend(piece);
            }
        }
        found
    }
}

/// How far it is from one end of some points to the other, and how wide they lie around the line between the two.
fn size(points: impl Iterator<Item = DVec3> + Clone) -> Option<[f64; 2]> {
    let first = points.clone().next()?;
    let farthest = |from: DVec3| {
        let nearer = |p: &DVec3, q: &DVec3| p.distance_squared(from).total_cmp(&q.distance_squared(from));
        points.clone().max_by(nearer).unwrap_or(from)
    };
    let end = farthest(first);
    let along = farthest(end) - end;
    let direction = along.try_normalize()?;
    let aside = points.clone().map(|p| (p - end).reject_from_normalized(direction).length());
    Some([along.length(), 2.0 * aside.fold(0.0, f64::max)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of the edges are drawn, when the mesh's diagonal is about 1.
    fn drawn(ends: &[[u32; 2]], positions: &[DVec3]) -> Vec<bool> {
        let far = [DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0)];
        let all: Vec<DVec3> = positions.iter().copied().chain(far).collect();
        let edge = |&ends: &[u32; 2]| DrawnEdge { ends, style: Style::Sharp { strength: 1.0 }, triangles: [0, 0] };
        let edges = without_specks(ends.iter().map(edge).collect(), &all);
        edges.iter().map(|edge| matches!(edge.style, Style::Sharp { .. })).collect()
    }

    /// A ring of a circumference of about `length`, from vertex 0 on.
    fn ring(length: f64) -> (Vec<[u32; 2]>, Vec<DVec3>) {
        let at = |k: u32| f64::from(k) / 12.0 * std::f64::consts::TAU;
        let radius = length / std::f64::consts::TAU;
        let positions = (0..12).map(|k| 0.5 * DVec3::X + radius * DVec3::new(at(k).cos(), at(k).sin(), 0.0)).collect();
        ((0..12).map(|k| [k, (k + 1) % 12]).collect(), positions)
    }

    #[test]
    fn rims_of_small_holes_stay_and_their_spikes_go() {
        let (mut ends, mut positions) = ring(0.06);
        assert!(drawn(&ends, &positions).iter().all(|&drawn| drawn));
        positions.push(positions[3] + 0.01 * DVec3::Z);
        positions.push(positions[12] + 0.01 * DVec3::Z);
        ends.extend([[3, 12], [13, 12]]);
        let found = drawn(&ends, &positions);
        assert!(found[..12].iter().all(|&drawn| drawn) && found[12..] == [false, false], "{found:?}");
        let (ends, positions) = ring(0.02);
        assert!(drawn(&ends, &positions).iter().all(|&drawn| !drawn));
    }

    #[test]
    fn lines_with_two_ends_stay_when_they_are_long() {
        for (step, stays) in [(0.005, false), (0.02, true)] {
            let positions: Vec<DVec3> = (0..6).map(|k| step * f64::from(k) * DVec3::Y).collect();
            let ends: Vec<[u32; 2]> = (0..5).map(|k| [k, k + 1]).collect();
            assert_eq!(drawn(&ends, &positions), [stays; 5], "{step}");
        }
    }

    #[test]
    fn rims_of_slivers_are_lines() {
        for (length, width, stays) in [(0.05, 0.002, false), (0.05, 0.02, true), (0.08, 0.002, true)] {
            let corners = [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]];
            let positions = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
            assert_eq!(drawn(&[[0, 1], [1, 2], [2, 3], [3, 0]], &positions), [stays; 4], "{length} {width}");
        }
    }
}
