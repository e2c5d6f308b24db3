//! What is done to a solid beside repairing it: morphology, and the canals.

use std::str::FromStr;

use serde_json::json;

use super::drain::DrainChoice;
use super::exit::Failure;
use super::length::{Length, Scale};
use super::maker::Maker;
use super::report::RunReport;
use super::shared_args::CommonArgs;
use super::site::{Failed, Site};
use super::words::{self, UnitName};
use crate::mesh::TriMesh;
use crate::morphology::{Canal, Operation};
use crate::pipeline::{
    self, Advice, BooleanError, CanalError, CanalOptions, CanalReport, HollowOptions, MorphologyOptions, Outcome, Plan,
    Remove, SheetSide, SurfaceOptions, ThickenOptions, VoxelSize,
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
        sharp: Option<f64>,
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
    /// Make something of the file in another way than by a repair.
    Instead(Maker),
    /// Let thin walls and open sheets grow.
    Thicken {
        /// The least thickness.
        min: Length,
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
    /// What is made instead of a repair.
    pub fn instead(&self) -> Option<&Maker> {
        match self {
            Self::Instead(maker) => Some(maker),
            _ => None,
        }
    }

    /// Whether there is a mesh to write.
    pub fn makes_a_mesh(&self) -> bool {
        !matches!(self, Self::Canals { remove: None, .. })
    }

    /// What it would cost for a solid about where `mesh` is.
    pub fn plan(
        &self,
        mesh: &TriMesh,
        surface: &SurfaceOptions,
        scale: &Scale,
        failed: &Failed<'_>,
    ) -> Result<Plan, Failure> {
        match self.resolved(surface, scale)? {
            Resolved::Nothing => Err(only_after_a_repair()),
            Resolved::Morphology(options) => pipeline::plan_morphology(mesh, &options).map_err(|e| failed(&e)),
            Resolved::Canals(options) => pipeline::plan_canals(mesh, &options).map_err(|e| failed(&e)),
            Resolved::Hollow(options) => pipeline::plan_hollow(mesh, &options).map_err(|e| failed(&e)),
            Resolved::Thicken(options) => pipeline::plan_thicken(mesh, &options).map_err(|e| failed(&e)),
        }
    }

    /// Makes it of a solid; what has no solid can only grow thicker.
    pub fn apply(
        &self,
        made: Result<Outcome, BooleanError>,
        site: &Site<'_>,
        report: &mut RunReport,
    ) -> Result<Changed, Failure> {
        let resolved = self.resolved(site.surface, site.scale)?;
        resolved.tell(&mut report.options);
        let outcome = match made {
            Err(BooleanError::Nothing(_)) if matches!(resolved, Resolved::Thicken(_)) => None,
            made => Some(made.map_err(|e| (site.failed)(&e))?),
        };
        match (resolved, outcome) {
            (Resolved::Thicken(options), outcome) => site.thickened(outcome, &options),
            (_, None) => Err(Failure::internal("only what grows thicker can do without a solid")),
            (Resolved::Nothing, _) => Err(only_after_a_repair()),
            (Resolved::Morphology(options), Some(outcome)) => {
                let changed = pipeline::morphology(&outcome.solid, &options, site.progress);
                site.followed(outcome, changed).map(Changed::from)
            }
            (Resolved::Hollow(options), Some(outcome)) => {
                let changed = pipeline::hollow(&outcome.solid, &options, site.progress);
                site.followed(outcome, changed).map(Changed::from)
            }
            (Resolved::Canals(options), Some(outcome)) => site.canals(outcome, &options),
        }
    }

    /// The options of its pipeline, with lengths in model units.
    fn resolved(&self, surface: &SurfaceOptions, scale: &Scale) -> Result<Resolved, Failure> {
        // The voxel is that of the input, whatever the solid's size.
        let voxel = scale.voxel.map_or(surface.voxel, VoxelSize::Length);
        let surface = SurfaceOptions { voxel, ..*surface };
        Ok(match self {
            Self::Morphology { operation, radius, sharp } => Resolved::Morphology(MorphologyOptions {
                operation: *operation,
                radius: radius.resolve(scale)?,
                sharp: *sharp,
                surface,
            }),
            Self::Canals { max_diameter, remove } => {
                let remove = match remove {
                    None => Remove::None,
                    Some(RemoveChoice::All) => Remove::All,
                    Some(RemoveChoice::These(numbers)) => Remove::These(numbers.clone()),
                };
                Resolved::Canals(CanalOptions { max_diameter: max_diameter.resolve(scale)?, remove, surface })
            }
            Self::Hollow { wall, drains } => {
                let drains = drains.iter().map(|drain| drain.resolve(scale)).collect::<Result<_, Failure>>()?;
                Resolved::Hollow(HollowOptions { wall: wall.resolve(scale)?, drains, surface })
            }
            Self::Instead(_) => Resolved::Nothing,
            Self::Thicken { min, side } => {
                Resolved::Thicken(ThickenOptions { min: min.resolve(scale)?, side: *side, surface })
            }
        })
    }
}

fn only_after_a_repair() -> Failure {
    Failure::internal("what is made in another way than by a repair is no change of one")
}

impl Site<'_> {
    fn followed<E: Advice>(&self, outcome: Outcome, changed: Result<pipeline::Changed, E>) -> Result<Outcome, Failure> {
        let changed = changed.map_err(|e| (self.failed)(&e))?;
        Ok(outcome.followed_by(changed, self.operands.iter().copied(), self.progress)?)
    }

    fn thickened(&self, outcome: Option<Outcome>, options: &ThickenOptions) -> Result<Changed, Failure> {
        // What negative parts are taken away from has no sheets any more.
        let nothing = TriMesh::default();
        let surface = if let [operand] = self.operands { operand.mesh } else { &nothing };
        let solid = outcome.as_ref().map(|outcome| &outcome.solid);
        let changed = pipeline::thicken(solid, surface, options, self.progress);
        Ok(Changed::from(match outcome {
            Some(outcome) => self.followed(outcome, changed)?,
            None => changed.map_err(|e| (self.failed)(&e))?.into(),
        }))
    }

    fn canals(&self, outcome: Outcome, options: &CanalOptions) -> Result<Changed, Failure> {
        let found = pipeline::canals(&outcome.solid, options, self.progress).map_err(|e| (self.failed)(&e))?;
        let (mut outcome, canal_of) = match found.filled {
            None => (outcome, found.canal_of),
            Some(filled) => {
                let outcome = self.followed(outcome, Ok::<_, CanalError>(filled))?;
                let canal_of = vec![0; outcome.solid.triangles.len()];
                (outcome, canal_of)
            }
        };
        outcome.report.stages.extend(found.stages);
        outcome.report.canals = Some(found.report);
        Ok(Changed { outcome, canal_of })
    }
}

impl Resolved {
    /// Writes the lengths into the options of the report.
    fn tell(&self, report: &mut serde_json::Value) {
        match self {
            Self::Nothing => {}
            Self::Morphology(options) => {
                report["radius"] = json!(options.radius);
                report["mitre"] = json!(options.sharp);
            }
            Self::Canals(options) => report["max_diameter"] = json!(options.max_diameter),
            Self::Hollow(options) => report["wall"] = json!(options.wall),
            Self::Thicken(options) => {
                report["least"] = json!(options.min);
                report["side"] = json!(options.side);
            }
        }
    }
}

/// The options of one of the pipelines.
enum Resolved {
    /// It is no change of a solid.
    Nothing,
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
        Some(canals) => super::streams::write_stream(canal_table(canals, unit).as_bytes()),
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
