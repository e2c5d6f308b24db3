//! What a run costs, estimated before anything is allocated.

use glam::DVec3;
use serde::Serialize;

use super::ahead::{Ahead, Way};
use super::frame::Frame;
use super::outlook::Outlook;
use super::rates::{COMBINED, KEPT, OFFSET, OFFSET_AND_BACK, REBUILT, Rates, SURVEYED, THICKENED, UNFITTED};
use super::{BooleanError, LimitError, Method, Operand, Options, SurfaceOptions, VoxelSize, sizing};
use crate::lattice::Lattice;
use crate::ldi::{MAX_CROSSINGS, MAX_TRIANGLES};
use crate::mesh::{Bounds, TriMesh};
use crate::progress::Progress;

/// What a run would cost, before it is run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z.
    pub dims: [i32; 3],
    /// Whether what touches or crosses is cut exactly: without voxels, unless there are operands with holes, which are made whole first.
    pub exact: bool,
    /// Triangles that touch others, as far as that was looked for.
    pub touching: u64,
    /// Estimated voxels near the surface.
    pub voxels_near_surface: u64,
    /// Estimated triangles of the result.
    pub triangles: u64,
    /// Estimated peak memory, bytes.
    pub memory: u64,
    /// Bytes below which the run is refused: of an exact one, whose memory depends on what crosses what, those that its triangles take alone; of one with
    /// voxels that keeps triangles, what its rays take, after which it is known how much is to be made.
    pub least_memory: u64,
    /// Estimated seconds on one core of an ordinary machine.
    pub seconds: f64,
}

impl Plan {
    /// Of two runs one after the other: what the first needed is free when the second begins.
    pub fn then(self, next: Self) -> Self {
        Self {
            memory: self.memory.max(next.memory),
            least_memory: self.least_memory.max(next.least_memory),
            seconds: self.seconds + next.seconds,
            ..next
        }
    }
}

/// Bytes of the program itself, its threads and what it reads into.
pub(super) const BASE_BYTES: f64 = 11e6;
/// Crossings of the rays of all 13 directions per h² of surface, whichever way it lies: 8.5 to 9.3.
const CROSSINGS_PER_CELL: f64 = 9.3;
/// Bytes per crossing, for surface beyond what the lattice has cells for: many layers on few rays.
const BYTES_PER_CROSSING: f64 = 50.0;

/// The band of an offset is this much wider than its radius, h.
const OFFSET_MARGIN: f64 = 4.0;

/// Bytes per triangle of shells that stay as they are, at the peak: it is there in the file, in the soup, in the trees of the searches for
/// contacts, and in the file that is written.
const STANDING_BYTES: f64 = 600.0;
/// And those that each takes at least, whatever the format.
const LEAST_BYTES: f64 = 500.0;

/// Seconds on two cores per h² of surface that is built anew, fit included.
const SECONDS_PER_CELL: f64 = 22e-6;
/// The same where most triangles stay, and besides per h² of lids that lie in no plane, per triangle that touches others, and per triangle of the input. Of the
/// 15 broken meshes of the data set at 256 voxels 13 take between half and twice of that.
const SECONDS_PER_KEPT_CELL: f64 = 10e-6;
const SECONDS_PER_LID_CELL: f64 = 40e-6;
const SECONDS_PER_CONTACT: f64 = 1e-3;
const SECONDS_PER_TRIANGLE: f64 = 3e-6;
/// Whatever stands as it is: to start, and per triangle.
const STANDING_SECONDS: [f64; 2] = [0.008, 5e-6];
/// Of that what is spent up to the votes.
const VOTES_SECONDS: f64 = 0.2;
/// Triangles of the result per h² of surface that is built anew.
const TRIANGLES_PER_CELL: f64 = 2.2;
/// Where most triangles stay, triangles besides those of the input: per h² of lids that lie in no plane, of others, and per triangle that touches
/// others, whose surroundings are built anew. Of the 33 meshes of the data set at 256 voxels 25 come within a factor of 2.
const TRIANGLES_PER_LID_CELL: f64 = 1.0;
const TRIANGLES_PER_FLAT_CELL: f64 = 0.2;
const TRIANGLES_PER_CONTACT: f64 = 3.0;
/// How many times the seconds an offset adds.
const OFFSET_SECONDS: f64 = 5.0;

/// Offsets of the solid that are made after it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Offsets {
    /// How many.
    pub count: u32,
    /// Their radius, model units.
    pub radius: f64,
    /// Whether they are made only where walls are thin.
    pub thin: bool,
}

