//! `compare A B`: how far two meshes are from each other.

use clap::Args;
use std::path::Path;
use std::path::PathBuf;

use serde_json::json;

use super::entries::OutputEntry;
use super::exit::{Exit, Failure};
use super::input::{self, Input};
use super::length::{Length, Scale};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs};
use super::streams::{self, is_stream};
use super::table::{self, Row};
use super::words::{self, UnitName};
use super::{output, page, side, target};
use crate::compare::{CompareOptions, Comparison, Relative, compare, deviation_map};
use crate::io::{self, ColourScale, Format, LegendEntry, Unit, VertexMap};
use crate::progress::Stage;

/// `compare A B`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The reference
    #[arg(value_name = "A")]
    pub a: PathBuf,
    /// The mesh that is judged
    #[arg(value_name = "B")]
    pub b: PathBuf,
    /// Write B, coloured by its signed distance from A, to this file
    #[arg(long, value_name = "FILE.ply")]
    pub map: Option<PathBuf>,
    /// The distance that has the full colour in the map [default: what 99 of 100 vertices do not exceed]
    #[arg(long, value_name = "LEN", requires = "map")]
    pub map_range: Option<Length>,
    /// Points on each mesh at which distances are taken, besides all vertices
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub samples: u32,
    /// How near a sharp edge of the other mesh must be to count as found [default: 1/1024 of A's longest side]
    #[arg(long, value_name = "LEN")]
    pub tolerance: Option<Length>,
    /// Exit with 3 when a point of one mesh is farther than this from the other
    #[arg(long, value_name = "LEN")]
    pub fail_on_max: Option<Length>,
    /// How the inputs are read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Measures two files against each other and prints a table.
pub fn run(args: &CompareArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let paths: [&Path; 2] = [&args.a, &args.b];
    if let Some(map) = &args.map {
        check_map(map)?;
    }
    let mut inputs =
        report.timed(Stage::Read, |report| input::read_all(&paths, &args.reading, session, &mut report.warnings))?;
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let [a, b] = inputs.as_slice() else { return Err(Failure::internal("two meshes were wanted")) };
    let limits = Limits::of(args, a, unit)?;
    report.options = json!({
        "unit": unit.map(|unit| unit.to_string()),
        "samples": args.samples, "tolerance": limits.tolerance, "fail_on_max": limits.largest, "map_range": limits.range,
    });
    let options = CompareOptions { samples: args.samples as usize, edge_tolerance: limits.tolerance };
    let found =
        report.timed(Stage::Compare, |_| compare(&a.loaded.mesh, &b.loaded.mesh, &options, &session.progress))?;
    report.result = Some(RunResult::Comparison { comparison: found.clone(), output: None });
    for (input, measures) in [(a, &found.a), (b, &found.b)] {
        if measures.area <= 0.0 {
            return Err(Failure::input(format!("{}: no triangle has an area", input.label)));
        }
    }
    if let Some(path) = &args.map {
        let written = report.timed(Stage::Map, |_| write_map(path, [a, b], limits.range, unit, session))?;
        report.written(written);
    }
    let name = unit.map(|unit| unit.to_string());
    let sided = found.a.closed && found.b.closed;
    session.show(report, |_| page::of_comparison([a, b], sided, name.as_deref(), session))?;
    session.clear_bar();
    if !args.common.json {
        let text = table::table(&rows(&found, [&a.label, &b.label], name.as_deref()));
        streams::write_stream(text.as_bytes())?;
    }
    match (limits.largest, found.symmetric) {
        (Some(limit), Some(distance)) if distance.max > limit => Err(Failure::new(
            Exit::Limit,
            format!(
                "the largest distance is {}, and --fail-on-max allows {}",
                words::length(distance.max, name.as_deref()),
                words::length(limit, name.as_deref())
            ),
        )),
        _ => Ok(Exit::Done),
    }
}

/// The lengths of the command line, in model units.
struct Limits {
    tolerance: Option<f64>,
    largest: Option<f64>,
    range: Option<f64>,
}

impl Limits {
    fn of(args: &CompareArgs, a: &Input, unit: Option<Unit>) -> Result<Self, Failure> {
        let diagonal = a.loaded.mesh.bounds().map_or(0.0, |bounds| bounds.diagonal());
        let scale = Scale { unit, diagonal, voxel: None };
        let resolved = |length: Option<Length>| match length {
            Some(Length::Voxels(_)) => Err(Failure::usage("a length in voxels (h) means nothing to compare")
                .hint("0.4mm, 1% (of the diagonal of A) or a plain number in the file's units")),
            Some(length) => Ok(Some(length.resolve(&scale)?)),
            None => Ok(None),
        };
        let range = resolved(args.map_range)?;
        if range.is_some_and(|range| range <= 0.0) {
            return Err(Failure::usage("--map-range wants a length above 0"));
        }
        Ok(Self { tolerance: resolved(args.tolerance)?, largest: resolved(args.fail_on_max)?, range })
    }
}

/// Refuses maps that would not be found, or not be what they are named.
pub(super) fn check_map(map: &Path) -> Result<(), Failure> {
    if is_stream(map) {
        return Err(Failure::usage("--map wants a file"));
    }
    target::check_extension(map, Format::Ply.name())
}

/// Bars of the histogram in a map.
const BARS: usize = 61;

