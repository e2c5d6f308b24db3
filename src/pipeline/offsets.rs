//! Offsets of a solid, fitted: what dilation, erosion, closing, opening, canals and thickening are made with.

use rayon::prelude::*;

use super::crumbs::without_made_crumbs;
use super::frame::Frame;
use super::plan::{Offsets, area, check_limits};
use super::stages::Stages;
use super::{Changed, MorphologyError, Report, SurfaceOptions, VoxelSize, refine, sizing};
use crate::fit::{Facets, FitOptions, FitReport, Kept, Sides, Surface, TargetDistance, fit};
use crate::lattice::Lattice;
use crate::ldi::Evidence;
use crate::mesh::{Bounds, Solid, TriMesh, ValidateOptions, validate};
use crate::morphology::{Balls, Centres, Gauge, Offset, Region, Remain, closed, offset, reached};
use crate::progress::{Progress, Stage};
use crate::sdf::exact::{ExactDistance, PointSign};

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
pub(super) fn offset_voxel(solid: &TriMesh, voxel: VoxelSize, offsets: Offsets) -> Result<f64, MorphologyError> {
    let asked = sizing::spacing(&bounds(solid)?, voxel)?;
    let most = offsets.radius / VOXELS_OF_RADIUS[offsets.count as usize - 1];
    Ok(std::iter::successors(Some(asked), |h| Some(h / 2.0)).find(|&h| h <= most).unwrap_or(asked))
}

/// The same, or why so small ones cannot be.
pub(super) fn checked_voxel(
    solid: &TriMesh,
    surface: &SurfaceOptions,
    offsets: Offsets,
) -> Result<f64, MorphologyError> {
    let h = offset_voxel(solid, surface.voxel, offsets)?;
    check_offsets(solid, &surface.with_voxel(h), offsets)?;
    Ok(h)
}

/// An error when offsets over this voxel need more than there is.
pub(super) fn check_offsets(
    solid: &TriMesh,
    surface: &SurfaceOptions,
    offsets: Offsets,
) -> Result<(), MorphologyError> {
    let lattice = sizing::lattice(&bounds(solid)?, surface.voxel)?;
    Ok(check_limits(&[solid], &lattice, surface, offsets)?)
}

/// A radius, or why it is none.
pub(super) fn usable(radius: f64) -> Result<f64, MorphologyError> {
    if radius > 0.0 && radius.is_finite() { Ok(radius) } else { Err(MorphologyError::Radius { radius }) }
}

fn bounds(mesh: &TriMesh) -> Result<Bounds, MorphologyError> {
    sizing::bounds([mesh]).map_err(|_| MorphologyError::NothingLeft { thinner_than: None })
}

/// The fitted surface and, for each of its triangles, the solid's triangle that it lies on.
pub(super) struct Made {
    pub surface: Surface,
    pub own: Vec<Option<u32>>,
    fit: Option<FitReport>,
    /// The voxel it was made with, model units.
    pub h: f64,
    /// What no voxel shows and the surface does not have.
    pub too_thin: Vec<Remain>,
}

/// What the offsets of a solid are made with.
#[derive(Clone, Copy)]
pub(super) struct Job<'a> {
    /// The solid, near the origin.
    pub solid: &'a TriMesh,
    /// The voxel, model units.
    pub h: f64,
    pub surface: &'a SurfaceOptions,
    pub progress: &'a Progress,
}

