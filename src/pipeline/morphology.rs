//! Dilate, erode, close and open.

use serde::Serialize;

use super::frame::Frame;
use super::offsets::{Job, Made, check_offsets, checked_voxel, median, offset_voxel, thin_share, usable, volume};
use super::plan::{Offsets, of_offsets};
use super::stages::Stages;
use super::{Changed, LatticeError, LimitError, Plan, Report, SurfaceOptions, sizing};
use crate::digits;
use crate::mesh::{IndexError, NotSolid, Solid, SolidError, TriMesh};
use crate::morphology::{Gauge, OffsetError, Operation, places};
use crate::progress::{Progress, Stopped};
use crate::sdf::exact::ExactError;

/// Options of [`morphology`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MorphologyOptions {
    /// What is done.
    pub operation: Operation,
    /// The radius of the ball, model units, more than 0.
    pub radius: f64,
    /// Dilate and erode: edges that would become round stay sharp up to this many times the radius from where they were;
    /// `None`: round.
    pub sharp: Option<f64>,
    /// How the new surface is made.
    pub surface: SurfaceOptions,
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

/// Why an operation on a solid gave none. Lengths are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MorphologyError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The radius is no positive number.
    #[error("a radius of {} cannot be used; it must be above zero", digits::number(*radius))]
    Radius {
        /// The radius that was asked for.
        radius: f64,
    },
    /// The voxel size cannot be used with these coordinates.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// More memory or larger numbers would be needed than there are.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The distance to the solid could not be found.
    #[error(transparent)]
    Distance(ExactError),
    /// Nothing of the solid is left.
    #[error("nothing is left{}", thinner_than.map_or(String::new(), |t| format!(": the solid is nowhere thicker than {}", digits::number(t))))]
    NothingLeft {
        /// The solid is nowhere thicker than this; `None` where it is not that.
        thinner_than: Option<f64>,
    },
    /// What is left is too thin for the voxels.
    #[error("what is left is thinner than a voxel of {} everywhere: a smaller voxel shows it", digits::number(*voxel))]
    AllTooThin {
        /// The smallest voxel that was tried.
        voxel: f64,
    },
    /// What was made refers to a vertex that is not there.
    #[error(transparent)]
    Index(IndexError),
    /// What was made is not a valid solid. The fit sees to it that it is; without one, it may not be.
    #[error(transparent)]
    NotSolid(Box<NotSolid>),
}

/// Which voxels an offset is made with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Voxels {
    /// Those that were asked for, halved where they do not show what is left.
    AsNeeded,
    /// Those that the radius needs: what is thinner is not wanted.
    OfRadius,
}

impl Solid {
    /// All points within `radius` (model units) of the solid: [`morphology`] with [`Operation::Dilate`].
    ///
    /// # Errors
    /// See [`MorphologyError`].
    pub fn dilate(&self, radius: f64, surface: impl Into<SurfaceOptions>) -> Result<Self, MorphologyError> {
        self.by(Operation::Dilate, radius, surface)
    }

    /// All points of the solid farther than `radius` (model units) from its outside: [`morphology`] with [`Operation::Erode`].
    ///
    /// # Errors
    /// See [`MorphologyError`].
    pub fn erode(&self, radius: f64, surface: impl Into<SurfaceOptions>) -> Result<Self, MorphologyError> {
        self.by(Operation::Erode, radius, surface)
    }

    /// The solid with everything filled that a ball of `radius` (model units) outside cannot reach: [`morphology`] with
    /// [`Operation::Close`]. The rest of the surface stays as it is.
    ///
    /// # Errors
    /// See [`MorphologyError`].
    pub fn close(&self, radius: f64, surface: impl Into<SurfaceOptions>) -> Result<Self, MorphologyError> {
        self.by(Operation::Close, radius, surface)
    }

    /// The solid without everything that a ball of `radius` (model units) inside cannot reach: [`morphology`] with
    /// [`Operation::Open`]. The rest of the surface stays as it is.
    ///
    /// # Errors
    /// See [`MorphologyError`].
    pub fn open(&self, radius: f64, surface: impl Into<SurfaceOptions>) -> Result<Self, MorphologyError> {
        self.by(Operation::Open, radius, surface)
    }

    fn by(
        &self,
        operation: Operation,
        radius: f64,
        surface: impl Into<SurfaceOptions>,
    ) -> Result<Self, MorphologyError> {
        let options = MorphologyOptions { operation, radius, sharp: None, surface: surface.into() };
        morphology(self, &options, &Progress::none()).map(|changed| changed.solid)
    }
}

