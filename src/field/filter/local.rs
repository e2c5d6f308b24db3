//! Smoothing of a shape where a second shape says so (Sanchez et al. 2015 §6.1).

use std::sync::Arc;

use glam::DVec3;

use super::kernel::{Displacement, Kernel, Sampling, displacements, near_each_other};
use super::smoothstep;
use crate::field::{Ball, Extent, Field, Range, Sample, Shared, SourceTriangle};

/// Options of [`smooth`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothOptions {
    /// How far inside the smoothing volume the kernel has its full size, the paper's s_d, model units, more than 0.
    pub depth: f64,
    /// The radius of the kernel there, the paper's s_r, model units, more than 0.
    pub radius: f64,
    /// Where the field is sampled.
    pub sampling: Sampling,
}

/// `field`, smoothed inside `volume` by a bump kernel whose size grows with the depth in it; unchanged outside. The surface
/// moves there: edges become round.
///
/// The paper's formula of the kernel's size has the distance to the object where its text, and this, have the one
/// to the boundary of the volume.
pub fn smooth(field: Shared, volume: Shared, options: &SmoothOptions) -> Shared {
    let mut around = displacements(&Kernel::Bump { width: options.radius }, options.sampling);
    near_each_other(&mut around);
    Arc::new(Smoothed { field, volume, around, options: *options })
}

struct Smoothed {
    field: Shared,
    volume: Shared,
    around: Vec<Displacement>,
    options: SmoothOptions,
}

impl Smoothed {
    /// The kernel's size, 0 to 1, at a value of the volume, and how it grows with the value.
    fn size(&self, volume: f64) -> (f64, f64) {
        if volume >= 0.0 {
            return (0.0, 0.0);
        }
        let (size, growth) = smoothstep(-volume / self.options.depth);
        (size, -growth / self.options.depth)
    }
}

impl Field for Smoothed {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        self.field.values(points, values);
        let mut volumes = vec![0.0; points.len()];
        self.volume.values(points, &mut volumes);
        let (mut places, mut found) = (Vec::new(), vec![0.0; self.around.len()]);
        for ((&p, value), volume) in points.iter().zip(values).zip(volumes) {
            let size = self.size(volume).0;
            if size > 0.0 {
                places.clear();
                places.extend(self.around.iter().map(|d| p - d.by * size));
                self.field.values(&places, &mut found);
                *value = self.around.iter().zip(&found).map(|(d, value)| d.weight * value).sum();
            }
        }
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        self.field.samples(points, samples);
        let mut volumes = vec![Sample::default(); points.len()];
        self.volume.samples(points, &mut volumes);
        let mut found = vec![Sample::default(); self.around.len()];
        for ((&p, sample), volume) in points.iter().zip(samples).zip(volumes) {
            let (size, growth) = self.size(volume.value);
            if size <= 0.0 {
                continue;
            }
            let places: Vec<DVec3> = self.around.iter().map(|d| p - d.by * size).collect();
            self.field.samples(&places, &mut found);
            *sample = Sample::default();
            for (d, found) in self.around.iter().zip(&found) {
                let with_size = found.gradient.dot(d.by) * growth;
                sample.value += d.weight * found.value;
                sample.gradient += (found.gradient - volume.gradient * with_size) * d.weight;
            }
        }
    }

    fn range(&self, ball: &Ball) -> Range {
        let deepest = self.volume.range(ball).min;
        let reach = self.options.radius * if deepest.is_finite() { self.size(deepest).0 } else { 1.0 };
        self.field.range(&Ball { radius: ball.radius + reach, ..*ball })
    }

    fn lipschitz(&self) -> f64 {
        let growth = 1.5 / self.options.depth * self.volume.lipschitz() * self.options.radius;
        self.field.lipschitz() * (1.0 + growth)
    }

    fn extent(&self) -> Extent {
        self.field.extent().grown(self.options.radius)
    }

    fn source_triangle(&self, p: DVec3, within: f64) -> Option<SourceTriangle> {
        // Inside the volume a surface of planes that stays where it was, stays.
        self.field.source_triangle(p, within).filter(|_| self.value(p).abs() <= within)
    }
}