impl Job<'_> {
    /// What `make` makes, with voxels halved while they leave something out and `is_affordable` holds.
    pub(super) fn refined(
        &self,
        offsets: Offsets,
        is_affordable: impl Fn(f64) -> bool,
        mut make: impl FnMut(&Self) -> Result<Made, MorphologyError>,
    ) -> Result<Made, MorphologyError> {
        let longest = bounds(self.solid)?.size().max_element();
        let finest = (self.h / f64::from(1u32 << MOST_HALVINGS)).max((longest / MOST_ALONG).min(self.h / 2.0));
        let mut run = *self;
        loop {
            let made = make(&run)?;
            let shows = |&h: &f64| {
                let held = made.too_thin.iter().filter(|remain| remain.thickness >= h).count();
                held > 0 && 2 * held >= made.too_thin.len()
            };
            let worth = WORTH[offsets.count as usize - 1];
            if !made.surface.mesh.triangles.is_empty() && thin_share(&made.too_thin, &made.surface.mesh) < worth {
                return Ok(made);
            }
            let finer = std::iter::successors(Some(run.h / 2.0), |h| Some(h / 2.0)).take_while(|&h| h >= finest);
            match finer.take_while(|&h| is_affordable(h)).find(shows) {
                Some(h) => run.h = h,
                None if made.surface.mesh.triangles.is_empty() => {
                    return Err(MorphologyError::AllTooThin { voxel: run.h });
                }
                None => return Ok(made),
            }
        }
    }

    /// One offset. `reach`: how many times its level the farthest corners are away from the solid.
    pub(super) fn one_way(
        &self,
        body: &Gauge<'_>,
        level: f64,
        reach: f64,
        stages: &mut Stages<'_>,
    ) -> Result<Made, MorphologyError> {
        stages.begin(Stage::Offset)?;
        let lattice = self.lattice(level.max(0.0) * reach)?;
        let offset = offset(body, level, &lattice, self.progress)?;
        stages.begin(Stage::Fit)?;
        let off = |p| (body.at(p, level.abs() + self.h).0 - level).abs();
        self.fitted(
            (offset, &lattice),
            (&TriMesh::default(), &off),
            &Kept::default(),
            self.surface.fit,
            thinner_than(level),
        )
    }

    pub(super) fn there_and_back(&self, radius: f64, stages: &mut Stages<'_>) -> Result<Made, MorphologyError> {
        let body = Gauge::new(self.solid, None);
        let centres = self.there(&body, radius, stages)?;
        self.back(&body, &Balls::new(&centres, radius), radius, None, stages)
    }

    /// The first step of a closing or opening: where centres of balls can be.
    pub(super) fn there(
        &self,
        body: &Gauge<'_>,
        radius: f64,
        stages: &mut Stages<'_>,
    ) -> Result<Centres, MorphologyError> {
        stages.begin(Stage::FirstOffset)?;
        let lattice = self.lattice(radius.max(0.0))?;
        let mut there = offset(body, radius, &lattice, self.progress)?;
        let between = std::mem::take(&mut there.remains);
        if there.contour.mesh.triangles.is_empty() && !between.is_empty() {
            return Ok(Centres::new(TriMesh::default(), &between, self.h));
        }
        let off = |p| (body.at(p, radius.abs() + self.h).0 - radius).abs();
        // All triangles stay: the second distance is to this surface.
        let whole = FitOptions { simplify: 0.0, ..self.surface.fit.unwrap_or_default() };
        let made = self.fitted(
            (there, &lattice),
            (&TriMesh::default(), &off),
            &Kept::default(),
            Some(whole),
            thinner_than(radius),
        )?;
        Ok(Centres::new(made.surface.mesh, &between, self.h))
    }

    /// The second step, by the balls of the first; within a region, or everywhere.
    pub(super) fn back(
        &self,
        body: &Gauge<'_>,
        balls: &Balls<'_>,
        radius: f64,
        region: Option<&Region<'_>>,
        stages: &mut Stages<'_>,
    ) -> Result<Made, MorphologyError> {
        stages.begin(Stage::SecondOffset)?;
        let lattice = self.lattice(0.0)?;
        let back = closed(body, balls, &lattice, region, self.progress)?;
        let reached = reached(body, radius, &lattice, region, self.progress)?;
        if !back.changed && reached.iter().all(|reached| reached.touched == reached.tried) {
            return Ok(self.unchanged());
        }
        stages.begin(Stage::Fit)?;
        let evidence = Evidence::of_samples(reached.iter().map(|r| (r.tried, r.touched)));
        let kept = match self.surface.keeps() {
            true => Kept::of(self.solid, &evidence, self.h, self.progress)?,
            false => Kept::default(),
        };
        let off = |p| {
            let own = body.at(p, self.h).0.abs();
            if own < 1e-3 * self.h { own } else { own.min(balls.at(p, self.h).0.abs()) }
        };
        self.fitted((back.offset, &lattice), (self.solid, &off), &kept, self.surface.fit, None)
    }

    /// The solid as it is.
    fn unchanged(&self) -> Made {
        let own = (0..self.solid.triangles.len() as u32).map(Some).collect();
        let surface = Surface::new(self.solid.clone(), vec![Sides::of([]); self.solid.positions.len()]);
        Made { surface, own, fit: None, h: self.h, too_thin: Vec::new() }
    }

    /// The lattice for the solid grown by `room`, model units.
    pub(super) fn lattice(&self, room: f64) -> Result<Lattice, MorphologyError> {
        let mut bounds = bounds(self.solid)?;
        (bounds.min, bounds.max) = (bounds.min - room, bounds.max + room);
        Ok(sizing::lattice(&bounds, VoxelSize::Length(self.h))?)
    }

    fn fitted(
        &self,
        (offset, lattice): (Offset, &Lattice),
        (source, off): (&TriMesh, TargetDistance<'_>),
        kept: &Kept,
        options: Option<FitOptions>,
        thinner_than: Option<f64>,
    ) -> Result<Made, MorphologyError> {
        if offset.contour.mesh.triangles.is_empty() {
            if offset.remains.is_empty() {
                return Err(MorphologyError::NothingLeft { thinner_than });
            }
            let surface = Surface::new(TriMesh::default(), Vec::new());
            return Ok(Made { surface, own: Vec::new(), fit: None, h: self.h, too_thin: offset.remains });
        }
        let facets = Facets::new(source, offset.planes).with_target(off);
        let mut surface = refine::merged(offset.contour, &facets, lattice, self.surface, self.progress)?;
        let mut fitted = None;
        if let Some(options) = options {
            let options = FitOptions { rebuild: options.rebuild || source.triangles.is_empty(), ..options };
            let (fit, report) = fit(&surface, &facets, kept, self.h, &options, self.progress)?;
            (surface, fitted) = (fit, Some(report));
        }
        let own = |t: u32| surface.facet(&facets, t).and_then(|facet| facets.triangle(facet));
        let own = (0..surface.mesh.triangles.len() as u32).map(own).collect();
        let too_thin = self.left_out(&offset.remains, &surface.mesh);
        Ok(Made { surface, own, fit: fitted, h: self.h, too_thin })
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

    /// The judged result of operations on `solid`, where that is.
    pub(super) fn finish(
        &self,
        made: Made,
        (solid, frame): (&Solid, &Frame),
        mut report: Report,
        stages: Stages<'_>,
    ) -> Result<Changed, MorphologyError> {
        let Made { surface, mut own, fit, h, .. } = made;
        let mut mesh = surface.mesh;
        report.crumbs = without_made_crumbs(&mut mesh, &mut own, h);
        report.fit = fit;
        report.stages = stages.finish();
        let lattice = frame.global_lattice(Self { h, ..*self }.lattice(0.0)?);
        if mesh == *self.solid {
            return Ok(Changed { solid: solid.clone(), own, lattice, report });
        }
        frame.mesh(&mut mesh);
        Ok(Changed { solid: Solid::check(mesh, self.progress)?, own, lattice, report })
    }
}

/// Of a solid of which an erosion leaves nothing: how thick it is at most.
fn thinner_than(level: f64) -> Option<f64> {
    (level < 0.0).then_some(-2.0 * level)
}

/// The part that is missing of a surface.
pub(super) fn thin_share(missing: &[Remain], surface: &TriMesh) -> f64 {
    let missing: f64 = missing.iter().map(|remain| remain.area).sum();
    if missing > 0.0 { missing / (missing + area(surface)) } else { 0.0 }
}

pub(super) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().filter(|&value| value > 0.0)
}

/// Cubic model units.
pub(super) fn volume(mesh: &TriMesh) -> f64 {
    let quick = ValidateOptions { self_intersections: false, weld: false };
    validate(mesh, &quick, &Progress::none()).map_or(0.0, |validity| validity.volume)
}
