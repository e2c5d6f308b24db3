//! Walls that are too thin, and open sheets, made as thick as is wanted.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::frame::Frame;
use super::morphology::plan_offsets;
use super::offsets::{Job, check_offsets, usable, volume};
use super::plan::{Offsets, area};
use super::stages::Stages;
use super::{BooleanError, Changed, MorphologyError, Plan, Report, SurfaceOptions, TriangleSource, boolean, sizing};
use crate::digits;
use crate::ldi::Expression;
use crate::mesh::{Bounds, IndexError, Pseudonormals, Solid, TriMesh};
use crate::morphology::{Gauge, OffsetError, middles};
use crate::progress::{Progress, Stage, Stopped};

/// Walls are at least this many voxels thick: of less the lattice makes no round edge.
const LEAST_VOXELS: f64 = 4.0;

/// Walls are at most this many times as thick as the model is long: of more nothing of its shape would be left, and the lattice for
/// it would be mostly that.
const MOST_LENGTHS: f64 = 2.0;

/// Triangles of the input that are farther than this, h, from the solid's surface are open sheets.
const APART: f64 = 1.0;

/// On which side of an open sheet there will be material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SheetSide {
    /// Half of the thickness on either side.
    #[default]
    Both,
    /// Where the triangles' normals point.
    Front,
    /// On the other side.
    Back,
}

/// Options of [`thicken`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThickenOptions {
    /// The least thickness, model units; at least four voxels.
    pub min: f64,
    /// Where open sheets grow.
    pub side: SheetSide,
    /// How the new surface is made.
    pub surface: SurfaceOptions,
}

/// What was too thin.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThickenReport {
    /// The least thickness, model units.
    pub least: f64,
    /// Area of the surface of the solid whose wall is thinner, square model units; both sides count.
    pub thin_area: f64,
    /// Area of the open sheets.
    pub sheet_area: f64,
    /// Volume of the solid before, cubic model units; 0 where there was none.
    pub volume_before: f64,
    /// Volume after.
    pub volume_after: f64,
}

