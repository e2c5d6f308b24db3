//! Dilate, erode, close and open.

use rayon::prelude::*;
use serde::Serialize;

use super::crumbs::without_made_crumbs;
use super::frame::Frame;
use super::plan::{Offsets, area, check_offsets};
use super::{Error, Options, Outcome, TriangleSource, VoxelSize, boolean, kind, prepare, refine, stages};
use crate::digits;
use crate::fit::{Facets, FitOptions, FitReport, Sides, Surface, Wanted, fit};
use crate::lattice::Lattice;
use crate::ldi::{Evidence, Expression};
use crate::mesh::{TriMesh, ValidateOptions, validate};
use crate::morphology::{
    Balls, Body, Centres, MorphologyError, Offset, Operation, Region, Remain, closed, offset, places, reached,
};
use crate::progress::{Progress, Stage};
use crate::sdf::exact::{ExactDistance, PointSign};

/// Options of [`morphology`].
#[derive(Debug, Clone, PartialEq)]
pub struct MorphologyOptions {
    /// What is done.
    pub operation: Operation,
    /// The radius of the ball, model units, more than 0.
    pub radius: f64,
    /// Dilate and erode: edges that would become round stay sharp up to this many times the radius from where they were;
    /// `None`: round.
    pub mitre: Option<f64>,
    /// How the operand becomes a solid first, and the voxel size.
    pub solid: Options,
}

/// What was done to the solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MorphologyReport {
    /// What was done.
    pub operation: Operation,
    /// The radius, model units.
    pub radius: f64,
    /// Volume of the solid before, cubic model units.
    pub volume_before: f64,
    /// Volume after.
    pub volume_after: f64,
    /// Triangles of the result that the operation made; the others lie on the solid's own.
    pub made: usize,
    /// The voxel of the offsets, model units: smaller than that of the solid where the radius or what is left asks for it.
    pub voxel: f64,
    /// Places where what is left is thinner than that voxel, and is not there, or not whole.
    pub too_thin: usize,
    /// One of them, model units.
    pub thin_place: Option<[f64; 3]>,
    /// Their part of the surface that there should be, 0 to 1.
    pub thin_share: f64,
    /// A voxel that would hold half of them, model units.
    pub voxel_that_holds: Option<f64>,
}

/// Repairs `input` and dilates, erodes, closes or opens the solid.
///
/// # Errors
/// Those of [`boolean`]; [`Error::NothingEnclosed`] when nothing is left; [`Error::VoxelSize`] for a radius that
/// the lattice cannot hold.
pub fn morphology(input: &TriMesh, options: &MorphologyOptions, progress: &Progress) -> Result<Outcome, Error> {
    with_voxels(input, options, Voxels::AsNeeded, progress)
}

/// Which voxels an offset is made with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Voxels {
    /// Those that were asked for, halved where they do not show what is left.
    AsNeeded,
    /// Those that the radius needs: what is thinner is not wanted.
    OfRadius,
}

/// [`morphology`] with certain voxels.
pub(super) fn with_voxels(
    input: &TriMesh,
    options: &MorphologyOptions,
    voxels: Voxels,
    progress: &Progress,
) -> Result<Outcome, Error> {
    let radius = usable(options.radius)?;
    let frame = Frame::of(std::slice::from_ref(input), &options.solid);
    let input = &frame.local(std::slice::from_ref(input))[0];
    let offsets = Offsets { count: options.operation.offsets(), radius, thin: false };
    let h = checked_voxel(input, &options.solid, offsets)?;
    let outcome = boolean(std::slice::from_ref(input), &Expression::Operand(0), &options.solid, progress)?;
    let mut stages = stages::Stages::new(progress);
    let run = Run { solid: &outcome.mesh, h, options, progress };
    let finer = |h: f64| {
        let finer = Options { voxel: VoxelSize::Length(h), ..options.solid.clone() };
        voxels == Voxels::AsNeeded && check_offsets(input, &finer, offsets).is_ok()
    };
    let made = match options.operation {
        Operation::Dilate | Operation::Erode => {
            let level = if options.operation == Operation::Dilate { radius } else { -radius };
            let body = Body::new(run.solid, options.mitre);
            run.refined(finer, |run| run.one_way(&body, level, &mut stages))?
        }
        Operation::Close => run.refined(finer, |run| run.there_and_back(radius, &mut stages))?,
        Operation::Open => run.refined(finer, |run| run.there_and_back(-radius, &mut stages))?,
    };
    Ok(frame.global(kind::counted(run.finish(&outcome, made, stages), std::slice::from_ref(input))))
}