/// Writes B with its signed distances from A.
fn write_map(
    path: &Path,
    [a, b]: [&Input; 2],
    range: Option<f64>,
    unit: Option<Unit>,
    session: &Session,
) -> Result<OutputEntry, Failure> {
    let mesh = &b.loaded.mesh;
    let mut map = deviation_map(mesh, &a.loaded.mesh, &session.progress)?
        .ok_or_else(|| Failure::input(format!("{}: no triangle has an area", a.label)))?;
    let chosen = if range.is_some() { "as asked for" } else { "99th percentile" };
    map.range = range.unwrap_or(map.range);
    let range = map.range;
    let per = unit.map_or(String::new(), |unit| format!(" {unit}"));
    let name = unit.map(|unit| unit.to_string());
    let far = words::length(range, name.as_deref());
    let meanings = [
        (-range, format!("{far} inside the reference, or more")),
        (0.0, "on the surface of the reference".into()),
        (range, format!("{far} outside the reference, or more")),
    ];
    let legend = meanings.map(|(distance, text)| LegendEntry { colour: map.colour(distance), text });
    let sentences = [
        "quality is the signed distance to the reference: negative inside it, positive outside".to_string(),
        format!("colours: blue inside, grey 0, red outside; full colour at {range}{per} ({chosen}) and beyond"),
    ];
    let scale = ColourScale {
        title: name.map_or("distance".into(), |unit| format!("distance, {unit}")),
        low: -range,
        high: range,
        stops: [-range, 0.0, range].map(|distance| map.colour(distance)).to_vec(),
        histogram: ColourScale::count(map.distances.iter().copied(), [-range, range], BARS),
    };
    let comments = sentences.into_iter().chain(legend.iter().map(LegendEntry::to_string)).chain(scale.comments());
    let comments: Vec<String> = comments.collect();
    let quality: Vec<f32> = map.distances.iter().map(|&distance| distance as f32).collect();
    let attributes = VertexMap { quality: &quality, colours: &map.colours(), comments: &comments };
    let mut bytes = Vec::new();
    io::encode_vertex_map(mesh, &attributes, &mut bytes).map_err(|error| output::unencoded(path, &error))?;
    side::write_side(path, &bytes, session)?;
    Ok(OutputEntry {
        path: path.display().to_string(),
        format: Format::Ply.to_string(),
        bytes: bytes.len() as u64,
        sha256: streams::sha256(&bytes),
        unit: unit.map(|unit| unit.to_string()),
        validity: None,
    })
}

/// What was measured, as rows.
pub(super) fn rows(found: &Comparison, labels: [&str; 2], unit: UnitName<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for ((row, label), measures) in ["A", "B"].into_iter().zip(labels).zip([&found.a, &found.b]) {
        let closed = if measures.closed { "closed" } else { "open" };
        rows.push((row, format!("{label}: {}, {closed}", words::plural(measures.triangles, "triangle"))));
    }
    let ways = [("A to B", &found.a_to_b), ("B to A", &found.b_to_a)];
    for (row, distances) in ways.into_iter().filter_map(|(row, d)| Some((row, d.as_ref()?))) {
        let values = Relative { mean: distances.mean, rms: distances.rms, p99: distances.p99, max: distances.max };
        let place = distances.max_at.map(words::number).join(" ");
        rows.push((row, format!("{} at {place}", spread(values, |d| words::length(d, unit)))));
    }
    if let Some(both) = &found.symmetric {
        let values = Relative { mean: both.mean, rms: both.rms, p99: both.p99, max: both.max };
        rows.push(("both", spread(values, |d| words::length(d, unit))));
        let diagonal = words::length(found.diagonal, unit);
        rows.push(("both", format!("of A's diagonal ({diagonal}): {}", spread(both.relative, share))));
    }
    let volumes = [&found.a, &found.b].map(|m| words::volume(m.volume, unit));
    rows.push(("volume", changed(volumes, found.volume_difference)));
    let area = |area: f64| unit.map_or(words::number(area), |unit| format!("{} {unit}²", words::number(area)));
    rows.push(("area", changed([area(found.a.area), area(found.b.area)], found.area_difference)));
    if let Some(normals) = &found.normals {
        let text = format!(
            "{}° apart on average, over 10° on {} of A",
            words::number(normals.mean_degrees),
            share(normals.share_over_10_degrees)
        );
        rows.push(("normals", text));
    }
    rows.extend(sharp_rows(found, unit));
    rows
}

fn sharp_rows(found: &Comparison, unit: UnitName<'_>) -> Vec<Row> {
    let sharp = &found.sharp;
    let within = words::length(sharp.tolerance, unit);
    let row = |own: &str, other: &str, length: f64, found: Option<f64>| {
        let text = found.map_or(format!("none in {own}"), |found| {
            let length = words::length(length, unit);
            format!("{length} long in {own}, {} of it within {within} of those of {other}", share(found))
        });
        ("sharp edges", text)
    };
    vec![row("A", "B", sharp.length_a, sharp.recall), row("B", "A", sharp.length_b, sharp.precision)]
}

fn spread(d: Relative, show: impl Fn(f64) -> String) -> String {
    format!("mean {}, RMS {}, 99 % within {}, largest {}", show(d.mean), show(d.rms), show(d.p99), show(d.max))
}

/// A share in percent, without rounding to a whole that it is not.
fn share(share: f64) -> String {
    let percent = 100.0 * share;
    match words::number(percent) {
        text if text == "100" && share < 1.0 => "over 99.99 %".into(),
        text => format!("{text} %"),
    }
}

fn changed([a, b]: [String; 2], difference: Option<f64>) -> String {
    match difference {
        Some(0.0) => format!("{a} in both"),
        Some(difference) => {
            let way = if difference > 0.0 { "more" } else { "less" };
            format!("{a} in A, {b} in B: {} {way}", share(difference.abs()))
        }
        None => format!("{a} in A, {b} in B"),
    }
}
