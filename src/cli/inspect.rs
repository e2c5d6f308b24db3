//! `inspect IN`: what is in a file, and what is wrong with it.

use serde_json::json;

use super::args::{Defect, InspectArgs};
use super::exit::{Exit, Failure};
use super::input::{self, Input};
use super::report::RunReport;
use super::session::Session;
use super::{summary, words};
use crate::mesh::{ValidateOptions, Validity, validate};

/// Looks at one file and prints a table.
pub fn run(args: &InspectArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut inputs = report.timed("read", |_| input::read_all(&[&args.input], &args.reading, session))?;
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    let Some(input) = inputs.first() else { return Err(Failure::internal("nothing was read")) };
    session.progress.stage("examine")?;
    let validity = report.timed("examine", |_| input::examine(&input.loaded, session))?;
    report.warnings.extend(input.loaded.warnings.iter().cloned());
    report.warnings.extend(closable(input, &validity, session)?);
    report.warnings.extend(summary::size_doubts(&input.loaded, unit));
    report.options = json!({ "unit": unit.map(|unit| unit.to_string()) });
    report.inputs = vec![super::report::InputEntry { validity: Some(validity.clone()), ..input.entry.clone() }];
    session.clear_bar();
    if !args.common.json {
        let mut text = summary::table(&summary::inspection(input, &validity, unit));
        for warning in &report.warnings {
            text.push_str(&format!("note: {warning}\n"));
        }
        super::output::write_stream(text.as_bytes())?;
    }
    let found: Vec<String> = failing(&args.fail_on, &validity);
    if found.is_empty() {
        return Ok(Exit::Done);
    }
    Err(Failure::new(Exit::Limit, format!("{} has {}, as --fail-on asks", input.label, words::list(&found))))
}

/// For formats with shared vertices: how many open edges only come from vertices stored apart.
fn closable(input: &Input, validity: &Validity, session: &Session) -> Result<Option<String>, Failure> {
    if validity.open_edges == 0 || input::is_soup_format(input.loaded.format) {
        return Ok(None);
    }
    let options = ValidateOptions { self_intersections: false, weld: true };
    let welded = validate(&input.loaded.mesh, &options, &session.progress)?;
    let closed = validity.open_edges.saturating_sub(welded.open_edges);
    Ok((closed > 0).then(|| {
        format!(
            "{} of the {} close when vertices at the same place are joined (repair does)",
            words::count(closed),
            words::plural(validity.open_edges, "open edge")
        )
    }))
}

/// The defects asked for that the mesh has, in words.
fn failing(asked: &[Defect], validity: &Validity) -> Vec<String> {
    let all = [
        Defect::Open,
        Defect::Nonmanifold,
        Defect::Inconsistent,
        Defect::Degenerate,
        Defect::Duplicate,
        Defect::SelfIntersecting,
        Defect::InsideOut,
    ];
    let wanted = |defect: &Defect| asked.contains(defect) || asked.contains(&Defect::Any);
    all.iter().filter(|defect| wanted(defect)).filter_map(|defect| words_for(*defect, validity)).collect()
}

fn words_for(defect: Defect, validity: &Validity) -> Option<String> {
    let several = |n: usize, word: &str| (n > 0).then(|| words::plural(n, word));
    match defect {
        Defect::Open => several(validity.open_edges, "open edge"),
        Defect::Nonmanifold => several(validity.nonmanifold_edges, "non-manifold edge")
            .or_else(|| (validity.nonmanifold_vertices > 0).then(|| "non-manifold vertices".to_string())),
        Defect::Inconsistent => several(validity.inconsistent_edges, "inconsistent edge"),
        Defect::Degenerate => several(validity.degenerate_triangles, "degenerate triangle"),
        Defect::Duplicate => several(validity.duplicate_triangles, "repeated triangle"),
        Defect::SelfIntersecting => {
            several(validity.self_intersecting_triangles.unwrap_or(0), "self-intersecting triangle")
        }
        Defect::InsideOut => (validity.volume < 0.0).then(|| "a volume below zero".to_string()),
        Defect::Any => None,
    }
}
