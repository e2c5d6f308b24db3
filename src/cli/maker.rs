//! What is made of a file in another way than by a repair: blocks under sheets, and outer skins.

use serde_json::json;

use super::base::BaseChoice;
use super::exit::Failure;
use super::length::{Length, Scale};
use super::report::RunReport;
use super::site::{Failed, Site};
use crate::mesh::TriMesh;
use crate::pipeline::{self, Operand, Options, Outcome, OuterOptions, Plan};

/// What is to be made.
#[derive(Debug, Clone)]
pub enum Maker {
    /// A block under an open sheet.
    Block {
        /// Where its base lies.
        base: BaseChoice,
    },
    /// The surface as a ball sees it.
    Outer {
        /// The diameter of the ball.
        ball: Length,
        /// How thick sheets become.
        thickness: Option<Length>,
    },
}

impl Maker {
    /// What it would cost.
    pub fn plan(&self, mesh: &TriMesh, options: &Options, scale: &Scale, failed: &Failed<'_>) -> Result<Plan, Failure> {
        match self {
            Self::Block { base } => pipeline::plan_block(mesh, base.resolve(scale)?, options).map_err(|e| failed(&e)),
            Self::Outer { ball, thickness } => {
                let options = outer_options(*ball, *thickness, options, scale)?;
                pipeline::plan_outer(mesh, &options).map_err(|e| failed(&e))
            }
        }
    }

    /// Makes it.
    pub fn make(&self, options: &Options, site: &Site<'_>, report: &mut RunReport) -> Result<Outcome, Failure> {
        // Negative parts of the file are the second operand here.
        let operand = Operand { negative: site.operands.get(1).map(|negative| negative.mesh), ..site.operands[0] };
        match self {
            Self::Block { base } => {
                report.options["base"] = json!(base.to_string());
                let base = base.resolve(site.scale)?;
                pipeline::block(operand, base, options, site.progress).map_err(|e| (site.failed)(&e))
            }
            Self::Outer { ball, thickness } => {
                let options = outer_options(*ball, *thickness, options, site.scale)?;
                report.options["outer"] = json!(options.ball);
                report.options["thickness"] = json!(options.thickness);
                pipeline::outer(operand, &options, site.progress).map_err(|e| (site.failed)(&e))
            }
        }
    }
}

fn outer_options(
    ball: Length,
    thickness: Option<Length>,
    solid: &Options,
    scale: &Scale,
) -> Result<OuterOptions, Failure> {
    let thickness = thickness.map(|length| length.resolve(scale)).transpose()?;
    Ok(OuterOptions { ball: ball.resolve(scale)?, thickness, solid: *solid })
}