impl Offsets {
    fn rates(self) -> Option<&'static Rates> {
        match (self.count, self.thin) {
            (0, _) => None,
            (_, true) => Some(&THICKENED),
            (1, false) => Some(&OFFSET),
            _ => Some(&OFFSET_AND_BACK),
        }
    }
}

/// What [`boolean`](super::boolean) would cost, and [`repair`](super::repair): with one operand.
///
/// # Errors
/// Those that the run would have before anything is made.
pub fn plan<'a>(operands: impl IntoIterator<Item: Into<Operand<'a>>>, options: &Options) -> Result<Plan, BooleanError> {
    let given: Vec<&TriMesh> = operands.into_iter().map(|operand| operand.into().mesh).collect();
    let frame = Frame::of(&given, &options.surface());
    let local: Vec<_> = given.iter().map(|mesh| frame.local(mesh)).collect();
    let meshes: Vec<&TriMesh> = local.iter().map(AsRef::as_ref).collect();
    let bounds = sizing::bounds(meshes.iter().copied()).map_err(|operand| BooleanError::Empty { operand })?;
    let h = sizing::spacing(&bounds, options.voxel)?;
    seen(&meshes, &Ahead::of(&meshes, options, &Progress::none())?, options, h)
}

/// What a run over operands near the origin would cost, once they have been looked at.
pub(super) fn seen(meshes: &[&TriMesh], ahead: &Ahead, options: &Options, h: f64) -> Result<Plan, BooleanError> {
    let &Ahead { ref rest, ref way, touching, .. } = ahead;
    let given = Input::of(meshes).triangles;
    match way {
        Way::Exact => return Ok(Plan::of_exact(h, given, touching)),
        Way::Sealed(open) => {
            let alone = Options { method: Method::Auto, voxel: VoxelSize::Length(h), ..*options };
            let parts = open.iter().map(|&n| plan([meshes[n]], &alone)).collect::<Result<Vec<Plan>, _>>()?;
            return Ok(Plan::of_sealed(parts.into_iter(), Plan::of_exact(h, given, touching)));
        }
        Way::Voxel => {}
    }
    let standing = given.saturating_sub(rest.triangles.len());
    let Some(bounds) = rest.bounds() else { return Ok(Plan::of_standing(h, standing)) };
    let lattice = sizing::lattice(&bounds, VoxelSize::Length(h))?;
    let input = Input { touching, ..Input::surveyed(&[rest]) };
    let plan = input.cost(&lattice, &options.surface(), Offsets::default());
    let standing_memory = (STANDING_BYTES * standing as f64) as u64;
    let memory = plan.memory + standing_memory;
    let survey = || input.memory(&SURVEYED, &lattice, 0.0) as u64 + standing_memory;
    let least_memory = if options.keeps() { survey().min(memory) } else { memory };
    Ok(Plan { triangles: plan.triangles + standing as u64, touching: touching as u64, memory, least_memory, ..plan })
}

/// What offsets of a solid would cost, over a lattice around the mesh of a solid that exists, or of one that will be about where `mesh` is.
pub(super) fn of_offsets(mesh: &TriMesh, lattice: &Lattice, options: &SurfaceOptions, offsets: Offsets) -> Plan {
    Input::surveyed(&[mesh]).offsets_cost(lattice, options, offsets)
}

impl Plan {
    /// For shells that stand as they are, without a lattice.
    pub(super) fn of_standing(h: f64, triangles: usize) -> Self {
        let memory = |each: f64| (BASE_BYTES + each * triangles as f64) as u64;
        Self {
            voxel: h,
            dims: [0; 3],
            exact: false,
            touching: 0,
            voxels_near_surface: 0,
            triangles: triangles as u64,
            memory: memory(STANDING_BYTES),
            least_memory: memory(LEAST_BYTES),
            seconds: STANDING_SECONDS[0] + STANDING_SECONDS[1] * triangles as f64,
        }
    }
}

/// An error when shells that stand as they are would need more memory than allowed.
pub(super) fn check_standing(operands: &[&TriMesh], max_memory: Option<u64>) -> Result<(), LimitError> {
    let triangles = operands.iter().map(|operand| operand.triangles.len()).sum();
    let needed = Plan::of_standing(0.0, triangles).least_memory;
    match max_memory {
        Some(allowed) if needed > allowed => Err(LimitError::Memory { needed, allowed, voxel_that_fits: None }),
        _ => Ok(()),
    }
}