/// Dilates, erodes, closes or opens a solid.
///
/// # Errors
/// See [`MorphologyError`].
pub fn morphology(solid: &Solid, options: &MorphologyOptions, progress: &Progress) -> Result<Changed, MorphologyError> {
    with_voxels(solid, options, Voxels::AsNeeded, progress)
}

/// [`morphology`] with certain voxels.
pub(super) fn with_voxels(
    solid: &Solid,
    options: &MorphologyOptions,
    voxels: Voxels,
    progress: &Progress,
) -> Result<Changed, MorphologyError> {
    let (radius, surface) = (usable(options.radius)?, &options.surface);
    let frame = Frame::of(&[solid], surface);
    let local = frame.local(solid);
    let offsets = options.offsets();
    let h = checked_voxel(&local, surface, offsets)?;
    let mut stages = Stages::new(progress);
    let job = Job { solid: &local, h, surface, progress };
    let finer = |h: f64| voxels == Voxels::AsNeeded && check_offsets(&local, &surface.with_voxel(h), offsets).is_ok();
    let made = match options.operation {
        Operation::Dilate | Operation::Erode => {
            let level = if options.operation == Operation::Dilate { radius } else { -radius };
            let (body, reach) = (Gauge::new(&local, options.sharp), options.sharp.unwrap_or(1.0));
            job.refined(offsets, finer, |job| job.one_way(&body, level, reach, &mut stages))?
        }
        Operation::Close => job.refined(offsets, finer, |job| job.there_and_back(radius, &mut stages))?,
        Operation::Open => job.refined(offsets, finer, |job| job.there_and_back(-radius, &mut stages))?,
    };
    let mut account = options.account(&local, &made);
    account.thin_place.iter_mut().for_each(|place| frame.place(place));
    let mut changed = job.finish(made, (solid, &frame), Report::default(), stages)?;
    account.volume_after = volume(&changed.solid);
    account.made = changed.own.iter().filter(|own| own.is_none()).count();
    changed.report.morphology = Some(account);
    Ok(changed)
}

/// What [`morphology`] would cost for a solid that is about where `mesh` is.
///
/// # Errors
/// Those of [`morphology`] that come before anything is made.
pub fn plan_morphology(mesh: &TriMesh, options: &MorphologyOptions) -> Result<Plan, MorphologyError> {
    usable(options.radius)?;
    plan_offsets(mesh, &options.surface, options.offsets())
}

/// What as many offsets would cost.
pub(super) fn plan_offsets(
    mesh: &TriMesh,
    surface: &SurfaceOptions,
    offsets: Offsets,
) -> Result<Plan, MorphologyError> {
    let frame = Frame::of(&[mesh], surface);
    let local = frame.local(mesh);
    let h = if offsets.thin { None } else { Some(offset_voxel(&local, surface.voxel, offsets)?) };
    let surface = h.map_or(*surface, |h| surface.with_voxel(h));
    let bounds = sizing::bounds([&*local]).map_err(|_| MorphologyError::NothingLeft { thinner_than: None })?;
    Ok(of_offsets(&local, &sizing::lattice(&bounds, surface.voxel)?, &surface, offsets))
}

impl MorphologyOptions {
    fn offsets(&self) -> Offsets {
        Offsets { count: self.operation.offsets(), radius: self.radius, thin: false }
    }

    /// What is known of the result before it is judged.
    fn account(&self, solid: &TriMesh, made: &Made) -> MorphologyReport {
        MorphologyReport {
            operation: self.operation,
            radius: self.radius,
            volume_before: volume(solid),
            volume_after: 0.0,
            made: 0,
            voxel: made.h,
            too_thin: places(&made.too_thin, 2.0 * made.h),
            thin_place: made.too_thin.first().map(|remain| remain.point.to_array()),
            thin_share: thin_share(&made.too_thin, &made.surface.mesh),
            voxel_that_holds: median(made.too_thin.iter().map(|remain| remain.thickness)),
        }
    }
}

impl From<OffsetError> for MorphologyError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Stopped(stopped) => Self::Stopped(stopped),
            OffsetError::Distance(error) => Self::Distance(error),
        }
    }
}

impl From<SolidError> for MorphologyError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Stopped(stopped) => Self::Stopped(stopped),
            SolidError::Index(error) => Self::Index(error),
            SolidError::NotSolid(what) => Self::NotSolid(what),
        }
    }
}
