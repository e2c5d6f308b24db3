//! The samples around a point, and how far they reach.

use super::kernel::{Displacement, displacements, near_each_other};
use super::{FilterOptions, Sampling};

/// The samples around a point.
pub(super) struct Around {
    /// Those that are always taken, in packets; their weights add up to 1.
    pub first: Vec<Displacement>,
    /// Those that are taken where they are needed, in the order drawn.
    pub more: Vec<Displacement>,
    /// How many of them are added at a time: opposites together.
    pub step: usize,
    /// The width of the kernel, model units.
    pub width: f64,
    /// The farthest displacement, and the greatest mean of the first ones and any of the others, model units.
    pub farthest: f64,
    pub mean: f64,
}

impl Around {
    pub fn new(options: &FilterOptions) -> Self {
        let mut first = displacements(&options.kernel, options.sampling);
        let step = if matches!(options.sampling, Sampling::Drawn { mirrored: true, .. }) { 2 } else { 1 };
        let drawn = matches!(options.sampling, Sampling::Drawn { .. });
        let least = options.adaptive.filter(|_| drawn).map(|adaptive| adaptive.least.max(2).next_multiple_of(step));
        let least = least.unwrap_or(first.len());
        let mut more = first.split_off(least.min(first.len()));
        let sum: f64 = first.iter().map(|d| d.weight).sum();
        first.iter_mut().for_each(|d| d.weight /= sum);
        more.iter_mut().for_each(|d| d.weight = 1.0);
        near_each_other(&mut first);
        let farthest = first.iter().chain(&more).map(|d| d.by.length()).fold(0.0, f64::max);
        let mut sum: f64 = first.iter().map(|d| d.by.length() * d.weight).sum();
        let (mut mean, mut count) = (sum, first.len() as f64);
        sum *= count;
        for d in &more {
            (sum, count) = (sum + d.by.length(), count + 1.0);
            mean = mean.max(sum / count);
        }
        Self { width: options.kernel.width(), step, farthest, mean, first, more }
    }
}
