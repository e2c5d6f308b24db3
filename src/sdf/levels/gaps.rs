//! Which end of a slice contour belongs to which beginning.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use glam::DVec2;

/// Pairs every end with a beginning, by their numbers: of all pairs that are left the nearest is taken, again and again;
/// at the same distance the one with the lower numbers. What one list has more than the other stays alone.
pub(super) fn pairs(ends: &[DVec2], beginnings: &[DVec2]) -> Vec<(usize, usize)> {
    let mut free = Free::new(beginnings);
    let mut taken = vec![false; beginnings.len()];
    let found = |n: usize, free: &Free<'_>| free.nearest(ends[n]).map(|near| Reverse((near, n)));
    let mut candidates: BinaryHeap<Reverse<(Near, usize)>> = (0..ends.len()).filter_map(|n| found(n, &free)).collect();
    let mut pairs = Vec::new();
    while let Some(Reverse((near, n))) = candidates.pop() {
        if std::mem::replace(&mut taken[near.number], true) {
            candidates.extend(found(n, &free));
        } else {
            free.remove(near.place);
            pairs.push((n, near.number));
        }
    }
    pairs
}

/// A beginning as an end sees it; the nearer is less.
#[derive(Debug, Clone, Copy)]
struct Near {
    square: f64,
    number: usize,
    /// Its place in the order of the tree.
    place: usize,
}

impl Ord for Near {
    fn cmp(&self, other: &Self) -> Ordering {
        self.square.total_cmp(&other.square).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Near {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Near {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Near {}

/// The beginnings that are not taken, as a tree: the middle of a range halves it, along x and y in turn.
struct Free<'a> {
    points: &'a [DVec2],
    order: Vec<usize>,
    /// For the range whose middle is here: how many of it are free.
    count: Vec<u32>,
    is_free: Vec<bool>,
}

impl<'a> Free<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        let mut count = vec![0; points.len()];
        sort(points, &mut order, &mut count, 0);
        Self { points, order, count, is_free: vec![true; points.len()] }
    }

    fn nearest(&self, p: DVec2) -> Option<Near> {
        let mut best = None;
        self.search(p, 0..self.order.len(), 0, &mut best);
        best
    }

    fn search(&self, p: DVec2, range: std::ops::Range<usize>, axis: usize, best: &mut Option<Near>) {
        let place = (range.start + range.end) / 2;
        if range.is_empty() || self.count[place] == 0 {
            return;
        }
        let number = self.order[place];
        let q = self.points[number];
        let near = Near { square: p.distance_squared(q), number, place };
        if self.is_free[place] && best.is_none_or(|best| near < best) {
            *best = Some(near);
        }
        let off = p[axis] - q[axis];
        let (low, high) = (range.start..place, place + 1..range.end);
        let (nearer, farther) = if off < 0.0 { (low, high) } else { (high, low) };
        self.search(p, nearer, 1 - axis, best);
        if best.is_none_or(|best| off * off <= best.square) {
            self.search(p, farther, 1 - axis, best);
        }
    }

    fn remove(&mut self, place: usize) {
        self.is_free[place] = false;
        let mut range = 0..self.order.len();
        loop {
            let middle = (range.start + range.end) / 2;
            self.count[middle] -= 1;
            match place.cmp(&middle) {
                Ordering::Less => range.end = middle,
                Ordering::Greater => range.start = middle + 1,
                Ordering::Equal => return,
            }
        }
    }
}

fn sort(points: &[DVec2], order: &mut [usize], count: &mut [u32], axis: usize) {
    if order.is_empty() {
        return;
    }
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| points[a][axis].total_cmp(&points[b][axis]).then(a.cmp(&b)));
    count[middle] = order.len() as u32;
    let (low, high) = order.split_at_mut(middle);
    let (low_count, high_count) = count.split_at_mut(middle);
    sort(points, low, low_count, 1 - axis);
    sort(points, &mut high[1..], &mut high_count[1..], 1 - axis);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same by looking at all pairs.
    fn by_looking(ends: &[DVec2], beginnings: &[DVec2]) -> Vec<(usize, usize)> {
        let number = (0..ends.len()).flat_map(|n| (0..beginnings.len()).map(move |m| (n, m)));
        let mut all: Vec<(usize, usize)> = number.collect();
        let square = |&(n, m): &(usize, usize)| ends[n].distance_squared(beginnings[m]);
        all.sort_by(|a, b| square(a).total_cmp(&square(b)).then(a.1.cmp(&b.1)).then(a.0.cmp(&b.0)));
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (n, m) in all {
            if pairs.iter().all(|&(k, l)| k != n && l != m) {
                pairs.push((n, m));
            }
        }
        pairs
    }

    /// Few places, so that many are at the same distance.
    fn points() -> impl Strategy<Value = Vec<DVec2>> {
        prop::collection::vec((0..12_i32, 0..12_i32).prop_map(|(x, y)| DVec2::new(x.into(), y.into()) / 3.0), 0..40)
    }

    proptest! {
        #[test]
        fn the_nearest_pairs_come_first(ends in points(), beginnings in points()) {
            prop_assert_eq!(pairs(&ends, &beginnings), by_looking(&ends, &beginnings));
        }
    }
}
