//! Walls that are too thin, and open sheets, made as thick as is wanted.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::frame::Frame;
use super::morphology::{Run, usable, volume};
use super::plan::{Offsets, area, check_offsets};
use super::{Error, MorphologyOptions, Options, Outcome, TriangleSource, VoxelSize, boolean, kind, prepare, stages};
use crate::digits;
use crate::ldi::Expression;
use crate::mesh::{Pseudonormals, TriMesh};
use crate::morphology::{Body, Operation, middles};
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
#[derive(Debug, Clone, PartialEq)]
pub struct ThickenOptions {
    /// The least thickness, model units; at least four voxels.
    pub least: f64,
    /// Where open sheets grow.
    pub side: SheetSide,
    /// How the operand becomes a solid first, and the voxel size.
    pub solid: Options,
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

/// Repairs `input` and lets its walls, and open sheets that bound nothing, grow until a ball of the least thickness fits
/// everywhere in them. What is thick enough stays as it is.
///
/// # Errors
/// Those of [`boolean`], but for a surface that encloses nothing; [`Error::VoxelSize`] for a thickness that the lattice
/// cannot hold, or that is more than twice the model's longest side.
pub fn thicken(input: &TriMesh, options: &ThickenOptions, progress: &Progress) -> Result<Outcome, Error> {
    let least = usable(options.least)?;
    let frame = Frame::of(std::slice::from_ref(input), &options.solid);
    let input = &frame.local(std::slice::from_ref(input))[0];
    let bounds = prepare::bounds(std::slice::from_ref(input))?;
    let h = prepare::lattice(&bounds, options.solid.voxel)?.h;
    if least < LEAST_VOXELS * h {
        let (fits, finest) = (least / LEAST_VOXELS, prepare::finest(&bounds));
        let [walls, voxel] = [least, h].map(digits::number);
        let possible = if fits < prepare::TYPED * finest {
            format!(
                "{}, which is finer than is possible here: walls of at least {} are",
                digits::number(fits),
                digits::rounded_up(LEAST_VOXELS * finest)
            )
        } else {
            format!("{}, and it is {voxel}", digits::rounded_down(fits))
        };
        return Err(Error::VoxelSize { reason: format!("walls of {walls} need a voxel of at most {possible}") });
    }
    let longest = bounds.size().max_element();
    if least > MOST_LENGTHS * longest {
        let [walls, length] = [least, longest].map(digits::number);
        let most = digits::rounded_down(MOST_LENGTHS * longest);
        return Err(Error::VoxelSize {
            reason: format!(
                "walls of {walls} are more than {MOST_LENGTHS} times as thick as the model is long ({length}), so nothing of its \
                 shape would be left: look at the unit, or use at most {most}"
            ),
        });
    }
    let fixed = Options { voxel: VoxelSize::Length(h), ..options.solid.clone() };
    check_offsets(input, &fixed, Offsets { count: 1, radius: least / 2.0, thin: true })?;
    let solid = match boolean(std::slice::from_ref(input), &Expression::Operand(0), &fixed, progress) {
        Ok(outcome) => Some(outcome),
        Err(Error::NothingEnclosed { .. }) => None,
        Err(error) => return Err(error),
    };
    let mut stages = stages::Stages::new(progress);
    stages.begin(Stage::ThinWalls)?;
    let body = solid.as_ref().map(|solid| Body::new(&solid.mesh, None));
    let (mut thin, thin_area) = match &body {
        Some(body) => middles(body, least, h, progress)?,
        None => (TriMesh::default(), 0.0),
    };
    let sheets = sheets(input, body.as_ref(), h, progress)?;
    let sheet_area = area(&sheets);
    thin.append(&moved(sheets, options.side, least / 2.0));
    let before = solid.as_ref().map_or(0.0, |solid| volume(&solid.mesh));
    let mut outcome = match solid {
        Some(solid) if thin.triangles.is_empty() => solid,
        solid => {
            let grow = MorphologyOptions {
                operation: Operation::Dilate,
                radius: least / 2.0,
                mitre: None,
                solid: fixed.clone(),
            };
            let run = Run { solid: &thin, h, options: &grow, progress };
            let grown = run.one_way(&Body::sheet(&thin), least / 2.0, &mut stages)?.surface.mesh;
            united(solid, grown, &fixed, progress)?
        }
    };
    outcome.report.stages.extend(stages.finish());
    let after = volume(&outcome.mesh);
    outcome.report.thicken =
        Some(ThickenReport { least, thin_area, sheet_area, volume_before: before, volume_after: after });
    Ok(frame.global(kind::counted(outcome, std::slice::from_ref(input))))
}

/// The union of the solid and what was grown, with triangles of the solid where it stays the surface.
fn united(solid: Option<Outcome>, grown: TriMesh, options: &Options, progress: &Progress) -> Result<Outcome, Error> {
    let (meshes, own) = match solid {
        Some(solid) => (vec![solid.mesh, grown], solid.sources),
        None => (vec![grown], Vec::new()),
    };
    let with_solid = meshes.len() > 1;
    let options = Options { classes: Vec::new(), ..options.clone() };
    let mut outcome = boolean(&meshes, &Expression::union(meshes.len()), &options, progress)?;
    for source in &mut outcome.sources {
        *source = match *source {
            TriangleSource::Operand { operand: 0, triangle } if with_solid => own[triangle as usize],
            _ => TriangleSource::Closed,
        };
    }
    outcome.report.closed_triangles = outcome.sources.iter().filter(|s| **s == TriangleSource::Closed).count();
    Ok(outcome)
}

/// Triangles that are no part of the solid's surface and lie outside of it; all where there is no solid.
fn sheets(input: &TriMesh, solid: Option<&Body<'_>>, h: f64, progress: &Progress) -> Result<TriMesh, Stopped> {
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
