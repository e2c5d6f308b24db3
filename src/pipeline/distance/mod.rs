//! From a mesh to its signed distance over a lattice.

mod error;
mod options;

pub use error::DistanceError;
pub use options::{DistanceMethod, DistanceOptions, DistanceSign};

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use serde::Serialize;

use crate::backend::{self, Backend, FieldError};
use crate::digits;
use crate::lattice::{BRICK, DistanceField, Grid, Lattice, Slot};
use crate::ldi::{Expression, MAX_VOXELS};
use crate::mesh::{TriMesh, ValidateOptions, validate};
use crate::orient::OrientReport;
use crate::pipeline::account::refuse_scattered;
use crate::pipeline::frame::Frame;
use crate::pipeline::plan::{BASE_BYTES, Input};
use crate::pipeline::stages::Stages;
use crate::pipeline::{LatticeError, LimitError, StageTime, sizing};
use crate::progress::{Progress, Stage, Stopped};
use crate::sdf::exact::{self, Band, ExactOptions, Sign};
use crate::sdf::{self, Levels, RobustOptions, characteristics, levels_memory};
use crate::survey::{Cast, Soup, Survey};
use crate::vote::{VoteReport, VoteRule, doubts};

/// Bytes per h² of surface and per triangle that are there besides the field, for each way to the sides.
const VOTES_BYTES: [f64; 2] = [190.0, 540.0];
const WINDING_BYTES: [f64; 2] = [220.0, 100.0];
const LEVELS_BYTES: [f64; 2] = [130.0, 50.0];
const ROBUST_BYTES: [f64; 2] = [480.0, 270.0];
/// Bytes per stored voxel of the marched field: the field, what is done, and the front.
const MARCHED_BYTES: f64 = 10.5;
/// Seconds per stored voxel of the marched field.
const MARCHED_SECONDS: f64 = 1200e-9;
/// Seconds per stored voxel for the winding number.
const WINDING_SECONDS: f64 = 150e-9;

/// A field and how it came about.
#[derive(Debug, Clone)]
pub struct DistanceOutcome {
    /// The signed distance, on a lattice that reaches as far around the mesh as the band.
    pub field: DistanceField,
    /// What was found and done.
    pub report: DistanceReport,
}

/// The account of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DistanceReport {
    /// Position of the first voxel, model units.
    pub origin: [f64; 3],
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z.
    pub dims: [i32; 3],
    /// Values are clamped to ± this, model units; `None`: they are not.
    pub band: Option<f64>,
    /// Voxels whose distance is stored.
    pub stored: usize,
    /// Voxels of the lattice that lie inside.
    pub inside: usize,
    /// The smallest and the largest value, model units.
    pub range: [f32; 2],
    /// Cleaning and orientation; `None` where the mesh was taken as it is.
    pub orient: Option<OrientReport>,
    /// The votes, where there were any.
    pub vote: Option<VoteReport>,
    /// Which processor made the field, where there is a choice.
    pub made_by: Option<backend::BackendReport>,
    /// Wall-clock time of each stage, in order. Not written with the rest, as in [`super::Report::stages`].
    #[serde(skip)]
    pub stages: Vec<StageTime>,
}

/// What a field would cost, before it is made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DistancePlan {
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z.
    pub dims: [i32; 3],
    /// Estimated voxels whose distance is stored.
    pub stored: u64,
    /// Bytes of the numbers in a file.
    pub file: u64,
    /// Estimated peak memory, bytes.
    pub memory: u64,
    /// Estimated seconds on one core of an ordinary machine.
    pub seconds: f64,
}

/// What [`distance`] would cost.
pub fn plan_distance(input: &TriMesh, options: &DistanceOptions) -> Result<DistancePlan, DistanceError> {
    let (lattice, band) = place(input, options)?;
    Ok(plan(input, &lattice, band, options))
}

