//! What is seen where the mesh is not.

use super::options::Background;
use super::rgb::Rgb;
use crate::io::linear_from_srgb;

/// The greys above and below, sRGB: a white part, which is at most as bright as 97 of 100, stands out from both.
const GREYS: [f32; 2] = [236.0, 206.0];

/// The colour at a height of the image, 0 above and 1 below, before rounding; `None` for none.
pub(super) fn background(kind: Background, height: f32) -> Option<Rgb> {
    match kind {
        Background::White => Some(Rgb::WHITE),
        Background::Transparent => None,
        Background::Gradient => {
            let grey = GREYS[0] + (GREYS[1] - GREYS[0]) * height.clamp(0.0, 1.0);
            let low = linear_from_srgb(grey.floor() as u8) as f32;
            let high = linear_from_srgb(grey.ceil() as u8) as f32;
            let light = low + (high - low) * grey.fract();
            Some(Rgb::new(light, light, light))
        }
    }
}
