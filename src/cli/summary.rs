//! What a run says to a person: a few aligned lines, made from the report.

use super::course::in_words;
use super::entries::InputEntry;
use super::input::Input;
use super::report::RunReport;
use super::session::Session;
use super::table::{Row, table};
use super::words::{self, UnitName};
use super::{done, doubts, dropped, exact, holes};
use crate::io::{Loaded, Unit};
use crate::mesh::Validity;
use crate::pipeline::{Plan, Report};

/// Says what was wrong, what was done and what came out.
pub fn say(session: &Session, report: &RunReport, unit: UnitName<'_>) {
    session.say(table(&rows(report, unit)).trim_end());
    if let Some(pipeline) = report.pipeline().filter(|_| session.verbose) {
        session.say(table(&details(report, pipeline, unit)).trim_end());
    }
}

fn rows(report: &RunReport, unit: UnitName<'_>) -> Vec<Row> {
    let mut rows = input_rows(report);
    rows.extend(report.options["preset"].as_str().map(|text| ("preset", text.to_owned())));
    if let Some(pipeline) = report.pipeline() {
        rows.extend(done::done(pipeline, unit).into_iter().map(|text| ("done", text)));
        rows.extend(holes::rows(&pipeline.holes, unit));
        rows.extend(exact::rows(pipeline));
        if pipeline.lattice {
            rows.push(("voxel", voxel(pipeline.voxel, pipeline.dims, unit)));
        }
        rows.extend(dropped::rows(pipeline, unit));
        rows.extend(doubts::rows(pipeline, unit));
    }
    rows.extend(result_rows(report, unit));
    rows.push(time(report));
    rows
}

/// The mesh that was written.
pub fn result_rows(report: &RunReport, unit: UnitName<'_>) -> Vec<Row> {
    let Some((output, validity)) = report.output().and_then(|o| Some((o, o.validity.as_ref()?))) else {
        return Vec::new();
    };
    // The file may be in another unit than the model is told of in.
    let metres = |name: Option<&str>| name.and_then(|name| name.parse().ok()).map(Unit::metres);
    let factor = metres(output.unit.as_deref()).zip(metres(unit)).map_or(1.0, |(file, model)| file / model);
    if !validity.is_valid() {
        let triangles = words::plural(validity.triangles, "triangle");
        let open = words::plural(validity.open_edges, "open edge");
        return vec![("result", format!("{}: {triangles}, {open}: no solid", output.path))];
    }
    let volume = validity.volume * factor.powi(3);
    vec![
        ("result", format!("{}: {}, volume {}", output.path, solid(validity), words::volume(volume, unit))),
        ("result", "closed, oriented, without self-intersections; checked on the written file".into()),
    ]
}

/// What was read, and what is wrong with it.
pub fn input_rows(report: &RunReport) -> Vec<Row> {
    let mut rows = Vec::new();
    // All inputs were brought to one unit.
    let unit = report.options.get("unit").and_then(|unit| unit.as_str());
    for input in &report.inputs {
        rows.push(("input", described(input, unit)));
        rows.extend(wrong(input).into_iter().map(|text| ("wrong", text)));
    }
    rows
}

/// How long it took, and how much memory.
pub fn time(report: &RunReport) -> Row {
    let memory = report.peak_memory_bytes.map_or(String::new(), |bytes| format!(", {} of memory", words::bytes(bytes)));
    ("time", format!("{}{memory}", words::seconds(report.seconds)))
}

/// The seconds of each stage.
pub fn stages(report: &RunReport) -> impl Iterator<Item = Row> {
    report.stages.iter().map(|stage| ("stage", format!("{:8.3} s  {}", stage.seconds, in_words(stage.stage))))
}

