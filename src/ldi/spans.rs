//! Counters along each ray give the spans of the result (Bærentzen §3.1 and §5.1).
//!
//! A counter for each operand goes up where the ray enters it and down where it leaves; an operand
//! is inside while its counter is one of those that its rule, [`Inside`], says, and the boolean expression
//! over the operands says where the result is inside. Only the crossings where that changes are kept. A ray
//! on which a counter does not return to zero is silent, and so is, where surfaces have to face outwards, one
//! on which it goes negative: it keeps all its crossings for the half-rays of the vote, but it has no spans.

use super::{Expression, Hit, Inside, Layers};

/// Crossings of one ray closer together than this (voxels) count as one event, in which entries
/// come before exits. It absorbs the snapping of vertices to 2⁻¹⁶ h and makes the booleans
/// regular: facing boxes fuse, and spans and gaps of no length vanish.
pub const TIE: f64 = 1.0 / 8192.0;

/// Which operand each triangle of the common soup belongs to, and what counts as inside of an operand.
#[derive(Debug, Clone, PartialEq)]
pub struct Operands {
    ends: Vec<u32>,
    /// Which winding numbers are inside, of every operand.
    pub inside: Inside,
}

impl Operands {
    /// Operands with these numbers of triangles, one after another in the soup; winding numbers of at least 1 are inside.
    pub fn new(counts: impl IntoIterator<Item = usize>) -> Self {
        let mut end = 0;
        let ends = counts.into_iter().map(|count| {
            end += count as u32;
            end
        });
        Self { ends: ends.collect(), inside: Inside::default() }
    }

    /// The same with other winding numbers inside.
    pub fn with_inside(self, inside: Inside) -> Self {
        Self { inside, ..self }
    }

    /// Number of operands.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    /// The triangles of operand `operand`.
    pub fn range(&self, operand: usize) -> std::ops::Range<usize> {
        let start = if operand == 0 { 0 } else { self.ends[operand - 1] as usize };
        start..self.ends[operand] as usize
    }

    /// The operand of triangle `triangle`.
    #[inline]
    pub fn of(&self, triangle: u32) -> usize {
        if self.ends.len() == 1 { 0 } else { self.ends.partition_point(|&end| end <= triangle) }
    }
}

/// The spans of the result along the rays of one direction.
#[derive(Debug, Clone)]
pub struct Spans {
    /// On rays that speak: the kept crossings, alternately entering and leaving the *result*; on
    /// silent rays: all crossings as they were.
    pub layers: Layers,
    silent: Vec<u64>,
    /// Number of silent rays.
    pub silent_rays: usize,
}

impl Spans {
    /// Whether ray number `ray` abstains.
    #[inline]
    pub fn is_silent(&self, ray: usize) -> bool {
        self.silent[ray / 64] >> (ray % 64) & 1 == 1
    }
}

/// Counters of one ray's walk.
pub(crate) struct Walk<'a> {
    operands: &'a Operands,
    counters: Vec<i32>,
}

/// What one event of a walk changed.
pub(crate) enum Step {
    /// The counters after the event are fine.
    Fine,
    /// A counter has gone negative, where surfaces have to face outwards.
    Negative,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(operands: &'a Operands) -> Self {
        Self { operands, counters: vec![0; operands.count()] }
    }

    /// Applies the crossings of one event.
    #[inline]
    pub(crate) fn step(&mut self, event: &[Hit]) -> Step {
        for hit in event {
            let operand = self.operands.of(hit.triangle());
            self.counters[operand] += if hit.entering() { 1 } else { -1 };
        }
        let negative = |hit: &Hit| self.counters[self.operands.of(hit.triangle())] < 0;
        if self.operands.inside.needs_outward() && event.iter().any(negative) { Step::Negative } else { Step::Fine }
    }

    /// Whether all counters are zero; sets them to zero.
    pub(crate) fn finish(&mut self) -> bool {
        let balanced = self.counters.iter().all(|&c| c == 0);
        self.counters.fill(0);
        balanced
    }
}

