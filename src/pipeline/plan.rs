//! What a run costs, estimated before anything is allocated.

use super::{CanalOptions, Error, MorphologyOptions, Options, Plan, ThickenOptions, prepare};
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

/// What an offset of the solid adds: bytes per h² of surface and per triangle, bytes per h² for each h of the radius, and how
/// many times the seconds. Measured with closings, two offsets, of the bunny and fandisk at 128 and 256, 2 h to 16 h, and
/// rounded up.
const OFFSET_BYTES_PER_CELL: f64 = 900.0;
const OFFSET_BYTES_PER_TRIANGLE: f64 = 1500.0;
const OFFSET_BYTES_PER_CELL_AND_RADIUS: f64 = 125.0;
const OFFSET_SECONDS: f64 = 5.0;

/// Offsets of the solid that are made after it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Offsets {
    /// How many.
    pub count: u32,
    /// Their radius, model units.
    pub radius: f64,
}

/// What [`super::boolean`] (and [`super::repair`]: one operand) would cost.
pub fn plan(operands: &[TriMesh], options: &Options) -> Result<Plan, Error> {
    plan_with(operands, options, Offsets::default())
}

/// What [`super::morphology`] would cost.
pub fn plan_morphology(input: &TriMesh, options: &MorphologyOptions) -> Result<Plan, Error> {
    let offsets = Offsets { count: options.operation.offsets(), radius: super::morphology::usable(options.radius)? };
    plan_with(std::slice::from_ref(input), &options.solid, offsets)
}

/// What [`super::canals`] would cost.
pub fn plan_canals(input: &TriMesh, options: &CanalOptions) -> Result<Plan, Error> {
    let radius = super::morphology::usable(options.max_diameter / 2.0)?;
    plan_with(std::slice::from_ref(input), &options.solid, Offsets { count: 2, radius })
}

/// What [`super::thicken`] would cost.
pub fn plan_thicken(input: &TriMesh, options: &ThickenOptions) -> Result<Plan, Error> {
    let radius = super::morphology::usable(options.least / 2.0)?;
    plan_with(std::slice::from_ref(input), &options.solid, Offsets { count: 1, radius })
}

fn plan_with(operands: &[TriMesh], options: &Options, offsets: Offsets) -> Result<Plan, Error> {
    let lattice = prepare::lattice(&prepare::bounds(operands)?, options.voxel)?;
    Ok(Input::of(operands).cost(&lattice, offsets))
}

/// An error when the run would need more memory than allowed, or more than 32 bits to number things.
pub(super) fn check_limits(
    operands: &[TriMesh],
    lattice: &Lattice,
    options: &Options,
    offsets: Offsets,
) -> Result<(), Error> {
    let input = Input::of(operands);
    input.check_numbers(lattice)?;
    let Some(allowed) = options.max_memory else { return Ok(()) };
    let needed = input.cost(lattice, offsets).memory;
    if needed <= allowed {
        return Ok(());
    }
    let bounds = prepare::bounds(operands)?;
    let mut voxel_that_fits = None;
    let mut h = lattice.h;
    while h < bounds.size().max_element() {
        h *= 1.1;
        if input.cost(&Lattice::around(&bounds, h), offsets).memory <= allowed {
            voxel_that_fits = Some(h);
            break;
        }
    }
    Err(Error::Memory { needed, allowed, voxel_that_fits })
}

