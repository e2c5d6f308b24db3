//! The pipelines: short functions that read like the drawing in the crate's documentation.

mod apart;
mod backend;
mod canals;
mod colours;
mod crumbs;
mod distance;
mod field;
mod frame;
mod hollow;
mod kind;
mod morphology;
mod order;
mod plan;
mod prepare;
mod rebuild;
mod refine;
mod report;
mod solid;
mod stages;
mod survey;
mod textures;
mod thicken;
mod thickness;
mod topology;
mod work;

pub use apart::StandingReport;
pub use backend::{Backend, BackendReport};
pub use canals::{CanalOptions, CanalOutcome, CanalReport, Remove, canals};
pub use colours::{carry_colours, carry_to_simpler, classes};
pub use crumbs::{Dropped, drop_smaller};
pub use distance::{
    DistanceMethod, DistanceOptions, DistanceOutcome, DistancePlan, DistanceReport, DistanceSign, distance,
    plan_distance,
};
pub use field::{
    Built, FieldBand, FieldBuilder, FieldReport, Operand, OperandReport, field_grid, field_spacing, field_surface,
    field_values,
};
pub use hollow::{Drain, DrainReport, HollowOptions, HollowReport, hollow};
pub use kind::{TriangleCounts, TriangleKind, kinds};
pub use morphology::{MorphologyOptions, MorphologyReport, morphology};
pub use plan::{plan, plan_canals, plan_hollow, plan_morphology, plan_thicken};
pub use prepare::MAX_RESOLUTION;
pub use report::{LdiReport, Report, StageTime, ThinRegion, ThinReport};
pub use textures::{carry_texture, carry_texture_to_simpler, classes_of};
pub use thicken::{SheetSide, ThickenOptions, ThickenReport, thicken};
pub use thickness::{LengthsReport, ThicknessReport, thickness};
pub use topology::{LostBody, Topology, TopologyReport};
pub use work::Work;

use apart::Apart;
use frame::Frame;
use serde::Serialize;

use crate::field::filter::FilterError;
use crate::fit::FitOptions;
use crate::lattice::Lattice;
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::orient::OrientMode;
use crate::progress::{Progress, Stage, Stopped};
use crate::sdf::RobustOptions;
use crate::vote::VoteRule;

/// The voxel size of a pipeline. There is no default: it decides what is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VoxelSize {
    /// This many voxels along the longest side of the operands' common bounding box.
    Along(u32),
    /// This spacing, model units.
    Length(f64),
}

impl Precision {
    /// What a format holds.
    pub fn of_format(format: crate::io::Format) -> Self {
        if format.is_single() { Self::Single } else { Self::Double }
    }
}

impl VoxelSize {
    /// The spacing, model units, for operands whose common bounding box has this longest side.
    pub fn spacing(self, longest: f64) -> f64 {
        match self {
            Self::Along(count) => longest / f64::from(count),
            Self::Length(h) => h,
        }
    }
}

/// Options of [`repair`] and [`boolean`].
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Spacing of the lattice.
    pub voxel: VoxelSize,
    /// Orientation of the input.
    pub orient: OrientMode,
    /// Voting rule.
    pub rule: VoteRule,
    /// The distance field near the surface.
    pub robust: RobustOptions,
    /// Whether edges that join two faces of one voxel's cube are collapsed after contouring.
    pub collapse: bool,
    /// Sharp edges and corners, and fewer triangles where the surface is flat; `None`: the contour as it is.
    pub fit: Option<FitOptions>,
    /// For each operand a number for each of its triangles, or nothing: simplification keeps apart what
    /// has different numbers (colours, for instance; see [`classes`]).
    pub classes: Vec<Vec<u32>>,
    /// Upper bound for the working memory, bytes; `None`: no bound.
    pub max_memory: Option<u64>,
    /// Which processor makes the layered depth images.
    pub backend: Backend,
    /// What numbers the result may have: those of the format that it is for.
    pub precision: Precision,
}

/// What numbers a result may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Every coordinate is an `f32`, so that STL and glTF hold it unchanged, and the result is valid with these; only for operands far from the
    /// origin, which are worked on near it, coordinates get the offset back and have more digits.
    Single,
    /// What stays as it was keeps its `f64` coordinates; what is made has those of an `f32`, seen from near the operands.
    #[default]
    Double,
}

impl Options {
    /// The defaults at voxel size `voxel`.
    pub fn new(voxel: VoxelSize) -> Self {
        Self {
            voxel,
            orient: OrientMode::Auto,
            rule: VoteRule::default(),
            robust: RobustOptions::default(),
            collapse: true,
            fit: Some(FitOptions::default()),
            classes: Vec::new(),
            max_memory: None,
            backend: Backend::default(),
            precision: Precision::default(),
        }
    }
}

/// A finished mesh and how it came about.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The result; for its coordinates see [`Precision`].
    pub mesh: TriMesh,
    /// Where each triangle comes from.
    pub sources: Vec<TriangleSource>,
    /// The lattice on which surface was made; without voxels where none was, see [`Report::lattice`].
    pub lattice: Lattice,
    /// What was found and done.
    pub report: Report,
}

