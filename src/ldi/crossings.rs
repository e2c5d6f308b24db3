//! The exact crossings of the result's surface with lattice edges, from the three face directions.

use glam::IVec3;

use super::{Hit, Spans};

/// The crossing of the lattice edge from `voxel` along axis `axis`, of which the lower end is
/// inside the result or not: its place on the edge, 0 to 1, and the crossing itself. `None` where
/// the ray has none that fits. `spans` are those of the 13 directions; the first three are the axes.
pub fn edge_crossing(spans: &[Spans], voxel: IVec3, axis: usize, lower_inside: bool) -> Option<(f64, Hit)> {
    let layers = &spans.get(axis)?.layers;
    let s = layers.direction.shear(voxel);
    let factor = layers.factor as i32;
    let ray = layers.ray(s.x * factor, s.y * factor)?;
    let depth = s.z as f64;
    let hits = layers.of(ray);
    let first = hits.partition_point(|hit| hit.depth < depth);
    let on_edge = hits[first..].iter().take_while(|hit| hit.depth <= depth + 1.0);
    // Of several crossings between the two voxels the middle one that fits stands for all.
    let fits = |hit: &&Hit| hit.entering() != lower_inside;
    let count = on_edge.clone().filter(fits).count();
    on_edge.filter(fits).nth(count / 2).map(|hit| (hit.depth - depth, *hit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ldi::{Expression, Layers, Operands, spans};

    fn crossing(hits: &[(f64, u32, bool)], voxel: i32, lower_inside: bool) -> Option<(f64, u32)> {
        let spans = [spans(Layers::of_one_ray(hits), &Operands::new([9]), &Expression::Operand(0))];
        edge_crossing(&spans, IVec3::new(voxel, 0, 0), 0, lower_inside).map(|(t, hit)| (t, hit.triangle()))
    }

    #[test]
    fn of_several_crossings_of_one_edge_the_middle_one_that_fits_is_taken() {
        let slices =
            [(2.125, 0, true), (2.25, 1, false), (2.5, 2, true), (2.625, 3, false), (2.75, 4, true), (5.5, 5, false)];
        assert_eq!(crossing(&slices, 2, false), Some((0.5, 2)));
        assert_eq!(crossing(&slices, 2, true), Some((0.625, 3)));
        assert_eq!(crossing(&slices, 5, true), Some((0.5, 5)));
    }

    #[test]
    fn without_a_crossing_that_fits_there_is_none() {
        let span = [(2.5, 0, true), (4.0, 1, false)];
        assert_eq!(crossing(&span, 2, true), None);
        assert_eq!(crossing(&span, 3, false), None);
        assert_eq!(crossing(&span, 6, true), None);
        // Beyond the lattice there is no ray, and for a missing direction there are none at all.
        assert_eq!(edge_crossing(&[], IVec3::ZERO, 0, true), None);
        let spans = [spans(Layers::of_one_ray(&span), &Operands::new([9]), &Expression::Operand(0))];
        assert_eq!(edge_crossing(&spans, IVec3::new(2, 1, 0), 0, false), None);
    }

    #[test]
    fn a_crossing_on_a_voxel_lies_on_the_edge_that_changes_there() {
        // Voxel 4 on the exit is inside, voxel 2 on the entry outside.
        let span = [(2.0, 0, true), (4.0, 1, false)];
        assert_eq!(crossing(&span, 2, false), Some((0.0, 0)));
        assert_eq!(crossing(&span, 4, true), Some((0.0, 1)));
    }
}
