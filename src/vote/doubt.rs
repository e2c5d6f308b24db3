//! Where the vote is not sure.

use glam::IVec3;
use rustc_hash::FxHashMap;

use super::{DoubtfulRegion, VoteReport, Votes};
use crate::lattice::{BRICK, Grid, Lattice, voxel_in_brick};

/// At most this many regions are listed.
const REGIONS: usize = 10;

/// Counts the doubtful voxels and boxes their largest groups; a group is connected through bricks
/// that touch.
pub fn doubts(votes: &Grid<Votes>, lattice: &Lattice) -> VoteReport {
    let mut boxes: Vec<(IVec3, Doubt)> = Vec::new();
    for (&brick, values) in votes.bricks.active().iter().zip(&votes.values) {
        let doubtful = values.iter().enumerate().filter(|(_, v)| v.doubtful());
        let found = doubtful.fold(None, |doubt: Option<Doubt>, (n, _)| {
            let voxel = brick * BRICK + voxel_in_brick(n);
            let one = Doubt { min: voxel, max: voxel, voxels: 1 };
            Some(doubt.map_or(one, |doubt| doubt.join(one)))
        });
        boxes.extend(found.map(|doubt| (brick, doubt)));
    }
    let doubtful = boxes.iter().map(|(_, doubt)| doubt.voxels).sum();
    let mut groups = connected(&boxes);
    groups.sort_by_key(|doubt| (std::cmp::Reverse(doubt.voxels), doubt.min.to_array()));
    let region = |doubt: &Doubt| DoubtfulRegion {
        min: lattice.to_model(doubt.min.as_dvec3()).to_array(),
        max: lattice.to_model(doubt.max.as_dvec3()).to_array(),
        voxels: doubt.voxels,
    };
    VoteReport {
        voxels: votes.values.len() * crate::lattice::BRICK_VOXELS,
        doubtful,
        doubtful_regions: groups.iter().take(REGIONS).map(region).collect(),
    }
}

#[derive(Debug, Clone, Copy)]
struct Doubt {
    min: IVec3,
    max: IVec3,
    voxels: usize,
}

impl Doubt {
    fn join(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max), voxels: self.voxels + other.voxels }
    }
}

/// Joins the boxes of bricks that touch.
fn connected(boxes: &[(IVec3, Doubt)]) -> Vec<Doubt> {
    let at: FxHashMap<IVec3, usize> = boxes.iter().enumerate().map(|(n, (brick, _))| (*brick, n)).collect();
    let mut seen = vec![false; boxes.len()];
    let mut groups = Vec::new();
    for seed in 0..boxes.len() {
        if std::mem::replace(&mut seen[seed], true) {
            continue;
        }
        let mut group = boxes[seed].1;
        let mut stack = vec![seed];
        while let Some(n) = stack.pop() {
            for k in 0..27 {
                let other = boxes[n].0 + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                if let Some(&m) = at.get(&other).filter(|&&m| !seen[m]) {
                    seen[m] = true;
                    group = group.join(boxes[m].1);
                    stack.push(m);
                }
            }
        }
        groups.push(group);
    }
    groups
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::lattice::{Bricks, index_in_brick};

    const SURE: Votes = Votes { inside: 13, valid: 13, is_inside: true };
    const FEW_VOTES: Votes = Votes { inside: 4, valid: 4, is_inside: true };
    const SPLIT: Votes = Votes { inside: 6, valid: 13, is_inside: false };

    fn doubts_at(bricks: impl IntoIterator<Item = IVec3>, voxels: &[(IVec3, Votes)]) -> VoteReport {
        let lattice = Lattice { origin: DVec3::new(1.0, 0.0, 0.0), h: 0.5, dims: IVec3::splat(400) };
        let mut grid = Grid::filled(Arc::new(Bricks::new(bricks)), SURE, SURE, SURE);
        for &(voxel, votes) in voxels {
            let brick = crate::lattice::brick_of(voxel);
            let n = grid.bricks.active().iter().position(|&b| b == brick).expect("an active brick");
            grid.values[n][index_in_brick(voxel)] = votes;
        }
        doubts(&grid, &lattice)
    }

    #[test]
    fn doubtful_voxels_in_bricks_that_touch_are_one_region_and_the_largest_comes_first() {
        let bricks = [IVec3::ZERO, IVec3::new(3, 0, 0), IVec3::new(4, 1, 1)];
        let voxels = [
            (IVec3::new(1, 2, 3), FEW_VOTES),
            (IVec3::new(25, 7, 7), SPLIT),
            (IVec3::new(32, 8, 9), FEW_VOTES),
            (IVec3::new(2, 2, 2), Votes { inside: 3, valid: 13, is_inside: false }),
        ];
        let report = doubts_at(bricks, &voxels);
        assert_eq!((report.voxels, report.doubtful), (3 * 512, 3));
        let region = |min, max, voxels| DoubtfulRegion { min, max, voxels };
        let expected = [region([13.5, 3.5, 3.5], [17.0, 4.0, 4.5], 2), region([1.5, 1.0, 1.5], [1.5, 1.0, 1.5], 1)];
        assert_eq!(report.doubtful_regions, expected);
    }

    #[test]
    fn only_the_largest_regions_are_listed_but_all_voxels_are_counted() {
        let bricks: Vec<IVec3> = (0..15).map(|n| IVec3::new(2 * n, 0, 0)).collect();
        let mut voxels: Vec<(IVec3, Votes)> = bricks.iter().map(|&b| (b * BRICK, SPLIT)).collect();
        voxels.push((bricks[14] * BRICK + IVec3::X, SPLIT));
        let report = doubts_at(bricks, &voxels);
        assert_eq!(report.doubtful, 16);
        assert_eq!(report.doubtful_regions.len(), REGIONS);
        assert_eq!(report.doubtful_regions[0].voxels, 2);
        assert_eq!(report.doubtful_regions[1].min, [1.0, 0.0, 0.0]);
    }
}