/// Voxels of a radius, at least: of less, a ball passes between voxels; back and forth, chords of less are off by more than a
/// sixteenth of a voxel.
const VOXELS_OF_RADIUS: [f64; 2] = [1.0, 2.0];

/// Thin remains let voxels be halved so often, at most, where that shows half of them, and not to more than this many along the model's
/// longest side after the first time: the surface has four times as many each time.
const MOST_HALVINGS: u32 = 3;
const MOST_ALONG: f64 = 600.0;

/// Of the surface that there should be at least this part has to be missing for that: what grows thinner towards its rim always ends between
/// voxels. Of an offset, and of what the solid itself has and a closing or opening must not lose.
const WORTH: [f64; 2] = [0.01, 0.001];

/// A place is left out where the surface is farther from it than this, h.
const LEFT_OUT: f64 = 0.75;

/// The voxel of as many offsets, model units: the one that was asked for, halved until the radius has enough of them.
pub(super) fn offset_voxel(input: &TriMesh, solid: &Options, offsets: Offsets) -> Result<f64, Error> {
    let asked = prepare::spacing(&prepare::bounds(std::slice::from_ref(input))?, solid.voxel)?;
    let most = offsets.radius / VOXELS_OF_RADIUS[offsets.count as usize - 1];
    Ok(std::iter::successors(Some(asked), |h| Some(h / 2.0)).find(|&h| h <= most).unwrap_or(asked))
}

/// The same, or why so small ones cannot be.
pub(super) fn checked_voxel(input: &TriMesh, solid: &Options, offsets: Offsets) -> Result<f64, Error> {
    let h = offset_voxel(input, solid, offsets)?;
    check_offsets(input, &Options { voxel: VoxelSize::Length(h), ..solid.clone() }, offsets)?;
    Ok(h)
}

/// A radius, or why it is none.
pub(super) fn usable(radius: f64) -> Result<f64, Error> {
    let reason = || format!("a radius of {} cannot be used; it must be above zero", digits::number(radius));
    if radius > 0.0 && radius.is_finite() { Ok(radius) } else { Err(Error::VoxelSize { reason: reason() }) }
}

/// The fitted surface and, for each of its triangles, the solid's triangle that it lies on.
pub(super) struct Made {
    pub surface: Surface,
    own: Vec<Option<u32>>,
    fit: Option<FitReport>,
    /// The voxel it was made with, model units.
    h: f64,
    /// What no voxel shows and the surface does not have.
    too_thin: Vec<Remain>,
}

#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    pub solid: &'a TriMesh,
    pub h: f64,
    pub options: &'a MorphologyOptions,
    pub progress: &'a Progress,
}

