//! The pipelines: short functions that read like the drawing in the crate's documentation.
//!
//! [`repair`] and [`boolean`] make a [`Solid`](crate::mesh::Solid) of meshes that may be broken. [`morphology`], [`canals`], [`thicken`] and
//! [`hollow`] take a solid and give [`Changed`]; [`Outcome::followed_by`] puts that behind what the solid came from. Each has its own options, its
//! own plan and its own errors.

mod advice;
mod apart;
mod boolean;
mod canals;
mod changed;
mod colours;
mod crumbs;
mod distance;
mod field;
mod frame;
mod hollow;
mod kind;
mod morphology;
mod nothing;
mod offsets;
mod operand;
mod options;
mod order;
mod outcome;
mod outlook;
mod plan;
mod rebuild;
mod refine;
mod report;
mod sizing;
mod stages;
mod textures;
mod thicken;
mod thickness;
mod topology;
mod warning;
mod work;

pub use advice::{Advice, Trouble};
pub use apart::StandingReport;
pub use boolean::{BooleanError, boolean, repair};
pub use canals::{CanalError, CanalOptions, CanalOutcome, CanalReport, Remove, canals, plan_canals};
pub use changed::Changed;
pub use colours::{carry_colours, carry_to_simpler};
pub use crumbs::{Dropped, drop_smaller};
pub use distance::{
    DistanceError, DistanceMethod, DistanceOptions, DistanceOutcome, DistancePlan, DistanceReport, DistanceSign,
    distance, plan_distance,
};
pub use field::{
    Built, FieldBand, FieldBuilder, FieldError, FieldOperand, FieldReport, OperandReport, field_grid, field_spacing,
    field_surface, field_values,
};
pub use hollow::{Drain, DrainReport, HollowError, HollowOptions, HollowReport, hollow, plan_hollow};
pub use kind::{TriangleCounts, TriangleKind, kinds};
pub use morphology::{MorphologyError, MorphologyOptions, MorphologyReport, morphology, plan_morphology};
pub use nothing::NothingEnclosed;
pub use operand::Operand;
pub use options::{Options, Precision, SurfaceOptions};
pub use outcome::{Outcome, TriangleSource};
pub use plan::{LimitError, Plan, plan};
pub use report::{LdiReport, Report, StageTime, ThinRegion, ThinReport};
pub use sizing::{LatticeError, MAX_RESOLUTION, VoxelSize};
pub use textures::{carry_texture, carry_texture_to_simpler, classes_of};
pub use thicken::{SheetSide, ThickenError, ThickenOptions, ThickenReport, plan_thicken, thicken};
pub use thickness::{LengthsReport, ThicknessError, ThicknessReport, thickness};
pub use topology::{LostBody, Topology, TopologyReport};
pub use warning::Warning;
pub use work::Work;

use outcome::Draft;
