//! Fuzzy shapes: 1 deep inside, ½ on the surface, 0 far away (Payne and Toga 1992, "Alternate fields for blobby modelers").
//!
//! As fields they are given as 2 R (½ − blob): zero where the blob is ½, negative inside, and with the gain ½ the distance
//! itself up to R.

use std::sync::Arc;

use glam::DVec3;

use super::{Ball, Combined, Extent, Range, Rule, Shared, Slope};

/// How a distance becomes a blob.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlobOptions {
    /// Depth at which the blob is 1 and distance at which it is 0, model units, more than 0.
    pub radius: f64,
    /// Perlin's gain, between 0 and 1: ½ rises evenly, more of it steeper at the surface.
    pub gain: f64,
}

impl BlobOptions {
    /// The blob at a distance, model units, negative inside (the paper's is positive inside).
    pub fn blob(&self, distance: f64) -> f64 {
        let t = (0.5 - distance / (2.0 * self.radius)).clamp(0.0, 1.0);
        let half = |t: f64| (2.0 * t).powf(self.exponent()) / 2.0;
        if t < 0.5 { half(t) } else { 1.0 - half(1.0 - t) }
    }

    /// How the blob grows with the distance, per model unit.
    fn slope(&self, distance: f64) -> f64 {
        let t = 0.5 - distance / (2.0 * self.radius);
        if !(t > 0.0 && t < 1.0) {
            return 0.0;
        }
        let exponent = self.exponent();
        -exponent * (2.0 * t.min(1.0 - t)).powf(exponent - 1.0) / (2.0 * self.radius)
    }

    /// Of Perlin's bias for 1 − gain.
    fn exponent(&self) -> f64 {
        (1.0 - self.gain).ln() / 0.5f64.ln()
    }
}

/// The blob of one shape.
pub fn blob(field: Shared, options: BlobOptions) -> Shared {
    join(vec![field], options, Join::Sum)
}

/// The union of fuzzy shapes, what is probably in one of them: the sum of the blobs ("Surface blending", "Boolean operations"). Where two
/// come near each other they join.
pub fn blob_union(fields: Vec<Shared>, options: BlobOptions) -> Shared {
    join(fields, options, Join::Sum)
}

/// The intersection of fuzzy shapes, what is probably in all of them: the product of the blobs.
pub fn blob_intersection(fields: Vec<Shared>, options: BlobOptions) -> Shared {
    join(fields, options, Join::Product)
}

/// The first shape with bites by the others: its blob less theirs.
pub fn blob_difference(first: Shared, others: Vec<Shared>, options: BlobOptions) -> Shared {
    join(std::iter::once(first).chain(others).collect(), options, Join::Difference)
}

/// How much more `a` is there than `b`: the difference of the blobs, −1 to 1, and 0 where both are far away ("Boolean
/// operations"). A measure, not a shape.
pub fn compare(a: Shared, b: Shared, options: BlobOptions) -> Shared {
    join(vec![a, b], options, Join::Compare)
}

fn join(fields: Vec<Shared>, options: BlobOptions, join: Join) -> Shared {
    Arc::new(Combined::new(fields, Joined { options, join }))
}

#[derive(Clone, Copy, PartialEq)]
enum Join {
    Sum,
    Product,
    Difference,
    Compare,
}

struct Joined {
    options: BlobOptions,
    join: Join,
}

impl Joined {
    fn joined(&self, blobs: impl Iterator<Item = f64> + Clone) -> f64 {
        match self.join {
            Join::Sum => blobs.sum(),
            Join::Product => blobs.product(),
            Join::Difference | Join::Compare => blobs.clone().take(1).sum::<f64>() - blobs.skip(1).sum::<f64>(),
        }
    }

    /// As a field.
    fn field(&self, blob: f64) -> f64 {
        if self.join == Join::Compare { blob } else { 2.0 * self.options.radius * (0.5 - blob) }
    }
}

impl Rule for Joined {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        let blob = |k: usize| self.options.blob(values[k]);
        let per_blob = self.field(1.0) - self.field(0.0);
        for k in 0..values.len() {
            let others = || (0..values.len()).filter(|&j| j != k).map(blob).product::<f64>();
            let of_blob = match self.join {
                Join::Product => others(),
                Join::Difference | Join::Compare if k > 0 => -1.0,
                _ => 1.0,
            };
            slopes[k] = per_blob * of_blob * self.options.slope(values[k]);
        }
        Slope { value: self.field(self.joined((0..values.len()).map(blob))), ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        // Blobs fall as distances rise.
        let end = |least: bool| {
            let turned = |k: usize| matches!(self.join, Join::Difference | Join::Compare) && k > 0;
            let at =
                |(k, range): (usize, &Range)| self.options.blob(if turned(k) == least { range.max } else { range.min });
            self.field(self.joined(ranges.iter().enumerate().map(at)))
        };
        Range::of([end(false), end(true)])
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        // With less gain the blob is steep, without a bound, at its ends; with more at the surface.
        let exponent = self.options.exponent();
        let steepest = if exponent >= 1.0 { exponent } else { f64::INFINITY };
        let per_value = if self.join == Join::Compare { 1.0 / (2.0 * self.options.radius) } else { 1.0 };
        lipschitz.iter().map(|steep| steep * steepest * per_value).sum()
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        let all = extents.iter().copied();
        match self.join {
            Join::Sum => all.reduce(Extent::or).unwrap_or(Extent::Empty).grown(self.options.radius),
            Join::Product => all.reduce(Extent::and).unwrap_or(Extent::Empty),
            Join::Difference => all.take(1).next().unwrap_or(Extent::Empty),
            Join::Compare => Extent::Unbounded,
        }
    }
}