/// Why walls could not grow. Lengths are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ThickenError {
    /// The walls are too thin for the voxels.
    #[error("walls of {} need a voxel of at most {}", digits::number(*min), possible(*min, *voxel, *finest))]
    WallsForVoxel {
        /// The least thickness that was asked for.
        min: f64,
        /// The voxel.
        voxel: f64,
        /// The finest voxel that is possible.
        finest: f64,
    },
    /// The walls are so thick that nothing of the shape would be left.
    #[error(
        "walls of {} are more than {MOST_LENGTHS} times as thick as the model is long ({}), so nothing of its \
         shape would be left: look at the unit, or use at most {}",
        digits::number(*min), digits::number(*longest), digits::rounded_down(MOST_LENGTHS * longest)
    )]
    WallsForModel {
        /// The least thickness that was asked for.
        min: f64,
        /// The longest side of the model's box.
        longest: f64,
    },
    /// A triangle of the surface refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// There is neither a solid nor a sheet.
    #[error("there is no triangle with an area")]
    Empty,
    /// The offset of what is thin gave nothing.
    #[error(transparent)]
    Offset(#[from] MorphologyError),
    /// The union of the solid and what was grown gave nothing.
    #[error(transparent)]
    Union(#[from] BooleanError),
}

fn possible(min: f64, voxel: f64, finest: f64) -> String {
    let fits = min / LEAST_VOXELS;
    if fits < sizing::TYPED * finest {
        let walls = digits::rounded_up(LEAST_VOXELS * finest);
        return format!(
            "{}, which is finer than is possible here: walls of at least {walls} are",
            digits::number(fits)
        );
    }
    format!("{}, and it is {}", digits::rounded_down(fits), digits::number(voxel))
}

/// Lets walls of a solid, and open sheets that bound nothing, grow until a ball of the least thickness fits
/// everywhere in them. What is thick enough stays as it is. `surface`: the mesh that the solid was made of: what of it lies apart from
/// the solid, outside, is an open sheet; all of it where there is no solid. An empty mesh has no sheets.
///
/// # Errors
/// See [`ThickenError`].
pub fn thicken(
    solid: Option<&Solid>,
    surface: &TriMesh,
    options: &ThickenOptions,
    progress: &Progress,
) -> Result<Changed, ThickenError> {
    surface.check()?;
    let (min, h) = checked(solid, surface, options)?;
    let given: Vec<&TriMesh> = solid.iter().map(|solid| solid.mesh()).chain([surface]).collect();
    let frame = Frame::of(&given, &options.surface);
    let local = solid.map(|solid| frame.local(solid));
    let fixed = options.surface.with_voxel(h);
    let mut stages = Stages::new(progress);
    stages.begin(Stage::ThinWalls)?;
    let body = local.as_ref().map(|solid| Gauge::new(solid, None));
    let (mut thin, thin_area) = match &body {
        Some(body) => middles(body, min, h, progress)?,
        None => (TriMesh::default(), 0.0),
    };
    let sheets = sheets(&frame.local(surface), body.as_ref(), h, progress)?;
    let sheet_area = area(&sheets);
    thin.append(&moved(sheets, options.side, min / 2.0));
    let volume_before = local.as_ref().map_or(0.0, |solid| volume(solid));
    let mut changed = match solid {
        Some(solid) if thin.triangles.is_empty() => {
            let lattice = sizing::lattice(&bounds(&given)?, fixed.voxel).map_err(MorphologyError::Lattice)?;
            Changed::unchanged(solid, lattice, Report::default())
        }
        solid => {
            let job = Job { solid: &thin, h, surface: &fixed, progress };
            let mut grown = job.one_way(&Gauge::sheet(&thin), min / 2.0, 1.0, &mut stages)?.surface.mesh;
            frame.mesh(&mut grown);
            united(solid, &grown, &fixed, progress)?
        }
    };
    changed.report.stages.extend(stages.finish());
    let volume_after = volume(&changed.solid);
    changed.report.thicken = Some(ThickenReport { least: min, thin_area, sheet_area, volume_before, volume_after });
    Ok(changed)
}

/// What [`thicken`] would cost.
///
/// # Errors
/// Those of [`thicken`] that come before anything is made.
pub fn plan_thicken(mesh: &TriMesh, options: &ThickenOptions) -> Result<Plan, ThickenError> {
    let radius = usable(options.min / 2.0)?;
    Ok(plan_offsets(mesh, &options.surface, Offsets { count: 1, radius, thin: true })?)
}

fn bounds(meshes: &[&TriMesh]) -> Result<Bounds, ThickenError> {
    meshes.iter().filter_map(|mesh| mesh.bounds()).reduce(|a, b| a.union(&b)).ok_or(ThickenError::Empty)
}

/// The least thickness and the voxel, model units, if they go together.
fn checked(solid: Option<&Solid>, surface: &TriMesh, options: &ThickenOptions) -> Result<(f64, f64), ThickenError> {
    let radius = usable(options.min / 2.0)?;
    let min = options.min;
    let bounds = bounds(&solid.iter().map(|solid| solid.mesh()).chain([surface]).collect::<Vec<_>>())?;
    let h = sizing::spacing(&bounds, options.surface.voxel).map_err(MorphologyError::Lattice)?;
    if min < LEAST_VOXELS * h {
        return Err(ThickenError::WallsForVoxel { min, voxel: h, finest: sizing::finest(&bounds) });
    }
    let longest = bounds.size().max_element();
    if min > MOST_LENGTHS * longest {
        return Err(ThickenError::WallsForModel { min, longest });
    }
    let of = if surface.triangles.is_empty() { solid.map_or(surface, |solid| solid.mesh()) } else { surface };
    let fixed = options.surface.with_voxel(h);
    let frame = Frame::of(&[of], &fixed);
    check_offsets(&frame.local(of), &fixed, Offsets { count: 1, radius, thin: true })?;
    Ok((min, h))
}

/// The union of the solid and what was grown, with triangles of the solid where it stays the surface.
fn united(
    solid: Option<&Solid>,
    grown: &TriMesh,
    surface: &SurfaceOptions,
    progress: &Progress,
) -> Result<Changed, BooleanError> {
    let meshes: Vec<&TriMesh> = solid.iter().map(|solid| solid.mesh()).chain([grown]).collect();
    let outcome = boolean(meshes.iter().copied(), &Expression::union(meshes.len()), &(*surface).into(), progress)?;
    let own = |source: &TriangleSource| match *source {
        TriangleSource::Operand { operand: 0, triangle } if solid.is_some() => Some(triangle),
        _ => None,
    };
    let own = outcome.sources.iter().map(own).collect();
    Ok(Changed { solid: outcome.solid, own, lattice: outcome.lattice, report: outcome.report })
}

impl From<Stopped> for ThickenError {
    fn from(stopped: Stopped) -> Self {
        Self::Offset(stopped.into())
    }
}

impl From<OffsetError> for ThickenError {
    fn from(error: OffsetError) -> Self {
        Self::Offset(error.into())
    }
}

/// Triangles that are no part of the solid's surface and lie outside of it; all where there is no solid.
fn sheets(input: &TriMesh, solid: Option<&Gauge<'_>>, h: f64, progress: &Progress) -> Result<TriMesh, Stopped> {
    progress.check()?;
    let apart = |t: &usize| {
        let corners = input.corners(*t);
        let centre = corners.iter().sum::<DVec3>() / 3.0;
        let points = corners.iter().map(|corner| corner.lerp(centre, 0.1)).chain([centre]);
        let mut far = points.filter_map(|p| solid?.distance().at(p)).map(|nearest| nearest.signed);
        solid.is_none() || far.any(|signed| signed > APART * h)
    };
    let triangles: Vec<usize> = (0..input.triangles.len()).into_par_iter().filter(apart).collect();
    let triangles = triangles.into_iter().map(|t| input.triangles[t]).collect();
    Ok(TriMesh { positions: input.positions.clone(), triangles })
}

/// The sheets where the middle of the material will be.
fn moved(mut sheets: TriMesh, side: SheetSide, by: f64) -> TriMesh {
    let by = match side {
        SheetSide::Both => return sheets,
        SheetSide::Front => by,
        SheetSide::Back => -by,
    };
    let normals = Pseudonormals::of(&sheets);
    let mut to = sheets.positions.clone();
    for (t, corners) in (0..).zip(&sheets.triangles) {
        for (k, &v) in (0..).zip(corners) {
            to[v as usize] = sheets.positions[v as usize] + normals.of_corner(t, k).normalize_or_zero() * by;
        }
    }
    sheets.positions = to;
    sheets
}
