//! Between sRGB, which files of meshes hold, and linear light, which glTF holds.

/// Linear light, 0 to 1, of an sRGB channel.
pub(crate) fn linear_from_srgb(level: u8) -> f64 {
    let s = f64::from(level) / 255.0;
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB channel of linear light, 0 to 1; `None` beyond that by more than rounding does.
pub(in crate::io) fn srgb_from_linear(light: f64) -> Option<u8> {
    let s = if light <= 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    let level = (255.0 * s).round();
    (0.0..=255.0).contains(&level).then_some(level as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bits_of_linear_light_keep_every_level() {
        for level in 0..=255 {
            let stored = (linear_from_srgb(level) * 65535.0).round() as u16;
            assert_eq!(srgb_from_linear(f64::from(stored) / 65535.0), Some(level));
            assert_eq!(srgb_from_linear(f64::from(linear_from_srgb(level) as f32)), Some(level));
        }
    }

    #[test]
    fn what_is_beyond_the_range_is_told() {
        assert_eq!(
            [-0.001, 0.0, 0.5, 1.0, 1.001].map(srgb_from_linear),
            [None, Some(0), Some(188), Some(255), Some(255)]
        );
        assert_eq!([-0.5, 2.0, f64::NAN, f64::INFINITY].map(srgb_from_linear), [None; 4]);
    }
}
