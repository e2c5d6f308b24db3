//! The exact distance at the points of a lattice without an end, cube by cube, where it is asked for.

use std::sync::{Arc, PoisonError, RwLock};

use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;

use super::descend::{Lists, TILE, Worker};
use super::feature::Features;
use super::tiles::{Block, Scope, lists_of};
use crate::lattice::{BRICK, Lattice, brick_of, voxel_in_brick};
use crate::mesh::TriMesh;

/// Points along the side of a cube.
pub const SIDE: i32 = TILE;
/// How far apart cubes begin: the last three points of one are the first three of the next.
pub const STEP: i32 = SIDE - 3;
/// Cubes are grouped by two along each axis, and the groups again, so often: with 8 the largest groups are 128 cubes wide.
const LEVELS: u32 = 8;
/// Distances are told up to so many diagonals of the mesh from its middle.
const FARTHEST: f64 = 8.0;
/// Features of all groups that are remembered, at most: 64 MB of numbers.
const MOST_LISTED: usize = 1 << 24;

/// The exact signed distance to a closed, oriented mesh at the points of a lattice without an end. Cube `k` holds the 32³ points from `29 k - 1` on, in lattice
/// coordinates.
pub struct BlockDistance {
    features: Features,
    /// The middle of the mesh, lattice coordinates, and how far from there distances are told, h.
    middle: DVec3,
    reach: f64,
    /// What of the features matters to a group of cubes.
    groups: RwLock<Groups>,
}

#[derive(Default)]
struct Groups {
    lists: FxHashMap<(u32, IVec3), Arc<Lists>>,
    listed: usize,
}

impl BlockDistance {
    /// Of a mesh at the points `origin + h v`, model units; `None` for a mesh without triangles.
    pub fn of(mesh: &TriMesh, origin: DVec3, h: f64) -> Option<Self> {
        let lattice = Lattice { origin, h, dims: IVec3::ONE };
        let bounds = mesh.bounds()?;
        let middle = lattice.to_lattice((bounds.min + bounds.max) / 2.0);
        let reach = FARTHEST * bounds.diagonal() / h + f64::from(SIDE);
        Some(Self { features: Features::of(mesh, &lattice, reach), middle, reach, groups: RwLock::default() })
    }

    /// The distances in cube `cube`, h, negative inside, x fastest, then y: right to 1e-4 and to 3e-7 of each. `None` far from the mesh.
    pub fn cube(&self, cube: IVec3) -> Option<Vec<f32>> {
        let block = group(0, cube);
        let from_middle = block.centre().distance(self.middle) + f64::from(SIDE);
        if from_middle >= self.reach || from_middle.is_nan() {
            return None;
        }
        let lists = lists_of(&block, &self.lists(1, cube >> 1), &self.features, &self.scope());
        let mut filled = Vec::new();
        let (end, band) = (IVec3::MAX, self.scope().band as f32);
        Worker::default().tile(block.base, end, &self.features, &lists, band, &mut filled);
        let mut values = vec![f32::NAN; (SIDE * SIDE * SIDE) as usize];
        for part in filled {
            let first = (part.brick - brick_of(block.base)) * BRICK;
            for (n, &value) in part.values.iter().enumerate() {
                let at = first + voxel_in_brick(n);
                values[(at.x + SIDE * (at.y + SIDE * at.z)) as usize] = value;
            }
        }
        Some(values)
    }

    fn scope(&self) -> Scope {
        Scope { end: IVec3::MAX, band: self.reach, planes: [0, i32::MAX] }
    }

    /// What matters to a group.
    fn lists(&self, level: u32, number: IVec3) -> Arc<Lists> {
        let known = |groups: &Groups| groups.lists.get(&(level, number)).cloned();
        if let Some(known) = known(&self.groups.read().unwrap_or_else(PoisonError::into_inner)) {
            return known;
        }
        let block = group(level, number);
        let found = if level == LEVELS {
            lists_of(&block, &Lists::all(&self.features), &self.features, &self.scope())
        } else {
            lists_of(&block, &self.lists(level + 1, number >> 1), &self.features, &self.scope())
        };
        let found = Arc::new(found);
        let mut groups = self.groups.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = known(&groups) {
            return known;
        }
        if groups.listed + found.len() > MOST_LISTED {
            *groups = Groups::default();
        }
        groups.listed += found.len();
        groups.lists.insert((level, number), found.clone());
        found
    }
}

/// The points of `2^level` cubes along each axis.
fn group(level: u32, number: IVec3) -> Block {
    let step = STEP << level;
    Block { base: number * step - 1, size: step + SIDE - STEP }
}
