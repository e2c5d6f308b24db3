//! A property that is known on some shapes, everywhere between them.

use std::sync::Arc;

use glam::DVec3;

use super::{Ball, Combined, Extent, Range, Rule, Shared, Slope};

/// `values[k]` on the surface of `fields[k]`, and in between their mean by the inverse distances: transfinite interpolation
/// (Sanchez et al. 2015 §6.4 after Rvachev et al. 2001). It is as smooth as the fields are, so filtered ones give a property
/// without creases. A measure, not a shape.
pub fn material(fields: Vec<Shared>, values: Vec<f64>) -> Shared {
    Arc::new(Combined::new(fields, Transfinite { values }))
}

struct Transfinite {
    values: Vec<f64>,
}

impl Rule for Transfinite {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        // Relative to the least distance the weights stay finite; on a surface that one has all the weight.
        let least = values.iter().fold(f64::INFINITY, |least, v| v.abs().min(least));
        let weight = |value: f64| if value.abs() == least { 1.0 } else { least / value.abs() };
        let weights = || values.iter().map(|&value| weight(value));
        let sum: f64 = weights().sum();
        let value = weights().zip(&self.values).map(|(weight, value)| weight * value).sum::<f64>() / sum;
        for ((slope, weight), (at, own)) in slopes.iter_mut().zip(weights()).zip(values.iter().zip(&self.values)) {
            *slope = if at.abs() > 0.0 { (value - own) * weight / (sum * at) } else { 0.0 };
        }
        Slope { value, ..Slope::default() }
    }

    fn range(&self, _: &Ball, _: &[Range]) -> Range {
        Range::of(self.values.iter().copied())
    }

    fn lipschitz(&self, _: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn extent(&self, _: &[Extent]) -> Extent {
        Extent::Unbounded
    }
}
