//! Vertices by where they are.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::facets::Facets;
use super::fine::Fine;

/// Vertices in the cubes of a grid.
#[derive(Debug)]
pub(crate) struct Near {
    /// The size of a cube along each axis: how far away a vertex is found.
    reach: DVec3,
    cubes: FxHashMap<[i64; 3], Vec<(DVec3, u32)>>,
}

impl Near {
    /// The vertices of these facets. `reach`: how far away one is found, in the coarsest
    /// numbers along each axis.
    pub(crate) fn new(facets: &Facets, list: &[u32], fine: &Fine, reach: f64) -> Self {
        let mut vertices: Vec<u32> = list.iter().flat_map(|&f| facets.corners[f as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut near = Self { reach: reach * fine.coarsest, cubes: FxHashMap::default() };
        for v in vertices {
            let p = DVec3::from_array(facets.vertices[v as usize].map(f64::from));
            near.cubes.entry(near.cube(p)).or_default().push((p, v));
        }
        near
    }

    fn cube(&self, p: DVec3) -> [i64; 3] {
        (p / self.reach).to_array().map(|x| x.floor() as i64)
    }

    /// The vertex nearest to a point, if any is within reach; of two at one distance the one with the lower coordinates.
    pub(crate) fn nearest(&self, p: DVec3) -> Option<u32> {
        let [x, y, z] = self.cube(p);
        let around = (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
        let found = around.filter_map(|cube| self.cubes.get(&cube)).flatten();
        let off = |q: DVec3| ((p - q) / self.reach).length_squared();
        let by = |&&(q, _): &&(DVec3, u32)| (off(q), q.to_array());
        let best = found.min_by(|a, b| by(a).partial_cmp(&by(b)).unwrap_or(std::cmp::Ordering::Equal))?;
        (off(best.0) <= 1.0).then_some(best.1)
    }
}
