//! What was done to a mesh, in words.

use super::words::{self, UnitName};
use crate::morphology::Operation;
use crate::pipeline::{
    BlockReport, DrainReport, HoleClosing, HollowReport, OuterReport, Report, ThickenReport, TriangleKind,
};

/// What was done, one part of a sentence each.
pub fn done(pipeline: &Report, unit: UnitName<'_>) -> Vec<String> {
    let sum = |field: fn(&crate::orient::OrientReport) -> usize| pipeline.orient.iter().map(field).sum::<usize>();
    let mut parts = Vec::new();
    let mut add = |n: usize, word: &str, what: &str| {
        if n > 0 {
            parts.push(format!("{} {what}", words::plural(n, word)));
        }
    };
    add(sum(|o| o.degenerate_dropped), "triangle", "without area dropped");
    add(sum(|o| o.duplicates_dropped), "repeated triangle", "dropped");
    add(sum(|o| o.both_sided), "triangle", "present in both directions counted once");
    add(sum(|o| o.flipped_in_patches), "triangle", "turned over to agree with the neighbours");
    add(sum(|o| o.flipped_patches), "patch", "turned over as a whole");
    if let Some(zip) = &pipeline.zip {
        let closed = zip.open_before.saturating_sub(zip.open_after);
        let how = match (zip.inserted, zip.merged) {
            (inserted, 0) => format!("{} put on edges beside them", words::plural(inserted, "vertex")),
            (0, _) => format!("vertices moved by up to {}", words::length(zip.farthest, unit)),
            (inserted, _) => format!(
                "{} put on edges beside them, others moved by up to {}",
                words::plural(inserted, "vertex"),
                words::length(zip.farthest, unit)
            ),
        };
        add(closed, "open edge", &format!("at cracks closed: {how}"));
    }
    let lids = pipeline.holes.iter().map(|hole| hole.triangles).sum();
    let lidded = pipeline.holes.iter().filter(|hole| hole.has_lid()).count();
    add(lidded, "hole", &format!("closed with {}", words::plural(lids, "triangle")));
    add(pipeline.cut, "triangle", "cut along others first, so that what they cross in stays exact");
    if let Some(outer) = &pipeline.outer {
        let widest = pipeline.holes.iter().map(|hole| hole.diameter).reduce(f64::max);
        parts.extend(seen(outer, widest, unit));
    }
    parts.extend(pipeline.block.as_ref().map(|block| under(block, unit)));
    if pipeline.ldi.silent_rays > 0 {
        let share = words::percent(pipeline.ldi.silent_rays, pipeline.ldi.rays);
        parts.push(format!("{share} of the test rays met a hole or a crack, where those in other directions decided"));
    }
    parts.extend(kept(pipeline));
    if let Some(fit) = pipeline.fit.as_ref().filter(|fit| fit.kept < fit.of) {
        let points = words::plural(fit.inserted + fit.moved, "point");
        let given_up = match fit.given_up {
            0 => String::new(),
            n => format!("; {} left rough, where no sharp edge could be fitted", words::plural(n, "place")),
        };
        parts.push(format!("{points} set on edges and corners{given_up}"));
    }
    if let Some(canals) = pipeline.canals.as_ref().filter(|canals| !canals.removed.is_empty()) {
        let volume = pipeline.morphology.as_ref().map(|m| words::percent_change(m.volume_before, m.volume_after));
        let volume = volume.map_or(String::new(), |change| format!(": volume {change}"));
        let (filled, all) = (words::count(canals.removed.len()), words::plural(canals.canals.len(), "canal"));
        parts.push(format!("{filled} of {all} filled (--map shows where){volume}"));
    } else if let Some(change) = &pipeline.morphology {
        let by = words::length(change.radius, unit);
        let word = match change.operation {
            Operation::Dilate => "grown by",
            Operation::Erode => "shrunk by",
            Operation::Close => "closed by a ball of",
            Operation::Open => "opened by a ball of",
        };
        let volume = words::percent_change(change.volume_before, change.volume_after);
        parts.push(format!("{word} {by}: volume {volume}; {} new", words::plural(change.made, "triangle")));
    } else if let Some(hollow) = &pipeline.hollow {
        parts.extend(hollowed(hollow, unit));
    } else if let Some(thick) = &pipeline.thicken {
        parts.push(thickened(thick, pipeline.closed_triangles, unit));
    }
    parts
}

