//! Options that several pipelines share.

use serde::Serialize;

use crate::backend::Backend;
use crate::fill::Style;
use crate::fit::FitOptions;
use crate::ldi::Inside;
use crate::orient::OrientMode;
use crate::sdf::{RobustOptions, Trust};
use crate::vote::VoteRule;

/// The voxel size of a pipeline. There is no default: it decides what is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VoxelSize {
    /// This many voxels along the longest side of the operands' common bounding box.
    Along(u32),
    /// This spacing, model units.
    Length(f64),
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

/// Options of [`repair`](super::repair) and [`boolean`](super::boolean).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Spacing of the lattice.
    pub voxel: VoxelSize,
    /// Which way the result is made.
    pub method: Method,
    /// Orientation of the input.
    pub orient: OrientMode,
    /// Which winding numbers of an operand are inside.
    pub inside: Inside,
    /// How far vertices at cracks may move so that these close before anything is called a hole, model units; `None`: a [small share](crate::zip::USUAL) of
    /// the diagonal; 0: not at all. Closed operands are left alone.
    pub tolerance: Option<f64>,
    /// How holes are closed that a lid over their rim alone closes; others get the level ½ of the winding number, from voxels.
    pub fill: Style,
    /// Voting rule.
    pub vote: VoteRule,
    /// The distance field near the surface; `None`: as the voting rule needs it.
    pub robust: Option<RobustOptions>,
    /// Whether edges that join two faces of one voxel's cube are collapsed after contouring.
    pub collapse: bool,
    /// Sharp edges and corners, and fewer triangles where the surface is flat; `None`: the contour as it is.
    pub fit: Option<FitOptions>,
    /// Upper bound for the working memory, bytes; `None`: no bound.
    pub max_memory: Option<u64>,
    /// Which processor casts the rays.
    pub backend: Backend,
    /// What numbers the result may have: those of the format that it is for.
    pub precision: Precision,
}

/// Which way a result is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Exactly, where the operands are closed once they are cut where they cross; else from voxels.
    #[default]
    Auto,
    /// Exactly, or not at all: an operand with holes is an error.
    Exact,
    /// From voxels, apart from shells that are closed and touch nothing.
    Voxel,
}

/// How a pipeline that is given a solid makes surface anew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceOptions {
    /// Spacing of the lattice.
    pub voxel: VoxelSize,
    /// Whether edges that join two faces of one voxel's cube are collapsed after contouring.
    pub collapse: bool,
    /// Sharp edges and corners, and fewer triangles where the surface is flat; `None`: the contour as it is.
    pub fit: Option<FitOptions>,
    /// Upper bound for the working memory, bytes; `None`: no bound.
    pub max_memory: Option<u64>,
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

impl Precision {
    /// What a format holds.
    pub fn of_format(format: crate::io::Format) -> Self {
        if format.is_single() { Self::Single } else { Self::Double }
    }
}

impl Options {
    /// Whether triangles of the source that are right stay as they are.
    pub(super) fn keeps(&self) -> bool {
        self.surface().keeps()
    }

    /// The defaults at voxel size `voxel`.
    pub fn new(voxel: VoxelSize) -> Self {
        let SurfaceOptions { voxel, collapse, fit, max_memory, precision } = SurfaceOptions::new(voxel);
        Self {
            voxel,
            method: Method::default(),
            orient: OrientMode::Auto,
            inside: Inside::default(),
            tolerance: None,
            fill: Style::default(),
            vote: VoteRule::default(),
            robust: None,
            collapse,
            fit,
            max_memory,
            backend: Backend::default(),
            precision,
        }
    }

    /// The part that says how surface is made anew.
    pub fn surface(&self) -> SurfaceOptions {
        let Self { voxel, collapse, fit, max_memory, precision, .. } = *self;
        SurfaceOptions { voxel, collapse, fit, max_memory, precision }
    }

    /// The distance field near the surface. Only votes that end in the winding number have no noise to be smoothed away.
    pub(super) fn robust(&self) -> RobustOptions {
        let trust = if self.vote == VoteRule::Winding { Trust::All } else { Trust::Sure };
        self.robust.unwrap_or(RobustOptions { trust, ..RobustOptions::default() })
    }
}

impl SurfaceOptions {
    /// Whether triangles of the source that are right stay as they are.
    pub(super) fn keeps(&self) -> bool {
        self.fit.is_some_and(|fit| !fit.rebuild)
    }

    /// The defaults at voxel size `voxel`.
    pub fn new(voxel: VoxelSize) -> Self {
        Self {
            voxel,
            collapse: true,
            fit: Some(FitOptions::default()),
            max_memory: None,
            precision: Precision::default(),
        }
    }

    /// The same at another voxel, model units.
    pub(super) fn with_voxel(self, h: f64) -> Self {
        Self { voxel: VoxelSize::Length(h), ..self }
    }
}

impl From<SurfaceOptions> for Options {
    fn from(surface: SurfaceOptions) -> Self {
        let SurfaceOptions { voxel, collapse, fit, max_memory, precision } = surface;
        Self { collapse, fit, max_memory, precision, ..Self::new(voxel) }
    }
}

impl From<VoxelSize> for Options {
    fn from(voxel: VoxelSize) -> Self {
        Self::new(voxel)
    }
}

impl From<&Self> for Options {
    fn from(options: &Self) -> Self {
        *options
    }
}

impl From<VoxelSize> for SurfaceOptions {
    fn from(voxel: VoxelSize) -> Self {
        Self::new(voxel)
    }
}

impl From<&Self> for SurfaceOptions {
    fn from(options: &Self) -> Self {
        *options
    }
}