/// The signed distance to one mesh. All its shells together are one solid.
///
/// # Errors
/// See [`DistanceError`].
pub fn distance(
    input: &TriMesh,
    options: &DistanceOptions,
    progress: &Progress,
) -> Result<DistanceOutcome, DistanceError> {
    input.check()?;
    check_closed(input, options.method, progress)?;
    let frame = input.bounds().map_or_else(Frame::default, |bounds| Frame::around(&bounds));
    let input = &*frame.local(input);
    let (lattice, band) = place(input, options)?;
    check_planes(options, &lattice)?;
    let needed = plan(input, &lattice, band, options).memory;
    if let Some(allowed) = options.max_memory.filter(|&allowed| needed > allowed) {
        return Err(LimitError::Memory { needed, allowed, voxel_that_fits: None }.into());
    }
    let mut stages = Stages::new(progress);
    let run = Making { lattice, band, options, progress };
    let mut report = DistanceReport::default();
    let field = match (options.method, options.sign) {
        (DistanceMethod::Exact, DistanceSign::Pseudonormal) => {
            stages.begin(Stage::Distance)?;
            run.exact(input, Sign::Pseudonormal, &mut report)?
        }
        (DistanceMethod::Characteristics, _) => {
            stages.begin(Stage::Distance)?;
            run.characteristics(input)?
        }
        (DistanceMethod::Prism, _) => {
            stages.begin(Stage::Distance)?;
            run.prism(input)?
        }
        _ => run.of_soup(input, &mut stages, &mut report)?,
    };
    report.stages = stages.finish();
    let field = DistanceField { lattice: frame.global_lattice(lattice), ..field };
    let field = match options.planes {
        Some(planes) => planes_of(field, planes),
        None => field,
    };
    let mut outcome = DistanceOutcome { field, report };
    outcome.report.vote.iter_mut().for_each(|vote| frame.votes(vote));
    outcome.describe(band);
    Ok(outcome)
}

/// Refuses planes that are not there, that cut bricks, and those of methods that need the whole.
fn check_planes(options: &DistanceOptions, lattice: &Lattice) -> Result<(), DistanceError> {
    let Some([from, to]) = options.planes else { return Ok(()) };
    let there = lattice.dims.z as u32;
    let right = from < to && to <= there && from.is_multiple_of(BRICK as u32);
    match right && options.method == DistanceMethod::Exact && options.backend != Backend::Gpu {
        true => Ok(()),
        false => Err(DistanceError::Planes { from, to, there }),
    }
}

/// Some planes of a field.
fn planes_of(field: DistanceField, [from, to]: [u32; 2]) -> DistanceField {
    let mut lattice = field.lattice;
    lattice.origin.z += f64::from(from) * lattice.h;
    lattice.dims.z = (to - from) as i32;
    let bricks = field.grid.bricks.counted_from(IVec3::new(0, 0, from as i32 / BRICK));
    DistanceField { lattice, grid: Grid { bricks: Arc::new(bricks), ..field.grid }, ..field }
}

/// Refuses a surface that the method would give a wrong field for.
fn check_closed(input: &TriMesh, method: DistanceMethod, progress: &Progress) -> Result<(), DistanceError> {
    if !method.is_for_closed() {
        return Ok(());
    }
    let look = ValidateOptions { self_intersections: false, weld: true };
    let validity = validate(input, &look, progress)?;
    if validity.is_oriented_manifold() {
        return Ok(());
    }
    let problem = validity.problems().first().map_or_else(|| "It is not.".into(), String::clone);
    Err(DistanceError::NotClosed { method, problem })
}

/// The lattice, grown by the band, and the band in h.
fn place(input: &TriMesh, options: &DistanceOptions) -> Result<(Lattice, Band), DistanceError> {
    let mut lattice = sizing::lattice(&sizing::bounds([input]).map_err(|_| DistanceError::Empty)?, options.voxel)?;
    let Some(length) = options.band else { return Ok((lattice, Band::Full)) };
    let band = length / lattice.h;
    let longest = f64::from(lattice.dims.max_element());
    if !(band > 0.0 && longest + 2.0 * band + 2.0 < f64::from(MAX_VOXELS)) {
        let along = longest + 2.0 * band;
        return Err(LatticeError::WideBand { band: digits::number(length), along, or: " `full`," }.into());
    }
    let room = band.ceil() as i32;
    lattice.origin -= DVec3::splat(f64::from(room) * lattice.h);
    lattice.dims += 2 * room;
    Ok((lattice, Band::Within(band)))
}

