//! The sections that need no meshes: numbers before and after, what was done, time, how to do it again.

use crate::cli::course::in_words;
use crate::cli::report::RunReport;
use crate::cli::result::RunResult;
use crate::cli::words::{self, UnitName};
use crate::cli::{done, doubts, dropped, exact};
use crate::io::Format;
use crate::mesh::Validity;
use crate::page::{Part, Row, Section, Table};

use super::file_name;

/// At most so many inputs have a column.
const COLUMNS: usize = 4;

fn section(id: &'static str, title: &str, parts: Vec<Part>) -> Section {
    Section { id, title: title.into(), parts, folded: false }
}

/// What stands before the view: numbers, and notes.
pub(super) fn first(report: &RunReport, unit: UnitName<'_>) -> Vec<Section> {
    let mut columns: Vec<(String, &Validity)> = report
        .inputs
        .iter()
        .take(COLUMNS)
        .filter_map(|input| Some((format!("{} (read)", file_name(&input.path)), input.validity.as_ref()?)))
        .collect();
    let output = report.output().and_then(|output| Some((&output.path, output.validity.as_ref()?)));
    columns.extend(output.map(|(path, validity)| (format!("{} (written)", file_name(path)), validity)));
    let mut parts = Vec::new();
    if !columns.is_empty() {
        parts.push(Part::Table(measures(&columns, unit)));
    }
    if report.inputs.len() > COLUMNS {
        parts.push(Part::Text(format!("And {} more.", words::plural(report.inputs.len() - COLUMNS, "input"))));
    }
    let notes: Vec<String> = report.warnings.iter().map(|note| capital(note)).collect();
    let notes = if notes.is_empty() { Vec::new() } else { vec![Part::List(notes)] };
    vec![section("numbers", "In numbers", parts), section("notes", "Notes", notes)]
}

/// The text with a large letter at its beginning and a full stop at its end; names of formats are written large, those of files as they are.
fn capital(text: &str) -> String {
    let text = text.trim_end_matches('.');
    let word: String = text.chars().take_while(|letter| letter.is_ascii_alphanumeric()).collect();
    if word.parse::<Format>().is_ok() {
        return format!("{}{}.", word.to_uppercase(), &text[word.len()..]);
    }
    // The name of a file stays as it is.
    let named = text.split([' ', ':']).next().is_some_and(|first| first.contains(['.', '/', '\\']));
    if named {
        return format!("{text}.");
    }
    let mut letters = text.chars();
    let first: String = letters.next().map_or(String::new(), |first| first.to_uppercase().collect());
    first + letters.as_str() + "."
}

type Measure = (&'static str, fn(&Validity, UnitName<'_>) -> String);

fn measures(columns: &[(String, &Validity)], unit: UnitName<'_>) -> Table {
    let all: [Measure; 12] = [
        ("Triangles", |v, _| words::count(v.triangles)),
        ("Open edges", |v, _| words::count(v.open_edges)),
        ("Edges with more than two triangles", |v, _| words::count(v.nonmanifold_edges)),
        ("Edges between triangles that face opposite ways", |v, _| words::count(v.inconsistent_edges)),
        ("Vertices that join surfaces", |v, _| words::count(v.nonmanifold_vertices)),
        ("Crossing triangles", |v, _| v.self_intersecting_triangles.map_or("not checked".into(), words::count)),
        ("Repeated triangles", |v, _| words::count(v.duplicate_triangles)),
        ("Triangles without area", |v, _| words::count(v.degenerate_triangles)),
        ("Surfaces", |v, _| words::count(v.bodies)),
        ("Tunnels", |v, _| v.genus.map_or("not closed".into(), |genus| words::count(genus.max(0) as usize))),
        ("Area", |v, unit| words::area(v.area, unit)),
        ("Volume", |v, unit| words::volume(v.volume, unit)),
    ];
    let rows = all.iter().map(|(name, value)| {
        let values: Vec<String> = columns.iter().map(|(_, validity)| value(validity, unit)).collect();
        Row { cells: std::iter::once((*name).to_string()).chain(values).collect(), place: None }
    });
    // Defects that nobody has need no line.
    let rows = rows.enumerate().filter(|(n, row)| !(1..8).contains(n) || row.cells[1..].iter().any(|cell| cell != "0"));
    let head = std::iter::once(String::new()).chain(columns.iter().map(|(name, _)| name.clone())).collect();
    Table { head, rows: rows.map(|(_, row)| row).collect(), more: 0 }
}

