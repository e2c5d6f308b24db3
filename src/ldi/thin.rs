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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ldi::{Expression, Layers, Operands, spans};

    fn of(hits: &[(f64, u32, bool)]) -> Spans {
        spans(Layers::of_one_ray(hits), &Operands::new([9]), &Expression::Operand(0))
    }

    #[test]
    fn spans_and_the_gaps_between_them_are_measured_sorted() {
        let found = lengths(&[of(&[
            (1.0, 0, true),
            (3.0, 1, false),
            (3.5, 2, true),
            (4.25, 3, false),
            (5.25, 4, true),
            (7.75, 5, false),
        ])]);
        assert_eq!(found, Lengths { spans: vec![0.75, 2.0, 2.5], gaps: vec![0.5, 1.0], lost: 0 });
    }

    #[test]
    fn a_span_is_lost_when_no_voxel_lies_past_its_entry_and_up_to_its_exit() {
        for (entry, exit, lost) in [(1.25, 1.75, 1), (1.0, 1.5, 1), (1.5, 2.0, 0), (1.75, 2.25, 0)] {
            assert_eq!(lengths(&[of(&[(entry, 0, true), (exit, 1, false)])]).lost, lost, "{entry} to {exit}");
        }
    }

    #[test]
    fn silent_rays_and_the_sheared_directions_do_not_count() {
        let (span, open) = (of(&[(1.0, 0, true), (3.0, 1, false)]), of(&[(1.0, 0, true)]));
        let all = [open.clone(), span.clone(), open, span];
        assert_eq!(lengths(&all).spans, [2.0]);
    }
}