fn plan(input: &TriMesh, lattice: &Lattice, band: Band, options: &DistanceOptions) -> DistancePlan {
    let exact = match (options.method, options.planes) {
        (DistanceMethod::Characteristics, _) => characteristics::cost(input, lattice, band),
        (_, Some(planes)) => exact::cost_of_planes(input, lattice, band, planes),
        _ => exact::cost(input, lattice, band),
    };
    let all = lattice.dims.as_dvec3().element_product();
    let (mut memory, mut seconds) = (BASE_BYTES + exact.memory as f64, exact.seconds);
    let surface = Input::of(&[input]);
    let (cells, triangles, voxels) = (surface.cells(lattice), input.triangles.len() as f64, exact.voxels as f64);
    if options.votes() {
        seconds += surface.votes_seconds(lattice);
    }
    let beside = |[cell, triangle]: [f64; 2]| cell * cells + triangle * triangles;
    match (options.method, options.sign) {
        (DistanceMethod::Robust, _) => {
            memory = BASE_BYTES + beside(ROBUST_BYTES) + MARCHED_BYTES * voxels;
            seconds += MARCHED_SECONDS * voxels;
        }
        (DistanceMethod::Exact, DistanceSign::Votes) => memory += beside(VOTES_BYTES),
        (DistanceMethod::Exact, DistanceSign::Winding) => {
            memory += beside(WINDING_BYTES);
            seconds += WINDING_SECONDS * voxels;
        }
        (DistanceMethod::Exact, DistanceSign::Levels) => {
            memory += beside(LEVELS_BYTES) + levels_memory(lattice, input.triangles.len()) as f64;
        }
        _ => {}
    }
    DistancePlan {
        voxel: lattice.h,
        dims: lattice.dims.to_array(),
        stored: exact.voxels,
        file: (4.0 * all) as u64,
        memory: memory as u64,
        seconds,
    }
}

/// What the ways to a field share.
struct Making<'a> {
    lattice: Lattice,
    band: Band,
    options: &'a DistanceOptions,
    progress: &'a Progress,
}

impl Making<'_> {
    fn exact(
        &self,
        mesh: &TriMesh,
        sign: Sign<'_>,
        report: &mut DistanceReport,
    ) -> Result<DistanceField, DistanceError> {
        let options = ExactOptions { band: self.band, max_memory: None };
        if let Some(planes) = self.options.planes {
            let planes = planes.map(|plane| plane as i32);
            return Ok(exact::exact_planes(mesh, &self.lattice, sign, &options, planes, self.progress)?);
        }
        let made = backend::exact(mesh, &self.lattice, sign, &options, self.options.backend, self.progress);
        let (field, made_by) = made.map_err(|error| match error {
            FieldError::Field(error) => error.into(),
            FieldError::Gpu { reason, hint } => DistanceError::Device { reason, hint },
        })?;
        report.made_by = Some(made_by);
        Ok(field)
    }

    fn characteristics(&self, mesh: &TriMesh) -> Result<DistanceField, DistanceError> {
        let options = ExactOptions { band: self.band, max_memory: None };
        Ok(characteristics::characteristics(mesh, &self.lattice, &options, self.progress)?)
    }

    fn prism(&self, mesh: &TriMesh) -> Result<DistanceField, DistanceError> {
        let options = ExactOptions { band: self.band, max_memory: None };
        Ok(sdf::prism::prism(mesh, &self.lattice, &options, self.progress)?)
    }

    /// By way of orientation, rays and votes.
    fn of_soup(
        &self,
        input: &TriMesh,
        stages: &mut Stages<'_>,
        report: &mut DistanceReport,
    ) -> Result<DistanceField, DistanceError> {
        let (progress, orient, lattice) = (self.progress, self.options.orient, &self.lattice);
        stages.begin(Stage::Orient)?;
        let soup = Soup::of(&[input], orient, progress)?.with_inside(self.options.inside);
        stages.begin(Stage::Ldi)?;
        let mut cast = Cast::on_cpu(soup, lattice, orient, progress)?;
        report.orient = cast.soup.reports.first().cloned();
        let expression = Expression::Operand(0);
        match (self.options.method, self.options.sign) {
            (DistanceMethod::Exact, DistanceSign::Winding) => {
                cast.layers.clear();
                stages.begin(Stage::Distance)?;
                return self.exact(&cast.soup.mesh, Sign::Winding(&cast.winding(progress), &expression), report);
            }
            (DistanceMethod::Exact, DistanceSign::Levels) => {
                cast.layers.clear();
                stages.begin(Stage::Levels)?;
                let levels = Levels::of(&cast.soup.mesh, lattice, self.options.inside, progress)?;
                stages.begin(Stage::Distance)?;
                return self.exact(&cast.soup.mesh, Sign::Levels(&levels), report);
            }
            _ => {}
        }
        stages.begin(Stage::Spans)?;
        let mut survey = Survey::of(cast, &expression, progress)?;
        refuse_scattered(&survey)?;
        stages.begin(Stage::Vote)?;
        let votes = survey.votes(VoteRule::Winding, &survey.winding(progress), progress)?;
        report.vote = Some(doubts(&votes, lattice));
        stages.begin(Stage::Distance)?;
        match self.options.method {
            DistanceMethod::Exact | DistanceMethod::Characteristics | DistanceMethod::Prism => {
                self.exact(&survey.soup.mesh, Sign::Votes(&votes), report)
            }
            DistanceMethod::Robust => {
                let (options, planes) = (RobustOptions::default(), survey.planes());
                let near = sdf::robust(&survey.spans, &planes, (&votes, lattice), &options, progress)?;
                survey.spans.clear();
                Ok(self.march(&near)?)
            }
        }
    }

    /// Extends the robust field to the band, or to the whole lattice.
    fn march(&self, near: &DistanceField) -> Result<DistanceField, Stopped> {
        let reach = match self.band {
            Band::Within(h) => h as f32,
            Band::Full => self.lattice.dims.as_vec3().length() + BRICK as f32,
        };
        let mut field = sdf::march(near, reach, self.progress)?;
        if let Band::Within(h) = self.band {
            // Marching goes a little beyond narrow bands.
            let band = h as f32;
            field.grid.values.par_iter_mut().flatten().for_each(|value| *value = value.clamp(-band, band));
            (field.grid.inside, field.grid.outside) = (-band, band);
        }
        Ok(field)
    }
}