/// Length of the first event of `hits`: crossings within [`TIE`] of the first.
#[inline]
pub(crate) fn event_length(hits: &[Hit]) -> usize {
    let limit = hits[0].depth + TIE;
    hits.iter().take_while(|hit| hit.depth <= limit).count()
}

/// Whether every counter returns to zero along `hits`, and stays non-negative where surfaces have to face outwards.
pub(crate) fn is_balanced(hits: &[Hit], walk: &mut Walk<'_>) -> bool {
    let mut rest = hits;
    while !rest.is_empty() {
        let (event, others) = rest.split_at(event_length(rest));
        if let Step::Negative = walk.step(event) {
            walk.finish();
            return false;
        }
        rest = others;
    }
    walk.finish()
}

/// What the crossings of one operand on one ray say of how its surfaces face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Facing {
    /// All of them outwards, or inwards where others are around.
    Right,
    /// The counter returns to zero, but it is negative on the way.
    Inwards,
    /// The counter does not return to zero.
    Open,
}

/// How the surfaces face that a ray crosses; the crossings are all of one operand.
pub(crate) fn facing(hits: &[Hit]) -> Facing {
    let (mut counter, mut negative) = (0, false);
    let mut rest = hits;
    while !rest.is_empty() {
        let (event, others) = rest.split_at(event_length(rest));
        counter += event.iter().map(|hit| if hit.entering() { 1 } else { -1 }).sum::<i32>();
        negative |= counter < 0;
        rest = others;
    }
    match (counter, negative) {
        (0, false) => Facing::Right,
        (0, true) => Facing::Inwards,
        _ => Facing::Open,
    }
}

/// Rays with crossings, and how many of them do not balance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Balance {
    /// Rays with at least one crossing.
    pub occupied: usize,
    /// Of these, rays on which an operand's counter does not return to zero, or is negative where surfaces have to face outwards.
    pub unbalanced: usize,
}

/// Counts the occupied and the unbalanced rays. A closed mesh, consistently oriented outwards, has
/// no unbalanced ones.
pub fn balance(layers: &Layers, operands: &Operands) -> Balance {
    let mut walk = Walk::new(operands);
    let mut balance = Balance::default();
    for hits in layers.offsets.windows(2).map(|w| &layers.hits[w[0] as usize..w[1] as usize]) {
        if !hits.is_empty() {
            balance.occupied += 1;
            balance.unbalanced += !is_balanced(hits, &mut walk) as usize;
        }
    }
    balance
}

/// The spans of `expression` over the operands along each ray of `layers`.
pub fn spans(mut layers: Layers, operands: &Operands, expression: &Expression) -> Spans {
    let rays = layers.ray_count();
    let mut silent = vec![0u64; rays.div_ceil(64)];
    let mut silent_rays = 0;
    let mut walk = Walk::new(operands);
    let mut inside = vec![false; operands.count()];
    let mut kept = Vec::new();
    let mut write = 0;
    for ray in 0..rays {
        let (start, end) = (layers.offsets[ray] as usize, layers.offsets[ray + 1] as usize);
        layers.offsets[ray] = write as u32;
        if start == end {
            continue;
        }
        kept.clear();
        if keep_changes(&layers.hits[start..end], &mut walk, expression, &mut inside, &mut kept) {
            layers.hits[write..write + kept.len()].copy_from_slice(&kept);
            write += kept.len();
        } else {
            silent[ray / 64] |= 1 << (ray % 64);
            silent_rays += 1;
            layers.hits.copy_within(start..end, write);
            write += end - start;
        }
    }
    layers.offsets[rays] = write as u32;
    layers.hits.truncate(write);
    Spans { layers, silent, silent_rays }
}

