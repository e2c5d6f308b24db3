//! The surface as a ball sees it from outside: inner skins, buried faces and parts go, and pinholes are closed.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::assembled::Assembled;
use super::frame::Frame;
use super::holes::WIDE;
use super::plan::area;
use super::{
    BooleanError, HoleReport, LidShape, NothingEnclosed, Operand, Options, Outcome, OuterReport, Plan, Precision,
    SheetSide, SurfaceOptions, ThickenError, ThickenOptions, TriangleSource, VoxelSize, boolean, plan, sizing, thicken,
};
use crate::arrange::{ArrangeError, cut};
use crate::digits;
use crate::fill::{FillOptions, Lid, Style, Surroundings, lid, rims};
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::mesh::edges::Union;
use crate::orient::{OrientMode, OrientReport, PatchId};
use crate::outer::{Part, Parts, Reach, ReachError, judge, sights};
use crate::progress::{Progress, Stage, Stopped};
use crate::survey::{Soup, SoupError};

/// Voxels to the thickness of a sheet, at least.
const ACROSS: f64 = 5.0;

/// Options of [`outer`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OuterOptions {
    /// Diameter of the ball, model units: what is narrower is no way in.
    pub ball: f64,
    /// How thick sheets become that the ball sees from both sides, model units; `None`: they are an error.
    pub thickness: Option<f64>,
    /// How the solid is made of what is left, and the voxels of what is made thick. Which way triangles face is found by the ball, whatever [`Options::orient`] says.
    pub solid: Options,
}

