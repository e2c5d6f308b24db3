//! Colours for values.

/// From dark violet over green to yellow: each step is as much lighter as the one before.
const RAMP: [[f64; 3]; 5] =
    [[52.0, 28.0, 96.0], [45.0, 84.0, 140.0], [38.0, 135.0, 134.0], [96.0, 186.0, 96.0], [246.0, 228.0, 94.0]];

/// The colour of a measured value, scaled so that the least one is 0 and the greatest 1. A value below 0 or above 1 has the colour of
/// that end, and NaN is grey.
pub fn ramp_colour(value: f64) -> [u8; 3] {
    if value.is_nan() {
        return [128; 3];
    }
    let at = value.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let first = (at as usize).min(RAMP.len() - 2);
    let part = at - first as f64;
    std::array::from_fn(|k| (RAMP[first][k] + (RAMP[first + 1][k] - RAMP[first][k]) * part).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_grow_lighter_with_the_value() {
        let light = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
        let all: Vec<f64> = (0..=100).map(|k| light(ramp_colour(f64::from(k) / 100.0))).collect();
        assert!(all.windows(2).all(|pair| pair[1] > pair[0]));
        assert_eq!(ramp_colour(-1.0), ramp_colour(0.0));
        assert_eq!(ramp_colour(f64::INFINITY), ramp_colour(1.0));
        assert_eq!(ramp_colour(f64::NAN), [128; 3]);
    }
}
