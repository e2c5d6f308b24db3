//! The exact rasteriser: all crossings of one direction's rays with the soup.
//!
//! Vertices are snapped once to a sub-voxel integer lattice. The shear of a direction keeps
//! integers exact, so 64-bit edge functions decide coverage exactly, and ties are broken as if the
//! ray were moved by (ε, ε²). A ray therefore crosses a closed mesh a balanced number of times, in
//! all 13 directions, whatever the mesh. Depths are interpolated with the exact integer weights.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::{Hit, Layers};
use crate::lattice::{Direction, Lattice};
use crate::progress::{Progress, Stopped};

/// Sub-voxel bits of a snapped vertex. 16 bits snap to 8e-6 h and leave room for lattices of
/// [`MAX_VOXELS`] along a side in 32-bit coordinates and 64-bit edge functions.
pub const SNAP_BITS: u32 = 16;
/// The most voxels along one side of a lattice.
pub const MAX_VOXELS: i32 = 1 << 12;
/// One voxel in snapped units.
const UNIT: i32 = 1 << SNAP_BITS;
/// Snapped coordinates stay below this, so that sheared ones and their differences fit 32 bits.
const FARTHEST: f64 = (1 << (SNAP_BITS + 13)) as f64 - 1.0;
/// Triangles that one task rasterises.
const CHUNK: usize = 8192;
/// Crossings of one task after which it looks whether to stop.
const CHECK_AFTER: usize = 1 << 16;

/// The soup's vertices on the sub-voxel integer lattice of `lattice`. Those more than twice
/// [`MAX_VOXELS`] from its origin along an axis are moved there: a closed mesh stays closed.
pub fn snap(positions: &[DVec3], lattice: &Lattice) -> Vec<IVec3> {
    let scale = UNIT as f64;
    let far = DVec3::splat(FARTHEST);
    positions.par_iter().map(|&p| (lattice.to_lattice(p) * scale).round().max(-far).min(far).as_ivec3()).collect()
}

/// All crossings of the rays of `direction` with the triangles, `factor` rays per voxel along u
/// and v, sorted along each ray by depth (ties by triangle).
pub fn rasterise(
    vertices: &[IVec3],
    triangles: &[[u32; 3]],
    dims: IVec3,
    direction: Direction,
    factor: u32,
    progress: &Progress,
) -> Result<Layers, Stopped> {
    let mut layers = Layers::empty(direction, dims, factor);
    let window = Window { low: layers.low, size: layers.size, step: ray_step(factor) };
    let chunks = triangles.par_chunks(CHUNK).enumerate();
    let found: Vec<Vec<(u32, Hit)>> = chunks
        .map(|(n, chunk)| {
            progress.check()?;
            let mut found = Vec::with_capacity(chunk.len());
            let mut unchecked = CHECK_AFTER;
            for (k, t) in chunk.iter().enumerate() {
                let corners = t.map(|v| direction.shear(vertices[v as usize]));
                let triangle = (n * CHUNK + k) as u32;
                window.cover(corners, |ray, depth, entering| found.push((ray, Hit::new(depth, triangle, entering))));
                if found.len() >= unchecked {
                    progress.check()?;
                    unchecked = found.len() + CHECK_AFTER;
                }
            }
            Ok(found)
        })
        .collect::<Result<_, Stopped>>()?;
    progress.check()?;
    layers.fill(&found);
    Ok(layers)
}

/// The rays of one direction: (low + (i, j)) * step in snapped units.
struct Window {
    low: [i32; 2],
    size: [i32; 2],
    step: i32,
}

/// An edge function a·(V - v0) - b·(U - u0), biased so that "covered" is `>= 0`.
struct EdgeFunction {
    along: i64,
    across: i64,
    bias: i64,
    origin: IVec3,
}

impl EdgeFunction {
    fn new(from: IVec3, to: IVec3) -> Self {
        let (along, across) = ((to.x - from.x) as i64, (to.y - from.y) as i64);
        // On the edge itself the ray counts as moved by (ε, ε²).
        let covered = across < 0 || (across == 0 && along > 0);
        Self { along, across, bias: if covered { 0 } else { 1 }, origin: from }
    }

    #[inline]
    fn at(&self, u: i64, v: i64) -> i64 {
        self.along * (v - self.origin.y as i64) - self.across * (u - self.origin.x as i64)
    }
}

/// A triangle as the rays of one direction see it.
pub(super) struct ShearedTriangle {
    /// Opposite to corner 0, 1 and 2.
    edges: [EdgeFunction; 3],
    per_area: f64,
    rise: [f64; 2],
    base: f64,
    entering: bool,
}

impl ShearedTriangle {
    /// The triangle with these corners, sheared and snapped; `None` when the rays see it from the side.
    #[inline]
    pub(super) fn new(mut p: [IVec3; 3]) -> Option<Self> {
        let mut area = cross(p[0], p[1], p[2]);
        if area == 0 {
            return None;
        }
        let entering = area < 0;
        if entering {
            p.swap(1, 2);
            area = -area;
        }
        let edges = [EdgeFunction::new(p[1], p[2]), EdgeFunction::new(p[2], p[0]), EdgeFunction::new(p[0], p[1])];
        let rise = [(p[1].z - p[0].z) as f64, (p[2].z - p[0].z) as f64];
        Some(Self { edges, per_area: 1.0 / area as f64, rise, base: p[0].z as f64, entering })
    }

