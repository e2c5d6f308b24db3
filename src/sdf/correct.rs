//! Correction of the distances by the length of their gradient (Bærentzen §3.4).

use rayon::prelude::*;

use super::RobustOptions;
use super::neighbours::Adjacency;
use crate::lattice::Grid;
use crate::progress::{Progress, Stopped};

/// A gradient shorter than this says nothing about the distance.
const FLAT: f32 = 0.1;

/// Rounds of `d ← (1 - k) d + k d / |∇d|` over the transition region, the voxels that have a
/// neighbour of the other sign, with upwind differences: only neighbours that are closer to the
/// surface or on its other side count. Signs do not change.
///
/// Departure: voxels that hold their estimate are left alone. Here the nearest of 13 directions'
/// points gives them a mean error of 0.0009 h on a torus at 96, and ten rounds make that 0.022 h;
/// the paper has 0.0095 h before and 0.0029 h after. [`RobustOptions::correct_estimates`] corrects
/// them all the same.
pub fn correct(
    mut grid: Grid<f32>,
    estimates: &Grid<f32>,
    options: &RobustOptions,
    progress: &Progress,
) -> Result<Grid<f32>, Stopped> {
    let adjacency = Adjacency::new(&grid.bricks);
    let mut near = adjacency.transition(&grid);
    if !options.correct_estimates {
        near.par_iter_mut().enumerate().for_each(|(brick, near)| {
            near.retain(|&n| grid.values[brick][n as usize] != estimates.values[brick][n as usize]);
        });
    }
    for _ in 0..options.correction_rounds {
        progress.check()?;
        let changes: Vec<Vec<f32>> = near
            .par_iter()
            .enumerate()
            .map(|(brick, near)| {
                let step = |&n: &u16| {
                    let value = grid.values[brick][n as usize];
                    let slope = upwind_slope(value, adjacency.values(&grid, brick, n as usize));
                    let k = options.damping;
                    if slope < FLAT { value } else { (1.0 - k) * value + k * value / slope }
                };
                near.iter().map(step).collect()
            })
            .collect();
        for ((values, near), changes) in grid.values.iter_mut().zip(&near).zip(changes) {
            near.iter().zip(changes).for_each(|(&n, value)| values[n as usize] = value);
        }
    }
    Ok(grid)
}

/// Length of the gradient from the neighbours (-x, +x, -y, …) that lie towards the surface.
#[inline]
fn upwind_slope(value: f32, around: [f32; 6]) -> f32 {
    let sign = if value < 0.0 { -1.0 } else { 1.0 };
    let mut sum = 0.0;
    for axis in 0..3 {
        // Towards the surface the distance falls; take the steeper of the two sides.
        let fall = |other: f32| sign * (value - other);
        let steepest = fall(around[2 * axis]).max(fall(around[2 * axis + 1])).max(0.0);
        sum += steepest * steepest;
    }
    sum.sqrt()
}
