//! Smoothing of the voted volume against the estimates (Bærentzen §3.3).

use rayon::prelude::*;

use super::neighbours::Adjacency;
use super::{RobustOptions, Trust};
use crate::lattice::Grid;
use crate::progress::{Progress, Stopped};
use crate::vote::Votes;

/// The value of voxels that are known to be inside (negative) or outside only, in h: the longest
/// distance within a cell.
pub const FAR: f32 = 1.732_050_8;
/// A voxel that must keep its side stays at least this far on it, in h.
const HELD: f32 = 0.05;

/// The voted volume with the estimates worked in. A voxel is a vote's ±√3 to begin with; in each
/// round the voxels that have a six-neighbour of the other sign take the mean of themselves and
/// their neighbours, and then those whose estimate has their sign take the estimate.
///
/// Departure: the vote here is an exact test of the voxel itself, so a voxel that the vote is sure
/// of and that has an estimate keeps its side, and takes the estimate at once where the signs
/// agree. The paper's rule, under which walls of one voxel wear away, is
/// [`Trust::Nothing`].
pub fn smooth(
    votes: &Grid<Votes>,
    estimates: &Grid<f32>,
    options: &RobustOptions,
    progress: &Progress,
) -> Result<Grid<f32>, Stopped> {
    let adjacency = Adjacency::new(&votes.bricks);
    let work = Smoothing { votes, estimates, adjacency: &adjacency, trust: options.trust };
    let mut grid = Grid::filled(votes.bricks.clone(), 0.0f32, -FAR, FAR);
    grid.values.par_iter_mut().enumerate().for_each(|(brick, values)| {
        for (n, value) in values.iter_mut().enumerate() {
            *value = if votes.values[brick][n].is_inside { -FAR } else { FAR };
            if options.trust != Trust::Nothing {
                *value = work.with_estimate(brick, n, *value);
            }
        }
    });
    let mut lists = adjacency.transition(&grid);
    lists.par_iter_mut().enumerate().for_each(|(brick, list)| {
        list.retain(|&n| !work.is_settled(brick, n as usize, grid.values[brick][n as usize]));
    });
    for _ in 0..options.smoothing_rounds {
        progress.check()?;
        let changes: Vec<Vec<f32>> = lists
            .par_iter()
            .enumerate()
            .map(|(brick, list)| list.iter().map(|&n| work.next(&grid, brick, n as usize)).collect())
            .collect();
        let mut flipped = Vec::new();
        for (brick, (list, changes)) in lists.iter().zip(changes).enumerate() {
            for (&n, value) in list.iter().zip(changes) {
                let old = std::mem::replace(&mut grid.values[brick][n as usize], value);
                if (old < 0.0) != (value < 0.0) {
                    flipped.push((brick, n as usize));
                }
            }
        }
        work.widen(&mut lists, &grid, &flipped);
    }
    Ok(grid)
}

/// What the rounds of smoothing look at.
struct Smoothing<'a> {
    votes: &'a Grid<Votes>,
    estimates: &'a Grid<f32>,
    adjacency: &'a Adjacency,
    trust: Trust,
}

impl Smoothing<'_> {
    /// Whether the voxel keeps its side.
    fn is_held(&self, brick: usize, n: usize) -> bool {
        match self.trust {
            Trust::All => true,
            Trust::Sure => !self.estimates.values[brick][n].is_nan() && !self.votes.values[brick][n].doubtful(),
            Trust::Nothing => false,
        }
    }

    /// The estimate where it has the sign of `value`, else `value`.
    fn with_estimate(&self, brick: usize, n: usize, value: f32) -> f32 {
        let estimate = self.estimates.values[brick][n];
        let agrees = !estimate.is_nan() && (estimate < 0.0) == (value < 0.0);
        if agrees { estimate } else { value }
    }

    /// Whether the voxel has its final value.
    fn is_settled(&self, brick: usize, n: usize, value: f32) -> bool {
        self.is_held(brick, n) && (self.estimates.values[brick][n] < 0.0) == (value < 0.0)
    }

    /// The value after one round.
    fn next(&self, grid: &Grid<f32>, brick: usize, n: usize) -> f32 {
        let value = grid.values[brick][n];
        let around = self.adjacency.values(grid, brick, n);
        if around.iter().all(|a| (*a < 0.0) == (value < 0.0)) {
            return value;
        }
        let mean = (value + around.iter().sum::<f32>()) / 7.0;
        // The surface must not leave the stored bricks.
        let stored = self.adjacency.voxels(brick, n).iter().all(Option::is_some);
        let next = if stored && !self.is_held(brick, n) { mean } else { keep_side(mean, value) };
        self.with_estimate(brick, n, next)
    }

    /// Adds the neighbours of voxels whose sign changed.
    fn widen(&self, lists: &mut [Vec<u16>], grid: &Grid<f32>, flipped: &[(usize, usize)]) {
        let mut touched = Vec::new();
        for &(brick, n) in flipped {
            for (brick, n) in self.adjacency.voxels(brick, n).into_iter().flatten() {
                if !self.is_settled(brick, n, grid.values[brick][n]) {
                    lists[brick].push(n as u16);
                    touched.push(brick);
                }
            }
        }
        for brick in touched {
            lists[brick].sort_unstable();
            lists[brick].dedup();
        }
    }
}

/// `mean`, but on the side of `value`.
fn keep_side(mean: f32, value: f32) -> f32 {
    if value < 0.0 { mean.min(-HELD) } else { mean.max(HELD) }
}