/// An error when the run would need more memory than allowed, or more than 32 bits to number things. With offsets the operand is the solid
/// that they are made of.
pub(super) fn check_limits(
    operands: &[&TriMesh],
    lattice: &Lattice,
    options: &SurfaceOptions,
    offsets: Offsets,
) -> Result<(), LimitError> {
    let input = Input::of(operands);
    input.check_numbers(lattice)?;
    let Some(allowed) = options.max_memory else { return Ok(()) };
    check_memory(operands, lattice, allowed, 1.0, &|input, lattice, _| input.cost(lattice, options, offsets).memory)
}

/// An error when rays, and the making of a share of the surface (0 to 1), most of which stays as it is, would need more memory than allowed, or more than 32 bits to number things.
pub(super) fn check_share(
    operands: &[&TriMesh],
    lattice: &Lattice,
    options: &SurfaceOptions,
    share: f64,
) -> Result<(), LimitError> {
    Input::of(operands).check_numbers(lattice)?;
    let Some(allowed) = options.max_memory else { return Ok(()) };
    check_memory(operands, lattice, allowed, share, &|input, lattice, share| {
        let (survey, all) = (input.memory(&SURVEYED, lattice, 0.0), input.memory(input.rates(options), lattice, 0.0));
        (survey + share * (all - survey).max(0.0)) as u64
    })
}

/// An error when `cost`, bytes, for a share of the surface is more than allowed.
fn check_memory(
    operands: &[&TriMesh],
    lattice: &Lattice,
    allowed: u64,
    share: f64,
    cost: &dyn Fn(&Input, &Lattice, f64) -> u64,
) -> Result<(), LimitError> {
    // Most runs are allowed more than the worst surface of this size needs, and nothing is to be looked at.
    if cost(&Input::of(operands), lattice, share) <= allowed {
        return Ok(());
    }
    let input = Input::surveyed(operands);
    let needed = cost(&input, lattice, share);
    if needed <= allowed {
        return Ok(());
    }
    let bounds = operands.iter().filter_map(|mesh| mesh.bounds()).reduce(|a, b| a.union(&b));
    let fits = |bounds: &Bounds| {
        let coarser = std::iter::successors(Some(1.1 * lattice.h), |h| Some(1.1 * h));
        let mut possible = coarser.take_while(|h| h / 1.1 < bounds.size().max_element());
        // What is advised fits whatever share of the surface is made.
        possible.find(|&h| cost(&input, &Lattice::around(bounds, h), 1.0) <= allowed)
    };
    Err(LimitError::Memory { needed, allowed, voxel_that_fits: bounds.as_ref().and_then(fits) })
}

/// How often the rays of all directions cross the operands, about.
pub(super) fn crossings(operands: &[&TriMesh], lattice: &Lattice) -> f64 {
    Input::of(operands).crossings(lattice)
}

/// What the cost depends on, apart from the lattice.
pub(super) struct Input {
    operands: usize,
    triangles: usize,
    vertices: usize,
    /// Triangles that touch others, as far as that is known.
    touching: usize,
    /// Square model units.
    area: f64,
    /// What of it has to be made; without it the worst is assumed.
    outlook: Option<Outlook>,
}

impl Input {
    pub(super) fn of(operands: &[&TriMesh]) -> Self {
        Self {
            operands: operands.len(),
            triangles: operands.iter().map(|m| m.triangles.len()).sum(),
            vertices: operands.iter().map(|m| m.positions.len()).sum(),
            touching: 0,
            area: operands.iter().map(|mesh| area(mesh)).sum(),
            outlook: None,
        }
    }

    /// The same, with a look at holes and bends.
    fn surveyed(operands: &[&TriMesh]) -> Self {
        Self { outlook: Some(Outlook::of_all(operands)), ..Self::of(operands) }
    }

    /// Area in h².
    fn surface(&self, lattice: &Lattice) -> f64 {
        self.area / (lattice.h * lattice.h)
    }

    fn crossings(&self, lattice: &Lattice) -> f64 {
        CROSSINGS_PER_CELL * self.surface(lattice)
    }

    fn check_numbers(&self, lattice: &Lattice) -> Result<(), LimitError> {
        let (triangles, vertices) = (self.triangles, self.vertices);
        if triangles > MAX_TRIANGLES || vertices > u32::MAX as usize {
            return Err(LimitError::Triangles { triangles, vertices });
        }
        // Half of what can be numbered: the estimate leaves out what lies along the triangles' sides.
        let crossings = self.crossings(lattice);
        if crossings > MAX_CROSSINGS as f64 / 2.0 {
            return Err(LimitError::Crossings { crossings });
        }
        Ok(())
    }

