//! Offsets, booleans and weighted sums of fields (Payne and Toga 1992).

use std::sync::Arc;

use glam::DVec3;

use super::{Ball, Combined, Extent, Range, Rule, Shared, Slope};

/// The field with all levels moved out by `by`, model units: positive grows, negative shrinks ("Offsets").
pub fn offset(field: Shared, by: f64) -> Shared {
    Arc::new(Combined::new(vec![field], Offset { by }))
}

/// A wall along the surface: all points within half of `thickness`, model units, of it.
pub fn shell(field: Shared, thickness: f64) -> Shared {
    Arc::new(Combined::new(vec![field], Wall { half: thickness / 2.0 }))
}

/// The outside of a field, as a solid.
pub fn complement(field: Shared) -> Shared {
    Arc::new(Combined::new(vec![field], Complement))
}

/// The union, all points in at least one of the fields: the least of them ("Boolean operations"; the greatest there, where inside is positive).
pub fn union(fields: Vec<Shared>) -> Shared {
    Arc::new(Combined::new(fields, Pick { greatest: false }))
}

/// The intersection: all points that are in each of the fields.
pub fn intersection(fields: Vec<Shared>) -> Shared {
    Arc::new(Combined::new(fields, Pick { greatest: true }))
}

/// The difference: all points in the first field and in none of the others.
pub fn difference(first: Shared, others: Vec<Shared>) -> Shared {
    intersection(std::iter::once(first).chain(others.into_iter().map(complement)).collect())
}

/// The symmetric difference: all points in an odd number of the fields, of two fields in exactly one.
pub fn symmetric_difference(fields: Vec<Shared>) -> Shared {
    Arc::new(Combined::new(fields, Odd))
}

/// The sum of the fields times their weights, over the sum of the weights ("Multiple-object averaging"). Weights are not
/// negative, and not all zero; a field without one counts 1.
pub fn average(fields: Vec<Shared>, weights: &[f64]) -> Shared {
    let given = |k: usize| weights.get(k).copied().unwrap_or(1.0);
    let sum: f64 = (0..fields.len()).map(given).sum();
    let weights = (0..fields.len()).map(|k| given(k) / sum).collect();
    Arc::new(Combined::new(fields, Weighted { weights }))
}

/// A shape between two others, `a` at `t` = 0 and `b` at 1: (1 − t) a + t b ("Surface interpolation"; Sanchez et al. 2015 §6.3, where both are
/// filtered).
pub fn morph(a: Shared, b: Shared, t: f64) -> Shared {
    average(vec![a, b], &[1.0 - t, t])
}

/// What [`morph`] gives, each field divided by its radius, so that the smaller shape does not vanish at once. The radii are
/// the greatest depths inside, model units: see [`depth`].
pub fn morph_by_radii(fields: [Shared; 2], radii: [f64; 2], t: f64) -> Shared {
    let between = radii[0] * (1.0 - t) + radii[1] * t;
    let weights = vec![(1.0 - t) * between / radii[0], t * between / radii[1]];
    Arc::new(Combined::new(fields.into(), Weighted { weights }))
}

/// `a` where coordinate `axis` is up to `from`, `b` from `to` on, both model units, and in between what lies between
/// them ("Spatially-weighted interpolation").
pub fn ramp(a: Shared, b: Shared, axis: usize, from: f64, to: f64) -> Shared {
    Arc::new(Combined::new(vec![a, b], Ramp { axis: axis % 3, from, to }))
}

/// How deep the deepest point inside is, model units, to one part in a hundred (in plates, which are as deep all over,
/// as near as [`MOST_LOOKS`] come); 0 without an inside. The field's [extent](super::Field::extent) must have an end.
pub fn depth(field: &Shared) -> f64 {
    let Some(bounds) = field.extent().bounds() else { return 0.0 };
    let most = |centre: DVec3, half: DVec3| -field.range(&Ball { centre, radius: half.length() }).min;
    let (centre, half) = ((bounds.min + bounds.max) / 2.0, bounds.size() / 2.0);
    let mut found = (-field.value(centre)).max(0.0);
    // Boxes by what they may hold; the best one is halved until none can hold more than was found.
    let mut boxes = vec![(most(centre, half), centre, half)];
    for _ in 0..MOST_LOOKS {
        let Some((deepest, centre, half)) = boxes.pop() else { break };
        if deepest <= found * (1.0 + DEPTH) || half.max_element() < DEPTH * DEPTH * bounds.size().max_element() {
            break;
        }
        let half = half / 2.0;
        for k in 0..8 {
            let side = DVec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 0 { -1.0 } else { 1.0 }));
            let centre = centre + side * half;
            found = found.max(-field.value(centre));
            let deepest = most(centre, half);
            boxes.insert(boxes.partition_point(|other| other.0 < deepest), (deepest, centre, half));
        }
    }
    found
}

/// The part by which [`depth`] may be off.
const DEPTH: f64 = 1e-2;
/// Boxes that [`depth`] halves at most.
pub const MOST_LOOKS: usize = 5000;

struct Offset {
    by: f64,
}

impl Rule for Offset {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        slopes[0] = 1.0;
        Slope { value: values[0] - self.by, ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        ranges[0].rising(|v| v - self.by)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        lipschitz[0]
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        extents[0].grown(self.by.max(0.0))
    }
}

struct Wall {
    half: f64,
}