fn described(input: &InputEntry, unit: UnitName<'_>) -> String {
    let mut text = format!("{}: ", input.path);
    if let Some(name) = &input.name {
        text = format!("{name} = {text}");
    }
    if input.parts.is_empty() {
        return text + "values over a lattice";
    }
    let triangles = input.validity.as_ref().map_or(0, |validity| validity.triangles);
    text.push_str(&words::plural(triangles, "triangle"));
    if input.parts.len() > 1 {
        text.push_str(&format!(" in {}", words::plural(input.parts.len(), "object")));
    }
    if let Some(bounds) = input.validity.as_ref().and_then(|validity| validity.bounds) {
        text.push_str(&format!(", {}", words::size(extent(bounds), unit)));
    }
    text
}

fn wrong(input: &InputEntry) -> Vec<String> {
    match &input.validity {
        Some(validity) if validity.is_valid() => vec!["nothing: it is a closed, oriented solid".into()],
        Some(validity) => validity.problems().iter().map(|problem| problem.trim_end_matches('.').to_string()).collect(),
        None => Vec::new(),
    }
}

/// The voxel size, and how many of them.
pub fn voxel(voxel: f64, dims: [i32; 3], unit: UnitName<'_>) -> String {
    let [x, y, z] = dims;
    format!("{} ({x} x {y} x {z} of them)", words::length(voxel, unit))
}

pub(super) fn solid(validity: &Validity) -> String {
    let mut text = format!(
        "{}, {}",
        words::plural(validity.triangles, "triangle"),
        words::plural(validity.bodies, "closed surface")
    );
    if let Some(genus) = validity.genus.filter(|genus| *genus > 0) {
        text.push_str(&format!(" with {}", words::plural(genus as usize, "tunnel")));
    }
    text
}

/// What `-v` adds: what was cut, where the votes were close, and the stages.
fn details(report: &RunReport, pipeline: &Report, unit: UnitName<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = exact::details(pipeline);
    if pipeline.lattice {
        rows.extend(votes(pipeline, unit));
    }
    rows.extend(stages(report));
    rows
}

/// What the rays met, and where the votes were close.
fn votes(pipeline: &Report, unit: UnitName<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let vote = &pipeline.vote;
    rows.push((
        "rays",
        format!(
            "{}, of which {} could not decide; {}, at most {} on one",
            words::count(pipeline.ldi.rays),
            words::count(pipeline.ldi.silent_rays),
            words::plural(pipeline.ldi.hits, "crossing"),
            words::count(pipeline.ldi.layers)
        ),
    ));
    rows.push(("rays", super::backend::words(&pipeline.ldi.made_by, "found")));
    let (doubtful, voxels) = (words::plural(vote.doubtful, "voxel"), words::count(vote.voxels));
    rows.push(("doubt", format!("{doubtful} of {voxels} near the surface")));
    for region in vote.doubtful_regions.iter().take(5) {
        let place = |p: [f64; 3]| p.map(words::number).join(" ");
        let text = format!(
            "{} from {} to {}",
            words::plural(region.voxels, "voxel"),
            place(region.min),
            words::with_unit(&place(region.max), unit)
        );
        rows.push(("doubt", text));
    }
    rows
}

/// The rows of `--plan`.
pub fn plan(plan: &Plan, unit: UnitName<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = exact::planned(plan).into_iter().map(|text| ("exact", text)).collect();
    let lattice = match plan.dims {
        [0, 0, 0] if plan.exact => vec![],
        [0, 0, 0] => vec![("voxel", "none: every closed surface stays as it is".into())],
        dims => vec![
            ("voxel", voxel(plan.voxel, dims, unit)),
            ("surface", format!("about {}", words::plural(plan.voxels_near_surface as usize, "voxel"))),
        ],
    };
    let rest = [
        ("result", format!("about {}", words::plural(plan.triangles as usize, "triangle"))),
        ("memory", format!("about {}", words::bytes(plan.memory))),
        ("time", format!("about {} on one core", words::seconds(plan.seconds))),
    ];
    rows.extend(lattice.into_iter().chain(rest));
    rows
}

/// As many objects of a file are listed by name.
const LISTED_OBJECTS: usize = 20;