    /// Seconds for orientation, rays and votes.
    pub(super) fn votes_seconds(&self, lattice: &Lattice) -> f64 {
        VOTES_SECONDS * self.rebuild_seconds(self.cells(lattice))
    }

    /// No more surface is kept than the lattice has cells.
    pub(super) fn cells(&self, lattice: &Lattice) -> f64 {
        self.surface(lattice).min(lattice.dims.as_dvec3().element_product())
    }

    fn rebuild_seconds(&self, cells: f64) -> f64 {
        SECONDS_PER_CELL * cells + SECONDS_PER_TRIANGLE * self.triangles as f64
    }

    /// Seconds, and triangles of the result, where most triangles stay.
    fn kept(&self, lattice: &Lattice, cells: f64) -> (f64, f64) {
        let area = lattice.h * lattice.h;
        let (curved, flat) =
            self.outlook.as_ref().map_or((cells, 0.0), |s| (s.curved_lids / area, (s.lids - s.curved_lids) / area));
        let (triangles, touching) = (self.triangles as f64, self.touching as f64);
        let seconds = SECONDS_PER_KEPT_CELL * cells
            + SECONDS_PER_LID_CELL * curved.min(cells)
            + SECONDS_PER_CONTACT * touching
            + SECONDS_PER_TRIANGLE * triangles;
        let made = TRIANGLES_PER_LID_CELL * curved.min(cells)
            + TRIANGLES_PER_FLAT_CELL * flat.min(cells)
            + TRIANGLES_PER_CONTACT * touching;
        (seconds, triangles + made.min(TRIANGLES_PER_CELL * cells))
    }

    /// Of what is to be done over a lattice: with offsets these, else a boolean, from file to file.
    fn cost(&self, lattice: &Lattice, options: &SurfaceOptions, offsets: Offsets) -> Plan {
        if offsets.count > 0 {
            return self.offsets_cost(lattice, options, offsets);
        }
        let cells = self.cells(lattice);
        let (seconds, triangles) = match &options.fit {
            Some(fit) if !fit.rebuild => self.kept(lattice, cells),
            _ => (self.rebuild_seconds(cells), TRIANGLES_PER_CELL * cells),
        };
        let memory = self.memory(self.rates(options), lattice, 0.0);
        Plan { triangles: triangles as u64, seconds, ..self.sized(lattice, memory) }
    }

    /// Of a boolean of all of the surface.
    fn rates(&self, options: &SurfaceOptions) -> &'static Rates {
        match &options.fit {
            None => &UNFITTED,
            Some(fit) if !fit.rebuild && self.operands > 1 => &COMBINED,
            Some(fit) if !fit.rebuild => &KEPT,
            Some(_) => &REBUILT,
        }
    }

    /// Of offsets of a solid.
    fn offsets_cost(&self, lattice: &Lattice, options: &SurfaceOptions, offsets: Offsets) -> Plan {
        let cells = self.cells(lattice);
        let memory = offsets.rates().map_or(0.0, |rates| self.memory(rates, lattice, offsets.radius / lattice.h));
        let triangles = match &options.fit {
            Some(fit) if !fit.rebuild => self.kept(lattice, cells).1,
            _ => TRIANGLES_PER_CELL * cells,
        };
        let seconds = self.rebuild_seconds(cells) * OFFSET_SECONDS * f64::from(offsets.count);
        Plan { triangles: triangles as u64, seconds, ..self.sized(lattice, memory) }
    }

    fn sized(&self, lattice: &Lattice, memory: f64) -> Plan {
        Plan {
            voxel: lattice.h,
            dims: lattice.dims.to_array(),
            exact: false,
            touching: self.touching as u64,
            voxels_near_surface: (2.0 * self.cells(lattice)) as u64,
            triangles: 0,
            memory: memory as u64,
            least_memory: memory as u64,
            seconds: 0.0,
        }
    }

    /// Bytes at the peak of work that costs `rates`; `radius`: of an offset, h.
    fn memory(&self, rates: &Rates, lattice: &Lattice, radius: f64) -> f64 {
        let (surface, cells) = (self.surface(lattice), self.cells(lattice));
        // The crossings of what is beyond the cells are there all the same.
        let buried = (surface - cells) * CROSSINGS_PER_CELL * BYTES_PER_CROSSING;
        let (lids, bends) = match &self.outlook {
            Some(outlook) => (outlook.lids / (lattice.h * lattice.h), outlook.bent_cells(lattice.h)),
            None => (cells, cells),
        };
        let size = lattice.dims.as_dvec3();
        let sides = size.x * size.y + size.y * size.z + size.z * size.x;
        let reach = radius + OFFSET_MARGIN;
        let band = around(cells, size, reach).min((size + 2.0 * reach).element_product());
        rates.base
            + rates.cell * cells
            + rates.triangle * self.triangles as f64
            + rates.lid * lids.min(cells)
            + rates.bend * bends.min(cells)
            + rates.side * sides
            + rates.voxel * band
            + buried
    }
}