impl Rule for Wall {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        slopes[0] = values[0].signum();
        Slope { value: values[0].abs() - self.half, ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        ranges[0].abs().rising(|v| v - self.half)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        lipschitz[0]
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        extents[0].grown(self.half)
    }
}

struct Complement;

impl Rule for Complement {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        slopes[0] = -1.0;
        Slope { value: -values[0], ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        ranges[0].times(-1.0)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        lipschitz[0]
    }

    fn extent(&self, _: &[Extent]) -> Extent {
        Extent::Unbounded
    }

    fn keeps_surfaces(&self) -> bool {
        true
    }
}

/// The least or the greatest.
struct Pick {
    greatest: bool,
}

impl Rule for Pick {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        let better = |a: f64, b: f64| if self.greatest { a > b } else { a < b };
        let chosen = (1..values.len()).fold(0, |best, k| if better(values[k], values[best]) { k } else { best });
        slopes.fill(0.0);
        slopes[chosen] = 1.0;
        Slope { value: values[chosen], ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        let pick = if self.greatest { f64::max } else { f64::min };
        let both = |a: Range, b: Range| Range { min: pick(a.min, b.min), max: pick(a.max, b.max) };
        ranges.iter().copied().reduce(both).unwrap_or(Range::ALL)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        lipschitz.iter().copied().fold(0.0, f64::max)
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        let both = if self.greatest { Extent::and } else { Extent::or };
        extents.iter().copied().reduce(both).unwrap_or(Extent::Empty)
    }

    fn keeps_surfaces(&self) -> bool {
        true
    }
}

/// One after the other, what is in exactly one of the field so far and the next: max(min(a, b), −max(a, b)).
struct Odd;

impl Rule for Odd {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        slopes.fill(0.0);
        slopes[0] = 1.0;
        let mut so_far = values[0];
        for k in 1..values.len() {
            let (own, next) = (values[k], so_far.min(values[k]).max(-so_far.max(values[k])));
            // The value is that of one of the two, or the opposite of it.
            let of_own = next == own || next == -own && next != so_far;
            let sign = if next == own || next == so_far { 1.0 } else { -1.0 };
            slopes[..k].iter_mut().for_each(|slope| *slope *= if of_own { 0.0 } else { sign });
            slopes[k] = if of_own { sign } else { 0.0 };
            so_far = next;
        }
        Slope { value: so_far, ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        let pick = |a: Range, b: Range, f: fn(f64, f64) -> f64| Range { min: f(a.min, b.min), max: f(a.max, b.max) };
        let both = |a: Range, b: Range| pick(pick(a, b, f64::min), pick(a, b, f64::max).times(-1.0), f64::max);
        ranges.iter().copied().reduce(both).unwrap_or(Range::ALL)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        lipschitz.iter().copied().fold(0.0, f64::max)
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        extents.iter().copied().reduce(Extent::or).unwrap_or(Extent::Empty)
    }

    fn keeps_surfaces(&self) -> bool {
        true
    }
}

/// All of them, times their weights.
struct Weighted {
    weights: Vec<f64>,
}

impl Rule for Weighted {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        slopes.copy_from_slice(&self.weights);
        // A field that does not count may be infinite.
        let counting = values.iter().zip(&self.weights).filter(|(_, weight)| **weight != 0.0);
        Slope { value: counting.map(|(value, weight)| value * weight).sum(), ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        let counting = ranges.iter().zip(&self.weights).filter(|(_, weight)| **weight != 0.0);
        counting.map(|(range, &weight)| range.times(weight)).reduce(Range::plus).unwrap_or(Range::ALL)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        let counting = lipschitz.iter().zip(&self.weights).filter(|(_, weight)| **weight != 0.0);
        counting.map(|(steep, weight)| steep * weight.abs()).sum()
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        let counting = extents.iter().zip(&self.weights).filter(|(_, weight)| **weight != 0.0);
        counting.map(|(extent, _)| *extent).reduce(Extent::or).unwrap_or(Extent::Empty)
    }
}

struct Ramp {
    axis: usize,
    from: f64,
    to: f64,
}

impl Ramp {
    /// The part of the second field, and how it grows along the axis.
    fn part(&self, coordinate: f64) -> (f64, f64) {
        let part = (coordinate - self.from) / (self.to - self.from);
        let between = part > 0.0 && part < 1.0;
        (part.clamp(0.0, 1.0), if between { 1.0 / (self.to - self.from) } else { 0.0 })
    }
}

impl Rule for Ramp {
    fn apply(&self, p: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        let (part, growth) = self.part(p[self.axis]);
        slopes.copy_from_slice(&[1.0 - part, part]);
        let value = values[0] * (1.0 - part) + values[1] * part;
        Slope { value, with_place: DVec3::AXES[self.axis] * ((values[1] - values[0]) * growth) }
    }

    fn range(&self, ball: &Ball, ranges: &[Range]) -> Range {
        let at = |side: f64| {
            let part = self.part(ball.centre[self.axis] + side * ball.radius).0;
            ranges[0].times(1.0 - part).plus(ranges[1].times(part))
        };
        at(-1.0).or(at(1.0))
    }

    fn lipschitz(&self, _: &[f64]) -> f64 {
        // What lies between two values grows with their difference, which has no bound.
        f64::INFINITY
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        extents[0].or(extents[1])
    }
}
