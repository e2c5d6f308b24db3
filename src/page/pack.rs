//! Arrays of numbers as text: differences, their bytes by place, zlib, base64. The script of the page undoes it.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::DVec3;

use crate::mesh::Bounds;

/// The largest quantised coordinate.
const STEPS: f64 = 65_535.0;

/// A box that coordinates are told in: 65,535 steps along each side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// The smallest coordinates.
    pub min: DVec3,
    /// The largest.
    pub max: DVec3,
}

impl Grid {
    /// The one around a box; it has an extent along every axis.
    pub(super) fn around(bounds: &Bounds) -> Self {
        let least = bounds.diagonal().max(f64::MIN_POSITIVE) * 1e-6;
        Self { min: bounds.min, max: bounds.max.max(bounds.min + DVec3::splat(least)) }
    }

    fn steps(&self, p: DVec3) -> [u32; 3] {
        let steps = ((p - self.min) / (self.max - self.min) * STEPS).round();
        // What is no number becomes 0.
        steps.to_array().map(|step| step.clamp(0.0, STEPS) as u32)
    }

    /// Points, in two bytes for each coordinate.
    pub(super) fn points(&self, points: impl IntoIterator<Item = DVec3>) -> String {
        let steps: Vec<u32> = points.into_iter().flat_map(|p| self.steps(p)).collect();
        numbers(&steps, 3, 2)
    }
}

/// Whole numbers that are like those `stride` places before, of `bytes` bytes.
pub(super) fn numbers(values: &[u32], stride: usize, bytes: usize) -> String {
    let before = |n: usize| n.checked_sub(stride).map_or(0, |n| values[n]);
    let difference = |(n, &value): (usize, &u32)| match bytes {
        4 => zigzag(value.wrapping_sub(before(n)) as i32),
        // Differences of smaller numbers wrap within their bytes.
        bytes => value.wrapping_sub(before(n)) & ((1 << (8 * bytes)) - 1),
    };
    let differences: Vec<u32> = values.iter().enumerate().map(difference).collect();
    let planes = (0..bytes).flat_map(|place| differences.iter().map(move |d| (d >> (8 * place)) as u8));
    packed(&planes.collect::<Vec<u8>>())
}

/// Small numbers, one byte each.
pub(super) fn bytes(values: &[u8]) -> String {
    packed(values)
}

/// 0, -1, 1, -2, 2 and so on as 0, 1, 2, 3, 4.
fn zigzag(value: i32) -> u32 {
    ((value << 1) ^ (value >> 31)) as u32
}

fn packed(bytes: &[u8]) -> String {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
    // A vector takes all that is written to it.
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    STANDARD.encode(packed)
}

/// Bytes as an address that holds them itself.
pub(super) fn data_address(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    fn unpacked(text: &str) -> Vec<u8> {
        let mut out = Vec::new();
        let packed = STANDARD.decode(text).expect("base64");
        flate2::read::ZlibDecoder::new(&packed[..]).read_to_end(&mut out).expect("zlib");
        out
    }

    #[test]
    fn numbers_come_back() {
        let values = [7u32, 5, 4_000_000_000, 0, 1, 2];
        let bytes = unpacked(&numbers(&values, 1, 4));
        let n = values.len();
        let mut before = 0u32;
        let back: Vec<u32> = (0..n)
            .map(|k| {
                let raw = (0..4).fold(0u32, |sum, place| sum | u32::from(bytes[place * n + k]) << (8 * place));
                before = before.wrapping_add((raw >> 1) ^ (raw & 1).wrapping_neg());
                before
            })
            .collect();
        assert_eq!(back, values);
    }

    #[test]
    fn points_are_within_a_step_of_where_they_were() {
        let bounds = Bounds::of([DVec3::new(-3.0, 1.0, 5.0), DVec3::new(9.0, 1.0, 6.0)]).expect("two points");
        let grid = Grid::around(&bounds);
        assert_eq!(grid.steps(DVec3::new(-3.0, 1.0, 6.0)), [0, 0, 65_535]);
        assert_eq!(grid.steps(DVec3::splat(f64::NAN)), [0, 0, 0]);
        assert_eq!(unpacked(&grid.points([bounds.min, bounds.max])).len(), 12);
    }
}