/// Voxels within `r` of a surface of `cells`: on both sides of it, and as much more outside as there is around a box of this
/// size (Steiner).
fn around(cells: f64, size: DVec3, r: f64) -> f64 {
    let pi = std::f64::consts::PI;
    2.0 * cells * r + pi * size.element_sum() * r * r + 4.0 / 3.0 * pi * r.powi(3)
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
    use crate::pipeline::{MorphologyOptions, plan_morphology};
    use glam::DVec3;

    /// Triangles of area ½, one closely over the other.
    fn stack(count: u32) -> TriMesh {
        let layer =
            |k: u32| [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 0.2)].map(|p| p + DVec3::Z * f64::from(k) * 1e-9);
        TriMesh {
            positions: (0..count).flat_map(layer).collect(),
            triangles: (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
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
        let layers = stack(1000);
        let lattice =
            |n| sizing::lattice(&sizing::bounds([&layers]).expect("bounds"), VoxelSize::Along(n)).expect("a lattice");
        let surface = SurfaceOptions::new(VoxelSize::Along(1));
        assert_eq!(check_limits(&[&layers], &lattice(256), &surface, Offsets::default()), Ok(()));
        assert!(matches!(
            check_limits(&[&layers], &lattice(4000), &surface, Offsets::default()),
            Err(LimitError::Crossings { .. })
        ));
    }

    #[test]
    fn the_voxel_that_fits_is_the_smallest_of_its_series_that_does() {
        let input = stack(4);
        let bounds = sizing::bounds([&input]).expect("bounds");
        let lattice = sizing::lattice(&bounds, VoxelSize::Along(500)).expect("a lattice");
        let surface = SurfaceOptions::new(VoxelSize::Along(500));
        let cost = |lattice: &Lattice| Input::surveyed(&[&input]).cost(lattice, &surface, Offsets::default()).memory;
        let allowed = cost(&lattice) / 2;
        let surface = SurfaceOptions { max_memory: Some(allowed), ..surface };
        let Err(LimitError::Memory { voxel_that_fits: Some(h), .. }) =
            check_limits(&[&input], &lattice, &surface, Offsets::default())
        else {
            panic!("allowed");
        };
        let at = |h: f64| cost(&Lattice::around(&bounds, h));
        assert!(at(h) <= allowed && at(h / 1.1) > allowed);
    }

    #[test]
    fn offsets_cost_more_the_more_and_the_larger_they_are() {
        let input = stack(4);
        let options = Options::new(VoxelSize::Along(64));
        let surface = options.surface();
        let plain = plan([&input], &options).expect("a plan");
        let of = |operation, radius| {
            let options = MorphologyOptions { operation, radius, sharp: None, surface };
            plain.then(plan_morphology(&input, &options).expect("a plan"))
        };
        let costs = [plain, of(Operation::Dilate, 0.1), of(Operation::Close, 0.1), of(Operation::Close, 0.2)];
        assert!(costs.is_sorted_by(|a, b| a.memory < b.memory && a.seconds <= b.seconds), "{costs:?}");
        let offsets = Offsets { count: 1, radius: 0.1, thin: false };
        let lattice = sizing::lattice(&sizing::bounds([&input]).expect("bounds"), surface.voxel).expect("a lattice");
        let between = (costs[0].memory + costs[1].memory) / 2;
        let surface = SurfaceOptions { max_memory: Some(between), ..surface };
        let refused = check_limits(&[&input], &lattice, &surface, offsets);
        assert!(matches!(refused, Err(LimitError::Memory { voxel_that_fits: Some(_), .. })), "{refused:?}");
    }
}
