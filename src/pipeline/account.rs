//! Fills the report: what the rays, the votes, the shells and the surface say of a run.

use super::apart::Apart;
use super::sizing::TYPED;
use super::stages::Stages;
use super::{
    Draft, LdiReport, NothingEnclosed, Report, ThinRegion, ThinReport, TopologyReport, TriangleSource, Warning,
    topology,
};
use crate::backend::BackendReport;
use crate::fit::Surface;
use crate::lattice::{Grid, Lattice};
use crate::ldi::{Spans, THIN, ThinPlace, lengths, thin_places};
use crate::mesh::Plane;
use crate::survey::Survey;
use crate::vote::{Votes, doubts};

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
        self.closed_triangles = sources.iter().filter(|source| source.is_made_up()).count();
    }
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

/// Shares of rays and spans above which a user should know.
const MANY_LOST: f64 = 0.02;
const MANY_SILENT: f64 = 0.25;
/// And the part of the volume that rounding may take from an exact result without a word.
const ROUNDED: f64 = 1e-6;

/// What a user should know of a report that is complete but for that.
pub(super) fn warnings(report: &Report) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let share = |part: usize, all: usize| part as f64 / all.max(1) as f64;
    let lost = share(report.thin.lost_spans, report.thin.spans);
    if lost > MANY_LOST && !report.kept_all() {
        warnings.push(Warning::ThinWalls { share: lost, thin: report.thin.clone() });
    }
    let silent = share(report.ldi.silent_rays, report.ldi.rays);
    if silent > MANY_SILENT {
        warnings.push(Warning::SilentRays { share: silent });
    }
    if let Some(reason) = &report.ldi.made_by.fallback {
        warnings.push(Warning::Fallback { reason: reason.clone() });
    }
    warnings
}

/// What a user should know of what was cut exactly.
fn rounded(report: &Report) -> Option<Warning> {
    let share = report.exact.as_ref()?.volume_error;
    (share > ROUNDED).then_some(Warning::Rounded { share })
}

/// With a larger share of silent rays there is no solid to speak of: of the real files that are
/// worth repairing `beetle` has the largest, 75 %; a hundred unrelated triangles have 91 %.
const MOST_SILENT: f64 = 0.85;

/// Refuses a soup of which nearly all rays are silent.
pub(super) fn refuse_scattered(survey: &Survey) -> Result<(), NothingEnclosed> {
    let share = survey.silent_share();
    if share <= MOST_SILENT { Ok(()) } else { Err(NothingEnclosed::Scattered { share }) }
}

/// Why the contour of a survey is empty. `finest`: the smallest voxel that is possible.
pub(super) fn why_nothing(survey: &Survey, finest: f64) -> NothingEnclosed {
    let (thin, voxel) = (ThinReport::of(survey, finest), survey.lattice.h);
    if 2 * survey.silent_rays() > survey.count.rays {
        return NothingEnclosed::OpenSheet;
    }
    match (thin.spans, survey.soup.operands.count()) {
        (0, 1) => NothingEnclosed::Nothing,
        (0, _) => NothingEnclosed::NoCommonPart,
        _ => NothingEnclosed::ThinnerThanVoxel { voxel, thin },
    }
}

/// Completes the report of a boolean.
pub(super) fn finished(mut outcome: Draft, apart: &Apart, stages: Stages<'_>) -> Draft {
    let report = &mut outcome.report;
    report.standing = apart.report();
    let has_lids = apart.operands() == 1 && !report.holes.is_empty();
    if report.exact.is_some() && !has_lids {
        // What was made whole first has been judged already.
        let found = topology::of_exact(&outcome.mesh, &outcome.sources, apart);
        let topology::Found { after, buried } = found;
        let before = report.topology.take().unwrap_or_default();
        report.topology = Some(TopologyReport { after, buried, before: None, new_tunnels: None, ..before });
        let words = rounded(report);
        report.warnings.extend(words);
    } else {
        report.topology = Some(topology::compared(&outcome.mesh, &outcome.sources, apart));
        let words = warnings(report);
        report.warnings.extend(words);
        let words = rounded(report);
        report.warnings.extend(words);
    }
    report.stages = stages.finish();
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arrange::ArrangeReport;

    #[test]
    fn why_the_main_processor_stepped_in_is_a_line_of_the_report() {
        let mut report = Report::default();
        assert!(warnings(&report).is_empty());
        report.ldi.made_by.fallback = Some("it melted".into());
        let lines = warnings(&report);
        assert!(lines.len() == 1 && lines[0].to_string().contains("it melted"), "{lines:?}");
    }

    #[test]
    fn a_volume_that_rounding_changes_by_more_than_a_millionth_is_told() {
        let told = |volume_error| {
            let exact = Some(ArrangeReport { volume_error, ..ArrangeReport::default() });
            rounded(&Report { exact, ..Report::default() }).map(|told| told.to_string())
        };
        assert_eq!(told(0.9e-6), None);
        let line = told(2e-6).expect("it is more");
        assert!(line.contains("the volume by 0.0002 %"), "{line}");
    }
}
