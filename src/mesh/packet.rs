//! Nearest points for many neighbouring points in one go: the box tree is walked once for eight of them
//! (Sanchez et al. 2015 §3, "packet sampling").

use glam::{DVec3, Vec3};
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

type Lane = [f32; LANES];

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
        let (min, max) = (glam::Vec3::from(node.aabb().min).to_array(), glam::Vec3::from(node.aabb().max).to_array());
        let mut sum = [0.0; LANES];
        for axis in 0..3 {
            for k in 0..LANES {
                let below = min[axis] - self.more[axis][k];
                let above = self.less[axis][k] - max[axis];
                let off = if below > above { below } else { above };
                let off = if off > 0.0 { off } else { 0.0 };
                sum[k] += off * off;
            }
        }
        sum.map(|square| square * (1.0 - SQUARE))
    }

    /// Squared distances to a triangle, off by rounding: the least of those to its sides and, over it, to its plane.
    #[inline(always)]
    fn to_triangle(&self, corners: &[Vec3; 3]) -> Lane {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let square = normal.length_squared();
        let mut least = [f32::INFINITY; LANES];
        let mut over = [square > 0.0; LANES];
        for k in 0..3 {
            let (from, side) = (corners[k], corners[(k + 1) % 3] - corners[k]);
            let inner = normal.cross(side);
            let length = side.length_squared();
            let part = if length > 0.0 { 1.0 / length } else { 0.0 };
            for lane in 0..LANES {
                let [x, y, z] = [self.at[0][lane] - from.x, self.at[1][lane] - from.y, self.at[2][lane] - from.z];
                let along = (x * side.x + y * side.y + z * side.z) * part;
                let along = if along > 0.0 { along } else { 0.0 };
                let along = if along < 1.0 { along } else { 1.0 };
                let [dx, dy, dz] = [x - side.x * along, y - side.y * along, z - side.z * along];
                let off = dx * dx + dy * dy + dz * dz;
                least[lane] = if off < least[lane] { off } else { least[lane] };
                over[lane] &= x * inner.x + y * inner.y + z * inner.z >= 0.0;
            }
        }
        let part = if square > 0.0 { 1.0 / square } else { 0.0 };
        for lane in 0..LANES {
            let [x, y, z] =
                [self.at[0][lane] - corners[0].x, self.at[1][lane] - corners[0].y, self.at[2][lane] - corners[0].z];
            let level = x * normal.x + y * normal.y + z * normal.z;
            let plane = level * level * part;
            let nearer = over[lane] & (plane < least[lane]);
            least[lane] = if nearer { plane } else { least[lane] };
        }
        least
    }

    /// Notes the square of a lane's best distance in the space of the boxes.
    #[inline(always)]
    fn note(&mut self, lane: usize, square: f64) {
        let square = square as f32 * (1.0 + SQUARE);
        self.best[lane] = square;
        self.doubted[lane] = (square.sqrt() + self.doubt[lane]).powi(2);
    }

    /// The least of the squares that are of interest.
    #[inline(always)]
    fn least(&self, squares: &Lane) -> Option<f32> {
        let mut least = f32::INFINITY;
        for (&square, &best) in squares.iter().zip(&self.best) {
            let counts = if square <= best { square } else { f32::INFINITY };
            least = if counts < least { counts } else { least };
        }
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
            if eight.best.iter().all(|&best| least > best) {
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
        let (none, zero) = ([[0.0; LANES]; 3], [0.0; LANES]);
        let mut eight = Eight { more: none, less: none, at: none, best: zero, doubted: zero, doubt: zero };
        for (k, target) in targets.iter().enumerate() {
            let p = ((*target - self.centre) * self.shrink).as_vec3();
            let margin = ROUNDING * p.abs().max_element().max(1.0);
            for axis in 0..3 {
                eight.more[axis][k] = p[axis] + margin;
                eight.less[axis][k] = p[axis] - margin;
                eight.at[axis][k] = p[axis];
            }
            eight.doubt[k] = DOUBT * margin;
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
            let id = self.tree.primitive_indices[place];
            for k in 0..LANES {
                if squares[k] <= eight.doubted[k] {
                    best[k].offer(id, self.shapes[id as usize].nearest(targets[k]), targets[k]);
                    eight.note(k, self.in_boxes(best[k].square));
                }
            }
        }
    }
}
