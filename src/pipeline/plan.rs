//! What a run costs, estimated before anything is allocated.

use super::{Error, Options, Plan, prepare};
use crate::lattice::{DIRECTIONS, Lattice};
use crate::ldi::{MAX_CROSSINGS, MAX_TRIANGLES};
use crate::mesh::TriMesh;

/// Bytes per h² of surface at the peak. Measured as the growth of the peak between 128 and 256 on
/// the bunny, fandisk and 520644 (see `docs/benchmarks.md`), rounded up.
const BYTES_PER_CELL: f64 = 2200.0;
/// Crossings of the rays of all 13 directions per h² of surface, whichever way it lies: 8.5 to 9.3.
const CROSSINGS_PER_CELL: f64 = 9.3;
/// Bytes per crossing, for surface beyond what the lattice has cells for: many layers on few rays.
const BYTES_PER_CROSSING: f64 = 50.0;
/// Bytes per input triangle at the peak, the file's text included.
const BYTES_PER_TRIANGLE: f64 = 400.0;
/// Bytes of the program itself.
const BASE_BYTES: f64 = 12e6;
/// Seconds on one core per h² of surface, fit included, and per input triangle.
const SECONDS_PER_CELL: f64 = 22e-6;
const SECONDS_PER_TRIANGLE: f64 = 3e-6;
/// Of that, and of the memory at the peak, what is spent up to the votes.
const VOTES_SECONDS: f64 = 0.2;
const VOTES_MEMORY: f64 = 0.4;
/// Triangles of the result per h² of surface.
const TRIANGLES_PER_CELL: f64 = 2.2;

/// What [`super::boolean`] (and [`super::repair`]: one operand) would cost.
pub fn plan(operands: &[TriMesh], options: &Options) -> Result<Plan, Error> {
    let lattice = prepare::lattice(&prepare::bounds(operands)?, options.voxel)?;
    Ok(Input::of(operands).cost(&lattice))
}

/// An error when the run would need more memory than allowed, or more than 32 bits to number things.
pub(super) fn check_limits(operands: &[TriMesh], lattice: &Lattice, options: &Options) -> Result<(), Error> {
    let input = Input::of(operands);
    input.check_numbers(lattice)?;
    let Some(allowed) = options.max_memory else { return Ok(()) };
    let needed = input.cost(lattice).memory;
    if needed <= allowed {
        return Ok(());
    }
    let bounds = prepare::bounds(operands)?;
    let mut voxel_that_fits = None;
    let mut h = lattice.h;
    while h < bounds.size().max_element() {
        h *= 1.1;
        if input.cost(&Lattice::around(&bounds, h)).memory <= allowed {
            voxel_that_fits = Some(h);
            break;
        }
    }
    Err(Error::Memory { needed, allowed, voxel_that_fits })
}

/// How often the rays of all directions cross the operands, about.
pub(super) fn crossings(operands: &[TriMesh], lattice: &Lattice) -> f64 {
    Input::of(operands).crossings(lattice)
}

/// What the cost depends on, apart from the lattice.
pub(super) struct Input {
    triangles: usize,
    vertices: usize,
    /// Square model units.
    area: f64,
}

impl Input {
    pub(super) fn of(operands: &[TriMesh]) -> Self {
        Self {
            triangles: operands.iter().map(|m| m.triangles.len()).sum(),
            vertices: operands.iter().map(|m| m.positions.len()).sum(),
            area: operands.iter().map(area).sum(),
        }
    }

    /// Area in h².
    fn surface(&self, lattice: &Lattice) -> f64 {
        self.area / (lattice.h * lattice.h)
    }

    fn crossings(&self, lattice: &Lattice) -> f64 {
        CROSSINGS_PER_CELL * self.surface(lattice)
    }

    fn check_numbers(&self, lattice: &Lattice) -> Result<(), Error> {
        if self.triangles > MAX_TRIANGLES || self.vertices > u32::MAX as usize {
            let reason = format!(
                "{} triangles over {} vertices are more than the {MAX_TRIANGLES} triangles that are possible: \
                 repair the parts one by one",
                self.triangles, self.vertices
            );
            return Err(Error::TooLarge { reason });
        }
        // Half of what can be numbered: the estimate leaves out what lies along the triangles' sides.
        let crossings = self.crossings(lattice);
        if crossings > MAX_CROSSINGS as f64 / 2.0 {
            let reason = format!(
                "the surface would be crossed {crossings:.1e} times, more than can be numbered: \
                 use a larger voxel, or look for faces that lie on one another in thousands"
            );
            return Err(Error::TooLarge { reason });
        }
        Ok(())
    }

