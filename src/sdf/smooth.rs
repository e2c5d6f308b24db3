//! Smoothing of the voted volume against the estimates (Bærentzen §3.3).

use rayon::prelude::*;

use super::RobustOptions;
use super::neighbours::Adjacency;
use crate::lattice::Grid;
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
/// [`RobustOptions::trust_votes`] = false.
pub fn smooth(votes: &Grid<Votes>, estimates: &Grid<f32>, options: &RobustOptions) -> Grid<f32> {
    let bricks = &votes.bricks;
    let adjacency = Adjacency::new(bricks);
    let side = |inside: bool| if inside { -FAR } else { FAR };
    let mut grid = Grid::filled(bricks.clone(), 0.0f32, -FAR, FAR);
    let held = |brick: usize, n: usize| {
        options.trust_votes && !estimates.values[brick][n].is_nan() && !votes.values[brick][n].doubtful()
    };
    let lists: Vec<Vec<u16>> = grid
        .values
        .par_iter_mut()
        .enumerate()
        .map(|(brick, values)| {
            let mut free = Vec::new();
            for (n, value) in values.iter_mut().enumerate() {
                let estimate = estimates.values[brick][n];
                *value = side(votes.values[brick][n].is_inside);
                let agrees = estimate.is_sign_negative() == value.is_sign_negative();
                if held(brick, n) && agrees {
                    *value = estimate;
                } else {
                    free.push(n as u16);
                }
            }
            free
        })
        .collect();
    for _ in 0..options.smoothing_rounds {
        let changes: Vec<Vec<(u16, f32)>> = lists
            .par_iter()
            .enumerate()
            .map(|(brick, free)| {
                let smoothed = |&n: &u16| {
                    let voxel = n as usize;
                    let value = grid.values[brick][voxel];
                    let around = adjacency.values(&grid, brick, voxel);
                    let differs = around.iter().any(|a| (*a < 0.0) != (value < 0.0));
                    differs.then(|| {
                        let mean = (value + around.iter().sum::<f32>()) / 7.0;
                        // The surface must not leave the stored bricks.
                        let may_cross = !held(brick, voxel) && adjacency.is_interior(brick, voxel);
                        let next = if may_cross { mean } else { keep_side(mean, value) };
                        let estimate = estimates.values[brick][voxel];
                        let agrees = !estimate.is_nan() && (estimate < 0.0) == (next < 0.0);
                        (n, if agrees { estimate } else { next })
                    })
                };
                free.iter().filter_map(smoothed).collect()
            })
            .collect();
        for (values, changes) in grid.values.iter_mut().zip(changes) {
            changes.into_iter().for_each(|(n, value)| values[n as usize] = value);
        }
    }
    grid
}

/// `mean`, but on the side of `value`.
fn keep_side(mean: f32, value: f32) -> f32 {
    if value < 0.0 { mean.min(-HELD) } else { mean.max(HELD) }
}