    /// Whether a ray enters here, against the triangle's normal.
    #[inline]
    pub(super) fn entering(&self) -> bool {
        self.entering
    }

    /// Depth, voxels, of the triangle's plane on the ray (u, v), snapped units.
    #[inline]
    fn depth(&self, u: i64, v: i64) -> f64 {
        let (w1, w2) = (self.edges[1].at(u, v) as f64, self.edges[2].at(u, v) as f64);
        let depth = self.base + (w1 * self.rise[0] + w2 * self.rise[1]) * self.per_area;
        depth * (1.0 / UNIT as f64)
    }

    /// Depth, voxels, where the ray (u, v), snapped units, crosses the triangle; `None` when it passes beside it.
    #[inline]
    pub(super) fn crossing(&self, u: i64, v: i64) -> Option<f64> {
        self.edges.iter().all(|edge| edge.at(u, v) >= edge.bias).then(|| self.depth(u, v))
    }
}

/// Distance of the rays, snapped units, with `factor` rays a voxel.
pub(super) fn ray_step(factor: u32) -> i32 {
    UNIT / factor as i32
}

impl Window {
    /// Calls `hit(ray, depth in voxels, entering)` for each ray that the triangle covers.
    #[inline]
    fn cover(&self, p: [IVec3; 3], mut hit: impl FnMut(u32, f64, bool)) {
        let low = p[0].min(p[1]).min(p[2]);
        let high = p[0].max(p[1]).max(p[2]);
        let (u0, u1) = self.range(low.x, high.x, 0);
        let (v0, v1) = self.range(low.y, high.y, 1);
        if u0 > u1 || v0 > v1 {
            return;
        }
        let Some(seen) = ShearedTriangle::new(p) else { return };
        let step = self.step as i64;
        for j in v0..=v1 {
            let v = j as i64 * step;
            let (first, last) = row(&seen.edges, v, u0, u1, step);
            let start = (j - self.low[1]) as u32 * self.size[0] as u32;
            for i in first..=last {
                let u = i as i64 * step;
                hit(start + (i - self.low[0]) as u32, seen.depth(u, v), seen.entering);
            }
        }
    }

    /// Indices of the rays in [low, high], cut to the window along u (0) or v (1).
    #[inline]
    fn range(&self, low: i32, high: i32, axis: usize) -> (i32, i32) {
        let first = low.div_euclid(self.step) + (low.rem_euclid(self.step) != 0) as i32;
        let last = high.div_euclid(self.step);
        (first.max(self.low[axis]), last.min(self.low[axis] + self.size[axis] - 1))
    }
}

/// The covered rays of one row: first and last index (first > last: none).
#[inline]
fn row(edges: &[EdgeFunction; 3], v: i64, u0: i32, u1: i32, step: i64) -> (i32, i32) {
    let (mut first, mut last) = (u0 as i64, u1 as i64);
    for e in edges {
        // covered: value(u) = c - across * step * i >= 0
        let c = e.at(0, v) - e.bias;
        let slope = e.across * step;
        match slope.signum() {
            0 if c < 0 => return (1, 0),
            0 => {}
            1 => last = last.min(c.div_euclid(slope)),
            _ => first = first.max(-(c.div_euclid(-slope))),
        }
    }
    (first as i32, last as i32)
}

/// Twice the signed area of the projection to (u, v).
#[inline]
fn cross(a: IVec3, b: IVec3, c: IVec3) -> i64 {
    let (abx, aby) = ((b.x - a.x) as i64, (b.y - a.y) as i64);
    let (acx, acy) = ((c.x - a.x) as i64, (c.y - a.y) as i64);
    abx * acy - aby * acx
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ldi::{Operands, balance, ldis};
    use crate::mesh::TriMesh;

    #[test]
    fn a_closed_mesh_that_reaches_far_beyond_the_lattice_still_balances() {
        let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: IVec3::new(9, 5, 7) };
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for size in [20.0, 1e4, 1e9, 1e300] {
            let corner = |n: u32| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) - 0.4;
            let mesh = TriMesh {
                positions: (0..8).map(|n| corner(n) * size).collect(),
                triangles: sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
            };
            for layers in ldis(&mesh, &lattice, 1, &Progress::none()).expect("not stopped") {
                let balance = balance(&layers, &Operands::new([12]));
                assert!(balance.occupied > 0 && balance.unbalanced == 0, "{balance:?} at {size}");
            }
        }
    }

    #[test]
    fn a_set_flag_stops_before_the_first_chunk_and_after_the_last() {
        let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: IVec3::splat(8) };
        let flag = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
        let stopped = ldis(&TriMesh::default(), &lattice, 1, &Progress::none().with_flag(flag));
        assert_eq!(stopped.map(|layers| layers.len()), Err(crate::progress::Stopped::Interrupted));
    }
}
