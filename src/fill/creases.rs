//! Sharp edges that run into a hole and out of it.
//!
//! A smooth lid would round such an edge off. Where exactly two sharp edges of the surface end at a rim and point to each other, the edge is continued first, by a cubic curve that has
//! the direction of the edges at its ends. It divides the rim into two loops, each of which is closed by itself.

use glam::DVec3;

use super::boundary::{Boundary, normal};
use super::flat::Cover;
use super::minimal::{Rule, of_points};
use super::{Rim, Surroundings};

/// Cosine of 40°: edges that are bent more are sharp.
const SHARP: f64 = 0.766;

/// The least cosine between a sharp edge and the line to the other one.
const TOWARDS: f64 = 0.3;

/// Cosine of 30°: sharp edges that follow each other with a smaller bend are one curve.
const FOLLOWS: f64 = 0.866;

/// The other ends of the sharp edges at a vertex, in order of their places.
pub(super) fn sharp_edges(around: &Surroundings<'_>, vertex: u32) -> Vec<u32> {
    let mesh = around.mesh();
    let mut ends: Vec<(u32, DVec3)> = Vec::new();
    for &t in around.of(vertex) {
        let n = normal(mesh.corners(t as usize));
        ends.extend(mesh.triangles[t as usize].iter().filter(|&&w| w != vertex).map(|&w| (w, n)));
    }
    ends.sort_by_key(|end| end.0);
    let known = |(_, n): &(u32, DVec3)| *n != DVec3::ZERO;
    let sharp = |pair: &&[(u32, DVec3)]| pair.len() == 2 && pair.iter().all(known) && pair[0].1.dot(pair[1].1) < SHARP;
    let mut found: Vec<u32> = ends.chunk_by(|a, b| a.0 == b.0).filter(sharp).map(|pair| pair[0].0).collect();
    let place = |v: u32| mesh.positions[v as usize].to_array();
    found.sort_by(|&a, &b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
    found
}

/// The direction in which the sharp edge that ends at a vertex goes on; `None` where none or several end there.
fn direction(around: &Surroundings<'_>, vertex: u32) -> Option<DVec3> {
    let at = |v: u32| around.mesh().positions[v as usize];
    let ends = sharp_edges(around, vertex);
    let &[before] = &ends[..] else { return None };
    let last = (at(vertex) - at(before)).try_normalize()?;
    let earlier: Vec<u32> = sharp_edges(around, before).into_iter().filter(|&v| v != vertex).collect();
    if let &[first] = &earlier[..] {
        let first = (at(before) - at(first)).try_normalize()?;
        if first.dot(last) > FOLLOWS {
            // The tangent at the end of a curve turns on from its last chord by half as much as the chords turn.
            return (last * 1.5 - first * 0.5).try_normalize();
        }
    }
    Some(last)
}

/// The lid over a rim into which one sharp edge runs and out of which it comes, divided along that edge. The new vertices are those on the edge.
pub(super) fn along_crease(boundary: &Boundary, around: &Surroundings<'_>, rim: &Rim) -> Option<Cover> {
    let count = boundary.len();
    let sharp: Vec<usize> = (0..count).filter(|&k| !sharp_edges(around, rim.vertices[k]).is_empty()).collect();
    let &[from, to] = &sharp[..] else { return None };
    let gap = to - from;
    if gap < 2 || count - gap < 2 || boundary.is_joined(from as u32, to as u32) {
        return None;
    }
    let [start, end] = [from, to].map(|k| boundary.points[k]);
    let [out, back] = [direction(around, rim.vertices[from])?, direction(around, rim.vertices[to])?];
    let chord = end - start;
    let length = chord.length();
    let [first, second] = [out.dot(chord) / length, -back.dot(chord) / length];
    if first.min(second).is_nan() || first.min(second) < TOWARDS {
        return None;
    }
    // With this length of the derivatives the curve is nearly an arc where its ends lie on one.
    let speed = length * 2.0 / (1.0 + (first + second) / 2.0);
    let step = rim.perimeter * boundary.scale / count as f64;
    let pieces = (length / step).round().clamp(1.0, 10_000.0) as usize;
    let point = |k: usize| {
        let t = k as f64 / pieces as f64;
        let (t2, t3) = (t * t, t * t * t);
        start + chord * (3.0 * t2 - 2.0 * t3) + out * (speed * (t3 - 2.0 * t2 + t)) - back * (speed * (t3 - t2))
    };
    let added: Vec<DVec3> = (1..pieces).map(point).collect();
    let mut points = boundary.points.clone();
    points.push(DVec3::ZERO);
    points.extend(&added);
    let curve: Vec<u32> = (0..added.len()).map(|k| (count + 1 + k) as u32).collect();
    let mut triangles = Vec::new();
    for (from, to, back) in [(from, to, true), (to, from + count, false)] {
        let edges = (from..to).map(|k| k % count);
        let mut numbers: Vec<u32> = (from..=to).map(|k| (k % count) as u32).collect();
        let mut beside: Vec<DVec3> = edges.map(|edge| boundary.normal_beside(edge)).collect();
        if back {
            numbers.extend(curve.iter().rev())
        } else {
            numbers.extend(&curve)
        }
        // Nothing is known of what lies beyond the sharp edge.
        beside.resize(numbers.len(), DVec3::ZERO);
        of_points(boundary, &points, Rule::Bend, &numbers, &beside, &mut triangles);
    }
    Some(Cover { triangles, added })
}
