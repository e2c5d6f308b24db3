//! Where the vote is not sure.

use glam::IVec3;
use rustc_hash::FxHashMap;

use super::{DoubtfulRegion, VoteReport, Votes, voxel_in_brick};
use crate::lattice::{BRICK, Grid, Lattice};

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
