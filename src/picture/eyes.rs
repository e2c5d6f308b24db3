//! What eyes that lack a kind of cones make of colours, for tests of palettes.

use crate::io::linear_from_srgb;

/// What an eye makes of linear light: one with all cones, and ones without one kind (Machado, Oliveira and Fernandes 2009, severity 1).
pub(crate) const EYES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
];

/// CIE L*a*b* of linear light, where a distance of 2 can just be seen.
fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
    let f = |t: f64| if t > 0.008856 { t.max(0.0).cbrt() } else { 7.787 * t + 16.0 / 116.0 };
    let x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
    let y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
    let z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn seen(colour: [u8; 3], eye: &[[f64; 3]; 3]) -> [f64; 3] {
    let light = colour.map(linear_from_srgb);
    lab([0, 1, 2].map(|k| (0..3).map(|n| eye[k][n] * light[n]).sum::<f64>().clamp(0.0, 1.0)))
}

/// How far apart two colours, sRGB, look to an eye.
pub(crate) fn apart(a: [u8; 3], b: [u8; 3], eye: &[[f64; 3]; 3]) -> f64 {
    let (a, b) = (seen(a, eye), seen(b, eye));
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
