//! The pipelines: short functions that read like the drawing in the crate's documentation.

mod report;

pub use report::{LdiReport, Report, StageTime, ThinReport};

use crate::lattice::Lattice;
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::orient::OrientMode;
use crate::progress::{Progress, Stopped};
use crate::vote::VoteRule;

/// The voxel size of a pipeline. There is no default: it decides what is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VoxelSize {
    /// This many voxels along the longest side of the operands' common bounding box.
    Along(u32),
    /// This spacing, model units.
    Length(f64),
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
    /// Rays per voxel along each axis of an LDI (1 or 2); the contour needs no more than 1.
    pub supersampling: u32,
    /// Whether edges that join two faces of one voxel's cube are collapsed after contouring.
    pub collapse: bool,
    /// Upper bound for the working memory, bytes; `None`: no bound.
    pub max_memory: Option<u64>,
}

impl Options {
    /// The defaults at voxel size `voxel`.
    pub fn new(voxel: VoxelSize) -> Self {
        Self {
            voxel,
            orient: OrientMode::Auto,
            rule: VoteRule::default(),
            supersampling: 1,
            collapse: true,
            max_memory: None,
        }
    }
}

/// A finished mesh and how it came about.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The result; every coordinate is exactly an `f32`, so that any format holds it unchanged.
    pub mesh: TriMesh,
    /// The lattice that was used.
    pub lattice: Lattice,
    /// What was found and done.
    pub report: Report,
}

/// What a run would cost, before it is run.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
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
    /// More memory would be needed than allowed.
    #[error("about {needed} bytes would be needed and {allowed} are allowed; a voxel of {voxel_that_fits} would fit")]
    Memory {
        /// Estimated peak, bytes.
        needed: u64,
        /// The cap, bytes.
        allowed: u64,
        /// A voxel size that fits, model units.
        voxel_that_fits: f64,
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

/// What [`boolean`] (and [`repair`]: one operand) would cost.
pub fn plan(operands: &[TriMesh], options: &Options) -> Result<Plan, Error> {
    let _ = (operands, options);
    Err(Error::Empty { operand: 0 })
}

/// Repairs one soup: all its shells are one operand.
pub fn repair(input: &TriMesh, options: &Options, progress: &Progress) -> Result<Outcome, Error> {
    boolean(std::slice::from_ref(input), &Expression::Operand(0), options, progress)
}

/// Evaluates a boolean expression over operands, each of which may be broken.
pub fn boolean(
    operands: &[TriMesh],
    expression: &Expression,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, Error> {
    let _ = (operands, expression, options, progress);
    Err(Error::Empty { operand: 0 })
}
