//! Booleans with a smooth transition (Sanchez et al. 2015 §6.2 after Pasko et al. 1995).
//!
//! An R-function is the boolean, smooth wherever not both surfaces pass; a displacement near the seam adds or takes away
//! material. That of Pasko et al., a₀ / (1 + (f₁/a₁)² + (f₂/a₂)²), never ends, so that it moves both surfaces everywhere. Here
//! it is a₀ (1 − (f₁² + f₂²) / a²)² up to the distance a, where it ends with its slope: away from the seam the surfaces are exactly
//! those of the plain boolean.

use std::sync::Arc;

use glam::DVec3;

use super::algebra::complement;
use super::{Ball, Combined, Extent, Range, Rule, Shared, Slope};

/// The greatest displacement over the radius. At 1/4 the transition between two planes at right angles is, on the
/// diagonal, where the arc of a circle would be that touches both at the radius.
const HEIGHT: f64 = 0.25;

/// How steep the displacement is at most, over its height and with the radius 1: where r² = 1/3 of 4 r (1 − r²).
const STEEPEST: f64 = 1.54;

/// The union of two fields, with the seam filled within `radius`, model units, more than 0.
pub fn blend_union(a: Shared, b: Shared, radius: f64) -> Shared {
    Arc::new(Combined::new(vec![a, b], Blend { radius, sign: 1.0 }))
}

/// The intersection of two fields, with the seam rounded off within `radius`, model units, more than 0.
pub fn blend_intersection(a: Shared, b: Shared, radius: f64) -> Shared {
    Arc::new(Combined::new(vec![a, b], Blend { radius, sign: -1.0 }))
}

/// The difference of two fields, with the seam rounded off within `radius`, model units, more than 0.
pub fn blend_difference(a: Shared, b: Shared, radius: f64) -> Shared {
    blend_intersection(a, complement(b), radius)
}

struct Blend {
    radius: f64,
    /// 1 for the union, −1 for the intersection, which is the union of what is outside, seen from outside.
    sign: f64,
}

impl Blend {
    /// The R-function of the union.
    fn joined(a: f64, b: f64) -> f64 {
        // Written so that large values, infinite ones too, lose nothing: a + b − √(a² + b²).
        let (near, far) = (a.min(b), a.max(b));
        if far == f64::INFINITY || near == far && near == 0.0 {
            return near;
        }
        if near > 0.0 { 2.0 * near * far / (near + far + near.hypot(far)) } else { near + far - near.hypot(far) }
    }

    fn displacement(&self, square: f64) -> f64 {
        self.radius * HEIGHT * (1.0 - square / self.radius.powi(2)).max(0.0).powi(2)
    }
}

impl Rule for Blend {
    fn apply(&self, _: DVec3, values: &[f64], slopes: &mut [f64]) -> Slope {
        let [a, b] = [values[0] * self.sign, values[1] * self.sign];
        let hypot = a.hypot(b);
        let within = hypot < self.radius;
        let steep = if within { 4.0 * HEIGHT / self.radius * (1.0 - (hypot / self.radius).powi(2)) } else { 0.0 };
        for (slope, value) in slopes.iter_mut().zip([a, b]) {
            let along = if hypot > 0.0 && hypot.is_finite() { value / hypot } else { 0.0 };
            *slope = 1.0 - along + if within { steep * value } else { 0.0 };
        }
        Slope { value: self.sign * (Self::joined(a, b) - self.displacement(hypot * hypot)), ..Slope::default() }
    }

    fn range(&self, _: &Ball, ranges: &[Range]) -> Range {
        let [a, b] = [ranges[0].times(self.sign), ranges[1].times(self.sign)];
        let nearest = a.abs().min.powi(2) + b.abs().min.powi(2);
        let range =
            Range { min: Self::joined(a.min, b.min) - self.displacement(nearest), max: Self::joined(a.max, b.max) };
        range.times(self.sign)
    }

    fn lipschitz(&self, lipschitz: &[f64]) -> f64 {
        // The gradient of the R-function by its two values is (1 − cos, 1 − sin) of an angle.
        (1.0 + std::f64::consts::SQRT_2 + STEEPEST * HEIGHT) * lipschitz[0].hypot(lipschitz[1])
    }

    fn extent(&self, extents: &[Extent]) -> Extent {
        if self.sign > 0.0 { extents[0].or(extents[1]).grown(self.radius) } else { extents[0].and(extents[1]) }
    }

    fn keeps_surfaces(&self) -> bool {
        true
    }
}
