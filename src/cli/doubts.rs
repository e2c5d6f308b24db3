//! What a lattice may have harmed, in words: bodies that changed, and walls and gaps that it does not hold.

use super::report::RunReport;
use super::table::Row;
use super::words::{self, UnitName};
use crate::pipeline::{LostBody, Report, ThinRegion, Topology, TopologyReport};

/// All of it, as rows of the summary.
pub fn rows(pipeline: &Report, unit: UnitName<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = thin_places(pipeline, unit).into_iter().map(|text| ("thin", text)).collect();
    if let Some(topology) = &pipeline.topology {
        rows.extend(changes(topology).into_iter().map(|text| ("changed", text)));
        rows.extend(lost_bodies(topology, unit).into_iter().map(|text| ("lost", text)));
    }
    rows
}

/// What became of the bodies, where it is not what the operands describe.
pub fn changes(topology: &TopologyReport) -> Vec<String> {
    let mut parts = Vec::new();
    let (before, after) = (topology.before, topology.after);
    let mut add = |count: usize, one: &str, many: &str| match count {
        0 => {}
        1 => parts.push(one.to_string()),
        n => parts.push(format!("{} {many}", words::count(n))),
    };
    add(topology.lost_count, "1 body is gone", "bodies are gone");
    add(
        topology.fused,
        "2 bodies that do not touch came out as one",
        "bodies came out joined with others that they do not touch",
    );
    add(topology.parted - topology.crumbs, "1 piece came off a body", "pieces came off bodies");
    add(topology.crumbs, "1 crumb was made beside a body", "crumbs were made beside bodies");
    let tunnels = topology.new_tunnels.unwrap_or(0).max(0) as usize;
    add(tunnels, "1 tunnel is new", "tunnels are new");
    if let Some(before) = before.filter(|_| !parts.is_empty()) {
        let count = |t: &Topology| {
            let tunnels = words::plural(t.tunnels.max(0) as usize, "tunnel");
            format!("{}, {}, {tunnels}", words::plural(t.bodies, "body"), words::plural(t.voids, "void"))
        };
        parts.push(format!("before: {}; after: {}", count(&before), count(&after)));
    }
    parts
}

/// As many lost bodies, and thin places, are told; the report has more.
const TOLD: usize = 3;

fn lost_bodies(topology: &TopologyReport, unit: UnitName<'_>) -> Vec<String> {
    let told = |lost: &LostBody| {
        let what = if lost.void { "void" } else { "body" };
        let place = lost.at.map(words::number).join(" ");
        format!("a {what} of {} at {place}", words::length(lost.size, unit))
    };
    topology.lost.iter().take(TOLD).map(told).collect()
}

/// Where walls and gaps are thinner than the lattice holds.
fn thin_places(pipeline: &Report, unit: UnitName<'_>) -> Vec<String> {
    let told = |region: &ThinRegion| {
        let what = if region.gap { "gap" } else { "wall" };
        let middle: [f64; 3] = std::array::from_fn(|axis| (region.min[axis] + region.max[axis]) / 2.0);
        let size: [f64; 3] = std::array::from_fn(|axis| region.max[axis] - region.min[axis]);
        format!(
            "a {what} down to {} around {} ({} across): under 2 voxels, look there",
            words::length(region.thinnest, unit),
            middle.map(words::number).join(" "),
            words::size(size, unit)
        )
    };
    let mut rows: Vec<String> = pipeline.thin.regions.iter().take(TOLD).map(told).collect();
    match pipeline.thin.regions.len().saturating_sub(TOLD) {
        0 => {}
        more => rows.push(format!("and {} more (--report has them)", words::plural(more, "place"))),
    }
    rows.extend(finer(pipeline, unit));
    rows
}

/// What may do better than a result that is mostly lost; nothing that cannot be.
pub fn better(report: &RunReport, unit: UnitName<'_>) -> String {
    let pipeline = report.pipeline();
    let finer = pipeline.and_then(|p| p.thin.voxel_that_keeps.filter(|keeps| *keeps < p.voxel));
    match finer {
        Some(voxel) => {
            let voxel = words::with_unit(&words::rounded_down(voxel), unit).replace(' ', "");
            format!("--voxel {voxel} would keep 99 % of the walls")
        }
        None => "`meshwright inspect` says what is wrong with the input, and `render` shows it".into(),
    }
}

/// More than this share of walls under two voxels is worth a smaller voxel: rays that graze edges and
/// silhouettes make up to about 0.04 of short spans on any shape.
const THIN_WALLS_TOLD: f64 = 0.05;

/// The voxel that would hold the walls, where some of them may have suffered.
fn finer(pipeline: &Report, unit: UnitName<'_>) -> Option<String> {
    let thin = &pipeline.thin;
    if thin.thin_spans as f64 <= THIN_WALLS_TOLD * thin.spans as f64 || thin.regions.is_empty() {
        return None;
    }
    match thin.voxel_that_keeps {
        Some(keeps) if keeps < pipeline.voxel => {
            let keeps = words::with_unit(&words::rounded_down(keeps), unit).replace(' ', "");
            Some(format!("--voxel {keeps} would keep 99 % of the walls"))
        }
        Some(_) => None,
        None => Some("no voxel that is possible would keep 99 % of the walls: they are too thin".into()),
    }
}
