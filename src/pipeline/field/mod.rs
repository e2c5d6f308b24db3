//! From an expression over meshes and grids to a surface, or to a field over a lattice.

mod build;
mod sources;

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use serde::Serialize;

pub use build::{Built, FieldBuilder, FieldOperand};

use super::distance::DistanceOutcome;
use super::frame::Frame;
use super::offsets::volume;
use super::stages::Stages;
use super::{
    BooleanError, DistanceError, DistanceReport, Draft, LatticeError, LimitError, Options, Outcome, Report,
    TriangleCounts, TriangleSource, VoxelSize, refine, sizing,
};
use crate::contour::Ground;
use crate::digits;
use crate::field::language::{self, BuildError};
use crate::field::{Field, FillError, FillOptions, LevelError, Shared, fill, level};
use crate::fit::{Facets, Kept, fit};
use crate::ldi::MAX_VOXELS;
use crate::mesh::{Bounds, IndexError, NotSolid, SolidError};
use crate::progress::{Progress, Stage, Stopped};
use crate::sdf::exact::Band;

/// A lattice that cuts a shape off grows by this part of the shape's extent.
const MORE_ROOM: f64 = 0.3;
/// So often; then the shape has no end.
const MOST_TRIES: usize = 4;
/// Values below this, h, are as good as zero; points farther than the second one, h, are not near.
const NEAR: f64 = 1e-3;
const FAR: f64 = 0.1;
/// A gradient shorter than this says nothing about how far the level is.
const FLAT: f64 = 0.05;

/// Why there is no field, or no surface of it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The voxel size, or the band, cannot be used with these coordinates.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// More memory would be needed than allowed.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// No voxel is inside.
    #[error("the field is nowhere negative on the lattice: nothing is inside, or it is thinner than a voxel")]
    NothingOnLattice,
    /// A function of the expression cannot be made.
    #[error(transparent)]
    Build(BuildError),
    /// An operand could not be repaired.
    #[error(transparent)]
    Repair(BooleanError),
    /// The distance to an operand could not be found.
    #[error(transparent)]
    Distance(DistanceError),
    /// A triangle of an operand refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// What was made is not a valid solid. The fit sees to it that it is; without one, it may not be.
    #[error(transparent)]
    NotSolid(Box<NotSolid>),
}

/// What a field was made of, and what became of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FieldReport {
    /// What was done to the operands before they became fields.
    pub operands: Vec<OperandReport>,
    /// Triangles of the result that lie on no triangle of an operand.
    pub made: usize,
    /// Volume of the result, cubic model units.
    pub volume: f64,
}

/// How an operand became a field.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OperandReport {
    /// Number of the operand.
    pub operand: usize,
    /// What it is: `exact`, `repaired`, `robust`, `levels` or `grid`.
    pub made: &'static str,
}

/// The surface where the field is zero.
///
/// # Errors
/// See [`FieldError`].
pub fn field_surface(
    built: &Built,
    options: &Options,
    progress: &Progress,
) -> Result<(Outcome, FieldReport), FieldError> {
    let mut stages = Stages::new(progress);
    stages.begin(Stage::Field)?;
    let extent = language::shape_extent(&built.field)?;
    let h = field_spacing(built, options)?;
    let frame = Frame::of_box(&extent, &options.surface());
    let mut extent = frame.local_bounds(&extent);
    let field = &*frame.local_field(&built.field);
    let mut tries = 0;
    let (level, lattice) = loop {
        let lattice = sizing::lattice(&extent, VoxelSize::Length(h))?;
        let level = level(field, &lattice, options.max_memory, progress)?;
        if !level.cut_off {
            break (level, lattice);
        }
        tries += 1;
        if tries == MOST_TRIES {
            return Err(BuildError::Endless.into());
        }
        let room = MORE_ROOM * extent.size().max_element();
        extent = Bounds { min: extent.min - room, max: extent.max + room };
    };
    if level.contour.mesh.triangles.is_empty() {
        return Err(FieldError::NothingOnLattice);
    }
    let mut contour = level.contour;
    let sources = &built.sources;
    for (vertex, source) in contour.vertices.iter_mut().zip(&level.sources) {
        if let Some(triangle) = source.and_then(|source| sources.number(source)) {
            vertex.ground = Ground::Triangle(triangle);
        }
    }
    let target = |p: DVec3| off(field, p, lattice.h);
    let source = &*frame.local(&sources.mesh);
    let facets = Facets::new(source, level.planes).with_target(&target);
    stages.begin(Stage::Collapse)?;
    let mut surface = refine::merged(contour, &facets, &lattice, &options.surface(), progress)?;
    let mut fitted = None;
    if let Some(options) = options.fit {
        stages.begin(Stage::Fit)?;
        let options = crate::fit::FitOptions { rebuild: true, ..options };
        let (fit, report) = fit(&surface, &facets, &Kept::default(), lattice.h, &options, progress)?;
        (surface, fitted) = (fit, Some(report));
    }
    let source = |t: u32| sources.origin(surface.facet(&facets, t).and_then(|facet| facets.triangle(facet)));
    let origins: Vec<TriangleSource> = (0..surface.mesh.triangles.len() as u32).into_par_iter().map(source).collect();
    let made = origins.iter().filter(|source| source.is_made_up()).count();
    let report = Report {
        voxel: lattice.h,
        dims: lattice.dims.to_array(),
        lattice: true,
        fit: fitted,
        closed_triangles: made,
        triangles: TriangleCounts { rebuilt: origins.len() - made, made_up: made, ..TriangleCounts::default() },
        stages: stages.finish(),
        ..Report::default()
    };
    let account = FieldReport { operands: built.operands.clone(), made, volume: volume(&surface.mesh) };
    let draft = Draft { mesh: surface.mesh, sources: origins, lattice, report };
    Ok((draft.global(&frame).judged(&[], progress)?, account))
}

