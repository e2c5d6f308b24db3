//! Nearest points for many neighbouring points in one go: the box tree is walked once for eight of them
//! (Sanchez et al. 2015 §3, "packet sampling").

use glam::{DVec3, Vec3, Vec4};
use obvhs::bvh2::node::Bvh2Node;

use super::Closest;
use super::closest::{Best, ClosestTree};
use super::nearest_point::Shape;

/// Points that walk the tree together.
const LANES: usize = 8;
/// A point in single precision is off by less than this times 1 or, farther out, its largest coordinate.
const ROUNDING: f32 = 1.3e-7;
/// Distances in single precision to what is measured in it are off by less than this times the rounding of a point.
const DOUBT: f32 = 16.0;
/// Squares in single precision are off by less than this part.
const SQUARE: f32 = 1e-6;
/// Growth of the first guess over the distance to a point of the surface, so that rounding excludes nothing.
const GUESS: f64 = 1.0 + 1e-9;

/// A number for each of eight points, in two quads: written out as such, because loops over eight stay scalar.
type Lane = [Vec4; 2];

const ZERO: Lane = [Vec4::ZERO; 2];

/// Eight points in the space of the boxes.
struct Eight {
    /// Coordinates with the rounding added, and taken away.
    more: [Lane; 3],
    less: [Lane; 3],
    /// Coordinates as they are.
    at: [Lane; 3],
    /// Squared distances above which nothing is of interest, and the same for shapes measured in single precision.
    best: Lane,
    doubted: Lane,
    /// How far off such a measurement may be.
    doubt: Lane,
}

impl Eight {
    /// Lower bounds of the squared distances to a box.
    #[inline(always)]
    fn squares(&self, node: &Bvh2Node) -> Lane {
        let (min, max) = (node.aabb().min, node.aabb().max);
        let half = |half: usize| {
            let off = |axis: usize, min: f32, max: f32| {
                let below = Vec4::splat(min) - self.more[axis][half];
                let above = self.less[axis][half] - Vec4::splat(max);
                let off = below.max(above).max(Vec4::ZERO);
                off * off
            };
            (off(0, min.x, max.x) + off(1, min.y, max.y) + off(2, min.z, max.z)) * (1.0 - SQUARE)
        };
        [half(0), half(1)]
    }

    /// Squared distances to a triangle, off by rounding: the least of those to its sides and, over it, to its plane.
    #[inline(always)]
    fn to_triangle(&self, corners: &[Vec3; 3]) -> Lane {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let square = normal.length_squared();
        let part = if square > f32::MIN_POSITIVE { 1.0 / square } else { 0.0 };
        [self.half_to_triangle(0, corners, normal, part), self.half_to_triangle(1, corners, normal, part)]
    }

    /// The same for four of the points; `part` is 1 over the square of `normal`, or 0 where there is none.
    #[inline(always)]
    fn half_to_triangle(&self, half: usize, corners: &[Vec3; 3], normal: Vec3, part: f32) -> Vec4 {
        let from = |corner: Vec3| [0, 1, 2].map(|axis| self.at[axis][half] - Vec4::splat(corner[axis]));
        let dot = |[x, y, z]: [Vec4; 3], v: Vec3| x * v.x + y * v.y + z * v.z;
        let level = dot(from(corners[0]), normal);
        let plane = level * level * part;
        let mut sides = Vec4::INFINITY;
        let mut inner = Vec4::splat(if part > 0.0 { f32::INFINITY } else { -1.0 });
        for k in 0..3 {
            let (own, side) = (from(corners[k]), corners[(k + 1) % 3] - corners[k]);
            let length = side.length_squared();
            let along = dot(own, side) * if length > 0.0 { 1.0 / length } else { 0.0 };
            let along = along.max(Vec4::ZERO).min(Vec4::ONE);
            let [x, y, z] = [own[0] - along * side.x, own[1] - along * side.y, own[2] - along * side.z];
            sides = sides.min(x * x + y * y + z * z);
            inner = inner.min(dot(own, normal.cross(side)));
        }
        Vec4::select(inner.cmpge(Vec4::ZERO), plane.min(sides), sides)
    }

    /// Notes the square of a lane's best distance in the space of the boxes.
    #[inline(always)]
    fn note(&mut self, lane: usize, square: f64) {
        let square = square as f32 * (1.0 + SQUARE);
        let (half, lane) = (lane / 4, lane % 4);
        self.best[half][lane] = square;
        self.doubted[half][lane] = (square.sqrt() + self.doubt[half][lane]).powi(2);
    }