impl Run<'_> {
    /// What `make` makes, with voxels halved while they leave something out and `is_affordable` holds.
    fn refined(
        &self,
        is_affordable: impl Fn(f64) -> bool,
        mut make: impl FnMut(&Self) -> Result<Made, Error>,
    ) -> Result<Made, Error> {
        let longest = super::prepare::bounds(std::slice::from_ref(self.solid))?.size().max_element();
        let finest = (self.h / f64::from(1u32 << MOST_HALVINGS)).max((longest / MOST_ALONG).min(self.h / 2.0));
        let mut run = *self;
        loop {
            let made = make(&run)?;
            let shows = |&h: &f64| {
                let held = made.too_thin.iter().filter(|remain| remain.thickness >= h).count();
                held > 0 && 2 * held >= made.too_thin.len()
            };
            let worth = WORTH[self.options.operation.offsets() as usize - 1];
            if !made.surface.mesh.triangles.is_empty() && thin_share(&made.too_thin, &made.surface.mesh) < worth {
                return Ok(made);
            }
            let finer = std::iter::successors(Some(run.h / 2.0), |h| Some(h / 2.0)).take_while(|&h| h >= finest);
            match finer.take_while(|&h| is_affordable(h)).find(shows) {
                Some(h) => run.h = h,
                None if made.surface.mesh.triangles.is_empty() => return Err(self.all_too_thin(run.h)),
                None => return Ok(made),
            }
        }
    }

    pub(super) fn one_way(&self, body: &Body<'_>, level: f64, stages: &mut stages::Stages<'_>) -> Result<Made, Error> {
        stages.begin(Stage::Offset)?;
        let lattice = self.lattice(level.max(0.0) * self.options.mitre.unwrap_or(1.0))?;
        let offset = offset(body, level, &lattice, self.progress).map_err(|e| self.error(e))?;
        stages.begin(Stage::Fit)?;
        let off = |p| (body.at(p, level.abs() + self.h).0 - level).abs();
        self.fitted((offset, &lattice), (&TriMesh::default(), &off), Evidence::default(), self.options.solid.fit, level)
    }

    fn there_and_back(&self, radius: f64, stages: &mut stages::Stages<'_>) -> Result<Made, Error> {
        let body = Body::new(self.solid, None);
        let centres = self.there(&body, radius, stages)?;
        self.back(&body, &Balls::new(&centres, radius), radius, None, stages)
    }

    /// The first step of a closing or opening: where centres of balls can be.
    pub(super) fn there(
        &self,
        body: &Body<'_>,
        radius: f64,
        stages: &mut stages::Stages<'_>,
    ) -> Result<Centres, Error> {
        stages.begin(Stage::FirstOffset)?;
        let lattice = self.lattice(radius.max(0.0))?;
        let mut there = offset(body, radius, &lattice, self.progress).map_err(|e| self.error(e))?;
        let between = std::mem::take(&mut there.remains);
        if there.contour.mesh.triangles.is_empty() && !between.is_empty() {
            return Ok(Centres::new(TriMesh::default(), &between, self.h));
        }
        let off = |p| (body.at(p, radius.abs() + self.h).0 - radius).abs();
        // All triangles stay: the second distance is to this surface.
        let whole = FitOptions { tolerance: 0.0, ..self.options.solid.fit.unwrap_or_default() };
        let made =
            self.fitted((there, &lattice), (&TriMesh::default(), &off), Evidence::default(), Some(whole), radius)?;
        Ok(Centres::new(made.surface.mesh, &between, self.h))
    }

    /// The second step, by the balls of the first; within a region, or everywhere.
    pub(super) fn back(
        &self,
        body: &Body<'_>,
        balls: &Balls<'_>,
        radius: f64,
        region: Option<&Region<'_>>,
        stages: &mut stages::Stages<'_>,
    ) -> Result<Made, Error> {
        stages.begin(Stage::SecondOffset)?;
        let lattice = self.lattice(0.0)?;
        let back = closed(body, balls, &lattice, region, self.progress).map_err(|e| self.error(e))?;
        let reached = reached(body, radius, &lattice, region, self.progress)?;
        if !back.changed && reached.iter().all(|reached| reached.touched == reached.tried) {
            return Ok(self.unchanged());
        }
        stages.begin(Stage::Fit)?;
        let evidence = Evidence::of_samples(reached.iter().map(|r| (r.tried, r.touched)));
        let off = |p| {
            let own = body.at(p, self.h).0.abs();
            if own < 1e-3 * self.h { own } else { own.min(balls.at(p, self.h).0.abs()) }
        };
        self.fitted((back.offset, &lattice), (self.solid, &off), evidence, self.options.solid.fit, -radius)
    }

    /// The solid as it is.
    fn unchanged(&self) -> Made {
        let own = (0..self.solid.triangles.len() as u32).map(Some).collect();
        let surface = Surface::new(self.solid.clone(), vec![Sides::of([]); self.solid.positions.len()]);
        Made { surface, own, fit: None, h: self.h, too_thin: Vec::new() }
    }

    /// The lattice for the solid grown by `room`, model units.
    pub(super) fn lattice(&self, room: f64) -> Result<Lattice, Error> {
        let mut bounds = super::prepare::bounds(std::slice::from_ref(self.solid))?;
        (bounds.min, bounds.max) = (bounds.min - room, bounds.max + room);
        super::prepare::lattice(&bounds, VoxelSize::Length(self.h))
    }

    fn fitted(
        &self,
        (offset, lattice): (Offset, &Lattice),
        (source, off): (&TriMesh, Wanted<'_>),
        evidence: Evidence,
        options: Option<FitOptions>,
        level: f64,
    ) -> Result<Made, Error> {
        if offset.contour.mesh.triangles.is_empty() {
            if offset.remains.is_empty() {
                return Err(self.nothing_left(level));
            }
            let surface = Surface::new(TriMesh::default(), Vec::new());
            return Ok(Made { surface, own: Vec::new(), fit: None, h: self.h, too_thin: offset.remains });
        }
        let facets = Facets::new(source, offset.planes).with_wanted(off);
        let mut surface = refine::merged(offset.contour, &facets, lattice, &self.options.solid, self.progress)?;
        let mut fitted = None;
        if let Some(options) = options {
            let options = FitOptions { keep: options.keep && !source.triangles.is_empty(), ..options };
            let (fit, report) = fit(&surface, &facets, &evidence, self.h, &options, self.progress)?;
            (surface, fitted) = (fit, Some(report));
        }
        let own = |t: u32| surface.facet(&facets, t).filter(|&facet| (facet as usize) < source.triangles.len());
        let own = (0..surface.mesh.triangles.len() as u32).map(own).collect();
        let too_thin = self.left_out(&offset.remains, &surface.mesh);
        Ok(Made { surface, own, fit: fitted, h: self.h, too_thin })
    }

    fn nothing_left(&self, level: f64) -> Error {
        let reason = if level < 0.0 && self.options.operation != Operation::Close {
            format!("nothing is left: the solid is nowhere thicker than {}", digits::number(2.0 * level.abs()))
        } else {
            "nothing is left".into()
        };
        Error::NothingEnclosed { reason }
    }

    fn all_too_thin(&self, h: f64) -> Error {
        let reason = format!(
            "what is left is thinner than a voxel of {} everywhere: a smaller voxel shows it",
            digits::number(h)
        );
        Error::NothingEnclosed { reason }
    }

    /// Those that `surface` does not have.
    fn left_out(&self, remains: &[Remain], surface: &TriMesh) -> Vec<Remain> {
        if remains.is_empty() {
            return Vec::new();
        }
        let distance = ExactDistance::of(surface, PointSign::Unsigned);
        let is_there = |remain: &Remain| distance.within(remain.point, LEFT_OUT * self.h).is_some();
        remains.par_iter().copied().filter(|remain| !is_there(remain)).collect()
    }

    pub(super) fn finish(&self, solid: &Outcome, made: Made, stages: stages::Stages<'_>) -> Outcome {
        let Made { surface, mut own, fit, h, too_thin } = made;
        let mut mesh = surface.mesh;
        let crumbs = without_made_crumbs(&mut mesh, &mut own, h);
        let source = |own: &Option<u32>| own.map_or(TriangleSource::Closed, |t| solid.sources[t as usize]);
        let sources: Vec<TriangleSource> = own.iter().map(source).collect();
        let mut report = solid.report.clone();
        report.closed_triangles = sources.iter().filter(|source| **source == TriangleSource::Closed).count();
        report.morphology = Some(MorphologyReport {
            operation: self.options.operation,
            radius: self.options.radius,
            volume_before: volume(self.solid),
            volume_after: volume(&mesh),
            made: own.iter().filter(|own| own.is_none()).count(),
            voxel: h,
            too_thin: places(&too_thin, 2.0 * h),
            thin_place: too_thin.first().map(|remain| remain.point.to_array()),
            thin_share: thin_share(&too_thin, &mesh),
            voxel_that_holds: median(too_thin.iter().map(|remain| remain.thickness)),
        });
        report.fit = fit;
        report.crumbs = report.crumbs.and(crumbs);
        report.stages.extend(stages.finish());
        Outcome { mesh, sources, lattice: solid.lattice, report }
    }

    pub(super) fn error(&self, error: MorphologyError) -> Error {
        match error {
            MorphologyError::Stopped(stopped) => stopped.into(),
            MorphologyError::Distance(error) => Error::VoxelSize { reason: error.to_string() },
        }
    }
}

/// The part that is missing of a surface.
fn thin_share(missing: &[Remain], surface: &TriMesh) -> f64 {
    let missing: f64 = missing.iter().map(|remain| remain.area).sum();
    if missing > 0.0 { missing / (missing + area(surface)) } else { 0.0 }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().filter(|&value| value > 0.0)
}

/// Cubic model units.
pub(super) fn volume(mesh: &TriMesh) -> f64 {
    let quick = ValidateOptions { self_intersections: false, weld: false };
    validate(mesh, &quick, &Progress::none()).map_or(0.0, |validity| validity.volume)
}
