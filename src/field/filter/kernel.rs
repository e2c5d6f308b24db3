//! The kernels, and samples of them.

use std::f64::consts::TAU;

use glam::DVec3;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// How displacements are weighted (Sanchez et al. 2015 §4.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// e^(1 / (|u/b|² − 1)) up to |u| = b and nothing beyond (5, 6).
    Bump {
        /// The paper's b, model units.
        width: f64,
    },
    /// (a/π)^(3/2) e^(−a |u|²). It has no end, so that the filter may reach beyond the surface.
    Gaussian {
        /// The paper's a, over square model units: the standard deviation is 1 / √(2 a).
        a: f64,
    },
}

impl Kernel {
    /// The Gaussian of this standard deviation, model units.
    pub fn gaussian(sigma: f64) -> Self {
        Self::Gaussian { a: 1.0 / (2.0 * sigma * sigma) }
    }

    /// What counts as its width, model units: b, or three standard deviations.
    pub fn width(&self) -> f64 {
        match *self {
            Self::Bump { width } => width,
            Self::Gaussian { a } => 3.0 / (2.0 * a).sqrt(),
        }
    }

    /// The weight of a displacement, up to a factor.
    fn weight(&self, u: DVec3) -> f64 {
        match *self {
            Self::Bump { width } => {
                let square = (u / width).length_squared();
                if square < 1.0 { (1.0 / (square - 1.0)).exp() } else { 0.0 }
            }
            Self::Gaussian { a } => (-a * u.length_squared()).exp(),
        }
    }

    /// One displacement drawn with the kernel as density (§5.1).
    fn draw(&self, random: &mut impl Rng) -> DVec3 {
        match *self {
            // Rejection: the density is greatest, 1/e, at 0.
            Self::Bump { width } => loop {
                let u = DVec3::from_array(std::array::from_fn(|_| 2.0 * uniform(random) - 1.0));
                let height = Self::Bump { width: 1.0 }.weight(u) * std::f64::consts::E;
                if uniform(random) < height {
                    return u * width;
                }
            },
            // Box and Muller.
            Self::Gaussian { a } => {
                let mut pair = || {
                    let radius = (-2.0 * (1.0 - uniform(random)).ln()).sqrt();
                    let (sin, cos) = (TAU * uniform(random)).sin_cos();
                    [radius * cos, radius * sin]
                };
                let ([x, y], [z, _]) = (pair(), pair());
                DVec3::new(x, y, z) / (2.0 * a).sqrt()
            }
        }
    }
}

/// A number from 0 to below 1.
pub(in crate::field) fn uniform(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// Where a field is sampled around a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// At so many displacements drawn once from the kernel, all with the same weight: the sum (10).
    Drawn {
        /// How many, at least 1.
        count: usize,
        /// Where the sequence of random numbers begins.
        seed: u64,
        /// Whether each displacement is followed by its opposite. A field that is linear is then filtered without any
        /// error; docs/algorithms/fields.md has what it does to others.
        mirrored: bool,
    },
    /// At so many places along each axis of the cube around the kernel, weighted by it: the sum (9).
    Regular {
        /// How many, at least 2.
        side: usize,
    },
}

/// A displacement and its part of the whole weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Displacement {
    pub by: DVec3,
    pub weight: f64,
}

/// The displacements of `sampling`; their weights add up to 1.
pub(super) fn displacements(kernel: &Kernel, sampling: Sampling) -> Vec<Displacement> {
    match sampling {
        Sampling::Drawn { count, seed, mirrored } => {
            let count = count.max(1);
            let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
            let drawn = std::iter::repeat_with(|| kernel.draw(&mut random));
            let both = drawn.flat_map(|u| [Some(u), mirrored.then_some(-u)]).flatten();
            both.take(count).map(|by| Displacement { by, weight: 1.0 / count as f64 }).collect()
        }
        Sampling::Regular { side } => {
            let side = side.max(2);
            let at = |k: usize| kernel.width() * (2.0 * k as f64 / (side - 1) as f64 - 1.0);
            let places = (0..side.pow(3)).map(|n| DVec3::new(at(n % side), at(n / side % side), at(n / side / side)));
            let weighted: Vec<(DVec3, f64)> = places.map(|u| (u, kernel.weight(u))).filter(|(_, w)| *w > 0.0).collect();
            let sum: f64 = weighted.iter().map(|(_, weight)| weight).sum();
            let of = |(by, weight): (DVec3, f64)| Displacement { by, weight: weight / sum };
            // A side of 2 has only the corners, where the bump has ended: then the middle stands for all.
            let middle = || vec![Displacement { by: DVec3::ZERO, weight: 1.0 }];
            if weighted.is_empty() { middle() } else { weighted.into_iter().map(of).collect() }
        }
    }
}

/// An order in which packets of eight are near each other: sorted in halves along the longest side.
pub(super) fn near_each_other(displacements: &mut [Displacement]) {
    if displacements.len() <= 8 {
        return;
    }
    let low = displacements.iter().fold(DVec3::INFINITY, |low, d| low.min(d.by));
    let high = displacements.iter().fold(DVec3::NEG_INFINITY, |high, d| high.max(d.by));
    let size = high - low;
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    displacements.sort_by(|a, b| a.by[axis].total_cmp(&b.by[axis]));
    let middle = (displacements.len() / 16 * 8).max(8);
    let (left, right) = displacements.split_at_mut(middle);
    near_each_other(left);
    near_each_other(right);
}
