//! The nearest of many triangles or segments: a tree of boxes in single precision that decides only
//! what need not be looked at, and distances in double precision.

use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::PlocBuilder;

use super::nearest_point::{Feature, Shape};
use super::{Bounds, TriMesh};

/// By so much at least boxes are larger than what they hold, in the space where all of them together lie
/// within −1 to 1: more than rounding to single precision moves a coordinate there.
pub(crate) const MARGIN: f64 = 1.5e-7;

/// The margin of box number `k`. Shapes at the same place get different boxes: building a tree of equal ones takes time by the square of their
/// number.
pub(crate) fn margin(k: usize) -> f64 {
    MARGIN * (1.0 + 15.0 * (k as f64 * 0.618_033_988_749_894_9).fract())
}

/// A box is passed over only when it is farther than the best find by more than rounding explains.
const SLACK: f64 = 1.0 - 1e-12;

/// The nearest point of a [`ClosestTree`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Number of the shape in the list that the tree was made of.
    pub id: u32,
    /// The nearest point itself, model units.
    pub point: DVec3,
    /// The distance of that point, model units.
    pub distance: f64,
    /// Where on the shape it lies.
    pub feature: Feature,
}

/// Triangles (`[DVec3; 3]`) or segments (`[DVec3; 2]`), searched by nearness. The answer does not
/// depend on how the tree was built: of several shapes at exactly the same distance, the one with
/// the smallest number is it.
pub struct ClosestTree<S> {
    /// The shapes times `scale`.
    pub(super) shapes: Vec<S>,
    pub(super) tree: Bvh2,
    /// The shapes in the space of the boxes, in the order of the tree's leaves, for packets.
    pub(super) singles: Vec<[Vec3; 3]>,
    /// A power of two that brings coordinates so near to 1 that squares neither overflow nor vanish.
    pub(super) scale: f64,
    /// Centre of all shapes, times `scale`.
    pub(super) centre: DVec3,
    /// From there to the space of the boxes.
    pub(super) shrink: f64,
}

impl ClosestTree<[DVec3; 3]> {
    /// The tree over all triangles of `mesh`, by their ids.
    pub fn of_mesh(mesh: &TriMesh) -> Self {
        Self::new((0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect())
    }
}

impl<S: Shape> ClosestTree<S> {
    /// The tree over `shapes`; their coordinates are finite.
    pub fn new(mut shapes: Vec<S>) -> Self {
        let around = |shapes: &[S]| shapes.iter().map(Shape::bounds).reduce(|a, b| a.union(&b));
        let scale = around(&shapes).map_or(1.0, |b| power_of_two(&b));
        shapes.iter_mut().for_each(|shape| *shape = shape.scaled(scale));
        let (centre, half) =
            around(&shapes).map_or((DVec3::ZERO, 0.0), |b| ((b.min + b.max) / 2.0, (b.size() / 2.0).max_element()));
        let shrink = if half > 0.0 { 1.0 / half } else { 1.0 };
        let single = |p: DVec3, margin: f64| Vec3A::from(((p - centre) * shrink + margin).as_vec3());
        let boxes: Vec<Aabb> = shapes
            .iter()
            .enumerate()
            .map(|(k, shape)| {
                let margin = margin(k);
                let b = shape.bounds();
                Aabb::new(single(b.min, -margin), single(b.max, margin))
            })
            .collect();
        let tree = tree_over(&boxes);
        let singles = tree.primitive_indices.iter().map(|&id| shapes[id as usize].single(centre, shrink)).collect();
        Self { tree, singles, shapes, scale, centre, shrink }
    }

    /// The box around all shapes, model units.
    pub fn bounds(&self) -> Option<Bounds> {
        let all = self.shapes.iter().map(Shape::bounds).reduce(|a, b| a.union(&b))?;
        Some(Bounds { min: all.min / self.scale, max: all.max / self.scale })
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether the tree has no shapes.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The point nearest to `p` (model units); `None` for an empty tree.
    pub fn nearest(&self, p: DVec3) -> Option<Closest> {
        self.nearest_within(p, f64::INFINITY)
    }

    /// The point nearest to `p`, if one is not farther than `limit`; both in model units.
    pub fn nearest_within(&self, p: DVec3, limit: f64) -> Option<Closest> {
        let target = p * self.scale;
        let mut best = Best::within((limit * self.scale).powi(2));
        let mut stack: Vec<(f64, u32)> = Vec::with_capacity(64);
        if let Some(square) = self.square_to(0, target) {
            stack.push((square, 0));
        }
        while let Some((square, index)) = stack.pop() {
            if square * SLACK > best.square {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            if node.is_leaf() {
                let ids = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                for &id in &self.tree.primitive_indices[ids] {
                    best.offer(id, self.shapes[id as usize].nearest(target), target);
                }
                continue;
            }
            let child = |index| self.square_to(index, target).map(|square| (square, index));
            let children = [child(node.first_index), child(node.first_index + 1)];
            if let [Some(left), Some(right)] = children {
                // The nearer one comes off the stack first.
                stack.extend(if left.0 <= right.0 { [right, left] } else { [left, right] });
            }
        }
        best.closest(self.scale)
    }

    /// A lower bound of the squared distance from `target` to what a node holds, both times `scale`.
    fn square_to(&self, node: u32, target: DVec3) -> Option<f64> {
        let aabb = self.tree.nodes.get(node as usize)?.aabb();
        let p = (target - self.centre) * self.shrink;
        let (min, max) = (glam::Vec3::from(aabb.min).as_dvec3(), glam::Vec3::from(aabb.max).as_dvec3());
        let off = ((min - p).max(p - max).max(DVec3::ZERO)) / self.shrink;
        Some(off.length_squared())
    }
}

/// The best find of a search.
pub(super) struct Best {
    /// Of its distance, times the scale of the tree.
    pub(super) square: f64,
    found: Option<(u32, DVec3, Feature)>,
}

impl Best {
    /// Nothing yet, and nothing farther than the root of `square` will be.
    pub(super) fn within(square: f64) -> Self {
        Self { square, found: None }
    }

    /// What was found, model units.
    pub(super) fn closest(&self, scale: f64) -> Option<Closest> {
        let distance = self.square.sqrt() / scale;
        self.found.map(|(id, point, feature)| Closest { id, point: point / scale, distance, feature })
    }

    #[inline]
    pub(super) fn offer(&mut self, id: u32, (point, feature): (DVec3, Feature), target: DVec3) {
        let square = point.distance_squared(target);
        let first_of_equal = square == self.square && self.found.is_none_or(|(held, ..)| id < held);
        if square < self.square || first_of_equal {
            *self = Self { square, found: Some((id, point, feature)) };
        }
    }
}

/// The power of two that brings the larger of size and (so that scaled coordinates stay finite)
/// rounding of coordinates to about 1; capped where points far outside would overflow.
fn power_of_two(bounds: &Bounds) -> f64 {
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let size = (bounds.max / 2.0 - bounds.min / 2.0).max_element().max(farthest * f64::EPSILON);
    if size > 0.0 && size.is_finite() {
        let exponent = ((size.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        2f64.powi((-exponent).clamp(-1000, 300))
    } else {
        1.0
    }
}

/// A tree over boxes, quickly built.
pub(crate) fn tree_over(boxes: &[Aabb]) -> Bvh2 {
    let params = BvhBuildParams::fast_build();
    PlocBuilder::with_capacity(boxes.len()).build(
        params.ploc_search_distance,
        boxes,
        (0..boxes.len() as u32).collect(),
        params.sort_precision,
        params.search_depth_threshold,
    )
}
