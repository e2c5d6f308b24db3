//! What a run costs, estimated before anything is allocated.

use super::{Error, Options, Plan, prepare};
use crate::lattice::{DIRECTIONS, Lattice};
use crate::mesh::TriMesh;

/// Bytes per h² of surface at the peak. Measured as the growth of the peak between 128 and 256 on
/// the bunny, fandisk and 520644 (see `docs/benchmarks.md`), rounded up.
const BYTES_PER_CELL: f64 = 2200.0;
/// Bytes per input triangle at the peak, the file's text included.
const BYTES_PER_TRIANGLE: f64 = 400.0;
/// Bytes of the program itself.
const BASE_BYTES: f64 = 12e6;
/// Seconds on one core per h² of surface, and per input triangle.
const SECONDS_PER_CELL: f64 = 9e-6;
const SECONDS_PER_TRIANGLE: f64 = 3e-6;
/// Triangles of the result per h² of surface.
const TRIANGLES_PER_CELL: f64 = 2.2;

/// What [`super::boolean`] (and [`super::repair`]: one operand) would cost.
pub fn plan(operands: &[TriMesh], options: &Options) -> Result<Plan, Error> {
    let lattice = prepare::lattice(&prepare::bounds(operands)?, options.voxel)?;
    Ok(cost(operands, &lattice))
}

/// An error when the run would need more memory than allowed.
pub(super) fn check_memory(operands: &[TriMesh], lattice: &Lattice, options: &Options) -> Result<(), Error> {
    let Some(allowed) = options.max_memory else { return Ok(()) };
    let needed = cost(operands, lattice).memory;
    if needed <= allowed {
        return Ok(());
    }
    let bounds = prepare::bounds(operands)?;
    let mut voxel_that_fits = None;
    let mut h = lattice.h;
    while h < bounds.size().max_element() {
        h *= 1.1;
        if cost(operands, &Lattice::around(&bounds, h)).memory <= allowed {
            voxel_that_fits = Some(h);
            break;
        }
    }
    Err(Error::Memory { needed, allowed, voxel_that_fits })
}

fn cost(operands: &[TriMesh], lattice: &Lattice) -> Plan {
    let triangles: usize = operands.iter().map(|m| m.triangles.len()).sum();
    let area: f64 = operands.iter().map(area).sum();
    // No more surface is kept than the lattice has cells.
    let volume = lattice.dims.as_dvec3().element_product();
    let cells = (area / (lattice.h * lattice.h)).min(volume);
    let rays: f64 = DIRECTIONS.iter().map(|d| d.ray_window(lattice.dims).1.map(f64::from)).map(|[u, v]| u * v).sum();
    let memory = BASE_BYTES + 4.2 * rays + BYTES_PER_CELL * cells + BYTES_PER_TRIANGLE * triangles as f64;
    Plan {
        voxel: lattice.h,
        dims: lattice.dims.to_array(),
        voxels_near_surface: (2.0 * cells) as u64,
        triangles: (TRIANGLES_PER_CELL * cells) as u64,
        memory: memory as u64,
        seconds: SECONDS_PER_CELL * cells + SECONDS_PER_TRIANGLE * triangles as f64,
    }
}

fn area(mesh: &TriMesh) -> f64 {
    let double = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    (0..mesh.triangles.len()).map(double).sum::<f64>() / 2.0
}
