//! Colours for signed values: blue below zero, orange above, light in the middle.
//!
//! The map runs on straight lines in OKLab, whose distances are those that the eye sees, so equal steps of the value look
//! equally large, on both sides alike.

use glam::{Mat3, Vec3};

use super::rgb::Rgb;

/// Lightness of zero, and how much darker full colour is.
const LIGHTNESS: [f32; 2] = [0.97, 0.46];
/// Distance of full colour from grey; the largest that screens show for both hues.
const CHROMA: f32 = 0.118;
/// Hues of values below and above zero, degrees.
const HUES: [f32; 2] = [255.0, 55.0];

/// From the cube roots of the cones' answers to lightness and opponent colours, inverted.
const CONES_OF_LAB: Mat3 = Mat3::from_cols(
    Vec3::splat(1.0),
    Vec3::new(0.396_337_78, -0.105_561_346, -0.089_484_18),
    Vec3::new(0.215_803_76, -0.063_854_17, -1.291_485_5),
);
/// From the cones' answers to linear red, green and blue.
const RGB_OF_CONES: Mat3 = Mat3::from_cols(
    Vec3::new(4.076_741_7, -1.268_438, -0.004_196_086_3),
    Vec3::new(-3.307_711_6, 2.609_757_4, -0.703_418_6),
    Vec3::new(0.230_969_94, -0.341_319_38, 1.707_614_7),
);

/// The colour of a value from -1 to 1; beyond, that of the nearest.
pub(super) fn colour(value: f32) -> Rgb {
    let [r, g, b] = linear(value).to_array();
    Rgb::new(r, g, b)
}

fn linear(value: f32) -> Vec3 {
    let cones = CONES_OF_LAB * lab(value);
    RGB_OF_CONES * (cones * cones * cones)
}

fn lab(value: f32) -> Vec3 {
    let full = value.abs().min(1.0);
    let hue = HUES[usize::from(value > 0.0)].to_radians();
    Vec3::new(LIGHTNESS[0] - LIGHTNESS[1] * full, CHROMA * full * hue.cos(), CHROMA * full * hue.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_steps_look_equal_and_every_colour_can_be_shown() {
        let steps: Vec<f32> = (-20..=20).map(|n| n as f32 / 20.0).collect();
        let first = lab(steps[0]).distance(lab(steps[1]));
        for pair in steps.windows(2) {
            let step = lab(pair[0]).distance(lab(pair[1]));
            assert!((step - first).abs() < 1e-4, "{pair:?}: {step} and {first}");
            let rgb = linear(pair[0]);
            assert!(rgb.min_element() > -1e-3 && rgb.max_element() < 1.001, "{}: {rgb}", pair[0]);
        }
        assert_eq!(linear(-3.0), linear(-1.0));
    }

    #[test]
    fn blue_is_below_and_orange_above() {
        let [below, zero, above] = [-1.0, 0.0, 1.0].map(|value| colour(value).to_srgb());
        assert!(below[2] > below[0] + 60 && above[0] > above[2] + 60, "{below:?} {above:?}");
        assert!(zero.iter().all(|&channel| channel > 235), "{zero:?}");
    }
}
