//! Which loop of the cut surface goes with which loop of the border, and where its points come to lie.

use glam::DVec3;

use super::border::{Border, OnBorder};

/// Two points of a loop that follow each other are not farther apart than this along the border, h.
const LONGEST_STEP: f64 = 6.0;

/// Points that go back along the border by more than this, h, are no cut along it.
const MOST_BACK: f64 = 1.0;

/// A point nearer to a vertex of the border than this, h, is that vertex.
const SAME: f64 = 0.2;

/// One place on a loop where both surfaces get a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// A vertex of the source.
    Vertex(u32),
    /// A point of the cut, by its number.
    Point(u32),
}

/// A loop of the border with the points of the cut.
#[derive(Debug, Clone, Default)]
pub(super) struct BorderRing {
    /// The first of its segments.
    pub first: u32,
    /// The places along it, in order, once around, from the beginning of that segment.
    pub stops: Vec<Stop>,
    /// For each point of the cut, in order: its number and the stop that it is now.
    pub points: Vec<(u32, u32)>,
    /// For the stops that are points: segment and place.
    pub places: Vec<(u32, u32, DVec3)>,
}

/// Matches a loop of the cut, `points` numbered as in `found` and in the direction of the border, with a loop of
/// the border. In case of failure the points where it fails.
pub(super) fn matched(
    border: &Border,
    at: impl Fn(u32) -> DVec3,
    found: &[OnBorder],
    points: &[u32],
    h: f64,
) -> Result<(u32, BorderRing), Vec<u32>> {
    let ring_of = |p: u32| border.segments[found[p as usize].segment as usize].ring;
    let mut rings: Vec<u32> = points.iter().map(|&p| ring_of(p)).collect();
    rings.sort_unstable();
    let most = rings.chunk_by(|a, b| a == b).max_by_key(|same| same.len()).map_or(0, |same| same[0]);
    let strangers: Vec<u32> = points.iter().copied().filter(|&p| ring_of(p) != most).collect();
    if !strangers.is_empty() {
        return Err(strangers);
    }
    let (segments, length) = (border.ring(most), border.lengths[most as usize]);
    let along = |p: u32| {
        let OnBorder { at: place, segment, .. } = found[p as usize];
        let segment = &border.segments[segment as usize];
        segment.start + at(segment.from).distance(place)
    };
    let unrolled = unrolled(points, along, length, h)?;
    let ordered = ordered(&unrolled, length);
    let back = |k: &usize| (ordered[*k] - unrolled[*k]).abs() > MOST_BACK * h;
    let back: Vec<u32> = (0..points.len()).filter(back).map(|k| points[k]).collect();
    if !back.is_empty() {
        return Err(back);
    }
    let ring = placed(segments, border.starts[most as usize], &ordered, points, length, h, at);
    let turns = |w: &[(u32, u32)]| w[1].1 <= w[0].1;
    let last = ring.points.len() - 1;
    let turns =
        ring.points.windows(2).filter(|w| turns(w)).count() + usize::from(turns(&[ring.points[last], ring.points[0]]));
    if turns == 1 { Ok((most, ring)) } else { Err(points.to_vec()) }
}

/// How far along the border the points are, going on past its end, so that they go once around.
fn unrolled(points: &[u32], along: impl Fn(u32) -> f64, length: f64, h: f64) -> Result<Vec<f64>, Vec<u32>> {
    let mut all = Vec::with_capacity(points.len());
    let mut far = Vec::new();
    let (mut sum, mut last) = (along(points[0]), along(points[0]));
    for k in 0..points.len() {
        all.push(sum);
        let next = along(points[(k + 1) % points.len()]);
        let mut step = next - last;
        step -= (step / length).round() * length;
        if step.abs() > LONGEST_STEP * h {
            far.extend([points[k], points[(k + 1) % points.len()]]);
        }
        sum += step;
        last = next;
    }
    let once = (sum - all[0] - length).abs() < 0.5 * length;
    match (once, far.is_empty()) {
        (true, _) => Ok(all),
        (false, false) => Err(far),
        (false, true) => Err(points.to_vec()),
    }
}

