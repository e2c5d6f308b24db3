//! What is not in the result because it is too small, in words.

use super::table::Row;
use super::words::{self, UnitName};
use crate::pipeline::{Dropped, MorphologyReport, Report};

/// Missing surface that is less than this part of all is not worth a line: whatever grows thinner towards its rim ends between voxels.
const WORTH_A_LINE: f64 = 1e-3;

/// All of it, as rows of the summary.
pub fn rows(pipeline: &Report, unit: UnitName<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    if let Some(change) = &pipeline.morphology {
        rows.extend(finer(change, pipeline.voxel, unit).map(|text| ("voxel", text)));
        rows.extend(too_thin(change, unit).map(|text| ("thin", text)));
    }
    rows.extend(crumbs(&pipeline.crumbs, unit).map(|text| ("dropped", text)));
    rows.extend(smaller(&pipeline.smaller, unit).map(|text| ("dropped", text)));
    rows
}

fn crumbs(dropped: &Dropped, unit: UnitName<'_>) -> Option<String> {
    let volume = words::volume(dropped.volume, unit);
    (dropped.surfaces > 0).then(|| {
        let crumbs = words::plural(dropped.surfaces, "crumb");
        format!("{crumbs} under 2 voxels each way that no body of the input asked for (volume {volume} together)")
    })
}

/// What `--drop-smaller` left out.
pub fn smaller(dropped: &Dropped, unit: UnitName<'_>) -> Option<String> {
    let volume = words::volume(dropped.volume, unit);
    (dropped.surfaces > 0).then(|| {
        let surfaces = words::plural(dropped.surfaces, "closed surface");
        format!("{surfaces} smaller than --drop-smaller allows (volume {volume} together)")
    })
}

/// The voxels of the offsets, where they are others than those of the solid.
fn finer(change: &MorphologyReport, voxel: f64, unit: UnitName<'_>) -> Option<String> {
    let h = words::length(change.voxel, unit);
    (change.voxel < 0.99 * voxel).then(|| format!("{h} for the offset: the radius, or what is left, needs it"))
}

fn too_thin(change: &MorphologyReport, unit: UnitName<'_>) -> Option<String> {
    let place = change.thin_place.filter(|_| change.thin_share > WORTH_A_LINE)?.map(words::number).join(" ");
    let places = words::plural(change.too_thin, "place");
    let h = words::length(change.voxel, unit);
    let verb = if change.too_thin == 1 { "is" } else { "are" };
    Some(format!(
        "{places} (one at {place}) {verb} thinner than a voxel of {h} and missing or not whole; a smaller --voxel keeps more"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dropped_is_told_and_nothing_is_said_of_nothing() {
        assert!(rows(&Report::default(), None).is_empty());
        let crumbs = Dropped { surfaces: 1, triangles: 8, volume: 0.25 };
        let smaller = Dropped { surfaces: 2, triangles: 24, volume: 3.0 };
        let rows = rows(&Report { crumbs, smaller, ..Report::default() }, Some("mm"));
        let texts: Vec<&str> = rows.iter().map(|(_, text)| text.as_str()).collect();
        assert!(texts[0].starts_with("1 crumb under") && texts[0].contains("0.25 mm³"), "{texts:?}");
        assert!(texts[1].starts_with("2 closed surfaces smaller"), "{texts:?}");
    }
}
