//! The pipelines: short functions that read like the drawing in the crate's documentation.
//!
//! [`repair`] and [`boolean`] make a [`Solid`](crate::mesh::Solid) of meshes that may be broken. [`morphology`], [`canals`], [`thicken`] and
//! [`hollow`] take a solid and give [`Changed`]; [`Outcome::followed_by`] puts that behind what the solid came from. Each has its own options, its
//! own plan and its own errors.

mod account;
mod advice;
mod ahead;
mod apart;
mod assembled;
mod block;
mod boolean;
mod canals;
mod changed;
mod colours;
mod crumbs;
mod distance;
mod error;
mod exact;
mod exact_plan;
mod field;
mod foresight;
mod frame;
mod holes;
mod hollow;
mod kind;
mod lids;
mod morphology;
mod offsets;
mod operand;
mod options;
mod order;
mod outcome;
mod outer;
mod outlook;
mod part;
mod plan;
mod rates;
mod rebuild;
mod refine;
mod report;
mod seal;
mod sizing;
mod source;
mod stages;
mod textures;
mod thicken;
mod thickness;
mod topology;
mod window;
mod work;

pub use advice::{Advice, Trouble};
pub use block::{Base, BlockError, block, plan_block};
pub use boolean::{boolean, repair};
pub use canals::{CanalError, CanalOptions, CanalOutcome, Remove, canals, plan_canals};
pub use changed::Changed;
pub use colours::{carry_colours, carry_to_simpler};
pub use crumbs::drop_smaller;
pub use distance::{
    DistanceError, DistanceMethod, DistanceOptions, DistanceOutcome, DistancePlan, DistanceReport, DistanceSign,
    distance, plan_distance,
};
pub use error::{BooleanError, LimitError, MorphologyError};
pub use field::{
    Built, FieldBand, FieldBuilder, FieldError, FieldOperand, FieldReport, OperandReport, field_grid, field_spacing,
    field_surface, field_values,
};
pub use foresight::{Foresight, foresee};
pub use holes::{NotOpened, Opened, holes};
pub use hollow::{Drain, HollowError, HollowOptions, hollow, plan_hollow};
pub use morphology::{MorphologyOptions, morphology, plan_morphology};
pub use operand::Operand;
pub use options::{Method, Options, Precision, SurfaceOptions, VoxelSize};
pub use outcome::Outcome;
pub use outer::{OuterError, OuterOptions, outer, plan_outer};
pub use plan::{Plan, plan};
pub use report::{
    BlockReport, CanalReport, DrainReport, Dropped, HoleClosing, HoleReport, HollowReport, LdiReport, LidShape,
    LostBody, MorphologyReport, NotLidded, NothingEnclosed, OuterReport, Report, StageTime, StandingReport,
    ThickenReport, ThinRegion, ThinReport, Topology, TopologyReport, TriangleCounts, TriangleKind, Warning,
};
pub use sizing::{LatticeError, MAX_RESOLUTION};
pub use source::TriangleSource;
pub use textures::{carry_texture, carry_texture_to_simpler, classes_of};
pub use thicken::{SheetSide, ThickenError, ThickenOptions, plan_thicken, thicken};
pub use thickness::{LengthsReport, PERCENTILES, ThicknessError, ThicknessReport, thickness};
pub use work::Work;

use outcome::Draft;
