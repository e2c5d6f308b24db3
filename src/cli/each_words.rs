//! What `repair --each` says of the objects of a file.

use std::collections::BTreeMap;

use super::entries::{AsideEntry, ObjectDone, ObjectEntry};
use super::report::RunReport;
use super::result::RunResult;
use super::table::Row;
use super::target::Target;
use super::words::{self, UnitName};
use super::{done, summary};
use crate::io::{Aside, Format, Unit};

/// As many objects, and names, are listed one by one.
const LISTED: usize = 30;

/// What is said elsewhere of a flag that has no place here.
const MAP: &str = " (--map shows which)";

/// The summary.
pub fn rows(report: &RunReport, format: Format, target: &Target, unit: Option<Unit>) -> Vec<Row> {
    let Some(RunResult::Objects { objects, aside, output }) = &report.result else { return Vec::new() };
    let unit = unit.map(|unit| unit.to_string());
    let label = report.inputs.first().map_or("", |input| input.path.as_str());
    let places: usize = objects.iter().map(|object| object.places).sum();
    let often =
        if places == objects.len() { String::new() } else { format!(", placed {} times", words::count(places)) };
    let mut rows = vec![("input", format!("{label}: {format}, {}{often}", words::plural(objects.len(), "object")))];
    rows.extend(report.options["preset"].as_str().map(|text| ("preset", text.to_owned())));
    for (n, object) in objects.iter().take(LISTED).enumerate() {
        rows.extend(of_object(n + 1, object, unit.as_deref()));
    }
    if let Some(more) = objects.len().checked_sub(LISTED).filter(|&more| more > 0) {
        rows.push(("object", format!("and {} more, which --json lists", words::count(more))));
    }
    let own = |entry: &AsideEntry| Aside { what: entry.what.clone(), name: entry.name.clone() };
    let aside: Vec<Aside> = aside.iter().map(own).collect();
    let is_kept = target.options.format == format || (target.options.format.is_single() && format.is_single());
    if is_kept && !aside.is_empty() {
        rows.push(("as it is", listed(&aside)));
    }
    if let Some(output) = output {
        rows.push(("result", format!("{}: {}, {}", output.path, output.format, outcome(objects))));
        rows.push((
            "result",
            "every repaired object is closed, oriented, without self-intersections; checked on the written file".into(),
        ));
    }
    rows.push(summary::time(report));
    rows
}

/// A sentence on what a file of another kind does not get.
pub fn left_out(aside: &[Aside], format: Format) -> Option<String> {
    (!aside.is_empty()).then(|| format!("{format} has no place for it, left out: {}", listed(aside)))
}

fn outcome(objects: &[ObjectEntry]) -> String {
    let count = |done: ObjectDone| objects.iter().filter(|object| object.done == done).count();
    let kinds = [
        (ObjectDone::Repaired, "repaired"),
        (ObjectDone::Kept, "kept, solid already"),
        (ObjectDone::Left, "left alone, not solid"),
        (ObjectDone::NotPicked, "not picked"),
    ];
    let parts = kinds.into_iter().map(|(done, what)| (count(done), what)).filter(|(count, _)| *count > 0);
    let parts: Vec<String> = parts.map(|(count, what)| format!("{} {what}", words::plural(count, "object"))).collect();
    parts.join("; ")
}

fn of_object(number: usize, object: &ObjectEntry, unit: UnitName<'_>) -> Vec<Row> {
    let name = if object.name.is_empty() { "(no name)" } else { &object.name };
    let often =
        if object.places == 1 { String::new() } else { format!(" (placed {} times)", words::count(object.places)) };
    let mut rows = Vec::new();
    let triangles = object.before.as_ref().map(|before| words::plural(before.triangles, "triangle"));
    let mut what: Vec<String> = triangles.into_iter().collect();
    match (&object.before, object.done) {
        (Some(before), ObjectDone::Kept) if before.is_valid() => what.push("a solid; kept as it is".into()),
        (_, ObjectDone::Kept) => what.push("kept as it is".into()),
        (Some(before), _) => {
            what.extend(before.problems().iter().map(|problem| problem.trim_end_matches('.').to_string()));
        }
        (None, _) => what.push("not picked".into()),
    }
    rows.push(("object", format!("{number} {name}{often}: {}", what.join(", "))));
    if let Some(why) = &object.why {
        rows.push(("left", format!("as it is: {why}")));
    }
    if let (ObjectDone::Repaired, Some(pipeline), Some(after)) = (object.done, &object.pipeline, &object.after) {
        rows.extend(done::done(pipeline, unit).into_iter().map(|text| ("done", text.replace(MAP, ""))));
        let volume = words::volume(after.volume, unit);
        rows.push(("now", format!("{}, volume {volume}", summary::solid(after))));
    }
    rows
}

/// "2 modifiers (`a`, `b`), 1 camera".
fn listed(aside: &[Aside]) -> String {
    let mut kinds: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for own in aside {
        kinds.entry(&own.what).or_default().push(&own.name);
    }
    let kind = |(what, names): (&str, Vec<&str>)| {
        let count = names.len();
        let mut known: Vec<String> = Vec::new();
        for name in names.into_iter().filter(|name| !name.is_empty()) {
            let name = format!("`{name}`");
            if !known.contains(&name) && known.len() <= LISTED {
                known.push(name);
            }
        }
        let more = if known.len() > LISTED { ", …" } else { "" };
        known.truncate(LISTED);
        let known = if known.is_empty() { String::new() } else { format!(" ({}{more})", known.join(", ")) };
        format!("{}{known}", words::plural(count, what))
    };
    kinds.into_iter().map(kind).collect::<Vec<_>>().join(", ")
}
