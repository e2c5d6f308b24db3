//! What an exact result is told to be, in words.

use super::table::Row;
use super::words;
use crate::pipeline::{Plan, Report};

/// Whether all of a result is exact: cut where surfaces cross, or as it was, without any voxel.
fn is_all(pipeline: &Report) -> bool {
    pipeline.exact.is_some() && !pipeline.lattice && !is_changed(pipeline)
}

/// Whether something was done to the solid, with voxels of its own.
fn is_changed(pipeline: &Report) -> bool {
    pipeline.morphology.is_some() || pipeline.hollow.is_some() || pipeline.thicken.is_some()
}

/// What was cut, and what came of it.
pub fn rows(pipeline: &Report) -> Vec<Row> {
    let Some(exact) = &pipeline.exact else { return Vec::new() };
    let voxels = if is_all(pipeline) { "; no voxels" } else { "" };
    let cut = match (exact.cut, exact.curves) {
        (0, _) => "nothing had to be cut".to_string(),
        (cut, 0) => format!("{} cut where they touch others", words::plural(cut, "triangle")),
        (cut, curves) => {
            format!("{} cut along {}", words::plural(cut, "triangle"), words::plural(curves, "segment"))
        }
    };
    let mut rows = vec![cut + voxels];
    if exact.separated > 0 {
        let vertices = words::plural(exact.separated, "vertex");
        rows.push(format!("{vertices} moved apart by a hair, where bodies touch at an edge or a corner alone"));
    }
    rows.into_iter().map(|text| ("exact", text)).collect()
}

/// What `-v` adds.
pub fn details(pipeline: &Report) -> Vec<Row> {
    let Some(exact) = &pipeline.exact else { return Vec::new() };
    let (pairs, points) = (words::plural(exact.pairs, "pair"), words::plural(exact.points, "point"));
    let mut rows = vec![format!(
        "{pairs} of {} touch; {points} made where they cross, {} of space between them",
        words::plural(exact.triangles, "triangle"),
        words::plural(exact.cells, "part")
    )];
    if exact.rounds > 0 {
        let rounds = words::plural(exact.rounds, "time");
        let off = words::number(100.0 * exact.volume_error);
        rows.push(format!(
            "united with itself {rounds} more, because triangles crossed once rounded; volume {off} % off"
        ));
    }
    rows.into_iter().map(|text| ("exact", text)).collect()
}

/// What `--plan` says of what will be cut.
pub fn planned(plan: &Plan) -> Option<String> {
    let voxels = if plan.dims == [0; 3] { "no voxels" } else { "inputs with holes are made whole first" };
    plan.exact.then(|| match plan.touching {
        0 => format!("nothing touches anything; {voxels}"),
        n => format!(
            "about {} to be cut, where they touch or cross others; {voxels}",
            words::plural(n as usize, "triangle")
        ),
    })
}