    /// What orientation, rays and votes cost.
    pub(super) fn votes(&self, lattice: &Lattice) -> Plan {
        let plan = self.cost(lattice);
        let memory = (VOTES_MEMORY * plan.memory as f64) as u64;
        Plan { seconds: VOTES_SECONDS * plan.seconds, memory, ..plan }
    }

    fn cost(&self, lattice: &Lattice) -> Plan {
        // No more surface is kept than the lattice has cells; the crossings are there all the same.
        let surface = self.surface(lattice);
        let cells = surface.min(lattice.dims.as_dvec3().element_product());
        let buried = (surface - cells).max(0.0) * CROSSINGS_PER_CELL * BYTES_PER_CROSSING;
        let rays = DIRECTIONS.iter().map(|d| d.ray_window(lattice.dims).1.map(f64::from));
        let rays: f64 = rays.map(|[u, v]| u * v).sum();
        let triangles = self.triangles as f64;
        let memory = BASE_BYTES + 4.2 * rays + BYTES_PER_CELL * cells + buried + BYTES_PER_TRIANGLE * triangles;
        Plan {
            voxel: lattice.h,
            dims: lattice.dims.to_array(),
            voxels_near_surface: (2.0 * cells) as u64,
            triangles: (TRIANGLES_PER_CELL * cells) as u64,
            memory: memory as u64,
            seconds: SECONDS_PER_CELL * cells + SECONDS_PER_TRIANGLE * triangles,
        }
    }
}

fn area(mesh: &TriMesh) -> f64 {
    let double = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    (0..mesh.triangles.len()).map(double).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::VoxelSize;
    use glam::DVec3;

    /// `copies` of one triangle of area ½.
    fn stack(copies: usize) -> TriMesh {
        TriMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 0.2)],
            triangles: vec![[0, 1, 2]; copies],
        }
    }

    fn memory(mesh: &TriMesh, resolution: u32) -> u64 {
        plan(std::slice::from_ref(mesh), &Options::new(VoxelSize::Along(resolution))).expect("a plan").memory
    }

    #[test]
    fn a_finer_lattice_and_more_triangles_cost_more() {
        let finer: Vec<u64> = [16, 17, 64, 256, 1000, 4000].map(|n| memory(&stack(4), n)).to_vec();
        assert!(finer.is_sorted_by(|a, b| a < b), "{finer:?}");
        // Far more surface than the lattice has cells: its crossings still count.
        let larger: Vec<u64> = [1, 10, 1000, 100_000].map(|copies| memory(&stack(copies), 8)).to_vec();
        assert!(larger.is_sorted_by(|a, b| a < b), "{larger:?}");
        let by_triangles = 400 * 100_000;
        assert!(larger[3] > 20 * by_triangles, "{larger:?}");
    }

    #[test]
    fn more_crossings_than_can_be_numbered_are_refused_before_anything_is_made() {
        let layers = [stack(1000)];
        let lattice =
            |n| prepare::lattice(&prepare::bounds(&layers).expect("bounds"), VoxelSize::Along(n)).expect("one");
        let options = Options::new(VoxelSize::Along(1));
        assert_eq!(check_limits(&layers, &lattice(256), &options), Ok(()));
        assert!(matches!(check_limits(&layers, &lattice(4000), &options), Err(Error::TooLarge { .. })));
    }

    #[test]
    fn the_voxel_that_fits_is_the_smallest_of_its_series_that_does() {
        let input = [stack(4)];
        let bounds = prepare::bounds(&input).expect("bounds");
        let lattice = prepare::lattice(&bounds, VoxelSize::Along(500)).expect("a lattice");
        let needed = Input::of(&input).cost(&lattice).memory;
        let allowed = needed / 2;
        let options = Options { max_memory: Some(allowed), ..Options::new(VoxelSize::Along(500)) };
        let Err(Error::Memory { voxel_that_fits: Some(h), .. }) = check_limits(&input, &lattice, &options) else {
            panic!("allowed");
        };
        let at = |h: f64| Input::of(&input).cost(&Lattice::around(&bounds, h)).memory;
        assert!(at(h) <= allowed && at(h / 1.1) > allowed);
    }
}