    /// The least of the squares that are of interest.
    #[inline(always)]
    fn least(&self, squares: &Lane) -> Option<f32> {
        let counting = |half: usize| Vec4::select(squares[half].cmple(self.best[half]), squares[half], Vec4::INFINITY);
        let least = counting(0).min(counting(1)).min_element();
        (least < f32::INFINITY).then_some(least)
    }
}

/// Room for one walk, to be used again.
#[derive(Default)]
pub(crate) struct Walk {
    stack: Vec<(f32, u32)>,
}

impl<S: Shape> ClosestTree<S> {
    /// The nearest point for each of `points` (model units), in their order: what [`Self::nearest`] says of each. It is
    /// fast where points that follow each other are near each other; `found` is emptied first.
    pub fn nearest_all(&self, points: &[DVec3], found: &mut Vec<Closest>) {
        found.clear();
        let mut walk = Walk::default();
        for eight in points.chunks(LANES) {
            self.nearest_eight(eight, &mut walk, found);
        }
    }

    /// Up to eight points; the last of `found` is where to begin.
    fn nearest_eight(&self, points: &[DVec3], walk: &mut Walk, found: &mut Vec<Closest>) {
        if self.is_empty() {
            return;
        }
        let targets: [DVec3; LANES] = std::array::from_fn(|k| *points.get(k).unwrap_or(&points[0]) * self.scale);
        // Nothing can be farther than what was nearest to the points before.
        let guess = found.last().map(|last| last.point * self.scale);
        let limit = |target: DVec3| guess.map_or(f64::INFINITY, |guess| target.distance_squared(guess) * GUESS);
        let mut best = targets.map(|target| Best::within(limit(target)));
        let mut eight = self.eight(&targets, &best);
        walk.stack.clear();
        walk.stack.push((0.0, 0));
        while let Some((least, index)) = walk.stack.pop() {
            if least > eight.best[0].max(eight.best[1]).max_element() {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            if node.is_leaf() {
                self.look(node, &targets, &mut best, &mut eight);
            } else {
                self.descend(node, &eight, walk);
            }
        }
        for (k, &p) in points.iter().enumerate() {
            // A guess always finds itself again; should rounding forbid it, the slow way is right.
            found.extend(best[k].closest(self.scale).or_else(|| self.nearest(p)));
        }
    }

    fn eight(&self, targets: &[DVec3; LANES], best: &[Best; LANES]) -> Eight {
        let none = [ZERO; 3];
        let mut eight = Eight { more: none, less: none, at: none, best: ZERO, doubted: ZERO, doubt: ZERO };
        for (k, target) in targets.iter().enumerate() {
            let p = ((*target - self.centre) * self.shrink).as_vec3();
            let margin = ROUNDING * p.abs().max_element().max(1.0);
            let (half, lane) = (k / 4, k % 4);
            for axis in 0..3 {
                eight.more[axis][half][lane] = p[axis] + margin;
                eight.less[axis][half][lane] = p[axis] - margin;
                eight.at[axis][half][lane] = p[axis];
            }
            eight.doubt[half][lane] = DOUBT * margin;
            eight.note(k, self.in_boxes(best[k].square));
        }
        eight
    }

    /// A squared distance in the space of the boxes.
    #[inline]
    fn in_boxes(&self, square: f64) -> f64 {
        square * self.shrink * self.shrink
    }

    /// Puts the children of `node` on the stack, so that the nearer one comes off first.
    #[inline]
    fn descend(&self, node: &Bvh2Node, eight: &Eight, walk: &mut Walk) {
        let child = |index: u32| {
            let squares = eight.squares(&self.tree.nodes[index as usize]);
            eight.least(&squares).map(|least| (least, index))
        };
        match [child(node.first_index), child(node.first_index + 1)] {
            [Some(left), Some(right)] => {
                walk.stack.extend(if left.0 <= right.0 { [right, left] } else { [left, right] });
            }
            [one, other] => walk.stack.extend(one.or(other)),
        }
    }

    /// Offers the shapes of a leaf to the points whose best may be farther.
    #[inline]
    fn look(&self, node: &Bvh2Node, targets: &[DVec3; LANES], best: &mut [Best; LANES], eight: &mut Eight) {
        for place in node.first_index as usize..(node.first_index + node.prim_count) as usize {
            let squares = eight.to_triangle(&self.singles[place]);
            let near = |half: usize| squares[half].cmple(eight.doubted[half]).bitmask();
            let mut near = near(0) | near(1) << 4;
            let id = self.tree.primitive_indices[place];
            while near != 0 {
                let k = near.trailing_zeros() as usize;
                near &= near - 1;
                best[k].offer(id, self.shapes[id as usize].nearest(targets[k]), targets[k]);
                eight.note(k, self.in_boxes(best[k].square));
            }
        }
    }
}