impl DistanceOutcome {
    /// Appends the values of plane `z` of the lattice, model units, x fastest, then y.
    pub fn plane(&self, z: usize, values: &mut Vec<f32>) {
        let grid = &self.field.grid;
        let [width, height] = [self.field.lattice.dims.x as usize, self.field.lattice.dims.y as usize];
        let start = values.len();
        values.resize(start + width * height, 0.0);
        let (z, layer) = (z as i32 / BRICK, z % BRICK as usize);
        let scaled = |value: f32| self.field.length(value) as f32;
        for (y, rows) in values[start..].chunks_mut(8 * width).enumerate() {
            for x in 0..width.div_ceil(8) {
                let slot = grid.bricks.slot(IVec3::new(x as i32, y as i32, z));
                for (row, values) in rows.chunks_mut(width).enumerate() {
                    let values = &mut values[8 * x..width.min(8 * x + 8)];
                    match slot {
                        Slot::Active(n) => {
                            let brick = &grid.values[n as usize][64 * layer + 8 * row..];
                            values.iter_mut().zip(brick).for_each(|(value, &from)| *value = scaled(from));
                        }
                        Slot::Inside => values.fill(scaled(grid.inside)),
                        Slot::Outside => values.fill(scaled(grid.outside)),
                    }
                }
            }
        }
    }

    /// A field with its report filled in.
    pub(super) fn described(field: DistanceField, band: Band, report: DistanceReport) -> Self {
        let mut outcome = Self { field, report };
        outcome.describe(band);
        outcome
    }

    /// Fills in what the report says of the field.
    fn describe(&mut self, band: Band) {
        let planes = (0..self.field.lattice.dims.z as usize).into_par_iter();
        let of_plane = |z| {
            let mut values = Vec::new();
            self.plane(z, &mut values);
            let start = (0usize, [f32::INFINITY, f32::NEG_INFINITY]);
            values
                .iter()
                .fold(start, |(inside, [low, high]), &v| (inside + usize::from(v < 0.0), [low.min(v), high.max(v)]))
        };
        let parts: Vec<(usize, [f32; 2])> = planes.map(of_plane).collect();
        let (report, lattice) = (&mut self.report, &self.field.lattice);
        report.origin = lattice.origin.to_array();
        report.voxel = lattice.h;
        report.dims = lattice.dims.to_array();
        report.band = if let Band::Within(h) = band { Some(h * lattice.h) } else { None };
        report.stored = self.field.grid.values.len() * crate::lattice::BRICK_VOXELS;
        report.inside = parts.iter().map(|part| part.0).sum();
        let range = parts.iter().map(|part| part.1);
        report.range = range.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], [low, high]| [a.min(low), b.max(high)]);
    }
}