/// Why there is no outer skin. Lengths and places are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OuterError {
    /// The ball cannot be rolled around the surface.
    #[error(transparent)]
    Reach(#[from] ReachError),
    /// Sheets have no thickness.
    #[error("{}", sheets(*triangles, *at, *widest))]
    Sheets {
        /// How many triangles the ball sees from both sides.
        triangles: usize,
        /// One of them.
        at: DVec3,
        /// The diameter of the widest rim beside them; 0 where they have none.
        widest: f64,
    },
    /// The triangles cannot be cut where they cross.
    #[error(transparent)]
    Cut(ArrangeError),
    /// What is left is no solid.
    #[error(transparent)]
    Boolean(#[from] BooleanError),
    /// Sheets could not be made thick.
    #[error(transparent)]
    Thicken(#[from] ThickenError),
}

fn sheets(triangles: usize, at: DVec3, widest: f64) -> String {
    let at = at.to_array().map(digits::number).join(" ");
    format!(
        "the ball sees {} triangle{} from both sides, one at {at}: sheets that enclose nothing, or a surface with a hole that the ball \
         passes; the widest rim beside is {} across",
        digits::count(triangles),
        if triangles == 1 { "" } else { "s" },
        digits::number(widest)
    )
}

impl From<Stopped> for OuterError {
    fn from(stopped: Stopped) -> Self {
        Self::Boolean(stopped.into())
    }
}

impl From<SoupError> for OuterError {
    fn from(error: SoupError) -> Self {
        Self::Boolean(error.into())
    }
}

/// The solid whose surface a ball sees that rolls around the operand. Triangles that it sees stay as they are, those that bound only what it does not come to go, and the rims that are
/// left are closed by lids. What it sees from both sides is made thick, if that is asked for.
///
/// # Errors
/// See [`OuterError`].
pub fn outer<'a>(
    operand: impl Into<Operand<'a>>,
    options: &OuterOptions,
    progress: &Progress,
) -> Result<Outcome, OuterError> {
    let operand: Operand<'a> = operand.into();
    let (given, solid) = (operand.mesh, &options.solid);
    BooleanError::check(0, given)?;
    let frame = Frame::of(&[given], &solid.surface());
    let found = Found::new(&frame.local(given), options, progress);
    let mut found = found.map_err(|mut error| {
        if let OuterError::Sheets { at, .. } = &mut error {
            let mut place = at.to_array();
            frame.place(&mut place);
            *at = DVec3::from_array(place);
        }
        error
    })?;
    let (mut assembled, lids) = found.closed(solid, progress)?;
    frame.mesh(&mut assembled.mesh);
    frame.mesh(&mut found.sheets);
    let (operands, _) = Operand::with_negatives([operand], &Expression::Operand(0));
    let mut left = Vec::new();
    let outcome = match assembled.mesh.triangles.is_empty() {
        true => None,
        false => {
            let whole = Operand { negative: operand.negative, ..Operand::from(&assembled.mesh) };
            let keep = Options { orient: OrientMode::Keep, ..*solid };
            let mut made = boolean([whole], &Expression::Operand(0), &keep, progress)?;
            // What the ball saw is another thing than what the operand describes.
            made.report.topology = None;
            left = assembled.left(&made.sources);
            // Lids of skins that lie within others are not there.
            let mut holes = Vec::new();
            for Closing { mut hole, triangles } in lids {
                if left[triangles.clone()].contains(&true) {
                    hole.number = holes.len() + 1;
                    let source = TriangleSource::Lid { operand: 0, hole: hole.number as u32 };
                    assembled.own[triangles].fill(source);
                    frame.place(&mut hole.centre);
                    holes.push(hole);
                }
            }
            assembled.holes = holes.len();
            let mut told = assembled.told(made, &operands);
            told.report.holes.splice(0..0, holes);
            Some(told)
        }
    };
    let report = found.report(&left, options);
    let mut outcome = match (outcome, found.sheets.triangles.is_empty()) {
        (Some(outcome), true) => outcome,
        (outcome, _) => thickened(outcome, &found.sheets, options, &operands, progress)?,
    };
    outcome.report.orient = vec![found.orient];
    outcome.report.outer = Some(report);
    Ok(outcome)
}

/// The diameter of the widest rim of a soup that has an edge of any of these triangles.
fn widest_rim(soup: &Soup, triangles: &[u32]) -> f64 {
    let mut is_there = vec![false; soup.mesh.positions.len()];
    triangles.iter().flat_map(|&t| soup.mesh.triangles[t as usize]).for_each(|v| is_there[v as usize] = true);
    let beside = rims(&soup.mesh).into_iter().filter(|rim| rim.vertices.iter().any(|&v| is_there[v as usize]));
    beside.map(|rim| rim.diameter).fold(0.0, f64::max)
}

/// What [`outer`] would cost.
///
/// # Errors
/// Those of [`outer`] that come before anything is made.
pub fn plan_outer(mesh: &TriMesh, options: &OuterOptions) -> Result<Plan, OuterError> {
    BooleanError::check(0, mesh)?;
    let (lattice, _, cost) = Reach::plan(mesh, options.ball)?;
    let made = plan([mesh], &options.solid)?;
    Ok(Plan {
        voxel: lattice.h,
        dims: lattice.dims.to_array(),
        voxels_near_surface: cost.voxels,
        memory: made.memory.max(cost.memory),
        least_memory: made.least_memory.max(cost.memory),
        seconds: made.seconds + cost.seconds,
        ..made
    })
}

/// The union of the solid and of the sheets made thick.
fn thickened(
    outcome: Option<Outcome>,
    sheets: &TriMesh,
    options: &OuterOptions,
    operands: &[Operand<'_>],
    progress: &Progress,
) -> Result<Outcome, OuterError> {
    let Some(min) = options.thickness else { return Err(BooleanError::from(NothingEnclosed::Nothing).into()) };
    let bounds = sizing::bounds([operands[0].mesh]).map_err(|operand| BooleanError::Empty { operand })?;
    let h = sizing::spacing(&bounds, options.solid.voxel).map_err(BooleanError::Lattice)?;
    let surface = SurfaceOptions { voxel: VoxelSize::Length(h.min(min / ACROSS)), ..options.solid.surface() };
    let asked = ThickenOptions { min, side: SheetSide::Both, surface };
    let solid = outcome.as_ref().map(|outcome| &outcome.solid);
    let changed = thicken(solid, sheets, &asked, progress)?;
    Ok(match outcome {
        None => changed.into(),
        Some(outcome) => {
            let holes = outcome.report.holes.clone();
            let followed = outcome.followed_by(changed, operands.iter().copied(), progress);
            let mut followed = followed.map_err(BooleanError::from)?;
            followed.report.holes = holes;
            followed.report.topology = None;
            followed
        }
    })
}

/// For each vertex the diagonal of the box around all that hangs together with it.
fn sizes(mesh: &TriMesh) -> Vec<f64> {
    let mut parts = Union::of_triangles(mesh.positions.len(), mesh.triangles.iter().copied());
    let of: Vec<usize> = (0..mesh.positions.len() as u32).map(|v| parts.root(v) as usize).collect();
    let mut ends = vec![[DVec3::MAX, DVec3::MIN]; mesh.positions.len()];
    for (&p, &part) in mesh.positions.iter().zip(&of) {
        ends[part] = [ends[part][0].min(p), ends[part][1].max(p)];
    }
    of.into_iter().map(|part| ends[part][0].distance(ends[part][1])).collect()
}

/// What the ball has found.
struct Found {
    /// The outer triangles, which face outwards.
    outer: TriMesh,
    /// For each of them its number among those that were judged.
    number: Vec<u32>,
    /// The triangles that were judged, their patches, and for each the operand's that it is, or is a piece of.
    soup: Soup,
    /// What they are.
    parts: Parts,
    sheets: TriMesh,
    orient: OrientReport,
    /// Triangles that were cut.
    cut: usize,
    /// The voxel of the lattice, model units.
    voxel: f64,
}

/// A lid, and its triangles in the mesh that was put together.
struct Closing {
    hole: HoleReport,
    triangles: Range<usize>,
}

impl Found {
    /// Cuts the triangles of an operand where they cross, and rolls the ball around them.
    fn new(given: &TriMesh, options: &OuterOptions, progress: &Progress) -> Result<Self, OuterError> {
        progress.stage(Stage::Orient)?;
        let mut soup = Soup::of(&[given], OrientMode::Auto, progress)?;
        let mut orient = soup.reports[0].clone();
        progress.stage(Stage::Arrange)?;
        let single = options.solid.precision == Precision::Single;
        let pieces = cut(&soup.mesh, single, progress).map_err(|error| match error {
            ArrangeError::Stopped(stopped) => stopped.into(),
            error => OuterError::Cut(error),
        })?;
        // Also where nothing is cut, what rounding parted has the same vertices now.
        let whole = std::mem::replace(&mut soup, Soup::of(&[&pieces.mesh], OrientMode::Auto, progress)?);
        soup.source.iter_mut().for_each(|t| *t = whole.source[pieces.sources[*t as usize] as usize]);
        progress.stage(Stage::Distance)?;
        let reach = Reach::of(&soup.mesh, options.ball, options.solid.max_memory, progress)?;
        let sights = sights(&soup.mesh, &reach, progress)?;
        let parts = judge(&soup.mesh, &soup.patch_of, soup.patch_count, &sights);
        let turned = |t: usize| parts.turned[t];
        let of = |part: Part| -> Vec<u32> {
            (0..soup.mesh.triangles.len() as u32).filter(|&t| parts.of[t as usize] == part).collect()
        };
        let number = of(Part::Outer);
        let facing = |&t: &u32| {
            let [a, b, c] = soup.mesh.triangles[t as usize];
            if turned(t as usize) { [a, c, b] } else { [a, b, c] }
        };
        let positions = soup.mesh.positions.clone();
        let outer = TriMesh { positions, triangles: number.iter().map(facing).collect() }.welded();
        let seen = of(Part::Sheet);
        let sheets = soup.mesh.submesh(&seen).mesh;
        let turned_over: FxHashSet<PatchId> =
            number.iter().filter(|&&t| turned(t as usize)).map(|&t| soup.patch_of[t as usize]).collect();
        orient.flipped_patches = turned_over.len();
        orient.flipped_by_rays = number.iter().filter(|&&t| turned(t as usize)).count();
        if options.thickness.is_none()
            && let Some(&first) = seen.first()
        {
            let widest = widest_rim(&soup, &seen);
            let at = given.corners(soup.source[first as usize] as usize).iter().sum::<DVec3>() / 3.0;
            return Err(OuterError::Sheets { triangles: seen.len(), at, widest });
        }
        let voxel = reach.lattice.h;
        Ok(Self { outer, number, soup, parts, sheets, orient, cut: pieces.cut, voxel })
    }

    /// The outer triangles with a lid over each rim that has one.
    fn closed(&self, options: &Options, progress: &Progress) -> Result<(Assembled, Vec<Closing>), Stopped> {
        let known = self.outer.positions.len();
        let source = |&t: &u32| TriangleSource::Operand { operand: 0, triangle: self.soup.source[t as usize] };
        let own = self.number.iter().map(source).collect();
        let mut assembled = Assembled { mesh: self.outer.clone(), own, holes: 0 };
        let mut lids = Vec::new();
        let around = Surroundings::new(&self.outer);
        let rims = rims(&self.outer);
        let sizes = sizes(&self.outer);
        let made = rims.par_iter().map(|rim| {
            let is_wide = rim.diameter > WIDE * sizes[rim.vertices[0] as usize];
            let style = if is_wide && options.fill == Style::Auto { Style::Flat } else { options.fill };
            progress.check()?;
            Ok(lid(&around, rim, &FillOptions { style, ..FillOptions::default() }).ok())
        });
        let made: Vec<Option<Lid>> = made.collect::<Result<_, Stopped>>()?;
        // A rim without a lid is left to the repair.
        for (rim, lid) in rims.iter().zip(made).filter_map(|(rim, lid)| Some((rim, lid?))) {
            let first = assembled.mesh.triangles.len();
            let others = assembled.mesh.positions.len() - known;
            assembled.mesh.triangles.extend(lid.triangles_after(known, others));
            assembled.mesh.positions.extend_from_slice(&lid.positions);
            let hole = HoleReport::of(lids.len() + 1, rim, Ok((&lid, LidShape::of(&lid))));
            lids.push(Closing { hole, triangles: first..assembled.mesh.triangles.len() });
        }
        assembled.own.resize(assembled.mesh.triangles.len(), TriangleSource::Closed);
        Ok((assembled, lids))
    }

    /// What became of all triangles. `left`: for each triangle of the mesh that was put together whether it is there.
    fn report(&self, left: &[bool], options: &OuterOptions) -> OuterReport {
        let mut stays = vec![false; self.soup.patch_count];
        let outer = self.number.iter().zip(left).filter(|entry| *entry.1).map(|entry| *entry.0);
        let sheets = (0..self.soup.patch_of.len() as u32).filter(|&t| self.parts.of[t as usize] == Part::Sheet);
        let (outer_triangles, sheet_triangles) = (outer.clone().count(), sheets.clone().count());
        outer.chain(sheets).for_each(|t| stays[self.soup.patch_of[t as usize].index()] = true);
        OuterReport {
            ball: options.ball,
            voxel: self.voxel,
            cut: self.cut,
            outer_triangles,
            inner_triangles: self.parts.of.len() - outer_triangles - sheet_triangles,
            inner_patches: stays.iter().filter(|stays| !**stays).count(),
            sheet_triangles,
            sheet_area: area(&self.sheets),
            thickness: options.thickness.filter(|_| sheet_triangles > 0),
        }
    }
}
