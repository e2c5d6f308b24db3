//! Which shells a point may lie in: a tree over their boxes.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;

use super::Shell;
use super::winding::reach;
use crate::mesh::{Bounds, MARGIN, margin, tree_over};

/// A tree over the boxes of shells; those of open ones reach as far as their winding numbers are worth counting.
pub(super) struct Boxes {
    tree: Bvh2,
    centre: DVec3,
    shrink: f64,
}

impl Boxes {
    pub(super) fn new(shells: &[Shell]) -> Self {
        let wide = |shell: &Shell| {
            let reach = if shell.balanced { 0.0 } else { reach(shell) };
            Bounds { min: shell.bounds.min - reach, max: shell.bounds.max + reach }
        };
        let all = shells.iter().map(wide).reduce(|a, b| a.union(&b));
        let (centre, half) =
            all.map_or((DVec3::ZERO, 0.0), |b| (b.min / 2.0 + b.max / 2.0, (b.size() / 2.0).max_element()));
        let shrink = if half > 0.0 { 1.0 / half } else { 1.0 };
        let mut boxes = Self { tree: Bvh2::default(), centre, shrink };
        let list: Vec<Aabb> = shells
            .iter()
            .enumerate()
            .map(|(n, shell)| {
                let margin = margin(n);
                let Bounds { min, max } = wide(shell);
                Aabb::new(boxes.single(min, -margin), boxes.single(max, margin))
            })
            .collect();
        boxes.tree = tree_over(&list);
        boxes
    }

    fn single(&self, p: DVec3, margin: f64) -> Vec3A {
        Vec3A::from(((p - self.centre) * self.shrink + margin).as_vec3())
    }

    /// The shells whose boxes hold `p`, ascending, and perhaps a few more.
    pub(super) fn around(&self, p: DVec3) -> Vec<usize> {
        let mut found = Vec::new();
        self.tree.aabb_traverse(Aabb::new(self.single(p, -MARGIN), self.single(p, MARGIN)), |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            let leaf = &tree.primitive_indices[first..first + node.prim_count as usize];
            found.extend(leaf.iter().map(|&n| n as usize));
            true
        });
        found.sort_unstable();
        found
    }
}
