//! Sparse symmetric systems of equations, solved by Cholesky's method within an envelope.
//!
//! The unknowns are numbered by the rule of Cuthill and McKee, backwards, so that the numbers of neighbours differ little; then each row of the factor starts where the
//! row of the matrix starts, and is dense from there on. For the two thousand unknowns of a lid rows are about a hundred long.

use std::collections::VecDeque;

/// Which unknown comes when.
#[derive(Debug)]
pub(super) struct Order {
    /// The place of each unknown.
    place: Vec<u32>,
}

impl Order {
    /// An order for unknowns with these neighbours.
    pub(super) fn new(neighbours: &[Vec<u32>]) -> Self {
        let count = neighbours.len();
        let mut order: Vec<u32> = Vec::with_capacity(count);
        let mut seen = vec![false; count];
        for start in 0..count as u32 {
            if seen[start as usize] {
                continue;
            }
            // The last of a walk lies at an edge of the set, and the last of a walk from there at the other edge.
            let far = |from: u32| walk(neighbours, from, &mut seen.clone()).last().copied().unwrap_or(from);
            let start = far(far(start));
            order.extend(walk(neighbours, start, &mut seen));
        }
        let mut place = vec![0; count];
        for (at, &v) in order.iter().rev().enumerate() {
            place[v as usize] = at as u32;
        }
        Self { place }
    }
}

/// The unknowns in the order of their distance from one, those with few neighbours first.
fn walk(neighbours: &[Vec<u32>], start: u32, seen: &mut [bool]) -> Vec<u32> {
    let mut found = Vec::new();
    let mut queue = VecDeque::from([start]);
    seen[start as usize] = true;
    while let Some(v) = queue.pop_front() {
        found.push(v);
        let mut next: Vec<u32> = neighbours[v as usize].iter().copied().filter(|&w| !seen[w as usize]).collect();
        next.sort_unstable_by_key(|&w| (neighbours[w as usize].len(), w));
        for w in next {
            if !std::mem::replace(&mut seen[w as usize], true) {
                queue.push_back(w);
            }
        }
    }
    found
}

/// The factor of a positive definite matrix.
#[derive(Debug)]
pub(super) struct Factor<'a> {
    order: &'a Order,
    /// The first column of each row, in the order.
    first: Vec<usize>,
    /// The rows one after another, each up to its diagonal.
    starts: Vec<usize>,
    values: Vec<f64>,
}

impl<'a> Factor<'a> {
    /// The factor of the matrix that is the sum of the entries (row, column, value); those above the diagonal are those below, and one of both is given. `None` where the
    /// matrix is not positive definite.
    pub(super) fn new(order: &'a Order, entries: &[(u32, u32, f64)]) -> Option<Self> {
        let count = order.place.len();
        let place = |a: u32, b: u32| {
            let (a, b) = (order.place[a as usize] as usize, order.place[b as usize] as usize);
            (a.max(b), a.min(b))
        };
        let mut first: Vec<usize> = (0..count).collect();
        for &(a, b, _) in entries {
            let (row, column) = place(a, b);
            first[row] = first[row].min(column);
        }
        let mut starts = vec![0; count + 1];
        (0..count).for_each(|row| starts[row + 1] = starts[row] + row - first[row] + 1);
        let mut values = vec![0.0; starts[count]];
        for &(a, b, value) in entries {
            let (row, column) = place(a, b);
            values[starts[row] + column - first[row]] += value;
        }
        let mut factor = Self { order, first, starts, values };
        (0..count).all(|row| factor.eliminate(row)).then_some(factor)
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.values[self.starts[row]..self.starts[row + 1]]
    }

    /// Makes a row of the matrix that of the factor; false where its pivot is not positive.
    fn eliminate(&mut self, row: usize) -> bool {
        let first = self.first[row];
        let (above, mine) = self.values.split_at_mut(self.starts[row]);
        for column in first..row {
            let from = first.max(self.first[column]);
            let theirs = &above[self.starts[column] + from - self.first[column]..self.starts[column + 1]];
            let length = column - from;
            let sum = dot(&mine[from - first..][..length], &theirs[..length]);
            mine[column - first] = (mine[column - first] - sum) / theirs[length];
        }
        let length = row - first;
        let pivot = mine[length] - dot(&mine[..length], &mine[..length]);
        let positive = pivot > 1e-14 * mine[length].abs() && pivot.is_finite();
        mine[length] = pivot.sqrt();
        positive
    }

    /// The solution for one right side.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let count = right.len();
        let mut x = vec![0.0; count];
        for (v, &value) in right.iter().enumerate() {
            x[self.order.place[v] as usize] = value;
        }
        for row in 0..count {
            let (values, first) = (self.row(row), self.first[row]);
            let length = row - first;
            x[row] = (x[row] - dot(&values[..length], &x[first..row])) / values[length];
        }
        for row in (0..count).rev() {
            let (values, first) = (self.row(row), self.first[row]);
            let length = row - first;
            x[row] /= values[length];
            let solved = x[row];
            x[first..row].iter_mut().zip(values).for_each(|(x, value)| *x -= value * solved);
        }
        self.order.place.iter().map(|&at| x[at as usize]).collect()
    }
}

/// The scalar product, in four sums so that it can be done four at a time.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(x, y)| x * y).sum();
    let mut sums = [0.0; 4];
    for (x, y) in a.zip(b) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    sums[0] + sums[1] + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_springs_is_solved() {
        let neighbours: Vec<Vec<u32>> =
            (0..50u32).map(|v| [v.wrapping_sub(7), v + 7, v ^ 1].into_iter().filter(|&w| w < 50).collect()).collect();
        let order = Order::new(&neighbours);
        let mut entries = Vec::new();
        for (v, near) in neighbours.iter().enumerate() {
            entries.push((v as u32, v as u32, 5.0));
            entries.extend(near.iter().filter(|&&w| w > v as u32).map(|&w| (v as u32, w, -1.25)));
        }
        let truth: Vec<f64> = (0..50).map(|v| f64::from(v * v % 17)).collect();
        let mut right = vec![0.0; 50];
        for &(a, b, value) in &entries {
            right[a as usize] += value * truth[b as usize];
            if a != b {
                right[b as usize] += value * truth[a as usize];
            }
        }
        let found = Factor::new(&order, &entries).expect("it is positive definite").solve(&right);
        assert!(found.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        entries.push((3, 3, -6.0));
        assert!(Factor::new(&order, &entries).is_none());
    }
}