/// The same for one operand, before anything is done.
pub(super) fn check_offsets(input: &TriMesh, options: &Options, offsets: Offsets) -> Result<(), Error> {
    let operands = std::slice::from_ref(input);
    let lattice = prepare::lattice(&prepare::bounds(operands)?, options.voxel)?;
    check_limits(operands, &lattice, options, offsets)
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
        let plan = self.cost(lattice, Offsets::default());
        let memory = (VOTES_MEMORY * plan.memory as f64) as u64;
        Plan { seconds: VOTES_SECONDS * plan.seconds, memory, ..plan }
    }

    fn cost(&self, lattice: &Lattice, offsets: Offsets) -> Plan {
        // No more surface is kept than the lattice has cells; the crossings are there all the same.
        let surface = self.surface(lattice);
        let cells = surface.min(lattice.dims.as_dvec3().element_product());
        let buried = (surface - cells).max(0.0) * CROSSINGS_PER_CELL * BYTES_PER_CROSSING;
        let rays = DIRECTIONS.iter().map(|d| d.ray_window(lattice.dims).1.map(f64::from));
        let rays: f64 = rays.map(|[u, v]| u * v).sum();
        let triangles = self.triangles as f64;
        let memory = BASE_BYTES + 4.2 * rays + BYTES_PER_CELL * cells + buried + BYTES_PER_TRIANGLE * triangles;
        let count = f64::from(offsets.count);
        let per_cell = OFFSET_BYTES_PER_CELL + OFFSET_BYTES_PER_CELL_AND_RADIUS * offsets.radius / lattice.h;
        let memory = memory + count * (per_cell * cells + OFFSET_BYTES_PER_TRIANGLE * triangles);
        let seconds = SECONDS_PER_CELL * cells + SECONDS_PER_TRIANGLE * triangles;
        Plan {
            voxel: lattice.h,
            dims: lattice.dims.to_array(),
            voxels_near_surface: (2.0 * cells) as u64,
            triangles: (TRIANGLES_PER_CELL * cells) as u64,
            memory: memory as u64,
            seconds: seconds * (1.0 + OFFSET_SECONDS * count),
        }
    }
}

/// Square model units.
pub(super) fn area(mesh: &TriMesh) -> f64 {
    let double = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    (0..mesh.triangles.len()).map(double).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::morphology::Operation;
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
        assert_eq!(check_limits(&layers, &lattice(256), &options, Offsets::default()), Ok(()));
        assert!(matches!(
            check_limits(&layers, &lattice(4000), &options, Offsets::default()),
            Err(Error::TooLarge { .. })
        ));
    }

    #[test]
    fn the_voxel_that_fits_is_the_smallest_of_its_series_that_does() {
        let input = [stack(4)];
        let bounds = prepare::bounds(&input).expect("bounds");
        let lattice = prepare::lattice(&bounds, VoxelSize::Along(500)).expect("a lattice");
        let needed = Input::of(&input).cost(&lattice, Offsets::default()).memory;
        let allowed = needed / 2;
        let options = Options { max_memory: Some(allowed), ..Options::new(VoxelSize::Along(500)) };
        let Err(Error::Memory { voxel_that_fits: Some(h), .. }) =
            check_limits(&input, &lattice, &options, Offsets::default())
        else {
            panic!("allowed");
        };
        let at = |h: f64| Input::of(&input).cost(&Lattice::around(&bounds, h), Offsets::default()).memory;
        assert!(at(h) <= allowed && at(h / 1.1) > allowed);
    }

    #[test]
    fn offsets_cost_more_the_more_and_the_larger_they_are() {
        let input = stack(4);
        let solid = Options::new(VoxelSize::Along(64));
        let of = |operation, radius| {
            let options = MorphologyOptions { operation, radius, mitre: None, solid: solid.clone() };
            plan_morphology(&input, &options).expect("a plan")
        };
        let plain = plan(std::slice::from_ref(&input), &solid).expect("a plan");
        let costs = [plain, of(Operation::Dilate, 0.1), of(Operation::Close, 0.1), of(Operation::Close, 0.2)];
        assert!(costs.is_sorted_by(|a, b| a.memory < b.memory && a.seconds <= b.seconds), "{costs:?}");
        let options = Options { max_memory: Some(plain.memory), ..solid.clone() };
        assert_eq!(check_offsets(&input, &options, Offsets::default()), Ok(()));
        let refused = check_offsets(&input, &options, Offsets { count: 1, radius: 0.1 });
        assert!(matches!(refused, Err(Error::Memory { voxel_that_fits: Some(_), .. })), "{refused:?}");
    }
}