/// Where a triangle of the result comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TriangleSource {
    /// It lies on a triangle of an operand.
    Operand {
        /// Number of the operand, from 0.
        operand: u32,
        /// Number of the triangle in it.
        triangle: u32,
    },
    /// It closes a hole: no triangle of an operand is there.
    Closed,
}

/// What a run would cost, before it is run.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z.
    pub dims: [i32; 3],
    /// Estimated voxels near the surface.
    pub voxels_near_surface: u64,
    /// Estimated triangles of the result.
    pub triangles: u64,
    /// Estimated peak memory, bytes.
    pub memory: u64,
    /// Estimated seconds on one core of an ordinary machine.
    pub seconds: f64,
}

/// Why a pipeline gave no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// An operand has no triangles with area.
    #[error("operand {operand} has no triangle with an area")]
    Empty {
        /// Number of the operand, from 0.
        operand: usize,
    },
    /// The result encloses nothing (an open sheet, an empty intersection, walls far below h).
    #[error("{reason}")]
    NothingEnclosed {
        /// One sentence: why, and what to try.
        reason: String,
    },
    /// The voxel size cannot be used with these coordinates.
    #[error("{reason}")]
    VoxelSize {
        /// One sentence: why, and what to try.
        reason: String,
    },
    /// The operands are beyond what the program can number, however much memory there is.
    #[error("{reason}")]
    TooLarge {
        /// One sentence: what is too many, and what to try.
        reason: String,
    },
    /// More memory would be needed than allowed.
    #[error("about {} MB would be needed and {} MB are allowed{}", needed / 1_000_000, allowed / 1_000_000, fits(voxel_that_fits))]
    Memory {
        /// Estimated peak, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
        /// A voxel size that fits, model units; `None` when no size does.
        voxel_that_fits: Option<f64>,
    },
    /// A piece of memory could not be had.
    #[error("{reason}")]
    NoRoom {
        /// One sentence: for what, and what to try.
        reason: String,
    },
    /// A filter cannot be.
    #[error(transparent)]
    Filter(FilterError),
    /// A canal was to be filled that is not in the list.
    #[error("there is no canal {number}: {count} {} found", if *count == 1 { "was" } else { "were" })]
    MissingCanal {
        /// The number that was given.
        number: u32,
        /// Canals found.
        count: u32,
    },
    /// A drain that leads nowhere.
    #[error("{reason}")]
    Drain {
        /// One sentence: which, where, and why.
        reason: String,
    },
    /// The graphics processor was asked for and cannot do it.
    #[error("{reason}")]
    Gpu {
        /// One sentence: why.
        reason: String,
        /// What to try.
        hint: String,
    },
    /// The expression names an operand that was not given.
    #[error("the expression names operand {operand}, but only {given} were given")]
    MissingOperand {
        /// Number of the operand, from 0.
        operand: usize,
        /// Operands given.
        given: usize,
    },
}

fn fits(voxel: &Option<f64>) -> String {
    voxel.as_ref().map_or_else(
        || "; no voxel size would fit".into(),
        |h| format!("; a voxel of {} would fit", crate::digits::rounded_up(*h)),
    )
}

/// Repairs one soup: all its shells are one operand.
pub fn repair(input: &TriMesh, options: &Options, progress: &Progress) -> Result<Outcome, Error> {
    boolean(std::slice::from_ref(input), &Expression::Operand(0), options, progress)
}

/// Evaluates a boolean expression over operands, each of which may be broken. Shells that are closed and touch nothing stay as they
/// are; rays and voxels decide about the rest. The order of the operands does not matter: what says the same has the same result.
///
/// # Errors
/// See [`Error`].
pub fn boolean(
    operands: &[TriMesh],
    expression: &Expression,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, Error> {
    let needed = expression.operand_count();
    if needed > operands.len() {
        return Err(Error::MissingOperand { operand: needed - 1, given: operands.len() });
    }
    order::in_order(operands, expression, options, |operands, expression, options| {
        evaluate(operands, expression, options, progress)
    })
}

/// [`boolean`] for operands in their order.
fn evaluate(
    operands: &[TriMesh],
    expression: &Expression,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, Error> {
    let frame = Frame::of(operands, options);
    let operands = &*frame.local(operands);
    let h = prepare::spacing(&prepare::bounds(operands)?, options.voxel)?;
    plan::check_standing(operands.iter().map(|operand| operand.triangles.len()).sum(), options)?;
    let mut stages = stages::Stages::new(progress);
    stages.begin(Stage::Orient)?;
    let soup = prepare::prepare(operands, options.orient, progress)?;
    stages.begin(Stage::Shells)?;
    let mut apart = Apart::find(&soup, expression, options, progress)?;
    let standing = apart.surface(&soup, operands, options, h, progress)?;
    let job = rebuild::Job { expression, options, h, progress };
    let outcome = match apart.split(soup) {
        (rest, None) => job.alone(rest, h, &mut stages)?,
        (rest, Some(whole)) => match job.beside(rest, standing, &mut stages)? {
            Some(outcome) => outcome,
            None => {
                // What was made runs into what stands: all of it is made together.
                apart = apart.none_standing();
                job.alone(whole, h, &mut stages)?
            }
        },
    };
    Ok(frame.global(kind::counted(report::finished(outcome, &apart, stages), operands)))
}
