//! Lengths of spans and gaps along the face directions: the evidence for walls too thin.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Hit, Spans};
use crate::lattice::BRICK;
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

/// Calls `visit` with each wall and gap that is asked for and that a ray of any direction crosses steeply: whether it is a gap, the ray, its two ends, and the
/// width in voxels, the length of the piece times the cosine of the angle with the nearer normal. `planes` are those of
/// the triangles, lattice coordinates.
fn each_width(
    spans: &Spans,
    planes: &[Plane],
    asked: impl Fn(&[Hit]) -> bool,
    mut visit: impl FnMut(bool, usize, &[Hit], f64),
) {
    let way = spans.layers.direction.vector().as_dvec3();
    let (length, unit) = (way.length(), way.normalize());
    for ray in (0..spans.layers.ray_count()).filter(|&ray| !spans.is_silent(ray)) {
        for (n, ends) in spans.layers.of(ray).windows(2).enumerate().filter(|(_, ends)| asked(ends)) {
            let cosine = ends.iter().map(|hit| planes[hit.triangle() as usize].normal.dot(unit).abs());
            let cosine = cosine.fold(1.0, f64::min);
            if cosine >= ALONG {
                visit(n % 2 == 1, ray, ends, (ends[1].depth - ends[0].depth) * length * cosine);
            }
        }
    }
}

/// Widths, in voxels, of the walls and gaps that rays of any direction cross steeply. `planes` are those of the triangles,
/// lattice coordinates.
pub fn widths(spans: &[Spans], planes: &[Plane]) -> Lengths {
    let mut widths = Lengths::default();
    for spans in spans {
        each_width(
            spans,
            planes,
            |_| true,
            |gap, _, _, width| if gap { widths.gaps.push(width) } else { widths.spans.push(width) },
        );
    }
    widths.spans.sort_unstable_by(f64::total_cmp);
    widths.gaps.sort_unstable_by(f64::total_cmp);
    widths
}

/// A place where walls or gaps are thinner than [`THIN`]. Lattice coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinPlace {
    /// Whether the place is a gap between walls; else it is a wall.
    pub gap: bool,
    /// The smallest coordinates of the pieces of rays that are too short here.
    pub min: DVec3,
    /// The largest coordinates of these pieces.
    pub max: DVec3,
    /// The number of these pieces.
    pub rays: usize,
    /// The least width, voxels.
    pub least: f64,
}

impl ThinPlace {
    fn join(&mut self, other: &Self) {
        (self.min, self.max) = (self.min.min(other.min), self.max.max(other.max));
        self.rays += other.rays;
        self.least = self.least.min(other.least);
    }
}

/// Where walls and gaps are thinner than [`THIN`], of those of which a side may have suffered: one of the two triangles is not `sound`.
/// The places with the most rays come first; a place is connected through bricks that touch.
pub fn thin_places(spans: &[Spans], planes: &[Plane], sound: impl Fn(u32) -> bool) -> Vec<ThinPlace> {
    let mut cells: BTreeMap<(bool, [i32; 3]), ThinPlace> = BTreeMap::new();
    for spans in spans {
        let harmed = |ends: &[Hit]| !ends.iter().all(|hit| sound(hit.triangle()));
        each_width(spans, planes, harmed, |gap, ray, ends, width| {
            if width >= THIN {
                return;
            }
            let (u, v) = spans.layers.position(ray);
            let [a, b] = [ends[0], ends[1]].map(|hit| spans.layers.direction.unshear(u, v, hit.depth));
            let one = ThinPlace { gap, min: a.min(b), max: a.max(b), rays: 1, least: width };
            let brick = ((a + b) / (2.0 * f64::from(BRICK))).floor().as_ivec3();
            cells.entry((gap, brick.to_array())).and_modify(|place| place.join(&one)).or_insert(one);
        });
    }
    let mut places = Vec::new();
    while let Some((start, first)) = cells.pop_first() {
        let (mut place, mut stack) = (first, vec![start]);
        while let Some((gap, [x, y, z])) = stack.pop() {
            for k in 0..27 {
                let near = (gap, [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
                if let Some(other) = cells.remove(&near) {
                    place.join(&other);
                    stack.push(near);
                }
            }
        }
        places.push(place);
    }
    places.sort_by_key(|place| std::cmp::Reverse(place.rays));
    places
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

    #[test]
    fn thin_pieces_near_each_other_are_one_place_and_those_between_sound_triangles_are_none() {
        let spans = [of(&[(1.0, 0, true), (2.5, 1, false), (3.0, 2, true), (7.0, 3, false)])];
        let planes = vec![Plane { normal: DVec3::X, offset: 0.0 }; 4];
        let found = thin_places(&spans, &planes, |_| false);
        let place = |gap, from: f64, to: f64| ThinPlace {
            gap,
            min: DVec3::X * from,
            max: DVec3::X * to,
            rays: 1,
            least: to - from,
        };
        assert_eq!(found, [place(false, 1.0, 2.5), place(true, 2.5, 3.0)]);
        assert_eq!(thin_places(&spans, &planes, |t| t < 2), [place(true, 2.5, 3.0)]);
        assert!(thin_places(&spans, &planes, |_| true).is_empty());
    }
}
