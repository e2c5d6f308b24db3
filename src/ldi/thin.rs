//! Lengths of spans and gaps along the face directions: the evidence for walls too thin.

use super::Spans;

/// Spans and gaps shorter than this (voxels) may not survive the lattice.
pub const THIN: f64 = 2.0;

/// Span and gap lengths of the three face directions, in voxels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lengths {
    /// All spans, sorted.
    pub spans: Vec<f64>,
    /// Gaps between spans of one ray, sorted.
    pub gaps: Vec<f64>,
    /// Spans that hold no voxel: the ray alone would lose them.
    pub lost: usize,
}

/// Measures the spans of the three face directions (the first three of `spans`).
pub fn lengths(spans: &[Spans]) -> Lengths {
    let mut lengths = Lengths::default();
    for spans in spans.iter().take(3) {
        for ray in (0..spans.layers.ray_count()).filter(|&ray| !spans.is_silent(ray)) {
            let hits = spans.layers.of(ray);
            for span in hits.chunks_exact(2) {
                lengths.spans.push(span[1].depth - span[0].depth);
                lengths.lost += (span[0].depth.floor() == span[1].depth.floor()) as usize;
            }
            let gaps = hits.windows(2).skip(1).step_by(2).map(|gap| gap[1].depth - gap[0].depth);
            lengths.gaps.extend(gaps);
        }
    }
    lengths.spans.sort_unstable_by(f64::total_cmp);
    lengths.gaps.sort_unstable_by(f64::total_cmp);
    lengths
}
