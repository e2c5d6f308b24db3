//! Polygons of the plane cut into triangles, exactly.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use crate::mesh::predicates::side_of_line;

/// Whether no two edges of a closed polygon meet but where one ends and the next starts. Exact.
pub(super) fn is_simple(points: &[DVec2]) -> bool {
    let count = points.len();
    let edge = |k: usize| [points[k], points[(k + 1) % count]];
    let size = points.iter().fold([DVec2::MAX, DVec2::MIN], |[low, high], &p| [low.min(p), high.max(p)]);
    let axis = usize::from(size[1].x - size[0].x < size[1].y - size[0].y);
    let range = |k: usize| {
        let [a, b] = edge(k);
        [a[axis].min(b[axis]), a[axis].max(b[axis])]
    };
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| range(a)[0].total_cmp(&range(b)[0]).then(a.cmp(&b)));
    let mut active: Vec<usize> = Vec::new();
    for k in order {
        let start = range(k)[0];
        active.retain(|&other| range(other)[1] >= start);
        if active.iter().any(|&other| meet(points, k, other)) {
            return false;
        }
        active.push(k);
    }
    true
}

/// Whether two edges of a polygon meet in more than the point where one follows the other.
fn meet(points: &[DVec2], k: usize, other: usize) -> bool {
    let count = points.len();
    if (other + 1) % count == k {
        return meet(points, other, k);
    }
    let [a, b] = [points[k], points[(k + 1) % count]];
    let [c, d] = [points[other], points[(other + 1) % count]];
    if (k + 1) % count == other {
        return a == b || c == d || (side_of_line(a, b, d) == 0.0 && (a - b).dot(d - b) > 0.0);
    }
    if a.min(b).cmpgt(c.max(d)).any() || c.min(d).cmpgt(a.max(b)).any() {
        return false;
    }
    let [c_side, d_side] = [side_of_line(a, b, c), side_of_line(a, b, d)];
    let [a_side, b_side] = [side_of_line(c, d, a), side_of_line(c, d, b)];
    // On one line they meet, since their boxes do.
    let apart = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    !apart(c_side, d_side) && !apart(a_side, b_side)
}

/// The triangles of a polygon that runs counter-clockwise and does not cross itself; `None` where no ear is left. Points may be there twice, as at the ends of a bridge between
/// what is around and a hole. Ears with the shortest chords go first. A triangle has no
/// area only where nothing but points on one line was left.
pub(super) fn clip_ears(points: &[DVec2]) -> Option<Vec<[u32; 3]>> {
    let mut ears = Ears::new(points);
    let mut triangles = Vec::with_capacity(points.len() - 2);
    let mut left = points.len();
    let mut stuck = 0;
    while left > 3 {
        let Some(Reverse((_, ear, stamp))) = ears.heap.pop() else {
            stuck += 1;
            ears.refill(stuck)?;
            continue;
        };
        if ears.stamp[ear as usize] != stamp || !ears.is_ear(ear, stuck > 1) {
            continue;
        }
        stuck = 0;
        triangles.push(ears.cut(ear));
        left -= 1;
    }
    let last = ears.live.iter().position(|&live| live)? as u32;
    triangles.push([ears.before[last as usize], last, ears.after[last as usize]]);
    Some(triangles)
}

/// A polygon while ears are cut off.
struct Ears<'a> {
    points: &'a [DVec2],
    before: Vec<u32>,
    after: Vec<u32>,
    live: Vec<bool>,
    /// Grows whenever a neighbour changes, so that what the heap says of a vertex grows old.
    stamp: Vec<u32>,
    /// Square of the chord's length (as bits), vertex, stamp.
    heap: BinaryHeap<Reverse<(u64, u32, u32)>>,
    grid: Grid,
}