/// The same places in ascending order, each different from the others, as near to where they were as that allows.
fn ordered(places: &[f64], length: f64) -> Vec<f64> {
    let n = places.len();
    // Three times around, so that the beginning does not matter.
    let thrice: Vec<f64> = (0..3 * n).map(|k| places[k % n] + (k / n) as f64 * length).collect();
    let mut most = thrice.clone();
    (1..3 * n).for_each(|k| most[k] = most[k].max(most[k - 1]));
    let mut least = thrice;
    (0..3 * n - 1).rev().for_each(|k| least[k] = least[k].min(least[k + 1]));
    let mut all: Vec<f64> = (0..3 * n).map(|k| (most[k] + least[k]) / 2.0).collect();
    let mut start = 0;
    while start < 3 * n {
        let end = (start + 1..3 * n).find(|&k| all[k] > all[start]).unwrap_or(3 * n);
        if end - start > 1 {
            let before = if start > 0 { all[start] - all[start - 1] } else { length };
            let after = if end < 3 * n { all[end] - all[start] } else { length };
            let step = before.min(after) / (end - start + 1) as f64;
            let middle = (end - start - 1) as f64 / 2.0;
            let value = all[start];
            (start..end).for_each(|k| all[k] = value + ((k - start) as f64 - middle) * step);
        }
        start = end;
    }
    all[n..2 * n].iter().map(|place| place - length).collect()
}

/// The stops along a loop of the border.
fn placed(
    segments: &[super::border::Segment],
    first: u32,
    ordered: &[f64],
    points: &[u32],
    length: f64,
    h: f64,
    at: impl Fn(u32) -> DVec3,
) -> BorderRing {
    let place = |k: usize| ordered[k].rem_euclid(length);
    let segment_at = |along: f64| segments.partition_point(|s| s.start <= along).max(1) - 1;
    // For each vertex of the loop the nearest of the points that are close to it.
    let mut taken: Vec<Option<(f64, usize)>> = vec![None; segments.len()];
    for k in 0..points.len() {
        let s = segment_at(place(k));
        let next = (s + 1) % segments.len();
        let end = segments.get(s + 1).map_or(length, |s| s.start);
        let (behind, ahead) = (place(k) - segments[s].start, end - place(k));
        let (vertex, off) = if behind <= ahead { (s, behind) } else { (next, ahead) };
        // Of points at the same place the one before a vertex must not go past the other.
        let is_nearer = |best: f64| off < best || (off == best && vertex != s);
        if off < SAME * h && taken[vertex].is_none_or(|(best, _)| is_nearer(best)) {
            taken[vertex] = Some((off, k));
        }
    }
    let mut is_taken = vec![false; points.len()];
    taken.iter().flatten().for_each(|&(_, k)| is_taken[k] = true);
    let mut stops: Vec<(f64, Stop, Option<usize>)> =
        segments.iter().zip(&taken).map(|(s, taken)| (s.start, Stop::Vertex(s.from), taken.map(|t| t.1))).collect();
    let mut ring = BorderRing { first, ..BorderRing::default() };
    for k in (0..points.len()).filter(|&k| !is_taken[k]) {
        let s = segment_at(place(k));
        let (from, to) = (at(segments[s].from), at(segments[s].to));
        let share = (place(k) - segments[s].start) / from.distance(to);
        stops.push((place(k), Stop::Point(points[k]), Some(k)));
        ring.places.push((points[k], first + s as u32, from.lerp(to, share)));
    }
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut stop_of = vec![0; points.len()];
    for (n, stop) in (0..).zip(&stops) {
        stop.2.into_iter().for_each(|k| stop_of[k] = n);
    }
    ring.stops = stops.into_iter().map(|s| s.1).collect();
    ring.points = points.iter().copied().zip(stop_of).collect();
    ring
}

#[cfg(test)]
mod tests {
    use super::ordered;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn places_come_out_in_order_once_around_and_those_in_order_stay(
            steps in prop::collection::vec(-0.3f64..1.0, 3..40)
        ) {
            let places: Vec<f64> = steps.iter().scan(0.0, |sum, step| { *sum += step; Some(*sum) }).collect();
            let length = places.iter().copied().fold(0.0, f64::max) - places.iter().copied().fold(0.0, f64::min) + 1.0;
            let ordered = ordered(&places, length);
            prop_assert!(ordered.windows(2).all(|w| w[0] < w[1]), "{places:?} gives {ordered:?}");
            prop_assert!(ordered[places.len() - 1] < ordered[0] + length);
            if places.windows(2).all(|w| w[0] < w[1]) {
                prop_assert!(places.iter().zip(&ordered).all(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
    }
}
