//! The small pieces between the stages of a boolean: look-ups, counts, and words.

use glam::IVec3;

use super::prepare::TYPED;
use super::{Error, LdiReport, Report, ThinRegion, ThinReport};
use crate::contour::{Crossing, Edge};
use crate::digits;
use crate::fit::Surface;
use crate::lattice::{DistanceField, Grid, Lattice};
use crate::ldi::{Layers, Lengths, Spans, THIN, ThinPlace, edge_crossing, lengths, thin_places};
use crate::mesh::Plane;
use crate::vote::{Lid, Votes, doubts};

/// Crossings before and after the spans were made.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Count {
    pub rays: usize,
    hits: usize,
    layers: usize,
}

pub(super) fn count(layers: &[Layers]) -> Count {
    layers.iter().fold(Count::default(), |count, layers| Count {
        rays: count.rays + layers.offsets.windows(2).filter(|w| w[1] > w[0]).count(),
        hits: count.hits + layers.hits.len(),
        layers: count.layers.max(layers.deepest()),
    })
}

/// The crossings of lattice edges for the contour: with the surface, or with a lid over a hole.
pub(super) fn crossings<'a>(
    spans: &'a [Spans],
    distance: &'a DistanceField,
    lid: impl Fn(IVec3, IVec3) -> Option<Lid> + Sync + 'a,
) -> impl Fn(Edge) -> Option<Crossing> + Sync + 'a {
    move |edge| {
        let lower_inside = distance.grid.get(edge.voxel) < 0.0;
        if let Some((t, hit)) = edge_crossing(spans, edge.voxel, edge.axis as usize, lower_inside) {
            return Some(Crossing { t, triangle: Some(hit.triangle()) });
        }
        let upper = edge.voxel + IVec3::AXES[edge.axis as usize];
        let (inside, outside) = if lower_inside { (edge.voxel, upper) } else { (upper, edge.voxel) };
        let t = lid(inside, outside)?.t;
        Some(Crossing { t: if lower_inside { t } else { 1.0 - t }, triangle: None })
    }
}

/// The parts of the report that come from the rays and the votes.
/// `finest`: the smallest voxel that is possible, model units.
pub(super) fn report(lattice: &Lattice, finest: f64, spans: &[Spans], count: Count, votes: &Grid<Votes>) -> Report {
    let lengths = lengths(spans);
    Report {
        voxel: lattice.h,
        dims: lattice.dims.to_array(),
        ldi: LdiReport {
            rays: count.rays,
            silent_rays: spans.iter().map(|s| s.silent_rays).sum(),
            hits: count.hits,
            layers: count.layers,
            ..LdiReport::default()
        },
        vote: doubts(votes, lattice),
        thin: thin(&lengths, lattice.h, finest),
        ..Report::default()
    }
}

fn thin(lengths: &Lengths, h: f64, finest: f64) -> ThinReport {
    let shorter = |sorted: &[f64]| sorted.partition_point(|&length| length < THIN);
    let percentile = lengths.spans.get(lengths.spans.len() / 100).map(|voxels| voxels * h);
    let thin_spans = shorter(&lengths.spans);
    ThinReport {
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

/// At most so many thin places are listed, each of at least so many rays: of 13 directions three or four look along any wall.
const MOST_REGIONS: usize = 10;
const LEAST_RAYS: usize = 4;

/// Where walls and gaps are thinner than the lattice holds, of those that were not kept as they are.
pub(super) fn thin_regions(spans: &[Spans], planes: &[Plane], surface: &Surface, lattice: &Lattice) -> Vec<ThinRegion> {
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

/// What a user should know of a report that is complete but for this.
pub(super) fn warnings(report: &Report) -> Vec<String> {
    let mut warnings = Vec::new();
    let share = |part: usize, all: usize| part as f64 / all.max(1) as f64;
    let lost = share(report.thin.lost_spans, report.thin.spans);
    if lost > MANY_LOST && !report.kept_all() {
        warnings.push(format!(
            "{:.0} % of the walls that rays meet fall between the voxels and may be missing{}",
            100.0 * lost,
            keeping_voxel(&report.thin)
        ));
    }
    let silent = share(report.ldi.silent_rays, report.ldi.rays);
    if silent > MANY_SILENT {
        warnings.push(format!(
            "{:.0} % of the test rays meet an open or doubled surface and cannot tell inside from outside: \
             look whether the result is what you want (-v lists the doubtful places)",
            100.0 * silent
        ));
    }
    if let Some(reason) = &report.ldi.made_by.fallback {
        warnings.push(format!("the graphics processor failed, so the main one did its work: {reason}"));
    }
    warnings
}

fn keeping_voxel(thin: &ThinReport) -> String {
    match (thin.thinnest, thin.voxel_that_keeps) {
        (Some(thinnest), Some(voxel)) => {
            let [thinnest, voxel] = [digits::number(thinnest), digits::rounded_down(voxel)];
            format!("; the thinnest 1 % are at most {thinnest} thick: a voxel of {voxel} would hold them")
        }
        (Some(thinnest), None) if thin.thin_spans > 0 => {
            format!("; the thinnest 1 % are at most {} thick, too thin for any voxel", digits::number(thinnest))
        }
        _ => String::new(),
    }
}

/// With a larger share of silent rays there is no solid to speak of: of the real files that are
/// worth repairing `beetle` has the largest, 75 %; a hundred unrelated triangles have 91 %.
const MOST_SILENT: f64 = 0.85;

/// An error when nearly all rays are silent: voting would then fill the volume with noise.
pub(super) fn refuse_scattered(spans: &[Spans], count: Count) -> Result<(), Error> {
    let silent: usize = spans.iter().map(|s| s.silent_rays).sum();
    let share = silent as f64 / count.rays.max(1) as f64;
    if share <= MOST_SILENT {
        return Ok(());
    }
    let reason = format!(
        "the surface encloses nothing: {:.0} % of the rays that meet it pass an open sheet; close or thicken it first",
        100.0 * share
    );
    Err(Error::NothingEnclosed { reason })
}

/// Why the result has no inside, in one sentence, with what to try. The voxel and the smallest possible one, model units.
pub(super) fn why_nothing(spans: &[Spans], [h, finest]: [f64; 2], count: Count, operands: usize) -> String {
    let silent: usize = spans.iter().map(|s| s.silent_rays).sum();
    let lengths = lengths(spans);
    let lost = thin(&lengths, h, finest);
    if 2 * silent > count.rays {
        return "the surface encloses nothing: most rays that meet it pass an open sheet; close or thicken it first"
            .into();
    }
    if !lengths.spans.is_empty() {
        return format!(
            "no voxel lies inside: the walls are thinner than a voxel of {}{}",
            digits::number(h),
            keeping_voxel(&lost)
        );
    }
    match operands {
        1 => "the surface encloses nothing".into(),
        _ => "the result is empty: the operands have no such part in common".into(),
    }
}
