//! What a field costs, estimated before anything is allocated.

use super::Band;
use crate::lattice::{BRICK, BRICK_VOXELS, Lattice};
use crate::mesh::TriMesh;

/// Bytes per voxel of an active brick at the peak: the bricks as they are found, and the grid.
const BYTES_PER_VOXEL: f64 = 8.6;
/// Bytes per triangle: its features, their numbers in tiles, and the tree for doubtful voxels.
const BYTES_PER_TRIANGLE: f64 = 1200.0;
/// Bricks stick out of the band by about this much on each of its sides, h.
const OVERHANG: f64 = 4.5;
/// Seconds on one core per voxel, and per triangle.
const SECONDS_PER_VOXEL: f64 = 60e-9;
const SECONDS_PER_TRIANGLE: f64 = 2e-6;

/// What [`super::exact`] would cost.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cost {
    /// Voxels of active bricks.
    pub voxels: u64,
    /// Peak memory, bytes.
    pub memory: u64,
    /// Seconds on one core of an ordinary machine.
    pub seconds: f64,
}

/// An estimate for `mesh` on `lattice`, from area and extent alone.
pub fn cost(mesh: &TriMesh, lattice: &Lattice, band: Band) -> Cost {
    let all = lattice.dims.as_dvec3().max(glam::DVec3::splat(8.0)).element_product();
    let voxels = match band {
        Band::Full => all,
        Band::Within(h) => around(mesh, lattice, h + OVERHANG).min(all).max(BRICK_VOXELS as f64),
    };
    Cost::of(voxels, mesh.triangles.len())
}

/// The same of some planes of z alone, from the first on and before the second: as much of the whole as there is surface near them.
pub fn cost_of_planes(mesh: &TriMesh, lattice: &Lattice, band: Band, [from, to]: [u32; 2]) -> Cost {
    let whole = cost(mesh, lattice, band);
    let planes = f64::from(to.saturating_sub(from).next_multiple_of(BRICK as u32));
    let all = planes * lattice.dims.as_dvec3().max(glam::DVec3::splat(8.0)).truncate().element_product();
    let Band::Within(h) = band else { return Cost::of(all, mesh.triangles.len()) };
    let reach = h + OVERHANG;
    let near = |t: &usize| {
        let z = mesh.corners(*t).map(|p| lattice.to_lattice(p).z);
        let (low, high) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
        low <= f64::from(to) + reach && high >= f64::from(from) - reach
    };
    let area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    let total: f64 = (0..mesh.triangles.len()).map(area).sum();
    let part: f64 = (0..mesh.triangles.len()).filter(near).map(area).sum();
    let share = if total > 0.0 { part / total } else { 1.0 };
    Cost::of((whole.voxels as f64 * share).min(all), mesh.triangles.len())
}

impl Cost {
    fn of(voxels: f64, triangles: usize) -> Self {
        let triangles = triangles as f64;
        Self {
            voxels: voxels as u64,
            memory: (BYTES_PER_VOXEL * voxels + BYTES_PER_TRIANGLE * triangles) as u64,
            seconds: SECONDS_PER_VOXEL * voxels + SECONDS_PER_TRIANGLE * triangles,
        }
    }
}

/// Volume in h³ of what is within `r` (h) of the surface: on both sides of its area, and as much more outside as
/// there is around a box of the same extent (Steiner); never more than the box grown by `r`.
fn around(mesh: &TriMesh, lattice: &Lattice, r: f64) -> f64 {
    let Some(bounds) = mesh.bounds() else { return 0.0 };
    let size = bounds.size() / lattice.h;
    let double = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    let area = (0..mesh.triangles.len()).map(double).sum::<f64>() / (2.0 * lattice.h * lattice.h);
    let pi = std::f64::consts::PI;
    let sheet = 2.0 * area * r + pi * size.element_sum() * r * r + 4.0 / 3.0 * pi * r.powi(3);
    sheet.min((size + 2.0 * r).element_product())
}