/// What was done, in the words of the summary.
pub(super) fn done(report: &RunReport, unit: UnitName<'_>) -> Vec<Section> {
    let mut sections = Vec::new();
    if let Some(pipeline) = report.pipeline() {
        let rows = exact::rows(pipeline).into_iter().chain(dropped::rows(pipeline, unit)).map(|(_, text)| text);
        let texts: Vec<String> = done::done(pipeline, unit)
            .into_iter()
            .chain(rows)
            .map(|text| capital(&text.replace(" (--map shows which)", "")))
            .collect();
        sections.push(section("done", "What was done", vec![Part::List(texts)]));
        let looked: Vec<String> = doubts::rows(pipeline, unit).into_iter().map(|(_, text)| capital(&text)).collect();
        if !looked.is_empty() {
            sections.push(section("doubts", "What to look at", vec![Part::List(looked)]));
        }
    }
    if let Some(RunResult::Comparison { comparison, .. } | RunResult::Decimation { comparison: Some(comparison), .. }) =
        &report.result
    {
        let labels = match report.inputs.as_slice() {
            [a, b] => [file_name(&a.path), file_name(&b.path)],
            _ => ["before", "after"],
        };
        let rows = crate::cli::compare::rows(comparison, labels, unit);
        let rows = rows.into_iter().map(|(name, text)| Row { cells: vec![name.into(), text], place: None }).collect();
        sections.push(section("measured", "What was measured", vec![Part::Table(Table { rows, ..Table::default() })]));
    }
    sections
}

/// The surfaces of the result.
pub(super) fn bodies(table: Table) -> Section {
    section("bodies", "Surfaces, one by one", vec![Part::Table(table)])
}

/// Time and memory.
pub(super) fn time(report: &RunReport) -> Section {
    let memory =
        report.peak_memory_bytes.map_or(String::new(), |bytes| format!(" and {} of memory", words::bytes(bytes)));
    let text = format!("The run took {}{memory}.", words::seconds(report.seconds));
    let row = |name: &str, seconds: f64| Row {
        cells: vec![capital(name).trim_end_matches('.').into(), words::seconds(seconds)],
        place: None,
    };
    let rows = report.stages.iter().map(|stage| row(in_words(stage.stage), stage.seconds)).collect();
    let table = Table { head: vec!["Stage".into(), "Time".into()], rows, more: 0 };
    Section { folded: true, ..section("time", "Time and memory", vec![Part::Text(text), Part::Table(table)]) }
}

/// The command, and the files by their hashes.
pub(super) fn reproduce(report: &RunReport, command: Option<&str>) -> Section {
    let text = "The same program, files and options give the same result, to the byte. The hashes say whether the files are the same.";
    let mut parts = vec![Part::Text(text.into())];
    parts.extend(command.map(|command| Part::Code(command.to_string())));
    let row =
        |what: &str, path: &str, hash: &str| Row { cells: vec![what.into(), path.into(), hash.into()], place: None };
    let read =
        report.inputs.iter().map(|input| row("read", &input.path, input.sha256.as_deref().unwrap_or("in memory")));
    let hash = |hash: &str| if hash.is_empty() { "in memory".to_string() } else { hash.to_string() };
    let written = report.output().map(|output| row("written", &output.path, &hash(&output.sha256)));
    let rows: Vec<Row> = read.chain(written).collect();
    if !rows.is_empty() {
        parts.push(Part::Table(Table { head: ["", "File", "SHA-256"].map(String::from).into(), rows, more: 0 }));
    }
    section("again", "To do it again", parts)
}

/// The options after defaults were filled in.
pub(super) fn options(report: &RunReport) -> Section {
    let text = |value: &serde_json::Value| match value {
        serde_json::Value::String(text) => text.clone(),
        value => value.to_string(),
    };
    let given = report.options.as_object().into_iter().flatten().filter(|(_, value)| !value.is_null());
    let rows =
        given.map(|(name, value)| Row { cells: vec![name.replace('_', " "), text(value)], place: None }).collect();
    let table = Table { head: ["Option", "Value"].map(String::from).into(), rows, more: 0 };
    Section { folded: true, ..section("options", "Options, with defaults", vec![Part::Table(table)]) }
}