/// The rows of `inspect`.
pub fn inspection(input: &Input, validity: &Validity, unit: Option<Unit>) -> Vec<Row> {
    let name = unit.map(|unit| unit.to_string());
    let name = name.as_deref();
    let mut rows = vec![
        ("file", format!("{}, {}, {}", input.label, input.entry.format, words::bytes(input.entry.bytes.unwrap_or(0)))),
        ("unit", name.map_or("not stated in the file".into(), str::to_string)),
    ];
    let parts = &input.entry.parts;
    let listed = if parts.len() > 1 { parts.len().min(LISTED_OBJECTS) } else { 0 };
    for (n, part) in parts[..listed].iter().enumerate() {
        let called = if part.name.is_empty() { "(no name)" } else { &part.name };
        let number = n + 1;
        rows.push(("objects", format!("{number} {called}: {}", words::plural(part.triangles, "triangle"))));
    }
    if listed > 0 && parts.len() > listed {
        rows.push(("objects", format!("and {} more", words::count(parts.len() - listed))));
    }
    for part in &input.entry.negative_parts {
        let called = if part.name.is_empty() { "(no name)" } else { &part.name };
        rows.push(("negative", format!("{called}: {}, not counted below", words::plural(part.triangles, "triangle"))));
    }
    if let Some([min, max]) = validity.bounds {
        let place = |p: [f64; 3]| p.map(words::number).join(" ");
        rows.push(("size", words::size(extent([min, max]), name)));
        rows.push(("box", format!("{} to {}", place(min), place(max))));
    }
    let vertices = match validity.unused_vertices {
        0 => words::count(validity.vertices),
        unused => format!("{}, {} of them unused", words::count(validity.vertices), words::count(unused)),
    };
    let yes_no = |yes: bool| if yes { "yes" } else { "no" };
    rows.extend([
        ("triangles", words::count(validity.triangles)),
        ("vertices", vertices),
        ("surfaces", words::count(validity.bodies)),
        ("tunnels", validity.genus.map_or("not known: the surface is not closed".into(), |genus| genus.to_string())),
        ("area", words::area(validity.area, name)),
        ("volume", words::volume(validity.volume, name)),
        ("closed", yes_no(validity.is_closed()).into()),
        ("oriented", yes_no(validity.is_oriented_manifold()).into()),
        ("valid", yes_no(validity.is_valid()).into()),
    ]);
    rows.extend(validity.problems().into_iter().map(|problem| ("problems", problem)));
    rows
}

fn extent([min, max]: [[f64; 3]; 2]) -> [f64; 3] {
    std::array::from_fn(|axis| max[axis] - min[axis])
}

/// Sizes and places that are rarely meant.
pub fn size_doubts(loaded: &Loaded, unit: Option<Unit>) -> Vec<String> {
    let Some(bounds) = loaded.mesh.bounds() else { return Vec::new() };
    let mut doubts = Vec::new();
    let diagonal = bounds.diagonal();
    match unit.map(|unit| diagonal * unit.metres()) {
        Some(metres) if !(1e-4..1e3).contains(&metres) => doubts
            .push(format!("the diagonal is {} m, which is rarely meant: is the unit right?", words::number(metres))),
        None if !(1e-2..1e5).contains(&diagonal) => doubts.push(format!(
            "the diagonal is {}, which is rarely meant in millimetres: --unit says what the numbers are",
            words::number(diagonal)
        )),
        _ => {}
    }
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    // Single precision resolves 1 in 2^24; below a thousand steps across, shapes suffer visibly.
    if diagonal > 0.0 && farthest / diagonal > 16_000.0 {
        doubts.push(
            "it lies so far from the origin that single-precision formats (STL, GLB) cannot hold its details".into(),
        );
    }
    if bounds.size().min_element() == 0.0 {
        doubts.push("it is flat: it has no extent along one axis".into());
    }
    doubts
}