impl<'a> Ears<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let count = points.len() as u32;
        let mut ears = Self {
            points,
            before: (0..count).map(|v| (v + count - 1) % count).collect(),
            after: (0..count).map(|v| (v + 1) % count).collect(),
            live: vec![true; points.len()],
            stamp: vec![0; points.len()],
            heap: BinaryHeap::new(),
            grid: Grid::default(),
        };
        let reflex: Vec<u32> = (0..count).filter(|&v| ears.turn(v) <= 0.0).collect();
        ears.grid = Grid::new(points, &reflex);
        (0..count).for_each(|v| ears.offer(v));
        ears
    }

    fn corners(&self, v: u32) -> [DVec2; 3] {
        [self.before[v as usize], v, self.after[v as usize]].map(|v| self.points[v as usize])
    }

    fn turn(&self, v: u32) -> f64 {
        let [a, b, c] = self.corners(v);
        side_of_line(a, b, c)
    }

    fn offer(&mut self, v: u32) {
        let [a, _, c] = self.corners(v);
        self.heap.push(Reverse((a.distance_squared(c).to_bits(), v, self.stamp[v as usize])));
    }

    /// Offers all that is left again; `None` if that has been done twice in vain.
    fn refill(&mut self, stuck: usize) -> Option<()> {
        let left: Vec<u32> = (0..self.points.len() as u32).filter(|&v| self.live[v as usize]).collect();
        left.into_iter().for_each(|v| self.offer(v));
        (stuck < 3).then_some(())
    }

    /// Whether the triangle at a vertex lies inside; with `flat` also one without an area.
    fn is_ear(&self, v: u32, flat: bool) -> bool {
        let [a, b, c] = self.corners(v);
        let turn = side_of_line(a, b, c);
        if turn < 0.0 || (turn == 0.0 && !(flat && (a - b).dot(c - b) < 0.0)) {
            return false;
        }
        let mine = [self.before[v as usize], v, self.after[v as usize]];
        let blocks = |p: u32| {
            let at = self.points[p as usize];
            self.live[p as usize]
                && !mine.contains(&p)
                && ![a, b, c].contains(&at)
                && side_of_line(a, b, at) >= 0.0
                && side_of_line(b, c, at) >= 0.0
                && side_of_line(c, a, at) >= 0.0
                && self.turn(p) <= 0.0
        };
        turn == 0.0 || !self.grid.any(a.min(b).min(c), a.max(b).max(c), blocks)
    }

    fn cut(&mut self, v: u32) -> [u32; 3] {
        let (before, after) = (self.before[v as usize], self.after[v as usize]);
        self.live[v as usize] = false;
        self.after[before as usize] = after;
        self.before[after as usize] = before;
        for v in [before, after] {
            self.stamp[v as usize] += 1;
            self.offer(v);
        }
        [before, v, after]
    }
}

/// Points in the cells of a grid.
#[derive(Default)]
struct Grid {
    low: DVec2,
    cell: DVec2,
    size: [usize; 2],
    starts: Vec<u32>,
    points: Vec<u32>,
}

impl Grid {
    fn new(all: &[DVec2], chosen: &[u32]) -> Self {
        let [low, high] = all.iter().fold([DVec2::MAX, DVec2::MIN], |[low, high], &p| [low.min(p), high.max(p)]);
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let cells = chosen.len().max(1) as f64;
        let across = (cells * extent.x / extent.y).sqrt().clamp(1.0, cells);
        let size = [across.ceil() as usize, (cells / across).ceil() as usize];
        let cell = extent / DVec2::new(size[0] as f64, size[1] as f64);
        let mut grid = Self { low, cell, size, starts: vec![0; size[0] * size[1] + 1], points: Vec::new() };
        let mut sorted: Vec<(usize, u32)> = chosen.iter().map(|&v| (grid.index(all[v as usize]), v)).collect();
        sorted.sort_unstable();
        sorted.iter().for_each(|&(cell, _)| grid.starts[cell + 1] += 1);
        (0..size[0] * size[1]).for_each(|k| grid.starts[k + 1] += grid.starts[k]);
        grid.points = sorted.into_iter().map(|(_, v)| v).collect();
        grid
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) / self.cell;
        [(at.x as usize).min(self.size[0] - 1), (at.y as usize).min(self.size[1] - 1)]
    }

    fn index(&self, p: DVec2) -> usize {
        let [x, y] = self.cell(p);
        y * self.size[0] + x
    }

    /// Whether any point in the cells that a box touches fulfils a condition.
    fn any(&self, low: DVec2, high: DVec2, condition: impl Fn(u32) -> bool) -> bool {
        let ([x0, y0], [x1, y1]) = (self.cell(low), self.cell(high));
        (y0..=y1).any(|y| {
            let row = y * self.size[0];
            let range = self.starts[row + x0] as usize..self.starts[row + x1 + 1] as usize;
            self.points[range].iter().any(|&p| condition(p))
        })
    }
}
