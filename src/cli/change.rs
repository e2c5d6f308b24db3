//! What is done to a solid beside repairing it: morphology, and the canals.

use std::str::FromStr;

use serde_json::json;

use super::args::CommonArgs;
use super::exit::Failure;
use super::hollow::DrainChoice;
use super::length::{Length, Scale};
use super::report::RunReport;
use super::session::Session;
use super::words::{self, UnitName};
use crate::mesh::TriMesh;
use crate::morphology::{Canal, Operation};
use crate::pipeline::{
    self, CanalOptions, CanalReport, HollowOptions, MorphologyOptions, Options, Outcome, Plan, Remove, SheetSide,
    ThickenOptions,
};

/// A change, as asked for.
#[derive(Debug, Clone)]
pub enum Change {
    /// Dilate, erode, open or close.
    Morphology {
        /// Which of them.
        operation: Operation,
        /// The radius.
        radius: Length,
        /// How far sharp edges may reach, times the radius.
        mitre: Option<f64>,
    },
    /// List canals, and fill them.
    Canals {
        /// What no ball of this diameter passes is a canal.
        max_diameter: Length,
        /// Which are filled; `None`: they are listed.
        remove: Option<RemoveChoice>,
    },
    /// Make a cavity.
    Hollow {
        /// Thickness of the wall.
        wall: Length,
        /// Holes through it.
        drains: Vec<DrainChoice>,
    },
    /// Let thin walls and open sheets grow.
    Thicken {
        /// The least thickness.
        least: Length,
        /// Where sheets grow.
        side: SheetSide,
    },
}

/// `--remove`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RemoveChoice {
    /// All canals.
    All,
    /// Those with these numbers.
    These(Vec<u32>),
}

impl FromStr for RemoveChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
        }
        let number = |part: &str| part.trim().parse::<u32>().ok().filter(|&number| number > 0);
        let numbers: Option<Vec<u32>> = text.split(',').map(number).collect();
        numbers.map(Self::These).ok_or_else(|| "`all`, or numbers of canals such as 1,3, are needed".into())
    }
}

/// What a change has made.
pub struct Changed {
    /// The solid.
    pub outcome: Outcome,
    /// For each of its triangles the number of the canal that it bounds, 0 or nothing for none.
    pub canal_of: Vec<u32>,
}

impl From<Outcome> for Changed {
    fn from(outcome: Outcome) -> Self {
        Self { outcome, canal_of: Vec::new() }
    }
}

impl Change {
    /// Whether there is a mesh to write.
    pub fn makes_a_mesh(&self) -> bool {
        !matches!(self, Self::Canals { remove: None, .. })
    }

    /// What it would cost for `mesh`. The outer error is one of usage.
    pub fn plan(
        &self,
        mesh: &TriMesh,
        options: &Options,
        scale: &Scale,
    ) -> Result<Result<Plan, pipeline::Error>, Failure> {
        Ok(match self.resolved(options, scale)? {
            Resolved::Morphology(options) => pipeline::plan_morphology(mesh, &options),
            Resolved::Canals(options) => pipeline::plan_canals(mesh, &options),
            Resolved::Hollow(options) => pipeline::plan_hollow(mesh, &options),
            Resolved::Thicken(options) => pipeline::plan_thicken(mesh, &options),
        })
    }

    /// Makes it of `mesh`. The outer error is one of usage.
    pub fn apply(
        &self,
        mesh: &TriMesh,
        options: &Options,
        scale: &Scale,
        session: &Session,
        report: &mut RunReport,
    ) -> Result<Result<Changed, pipeline::Error>, Failure> {
        let progress = &session.progress;
        Ok(match self.resolved(options, scale)? {
            Resolved::Morphology(options) => {
                report.options["radius"] = json!(options.radius);
                report.options["mitre"] = json!(options.mitre);
                pipeline::morphology(mesh, &options, progress).map(Changed::from)
            }
            Resolved::Canals(options) => {
                report.options["max_diameter"] = json!(options.max_diameter);
                let found = pipeline::canals(mesh, &options, progress);
                found.map(|found| Changed { outcome: found.outcome, canal_of: found.canal_of })
            }
            Resolved::Hollow(options) => {
                report.options["wall"] = json!(options.wall);
                pipeline::hollow(mesh, &options, progress).map(Changed::from)
            }
            Resolved::Thicken(options) => {
                report.options["least"] = json!(options.least);
                report.options["side"] = json!(options.side);
                pipeline::thicken(mesh, &options, progress).map(Changed::from)
            }
        })
    }

    /// The options of its pipeline, with lengths in model units.
    fn resolved(&self, options: &Options, scale: &Scale) -> Result<Resolved, Failure> {
        let solid = options.clone();
        Ok(match self {
            Self::Morphology { operation, radius, mitre } => Resolved::Morphology(MorphologyOptions {
                operation: *operation,
                radius: radius.resolve(scale)?,
                mitre: *mitre,
                solid,
            }),
            Self::Canals { max_diameter, remove } => {
                let remove = match remove {
                    None => Remove::None,
                    Some(RemoveChoice::All) => Remove::All,
                    Some(RemoveChoice::These(numbers)) => Remove::These(numbers.clone()),
                };
                Resolved::Canals(CanalOptions { max_diameter: max_diameter.resolve(scale)?, remove, solid })
            }
            Self::Hollow { wall, drains } => {
                let drains = drains.iter().map(|drain| drain.resolve(scale)).collect::<Result<_, Failure>>()?;
                Resolved::Hollow(HollowOptions { wall: wall.resolve(scale)?, drains, solid })
            }
            Self::Thicken { least, side } => {
                Resolved::Thicken(ThickenOptions { least: least.resolve(scale)?, side: *side, solid })
            }
        })
    }
}

/// The options of one of the pipelines.
enum Resolved {
    Morphology(MorphologyOptions),
    Canals(CanalOptions),
    Hollow(HollowOptions),
    Thicken(ThickenOptions),
}

/// Prints the canals when that is all that was asked for.
pub fn list(
    change: Option<&Change>,
    report: &RunReport,
    common: &CommonArgs,
    unit: UnitName<'_>,
) -> Result<(), Failure> {
    let canals = report.pipeline().and_then(|pipeline| pipeline.canals.as_ref());
    match canals.filter(|_| !common.json && change.is_some_and(|change| !change.makes_a_mesh())) {
        Some(canals) => super::output::write_stream(canal_table(canals, unit).as_bytes()),
        None => Ok(()),
    }
}

/// One line for each canal, in columns.
fn canal_table(found: &CanalReport, unit: UnitName<'_>) -> String {
    let diameter = words::length(found.max_diameter, unit);
    if found.canals.is_empty() {
        return format!("no canal that a ball of {diameter} does not pass\n");
    }
    let head = ["canal", "kind", "diameter", "length", "volume", "handles", "at"].map(str::to_string);
    let row = |canal: &Canal| {
        [
            canal.number.to_string(),
            canal.kind.to_string(),
            words::length(canal.diameter, unit),
            words::length(canal.length, unit),
            words::volume(canal.volume, unit),
            canal.handles.to_string(),
            canal.position.map(words::number).join(" "),
        ]
    };
    let rows: Vec<[String; 7]> = std::iter::once(head).chain(found.canals.iter().map(row)).collect();
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: [usize; 7] = std::array::from_fn(width);
    let line = |row: &[String; 7]| {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
        cells.collect::<Vec<String>>().join("  ").trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}
