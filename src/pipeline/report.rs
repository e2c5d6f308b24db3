//! What a pipeline found and did, as data.

use serde::Serialize;

use super::apart::Apart;
use super::sizing::TYPED;
use super::stages::Stages;
use super::{
    CanalReport, Draft, Dropped, HollowReport, MorphologyReport, StandingReport, ThickenReport, TopologyReport,
    TriangleCounts, TriangleSource, Warning, topology,
};
use crate::backend::BackendReport;
use crate::fit::{FitReport, Surface};
use crate::lattice::{Grid, Lattice};
use crate::ldi::{Spans, THIN, ThinPlace, lengths, thin_places};
use crate::mesh::Plane;
use crate::orient::OrientReport;
use crate::progress::Stage;
use crate::survey::Survey;
use crate::vote::{VoteReport, Votes, doubts};

/// The account of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Report {
    /// Voxel spacing, model units.
    pub voxel: f64,
    /// Voxels along x, y, z; zero without a lattice.
    pub dims: [i32; 3],
    /// Whether there was a lattice: not where all of the result stands as it is.
    pub lattice: bool,
    /// What stayed as it is, without rays and voxels.
    pub standing: StandingReport,
    /// Bodies, voids and tunnels before and after; `None` where an operation changes them.
    pub topology: Option<TopologyReport>,
    /// Cleaning and orientation of each operand.
    pub orient: Vec<OrientReport>,
    /// The rays.
    pub ldi: LdiReport,
    /// The votes.
    pub vote: VoteReport,
    /// Walls and gaps near or below the voxel size.
    pub thin: ThinReport,
    /// Sharp edges and simplification; `None` without a fit.
    pub fit: Option<FitReport>,
    /// Dilation, erosion, closing or opening; `None` without.
    pub morphology: Option<MorphologyReport>,
    /// The cavity and its drains; `None` where none was to be made.
    pub hollow: Option<HollowReport>,
    /// Walls that were too thin; `None` where none were looked for.
    pub thicken: Option<ThickenReport>,
    /// Canals that were listed; `None` where none were looked for.
    pub canals: Option<CanalReport>,
    /// Surfaces under eight voxels that no operand asked for; they are not in the result.
    pub crumbs: Dropped,
    /// Surfaces smaller than the caller wants, see [`super::drop_smaller`].
    pub smaller: Dropped,
    /// Triangles of the result that close holes, or that morphology has made.
    pub closed_triangles: usize,
    /// How many triangles of the result are kept, rebuilt and made up.
    pub triangles: TriangleCounts,
    /// Wall-clock time of each stage, in order. Not written with the rest: a whole run has stages besides these, and tells all of
    /// them in one list; so it is with warnings.
    #[serde(skip)]
    pub stages: Vec<StageTime>,
    /// What a user should know, most important first.
    #[serde(skip)]
    pub warnings: Vec<Warning>,
}

impl Report {
    /// The parts that come from the rays and the votes. `finest`: the smallest voxel that is possible, model units.
    pub(super) fn surveyed(survey: &Survey, votes: &Grid<Votes>, made_by: BackendReport, finest: f64) -> Self {
        let (lattice, count) = (&survey.lattice, survey.count);
        Self {
            voxel: lattice.h,
            dims: lattice.dims.to_array(),
            lattice: true,
            ldi: LdiReport {
                rays: count.rays,
                silent_rays: survey.silent_rays(),
                hits: count.hits,
                layers: count.layers,
                made_by,
            },
            vote: doubts(votes, lattice),
            thin: ThinReport::of(survey, finest),
            orient: survey.soup.reports.clone(),
            ..Self::default()
        }
    }

    /// Adds what there is to say of the surface that was made.
    pub(super) fn of_surface(
        &mut self,
        survey: &Survey,
        planes: &[Plane],
        surface: &Surface,
        sources: &[TriangleSource],
    ) {
        self.thin.regions = thin_regions(&survey.spans, planes, surface, &survey.lattice);
        self.closed_triangles = sources.iter().filter(|source| **source == TriangleSource::Closed).count();
    }

    /// Triangles of the operands that stayed as they are, before simplification.
    pub fn kept(&self) -> usize {
        self.standing.triangles + self.fit.as_ref().map_or(0, |fit| fit.kept)
    }

    /// Triangles of the operands that could have: all but those of shells that were left out as a whole.
    pub fn of(&self) -> usize {
        self.standing.triangles + self.fit.as_ref().map_or(0, |fit| fit.of)
    }

