//! Dilate, erode, close and open.

use serde::Serialize;

use super::frame::Frame;
use super::plan::{Offsets, check_offsets};
use super::{Error, Options, Outcome, TriangleSource, boolean, prepare, refine, stages};
use crate::digits;
use crate::fit::{Facets, FitOptions, FitReport, Surface, Wanted, fit};
use crate::lattice::Lattice;
use crate::ldi::{Evidence, Expression};
use crate::mesh::{TriMesh, ValidateOptions, validate};
use crate::morphology::{Body, MorphologyError, Offset, Operation, Region, closed, offset, reached};
use crate::progress::Progress;

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
}

/// Repairs `input` and dilates, erodes, closes or opens the solid.
///
/// # Errors
/// Those of [`boolean`]; [`Error::NothingEnclosed`] when nothing is left; [`Error::VoxelSize`] for a radius that
/// the lattice cannot hold.
pub fn morphology(input: &TriMesh, options: &MorphologyOptions, progress: &Progress) -> Result<Outcome, Error> {
    let radius = usable(options.radius)?;
    let frame = Frame::of(std::slice::from_ref(input));
    let input = &frame.local(std::slice::from_ref(input))[0];
    check_offsets(input, &options.solid, Offsets { count: options.operation.offsets(), radius, thin: false })?;
    let outcome = boolean(std::slice::from_ref(input), &Expression::Operand(0), &options.solid, progress)?;
    let mut stages = stages::Stages::new(progress);
    let h = prepare::spacing(&prepare::bounds(std::slice::from_ref(input))?, options.solid.voxel)?;
    let run = Run { solid: &outcome.mesh, h, options, progress };
    let made = match options.operation {
        Operation::Dilate => run.one_way(&Body::new(run.solid, options.mitre), radius, &mut stages)?,
        Operation::Erode => run.one_way(&Body::new(run.solid, options.mitre), -radius, &mut stages)?,
        Operation::Close => run.there_and_back(radius, &mut stages)?,
        Operation::Open => run.there_and_back(-radius, &mut stages)?,
    };
    Ok(frame.global(run.finish(&outcome, made, stages)))
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
}

pub(super) struct Run<'a> {
    pub solid: &'a TriMesh,
    pub h: f64,
    pub options: &'a MorphologyOptions,
    pub progress: &'a Progress,
}

impl Run<'_> {
    pub(super) fn one_way(&self, body: &Body<'_>, level: f64, stages: &mut stages::Stages<'_>) -> Result<Made, Error> {
        stages.begin("offset")?;
        let lattice = self.lattice(level.max(0.0) * self.options.mitre.unwrap_or(1.0))?;
        let offset = offset(body, level, &lattice, self.progress).map_err(|e| self.error(e))?;
        stages.begin("fit")?;
        let off = |p| (body.at(p, level.abs() + self.h).0 - level).abs();
        self.fitted((offset, &lattice), (&TriMesh::default(), &off), Evidence::default(), self.options.solid.fit, level)
    }

    fn there_and_back(&self, radius: f64, stages: &mut stages::Stages<'_>) -> Result<Made, Error> {
        let body = Body::new(self.solid, None);
        let first = self.there(&body, radius, stages)?;
        self.back(&body, &Body::new(&first, None), radius, None, stages)
    }

    /// The first step of a closing or opening, as a surface.
    pub(super) fn there(
        &self,
        body: &Body<'_>,
        radius: f64,
        stages: &mut stages::Stages<'_>,
    ) -> Result<TriMesh, Error> {
        stages.begin("first offset")?;
        let lattice = self.lattice(radius.max(0.0))?;
        let there = offset(body, radius, &lattice, self.progress).map_err(|e| self.error(e))?;
        let off = |p| (body.at(p, radius.abs() + self.h).0 - radius).abs();
        // All triangles stay: the second distance is to this surface.
        let whole = FitOptions { tolerance: 0.0, ..self.options.solid.fit.unwrap_or_default() };
        let made =
            self.fitted((there, &lattice), (&TriMesh::default(), &off), Evidence::default(), Some(whole), radius)?;
        Ok(made.surface.mesh)
    }

    /// The second step, from `first`; within a region, or everywhere.
    pub(super) fn back(
        &self,
        body: &Body<'_>,
        first: &Body<'_>,
        radius: f64,
        region: Option<&Region<'_>>,
        stages: &mut stages::Stages<'_>,
    ) -> Result<Made, Error> {
        stages.begin("second offset")?;
        let lattice = self.lattice(0.0)?;
        let back = closed(body, first, radius, &lattice, region, self.progress).map_err(|e| self.error(e))?;
        let reached = reached(body, radius, &lattice, region, self.progress)?;
        stages.begin("fit")?;
        let evidence = Evidence::of_samples(reached.iter().map(|r| (r.tried, r.touched)));
        let off = |p| {
            let own = body.at(p, self.h).0.abs();
            if own < 1e-3 * self.h { own } else { own.min((first.at(p, radius.abs() + self.h).0 + radius).abs()) }
        };
        self.fitted((back, &lattice), (self.solid, &off), evidence, self.options.solid.fit, -radius)
    }

    /// The lattice for the solid grown by `room`, model units.
    pub(super) fn lattice(&self, room: f64) -> Result<Lattice, Error> {
        let mut bounds = super::prepare::bounds(std::slice::from_ref(self.solid))?;
        (bounds.min, bounds.max) = (bounds.min - room, bounds.max + room);
        super::prepare::lattice(&bounds, super::VoxelSize::Length(self.h))
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
            let reason = if level < 0.0 && self.options.operation != Operation::Close {
                format!("nothing is left: the solid is nowhere thicker than {}", digits::number(2.0 * level.abs()))
            } else {
                "nothing is left".into()
            };
            return Err(Error::NothingEnclosed { reason });
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
        Ok(Made { surface, own, fit: fitted })
    }

    pub(super) fn finish(&self, solid: &Outcome, made: Made, stages: stages::Stages<'_>) -> Outcome {
        let Made { surface, own, fit } = made;
        let source = |own: &Option<u32>| own.map_or(TriangleSource::Closed, |t| solid.sources[t as usize]);
        let sources: Vec<TriangleSource> = own.iter().map(source).collect();
        let mut report = solid.report.clone();
        report.closed_triangles = sources.iter().filter(|source| **source == TriangleSource::Closed).count();
        report.morphology = Some(MorphologyReport {
            operation: self.options.operation,
            radius: self.options.radius,
            volume_before: volume(self.solid),
            volume_after: volume(&surface.mesh),
            made: own.iter().filter(|own| own.is_none()).count(),
        });
        report.fit = fit;
        report.stages.extend(stages.finish());
        Outcome { mesh: surface.mesh, sources, lattice: solid.lattice, report }
    }

    pub(super) fn error(&self, error: MorphologyError) -> Error {
        match error {
            MorphologyError::Stopped(stopped) => stopped.into(),
            MorphologyError::Distance(error) => Error::VoxelSize { reason: error.to_string() },
        }
    }
}

/// Cubic model units.
pub(super) fn volume(mesh: &TriMesh) -> f64 {
    let quick = ValidateOptions { self_intersections: false, weld: false };
    validate(mesh, &quick, &Progress::none()).map_or(0.0, |validity| validity.volume)
}