/// How far a point is from the level, model units. Gradients cost more than values, and mostly the value tells enough.
fn off(field: &dyn Field, p: DVec3, h: f64) -> f64 {
    let value = field.value(p).abs();
    let least = value / field.lipschitz();
    if value < NEAR * h || least > FAR * h {
        return least.max(value.min(NEAR * h));
    }
    let steep = field.sample(p).gradient.length();
    value / if steep > FLAT { steep } else { 1.0 }
}

/// How far from zero a lattice has the values of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldBand {
    /// So far, model units.
    Length(f64),
    /// So many voxels.
    Voxels(f64),
    /// All of them.
    Full,
}

/// The field over a lattice around the shape, or around the operands and bodies where the field is no shape.
///
/// # Errors
/// See [`FieldError`].
pub fn field_grid(
    built: &Built,
    band: FieldBand,
    options: &Options,
    progress: &Progress,
) -> Result<DistanceOutcome, FieldError> {
    let mut stages = Stages::new(progress);
    stages.begin(Stage::Field)?;
    let extent = built.field.extent().bounds().or(built.parts).ok_or(BuildError::Endless)?;
    let frame = Frame::of_box(&extent, &options.surface());
    let mut lattice = sizing::lattice(&frame.local_bounds(&extent), options.voxel)?;
    let h = lattice.h;
    let band = match band {
        FieldBand::Length(length) => Some(length),
        FieldBand::Voxels(count) => Some(count * h),
        FieldBand::Full => None,
    };
    let room = (band.unwrap_or(0.0) / h).ceil();
    let most = f64::from(lattice.dims.max_element()) + 2.0 * room;
    if most.is_nan() || most >= f64::from(MAX_VOXELS) {
        let band = format!("{} voxels", digits::number(room));
        return Err(LatticeError::WideBand { band, along: most, or: "" }.into());
    }
    lattice.origin -= room * h;
    lattice.dims += 2 * IVec3::splat(room as i32);
    let wanted = FillOptions { band, max_memory: options.max_memory };
    let mut field = fill(&*frame.local_field(&built.field), &lattice, &wanted, progress)?;
    field.lattice = frame.global_lattice(lattice);
    let report = DistanceReport { stages: stages.finish(), ..DistanceReport::default() };
    let band = band.map_or(Band::Full, |band| Band::Within(band / h));
    Ok(DistanceOutcome::described(field, band, report))
}

/// The values of the field at points, model units: to paint a surface with.
pub fn field_values(field: &Shared, points: &[DVec3]) -> Vec<f64> {
    let packet = |points: &[DVec3]| {
        let mut values = vec![0.0; points.len()];
        field.values(points, &mut values);
        values
    };
    points.par_chunks(64).flat_map_iter(packet).collect()
}

/// The voxel spacing that [`field_surface`] takes, model units.
///
/// # Errors
/// Those of [`field_surface`].
pub fn field_spacing(built: &Built, options: &Options) -> Result<f64, FieldError> {
    Ok(sizing::lattice(&language::shape_extent(&built.field)?, options.voxel)?.h)
}

impl From<FillError> for FieldError {
    fn from(error: FillError) -> Self {
        match error {
            FillError::Stopped(stopped) => Self::Stopped(stopped),
            FillError::Memory { needed, allowed } => {
                LimitError::Memory { needed, allowed, voxel_that_fits: None }.into()
            }
        }
    }
}

impl From<BuildError> for FieldError {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Stopped(stopped) => Self::Stopped(stopped),
            BuildError::Fill(error) => error.into(),
            other => Self::Build(other),
        }
    }
}

impl From<LevelError> for FieldError {
    fn from(error: LevelError) -> Self {
        match error {
            LevelError::Fill(error) => error.into(),
            LevelError::Stopped(stopped) => Self::Stopped(stopped),
        }
    }
}

impl From<BooleanError> for FieldError {
    fn from(error: BooleanError) -> Self {
        match error {
            BooleanError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Repair(other),
        }
    }
}

impl From<DistanceError> for FieldError {
    fn from(error: DistanceError) -> Self {
        match error {
            DistanceError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Distance(other),
        }
    }
}

impl From<SolidError> for FieldError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Stopped(stopped) => Self::Stopped(stopped),
            SolidError::Index(error) => Self::Index(error),
            SolidError::NotSolid(what) => Self::NotSolid(what),
        }
    }
}
