//! The canals of a solid: which there are, and the solid without them.

use serde::Serialize;

use super::frame::Frame;
use super::morphology::plan_offsets;
use super::offsets::{Job, checked_voxel, usable};
use super::plan::Offsets;
use super::stages::Stages;
use super::{Changed, MorphologyError, Plan, Report, StageTime, SurfaceOptions};
use crate::mesh::{Solid, TriMesh};
use crate::morphology::{self, Balls, Canal, Gauge, OffsetError};
use crate::progress::{Progress, Stage, Stopped};

/// Options of [`canals`].
#[derive(Debug, Clone, PartialEq)]
pub struct CanalOptions {
    /// Canals through which no ball of this diameter passes, model units, are listed.
    pub max_diameter: f64,
    /// Which of them are filled.
    pub remove: Remove,
    /// How the new surface is made.
    pub surface: SurfaceOptions,
}

/// Which canals are filled.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remove {
    /// None: they are only listed.
    None,
    /// All.
    All,
    /// Those with these numbers.
    These(Vec<u32>),
}

/// What was found of canals.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CanalReport {
    /// The diameter that was asked for, model units.
    pub max_diameter: f64,
    /// The canals, the widest first.
    pub canals: Vec<Canal>,
    /// Shallow places that a closing would round besides: inner edges and dents.
    pub roundings: usize,
    /// Numbers of the canals that were filled.
    pub removed: Vec<u32>,
}

/// The canals of a solid.
#[derive(Debug, Clone)]
pub struct CanalOutcome {
    /// The list.
    pub report: CanalReport,
    /// For each triangle of the solid the number of the canal that it bounds, 0 for none.
    pub canal_of: Vec<u32>,
    /// The solid without the canals that were to be filled; `None` when there was none to fill.
    pub filled: Option<Changed>,
    /// Wall-clock time of each stage, in order.
    pub stages: Vec<StageTime>,
}

/// Why there is no list of canals.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CanalError {
    /// The closing that finds them gave nothing.
    #[error(transparent)]
    Closing(#[from] MorphologyError),
    /// A canal was to be filled that is not in the list.
    #[error("there is no canal {number}: {count} {} found", if *count == 1 { "was" } else { "were" })]
    Missing {
        /// The number that was given.
        number: u32,
        /// Canals found.
        count: u32,
    },
}

/// Lists the canals of a solid that a closing would fill; fills those that were asked for, and leaves the rest of
/// the surface as it was.
///
/// # Errors
/// See [`CanalError`].
pub fn canals(solid: &Solid, options: &CanalOptions, progress: &Progress) -> Result<CanalOutcome, CanalError> {
    let radius = usable(options.max_diameter / 2.0)?;
    let frame = Frame::of(&[solid], &options.surface);
    let local = frame.local(solid);
    let h = checked_voxel(&local, &options.surface, offsets(radius))?;
    let mut stages = Stages::new(progress);
    let job = Job { solid: &local, h, surface: &options.surface, progress };

    let body = Gauge::new(&local, None);
    let centres = job.there(&body, radius, &mut stages)?;
    let balls = Balls::new(&centres, radius);
    stages.begin(Stage::Canals)?;
    let lattice = job.lattice(0.0)?;
    let mut found = morphology::canals(&body, (&balls, &centres), &lattice, progress)?;
    let removed = chosen(&options.remove, found.list.len() as u32)?;
    let canal_of = found.walls(&local, &lattice);
    let filled = if removed.is_empty() {
        None
    } else {
        let region = found.region(|number| removed.contains(&number));
        let made = job.back(&body, &balls, radius, Some(&region), &mut stages)?;
        Some(job.finish(made, (solid, &frame), Report::default(), Stages::new(progress))?)
    };
    found.list.iter_mut().for_each(|canal| frame.place(&mut canal.position));
    let (max_diameter, roundings) = (options.max_diameter, found.roundings);
    let report = CanalReport { max_diameter, canals: found.list, roundings, removed };
    Ok(CanalOutcome { report, canal_of, filled, stages: stages.finish() })
}

/// What [`canals`] would cost for a solid that is about where `mesh` is.
///
/// # Errors
/// Those of [`canals`] that come before anything is made.
pub fn plan_canals(mesh: &TriMesh, options: &CanalOptions) -> Result<Plan, CanalError> {
    let radius = usable(options.max_diameter / 2.0)?;
    Ok(plan_offsets(mesh, &options.surface, offsets(radius))?)
}

fn offsets(radius: f64) -> Offsets {
    Offsets { count: 2, radius, thin: false }
}

impl From<Stopped> for CanalError {
    fn from(stopped: Stopped) -> Self {
        Self::Closing(stopped.into())
    }
}

impl From<OffsetError> for CanalError {
    fn from(error: OffsetError) -> Self {
        Self::Closing(error.into())
    }
}

/// The numbers that are meant, of `count`.
fn chosen(remove: &Remove, count: u32) -> Result<Vec<u32>, CanalError> {
    match remove {
        Remove::None => Ok(Vec::new()),
        Remove::All => Ok((1..=count).collect()),
        Remove::These(numbers) => match numbers.iter().find(|&&number| number == 0 || number > count) {
            Some(&number) => Err(CanalError::Missing { number, count }),
            None => Ok((1..=count).filter(|number| numbers.contains(number)).collect()),
        },
    }
}
