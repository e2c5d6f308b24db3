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