    /// Whether the surface is the operands' own, untouched by voxels.
    pub fn kept_all(&self) -> bool {
        self.kept() > 0 && self.kept() == self.of()
    }
}

/// Rays and crossings of all 13 directions.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LdiReport {
    /// Rays that hit something.
    pub rays: usize,
    /// Of these, the ones that abstain because an operand's crossings do not balance.
    pub silent_rays: usize,
    /// Crossings.
    pub hits: usize,
    /// The most crossings on one ray.
    pub layers: usize,
    /// The processor that found them.
    pub made_by: BackendReport,
}

/// Evidence of walls and gaps that the voxel size may not hold.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThinReport {
    /// Spans (ray pieces inside the solid) along the three face directions.
    pub spans: usize,
    /// Of these, spans shorter than 2 h: walls too thin for the voxel size.
    pub thin_spans: usize,
    /// Spans that hold no voxel: a ray alone would lose them.
    pub lost_spans: usize,
    /// Gaps between spans shorter than 2 h.
    pub thin_gaps: usize,
    /// The 1st percentile of the span lengths, model units.
    pub thinnest: Option<f64>,
    /// A voxel size, model units, that would hold 99 % of the spans; `None` when all are held, and when no possible
    /// voxel is small enough.
    pub voxel_that_keeps: Option<f64>,
    /// Where walls and gaps are thinner than 2 h, the largest such places first.
    pub regions: Vec<ThinRegion>,
}

impl ThinReport {
    /// Of the spans along the face directions; without regions. `finest`: the smallest voxel that is possible.
    pub(super) fn of(survey: &Survey, finest: f64) -> Self {
        let (lengths, h) = (lengths(&survey.spans), survey.lattice.h);
        let shorter = |sorted: &[f64]| sorted.partition_point(|&length| length < THIN);
        let percentile = lengths.spans.get(lengths.spans.len() / 100).map(|voxels| voxels * h);
        let thin_spans = shorter(&lengths.spans);
        Self {
            spans: lengths.spans.len(),
            thin_spans,
            lost_spans: lengths.lost,
            thin_gaps: shorter(&lengths.gaps),
            thinnest: percentile,
            voxel_that_keeps: percentile
                .filter(|_| thin_spans > 0)
                .map(|length| length / THIN)
                .filter(|&h| h >= TYPED * finest),
            regions: Vec::new(),
        }
    }
}

/// At most so many thin places are listed, each of at least so many rays: of 13 directions three or four look along any wall.
const MOST_REGIONS: usize = 10;
const LEAST_RAYS: usize = 4;

/// Where walls and gaps are thinner than the lattice holds, of those that were not kept as they are.
fn thin_regions(spans: &[Spans], planes: &[Plane], surface: &Surface, lattice: &Lattice) -> Vec<ThinRegion> {
    let mut kept = vec![false; planes.len()];
    let triangles = 0..surface.mesh.triangles.len() as u32;
    triangles.filter_map(|t| surface.source_triangle(t)).for_each(|t| kept[t as usize] = true);
    let region = |place: &ThinPlace| ThinRegion {
        gap: place.gap,
        min: lattice.to_model(place.min).to_array(),
        max: lattice.to_model(place.max).to_array(),
        rays: place.rays,
        thinnest: place.least * lattice.h,
    };
    let places = thin_places(spans, planes, |t| kept[t as usize]);
    places.iter().filter(|place| place.rays >= LEAST_RAYS).take(MOST_REGIONS).map(region).collect()
}

/// A place where walls or gaps are thinner than the lattice holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThinRegion {
    /// Whether it is a gap; else a wall.
    pub gap: bool,
    /// The smallest coordinates of the rays' pieces there, model units.
    pub min: [f64; 3],
    /// The largest.
    pub max: [f64; 3],
    /// How many pieces of rays there are.
    pub rays: usize,
    /// The shortest of them, model units.
    pub thinnest: f64,
}

/// Seconds a stage took.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StageTime {
    /// The stage.
    pub stage: Stage,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Completes the report of a boolean.
pub(super) fn finished(mut outcome: Draft, apart: &Apart, stages: Stages<'_>) -> Draft {
    let report = &mut outcome.report;
    report.standing = apart.report();
    report.topology = Some(topology::compared(&outcome.mesh, &outcome.sources, apart));
    let warnings = Warning::of(report);
    report.warnings.extend(warnings);
    report.stages = stages.finish();
    outcome
}
