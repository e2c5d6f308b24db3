//! What each verb says of what it found and made: one tagged value in the report.

use serde::{Deserialize, Serialize};

use super::entries::{
    AsideEntry, CrossingEntry, DetailEntry, DeviceReport, FurtherEntry, GridEntry, NextEntry, ObjectEntry, OutputEntry,
    SliceEntry, WorstEntry,
};
use crate::compare::Comparison;
use crate::decimate::DecimateReport;
use crate::fit::FitReport;
use crate::mesh::{MassProperties, Overhang};
use crate::pipeline::{DistancePlan, DistanceReport, Dropped, FieldReport, HoleReport, Plan, Report, ThicknessReport};

/// What leads from what `inspect` has found to a solid.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Lead {
    /// Groups of defects that hang together, the worst first, and at most a hundred; of a mesh that is no solid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub worst: Vec<WorstEntry>,
    /// The groups beyond these, by kind.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<FurtherEntry>,
    /// What a repair would lose; of a mesh that is no solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detail: Option<DetailEntry>,
    /// What to do next, the likeliest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub next: Vec<NextEntry>,
}

/// What a run found and made. Of a run that failed there is what it had found until then, and nothing that it wrote.
#[derive(Debug, Serialize, schemars::JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum RunResult {
    /// Of `--plan` with a verb that makes a solid.
    Plan {
        /// What the run would cost.
        plan: Plan,
    },
    /// Of `sdf --plan`.
    DistancePlan {
        /// What the run would cost.
        plan: DistancePlan,
    },
    /// Of `repair`, `union`, `intersection`, `difference`, `csg`, `dilate`, `erode`, `open`, `close`, `canals`, `thicken` and `hollow`.
    Solid {
        /// What was found and done.
        pipeline: Box<Report>,
        /// The written file.
        #[serde(skip_serializing_if = "Option::is_none")]
        output: Option<OutputEntry>,
    },
    /// Of `repair --each`.
    Objects {
        /// The objects, in the order of the file.
        objects: Vec<ObjectEntry>,
        /// What else is in the file and stays as it is, or is left out where the format of the output has no place for it.
        aside: Vec<AsideEntry>,
        /// The written file.
        #[serde(skip_serializing_if = "Option::is_none")]
        output: Option<OutputEntry>,
    },
    /// Of `sdf`.
    Distance {
        /// What was found and done.
        distance: DistanceReport,
        /// The written file.
        #[serde(skip_serializing_if = "Option::is_none")]
        output: Option<OutputEntry>,
    },
    /// Of `field`.
    Field {
        /// The results, one for each frame.
        frames: Vec<FrameEntry>,
    },
    /// Of `inspect` with a mesh.
    Inspection {
        /// Centre of mass and moments, of a closed, oriented mesh.
        #[serde(skip_serializing_if = "Option::is_none")]
        mass: Option<MassProperties>,
        /// What hangs over, of a closed, oriented mesh.
        #[serde(skip_serializing_if = "Option::is_none")]
        overhang: Option<Overhang>,
        /// Where triangles cross, of a mesh of which some do.
        #[serde(skip_serializing_if = "Option::is_none")]
        crossings: Option<CrossingEntry>,
        /// What `--thickness` measured.
        #[serde(skip_serializing_if = "Option::is_none")]
        thickness: Option<ThicknessReport>,
        /// The holes that `--holes` asked for, the longest rim first, and what would be done over each.
        #[serde(skip_serializing_if = "Option::is_none")]
        holes: Option<Vec<HoleReport>>,
        /// What leads from there to a solid.
        #[serde(flatten)]
        lead: Lead,
    },
    /// Of `inspect` with values over a lattice.
    Lattice {
        /// The lattice.
        grid: GridEntry,
    },
    /// Of `compare`.
    Comparison {
        /// What was measured.
        comparison: Comparison,
        /// The written map.
        #[serde(skip_serializing_if = "Option::is_none")]
        output: Option<OutputEntry>,
    },
    /// Of `decimate`.
    Decimation {
        /// What was done.
        decimate: DecimateReport,
        /// How far the surface has moved.
        #[serde(skip_serializing_if = "Option::is_none")]
        comparison: Option<Comparison>,
        /// The written file.
        #[serde(skip_serializing_if = "Option::is_none")]
        output: Option<OutputEntry>,
    },
    /// Of `split`.
    Bodies {
        /// The written files, the largest body first.
        outputs: Vec<OutputEntry>,
    },
    /// Of `convert`.
    Conversion {
        /// The written file.
        output: OutputEntry,
    },
    /// Of `render`.
    Picture {
        /// The slices that were drawn.
        slices: Vec<SliceEntry>,
        /// The written file.
        output: OutputEntry,
    },
    /// Of `report`, and of `view` with `-o`.
    Page {
        /// The written file.
        output: OutputEntry,
        /// What is to be said of files of the run that are not as they were.
        missing: Vec<String>,
    },
    /// Of `devices`.
    Devices {
        /// The graphics adapters.
        devices: DeviceReport,
    },
}

/// One result of `field`.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct FrameEntry {
    /// What it was made of.
    pub field: FieldReport,
    /// Sharp edges and simplification of a surface; none without a fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<FitReport>,
    /// Surfaces of it that `--drop-smaller` has left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smaller: Option<Dropped>,
    /// Its values over a lattice, where these were wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<DistanceReport>,
    /// The written file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputEntry>,
}

impl RunResult {
    /// A solid that is not written yet.
    pub fn solid(pipeline: Report) -> Self {
        Self::Solid { pipeline: Box::new(pipeline), output: None }
    }

    /// The account of a solid.
    pub fn pipeline(&self) -> Option<&Report> {
        if let Self::Solid { pipeline, .. } = self { Some(pipeline) } else { None }
    }

    /// The file that was written last.
    pub fn output(&self) -> Option<&OutputEntry> {
        match self {
            Self::Solid { output, .. }
            | Self::Objects { output, .. }
            | Self::Distance { output, .. }
            | Self::Comparison { output, .. }
            | Self::Decimation { output, .. } => output.as_ref(),
            Self::Field { frames } => frames.last()?.output.as_ref(),
            Self::Bodies { outputs } => outputs.last(),
            Self::Conversion { output } | Self::Picture { output, .. } | Self::Page { output, .. } => Some(output),
            Self::Plan { .. }
            | Self::DistancePlan { .. }
            | Self::Inspection { .. }
            | Self::Lattice { .. }
            | Self::Devices { .. } => None,
        }
    }

    /// Notes the file that a solid, a distance or the last frame of a field was written to.
    pub fn written(&mut self, entry: OutputEntry) {
        match self {
            Self::Solid { output, .. }
            | Self::Objects { output, .. }
            | Self::Distance { output, .. }
            | Self::Comparison { output, .. }
            | Self::Decimation { output, .. } => *output = Some(entry),
            Self::Field { frames } => {
                if let Some(frame) = frames.last_mut() {
                    frame.output = Some(entry);
                }
            }
            _ => {}
        }
    }
}