/// What stayed as it is.
fn kept(pipeline: &Report) -> Vec<String> {
    let standing = &pipeline.standing;
    let mut parts = Vec::new();
    let left_out = standing.left_out + pipeline.topology.as_ref().map_or(0, |topology| topology.buried);
    if left_out > 0 {
        let shells = words::plural(left_out, "surface");
        parts.push(format!("{shells} left out: inside of others, or outside of the result"));
    }
    let counts = &pipeline.triangles;
    parts.push(match (counts.cut, counts.rebuilt, counts.made_up) {
        (0, 0, 0) if pipeline.holes.iter().any(|hole| hole.closed_by == HoleClosing::LeftOut) => {
            "every triangle that is not of a sheet was kept as it is".into()
        }
        (0, 0, 0) => "every triangle was kept as it is".into(),
        _ => {
            let some = TriangleKind::BY_CHANGE.into_iter().filter(|&kind| counts.count(kind) > 0);
            let of = some.map(|kind| format!("{} {}", words::count(counts.count(kind)), kind.word()));
            format!("of its triangles {} (--map shows which)", of.collect::<Vec<_>>().join(", "))
        }
    });
    parts
}

/// What a ball saw from outside. `widest`: the diameter of the widest hole that was closed.
fn seen(found: &OuterReport, widest: Option<f64>, unit: UnitName<'_>) -> Vec<String> {
    let ball = words::length(found.ball, unit);
    let (outer, inner) = (words::plural(found.outer_triangles, "triangle"), words::count(found.inner_triangles));
    let mut parts = vec![format!("a ball of {ball} was rolled around: {outer} it sees from outside")];
    if found.inner_triangles > 0 {
        let patches = match found.inner_patches {
            0 => String::new(),
            n => format!(", {} among them as a whole", words::plural(n, "patch")),
        };
        parts.push(format!("{inner} went, which it does not come to{patches}"));
    }
    parts.extend(
        widest.map(|widest| format!("the widest hole that it does not pass is {} across", words::length(widest, unit))),
    );
    if let Some(thickness) = found.thickness {
        let (sheets, area) = (words::plural(found.sheet_triangles, "triangle"), words::area(found.sheet_area, unit));
        parts.push(format!(
            "{sheets} ({area}) that it sees from both sides made {} thick",
            words::length(thickness, unit)
        ));
    }
    parts
}

/// The block under a sheet.
fn under(block: &BlockReport, unit: UnitName<'_>) -> String {
    let turned = match block.turned {
        0 => String::new(),
        n => format!("; {} turned over", words::plural(n, "sheet")),
    };
    format!(
        "a block under {}, with walls under {} down to a base at {} = {}{turned}",
        words::plural(block.sheets, "sheet"),
        words::plural(block.edges, "open edge"),
        block.axis,
        words::with_unit(&words::number(block.base), unit)
    )
}

fn thickened(thick: &ThickenReport, made: usize, unit: UnitName<'_>) -> String {
    let least = words::length(thick.least, unit);
    if thick.thin_area == 0.0 && thick.sheet_area == 0.0 {
        return format!("nothing is thinner than {least}");
    }
    let sheets = if thick.sheet_area > 0.0 { " and open sheets" } else { "" };
    let volume = if thick.volume_before > 0.0 {
        format!("volume {}", words::percent_change(thick.volume_before, thick.volume_after))
    } else {
        "there was no solid before".into()
    };
    let made = words::plural(made, "triangle");
    format!("walls{sheets} grown to {least}: {volume}; {made} new")
}

/// What was done, in words.
fn hollowed(found: &HollowReport, unit: UnitName<'_>) -> Vec<String> {
    let (wall, cavities) = (words::length(found.wall, unit), words::plural(found.cavities, "cavity"));
    let saved = words::volume(found.volume_before - found.volume_after, unit);
    let share = words::percent_change(found.volume_before, found.volume_after);
    let mut parts = vec![format!("{cavities} with walls of {wall}: {saved} saved (volume {share})")];
    if found.left_out > 0 {
        parts.push(format!("{} of under 64 voxels not made", words::plural(found.left_out, "cavity")));
    }
    let drain = |drain: &DrainReport| {
        let place = |p: [f64; 3]| p.map(words::number).join(" ");
        let (diameter, depth) = (words::length(drain.diameter, unit), words::length(drain.depth, unit));
        format!("a drain of {diameter}, {depth} deep, from {} along {}", place(drain.at), place(drain.direction))
    };
    parts.extend(found.drains.iter().map(drain));
    if !found.drains.is_empty() {
        parts.push("what the drains cut of the surface was built anew, the rest is as said above".into());
    }
    parts
}
