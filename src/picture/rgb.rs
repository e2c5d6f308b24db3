//! Colours in linear light.

use std::ops::{Add, Mul};

use glam::Vec3;

/// A colour in linear light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rgb(Vec3);

impl Rgb {
    pub(super) const BLACK: Self = Self(Vec3::ZERO);
    pub(super) const WHITE: Self = Self(Vec3::ONE);

    /// From linear red, green and blue, 0 to 1.
    pub(super) fn of(light: Vec3) -> Self {
        Self(light)
    }

    /// From linear red, green and blue, 0 to 1.
    pub(super) const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }

    pub(super) fn to_srgb(self) -> [u8; 3] {
        self.0.to_array().map(|x| {
            let x = x.clamp(0.0, 1.0);
            let curved = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
            (curved * 255.0 + 0.5) as u8
        })
    }
}

impl Add for Rgb {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    fn mul(self, by: f32) -> Self {
        Self(self.0 * by)
    }
}

/// A colour in linear light, not multiplied by its alpha.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSample {
    pub(super) colour: Rgb,
    pub(super) alpha: f32,
}

impl PixelSample {
    /// Lays `colour` over it.
    pub(super) fn cover(&mut self, colour: Rgb, alpha: f32) {
        let total = alpha + self.alpha * (1.0 - alpha);
        if total > 0.0 {
            self.colour = self.colour * (self.alpha * (1.0 - alpha) / total) + colour * (alpha / total);
            self.alpha = total;
        }
    }
}
