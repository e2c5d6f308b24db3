//! Lengths of spans and gaps along the face directions: the evidence for walls too thin.

use super::{Hit, Spans};
use crate::mesh::Plane;

/// Spans and gaps shorter than this (voxels) may not survive the lattice.
pub const THIN: f64 = 2.0;

/// Span and gap lengths, in voxels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lengths {
    /// All spans, sorted.
    pub spans: Vec<f64>,
    /// Gaps between spans of one ray, sorted.
    pub gaps: Vec<f64>,
    /// Spans that hold no voxel: the ray alone would lose them. Not counted by [`widths`].
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

/// A ray counts for the width of a wall when both ends of its span look along it, to within 32°: one of the 13 directions
/// does for any wall, and the rounding of a silhouette, which makes short spans on any shape, does not.
const ALONG: f64 = 0.85;

/// Widths, in voxels, of the walls and gaps that rays of any direction cross steeply: the length of a span times the cosine
/// of the angle with the nearer normal. `planes` are those of the triangles, lattice coordinates.
pub fn widths(spans: &[Spans], planes: &[Plane]) -> Lengths {
    let mut widths = Lengths::default();
    for spans in spans {
        let way = spans.layers.direction.vector().as_dvec3();
        let (length, unit) = (way.length(), way.normalize());
        let width = |ends: &[Hit]| {
            let cosine = ends.iter().map(|hit| planes[hit.triangle() as usize].normal.dot(unit).abs());
            let cosine = cosine.fold(1.0, f64::min);
            (cosine >= ALONG).then(|| (ends[1].depth - ends[0].depth) * length * cosine)
        };
        for ray in (0..spans.layers.ray_count()).filter(|&ray| !spans.is_silent(ray)) {
            let hits = spans.layers.of(ray);
            widths.spans.extend(hits.chunks_exact(2).filter_map(width));
            widths.gaps.extend(hits.windows(2).skip(1).step_by(2).filter_map(width));
        }
    }
    widths.spans.sort_unstable_by(f64::total_cmp);
    widths.gaps.sort_unstable_by(f64::total_cmp);
    widths
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
