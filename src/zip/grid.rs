//! Points in cubes, to find those near a line.

use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;

/// Points by the cube that they lie in.
pub(super) struct Grid {
    cell: f64,
    cubes: FxHashMap<IVec3, Vec<(DVec3, u32)>>,
}

impl Grid {
    /// Numbered points, in cubes of edge `cell`.
    pub(super) fn new(points: impl Iterator<Item = (DVec3, u32)>, cell: f64) -> Self {
        let mut grid = Self { cell, cubes: FxHashMap::default() };
        for (p, number) in points {
            grid.cubes.entry(grid.cube(p)).or_default().push((p, number));
        }
        grid
    }

    fn cube(&self, p: DVec3) -> IVec3 {
        (p / self.cell).floor().as_ivec3()
    }

    /// Calls `found` once with the number of every point within `reach` of the line from `a` to `b`, and with some farther ones. What it looks at is taken from `budget`: nothing
    /// is found with one that does not suffice, and `None` is returned.
    pub(super) fn each_along(
        &self,
        [a, b]: [DVec3; 2],
        reach: f64,
        budget: &mut usize,
        mut found: impl FnMut(u32),
    ) -> Option<()> {
        let steps = (a.distance(b) / self.cell).ceil().max(1.0);
        // Around the middle of each step, by half of its length.
        let around = DVec3::splat(reach + a.distance(b) / steps / 2.0);
        // Each step looks at 27 cubes at most.
        *budget = budget.checked_sub(steps.min(1e15) as usize)?;
        let mut cubes: Vec<[i32; 3]> = Vec::new();
        for step in 0..steps as usize {
            let at = a.lerp(b, (step as f64 + 0.5) / steps);
            let (low, high) = (self.cube(at - around), self.cube(at + around));
            for x in low.x..=high.x {
                for y in low.y..=high.y {
                    cubes.extend((low.z..=high.z).map(|z| [x, y, z]));
                }
            }
        }
        cubes.sort_unstable();
        cubes.dedup();
        let lists = || cubes.iter().filter_map(|&cube| self.cubes.get(&IVec3::from_array(cube)));
        *budget = budget.checked_sub(lists().map(Vec::len).sum())?;
        lists().flatten().for_each(|&(_, number)| found(number));
        Some(())
    }
}
