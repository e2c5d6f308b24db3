//! Fields that are functions of the values of other fields.

use glam::DVec3;

use super::{Ball, Extent, Field, Range, Sample, Shared, SourceTriangle};

/// What a [`Rule`] makes of values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slope {
    /// The value.
    pub value: f64,
    /// How it grows with the place alone, all values held fast.
    pub with_place: DVec3,
}

/// How values make one value.
pub trait Rule: Send + Sync {
    /// The value at `p` of the fields' `values`, and into `slopes`, which is as long, how it grows with each of them.
    fn apply(&self, p: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope;

    /// Bounds of the value in `ball`, where the fields' are bounded by `ranges`.
    fn range(&self, ball: &Ball, ranges: &[Range]) -> Range;

    /// How steep the value is at most, where the fields are as steep as this.
    fn lipschitz(&self, lipschitz: &[f64]) -> f64;

    /// Where the value may be zero or less.
    fn extent(&self, extents: &[Extent]) -> Extent;

    /// Whether the zero level, where it lies on that of one of the fields, is what that field's is.
    fn keeps_surfaces(&self) -> bool {
        false
    }
}

/// Fields put together by a rule.
pub struct Combined<R> {
    fields: Vec<Shared>,
    rule: R,
}

impl<R: Rule> Combined<R> {
    /// The field that `rule` makes of the values of `fields`.
    pub fn new(fields: Vec<Shared>, rule: R) -> Self {
        Self { fields, rule }
    }
}

impl<R: Rule> Field for Combined<R> {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        let (n, count) = (points.len(), self.fields.len());
        let mut of = vec![0.0; n * count];
        of.chunks_exact_mut(n.max(1)).zip(&self.fields).for_each(|(part, field)| field.values(points, part));
        let (mut here, mut slopes) = (vec![0.0; count], vec![0.0; count]);
        for (k, &p) in points.iter().enumerate() {
            here.iter_mut().zip(of.chunks_exact(n)).for_each(|(value, part)| *value = part[k]);
            values[k] = self.rule.apply(p, &here, &mut slopes).value;
        }
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        let (n, count) = (points.len(), self.fields.len());
        let mut of = vec![Sample::default(); n * count];
        of.chunks_exact_mut(n.max(1)).zip(&self.fields).for_each(|(part, field)| field.samples(points, part));
        let (mut here, mut slopes) = (vec![0.0; count], vec![0.0; count]);
        for (k, &p) in points.iter().enumerate() {
            here.iter_mut().zip(of.chunks_exact(n)).for_each(|(value, part)| *value = part[k].value);
            let slope = self.rule.apply(p, &here, &mut slopes);
            let chain = of.chunks_exact(n).zip(&slopes).filter(|(_, slope)| **slope != 0.0);
            let gradient = chain.fold(slope.with_place, |sum, (part, &slope)| sum + part[k].gradient * slope);
            samples[k] = Sample { value: slope.value, gradient };
        }
    }

    fn range(&self, ball: &Ball) -> Range {
        let ranges: Vec<Range> = self.fields.iter().map(|field| field.range(ball)).collect();
        self.rule.range(ball, &ranges)
    }

    fn lipschitz(&self) -> f64 {
        let lipschitz: Vec<f64> = self.fields.iter().map(|field| field.lipschitz()).collect();
        self.rule.lipschitz(&lipschitz)
    }

    fn extent(&self) -> Extent {
        let extents: Vec<Extent> = self.fields.iter().map(|field| field.extent()).collect();
        self.rule.extent(&extents)
    }

    fn source_triangle(&self, p: DVec3, within: f64) -> Option<SourceTriangle> {
        let mut own = self.fields.iter().filter(|_| self.rule.keeps_surfaces());
        own.find_map(|field| field.source_triangle(p, within)).filter(|_| self.value(p).abs() <= within)
    }
}