/// Collects the crossings where the result changes; false when the ray does not balance.
fn keep_changes(
    hits: &[Hit],
    walk: &mut Walk<'_>,
    expression: &Expression,
    inside: &mut [bool],
    kept: &mut Vec<Hit>,
) -> bool {
    let operands = walk.operands;
    let mut was = false;
    let mut rest = hits;
    inside.fill(false);
    while !rest.is_empty() {
        let (event, others) = rest.split_at(event_length(rest));
        if let Step::Negative = walk.step(event) {
            walk.finish();
            return false;
        }
        for hit in event {
            let operand = operands.of(hit.triangle());
            inside[operand] = operands.inside.holds(walk.counters[operand]);
        }
        let now = expression.evaluate(inside);
        if now != was {
            // Of crossings that coincide, one that goes the way of the result speaks for it.
            let hit = event.iter().find(|hit| hit.entering() == now).unwrap_or(&event[0]);
            kept.push(hit.of_result(now));
            was = now;
        }
        rest = others;
    }
    walk.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depths(spans: &Spans) -> Vec<f64> {
        spans.layers.hits.iter().map(|hit| hit.depth).collect()
    }

    #[test]
    fn union_drops_what_is_inside() {
        let one = Operands::new([4]);
        let s = spans(
            Layers::of_one_ray(&[(1., 0, true), (2., 1, true), (3., 2, false), (4., 3, false)]),
            &one,
            &Expression::Operand(0),
        );
        assert_eq!(depths(&s), [1., 4.]);
    }

    #[test]
    fn facing_operands_fuse_and_a_minus_a_is_empty() {
        let two = Operands::new([2, 2]);
        let facing = Layers::of_one_ray(&[(1., 0, true), (2., 1, false), (2., 2, true), (3., 3, false)]);
        assert_eq!(depths(&spans(facing.clone(), &two, &Expression::union(2))), [1., 3.]);
        assert_eq!(depths(&spans(facing, &two, &Expression::intersection(2))), [0.; 0]);
        let same = Layers::of_one_ray(&[(1., 0, true), (1., 2, true), (3., 1, false), (3., 3, false)]);
        assert_eq!(depths(&spans(same, &two, &Expression::difference(2))), [0.; 0]);
    }

    #[test]
    fn a_ray_below_zero_is_silent_only_where_surfaces_have_to_face_outwards() {
        // A shell inside out; one in another, both inside out; and two that overlap, one of them inside out.
        let [alone, nested, crossing] = [
            &[(1., 0, false), (2., 1, true)][..],
            &[(1., 0, false), (2., 1, false), (3., 2, true), (4., 3, true)],
            &[(1., 0, true), (2., 1, false), (3., 2, false), (4., 3, true)],
        ];
        for (hits, nonzero, odd) in [
            (alone, &[1., 2.][..], &[1., 2.][..]),
            (nested, &[1., 4.], &[1., 2., 3., 4.]),
            (crossing, &[1., 2., 3., 4.], &[1., 2., 3., 4.]),
        ] {
            let by = |inside| {
                let operands = Operands::new([4]).with_inside(inside);
                spans(Layers::of_one_ray(hits), &operands, &Expression::Operand(0))
            };
            assert!(by(Inside::Positive).is_silent(0));
            for (inside, expected) in [(Inside::Nonzero, nonzero), (Inside::Odd, odd)] {
                let s = by(inside);
                assert_eq!((s.is_silent(0), &depths(&s)[..]), (false, expected), "{inside:?}");
                let enters: Vec<bool> = s.layers.hits.iter().map(|hit| hit.entering()).collect();
                assert_eq!(enters, (0..expected.len()).map(|n| n % 2 == 0).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn a_ray_that_does_not_balance_keeps_its_crossings_and_is_silent() {
        let one = Operands::new([3]);
        for hits in
            [&[(1., 0, true)][..], &[(1., 0, false), (2., 1, true)], &[(1., 0, true), (2., 1, true), (3., 2, false)]]
        {
            let s = spans(Layers::of_one_ray(hits), &one, &Expression::Operand(0));
            assert!(s.is_silent(0));
            assert_eq!(s.layers.hits.len(), hits.len());
        }
    }
}
