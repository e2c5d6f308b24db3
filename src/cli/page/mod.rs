//! `--report FILE.html`: the report of a run as a page, with what was seen of the meshes.

mod defects;
mod facts;
mod fates;
mod ground;
mod scene;
mod seen;
mod shown;
mod verdict;
mod viewed;

pub use scene::{of_comparison, of_decimation, of_inspection, of_solid, regions};
pub use seen::{Origin, SolidSeen};
pub use shown::Scene;
pub use viewed::html_of_files;

use super::exit::Failure;
use super::report::RunReport;
use super::session::Session;
use super::words::{UnitName, file_name};
use crate::page::{Page, Part, Section};

/// The report as a page.
pub fn html(report: &RunReport, session: &Session) -> Result<String, Failure> {
    let json = serde_json::to_value(report)
        .map_err(|e| Failure::internal(format!("the report cannot be written as JSON: {e}")))?;
    let scene = session.take_scene().unwrap_or_default();
    Ok(page(report, json, scene, session.command().as_deref()).html())
}

/// The page of a report that was written before, with what is to be said of its files.
pub fn html_of_written(report: &RunReport, json: serde_json::Value, scene: Option<Scene>) -> String {
    page(report, json, scene.unwrap_or_default(), None).html()
}

/// The unit of a run.
fn unit_of(report: &RunReport) -> UnitName<'_> {
    report.options.get("unit").and_then(|unit| unit.as_str())
}

fn page(report: &RunReport, json: serde_json::Value, scene: Scene, command: Option<&str>) -> Page {
    let unit = unit_of(report);
    let (mood, verdict) = verdict::verdict(report, unit);
    let names: Vec<&str> = report.inputs.iter().map(|input| file_name(&input.path)).collect();
    let mut sections = facts::done(report, unit);
    if let Some(table) = scene.defects {
        let text = match table.rows.is_empty() {
            true => vec![Part::Text("None was found.".into())],
            false => vec![Part::Text(scene.defects_text), Part::Table(table)],
        };
        sections.push(Section { id: "defects", title: scene.defects_title, parts: text, folded: false });
    }
    let mut first = facts::first(report, unit);
    first.retain(|section| !section.parts.is_empty());
    let charts: Vec<Part> = scene.charts.into_iter().map(Part::Chart).collect();
    if !charts.is_empty() {
        sections.push(Section { id: "charts", title: "Distances and thickness".into(), parts: charts, folded: false });
    }
    sections.extend(scene.bodies.map(facts::bodies));
    sections.push(facts::time(report));
    sections.push(facts::reproduce(report, command));
    sections.push(facts::options(report));
    Page {
        title: format!("{}: {}", report.verb, names.join(", ")),
        subtitle: format!("Report of {} {}", report.tool, report.version),
        mood,
        verdict,
        first,
        panes: scene.panes,
        view_title: scene.view_title,
        shown_first: scene.first,
        sections,
        report: json,
        made_by: format!("{} {}", report.tool, report.version),
        served: false,
    }
}
