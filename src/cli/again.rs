//! `report RUN.json`: the page of a run that has been, made of its report and of its files.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::entries::OutputEntry;
use super::exit::{Exit, Failure};
use super::input::{self, Input};
use super::page::{self, Origin, Scene, SolidSeen};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs};
use super::{epilogue, side, streams, target, written};
use crate::io::Unit;
use crate::mesh::TriMesh;
use crate::pipeline::Operand;
use crate::progress::Stage;

/// `report RUN.json`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The report of a run, as --report FILE.json or --json has written it
    #[arg(value_name = "RUN.json")]
    pub input: PathBuf,
    /// Where to write the page [default: the name of the report, ending in .html]
    #[arg(short, long, value_name = "OUT.html")]
    pub output: Option<PathBuf>,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

impl ReportArgs {
    /// Where the page goes.
    pub fn page(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| self.input.with_extension("html"))
    }
}

/// Makes the page.
pub fn run(args: &ReportArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let page = args.page();
    target::check_extension(&page, "html")?;
    let label = streams::label(&args.input);
    let bytes = input::bytes_of(&args.input, &session.progress)?;
    let json: serde_json::Value = serde_json::from_slice(&bytes)
        .map_err(|error| Failure::input(format!("{label} is no report: it is no JSON ({error})")))?;
    let mut told = written::read(&json, &label)?;
    let folder = args.input.parent().unwrap_or(Path::new(""));
    session.progress.stage(Stage::Draw)?;
    let (scene, missing) = report.timed(Stage::Draw, |_| looked(&mut told, folder, session))?;
    let text = page::html_of_written(&told, json, scene);
    side::write_side(&page, text.as_bytes(), session)?;
    let label = streams::label(&page);
    session.say(&format!("{label}: the page of {}", args.input.display()));
    report.options = json!({ "report": args.input.display().to_string() });
    report.warnings.extend(missing.iter().cloned());
    let output = OutputEntry {
        path: label,
        format: "html".into(),
        bytes: text.len() as u64,
        sha256: streams::sha256(text.as_bytes()),
        unit: None,
        validity: None,
    };
    report.result = Some(RunResult::Page { output, missing });
    Ok(epilogue::measured(session, report, None))
}

/// What can be seen of the meshes of a run, and what is to be said of files that are not as they were; the report is told so, too.
fn looked(told: &mut RunReport, folder: &Path, session: &Session) -> Result<(Option<Scene>, Vec<String>), Failure> {
    if told.error.is_some()
        || !matches!(
            told.result,
            Some(
                RunResult::Solid { .. }
                    | RunResult::Comparison { .. }
                    | RunResult::Decimation { .. }
                    | RunResult::Inspection { .. }
            )
        )
    {
        return Ok((None, Vec::new()));
    }
    let mut missing = Vec::new();
    let mut found = Vec::new();
    let map = matches!(told.result, Some(RunResult::Comparison { .. }));
    let inputs = told.inputs.iter().map(|input| (input.path.as_str(), input.sha256.as_deref(), input.format.as_str()));
    let made = told
        .output()
        .filter(|_| !map)
        .map(|output| (output.path.as_str(), Some(output.sha256.as_str()), output.format.as_str()));
    for (path, hash, format) in inputs.chain(made) {
        match same_file(path, hash, folder, session)? {
            Ok((place, bytes)) => found.push((place, bytes, format.to_string())),
            Err(sentence) => missing.push(sentence),
        }
    }
    if !missing.is_empty() {
        let end = "so the page has no meshes, and its numbers are those of the report";
        told.warnings.extend(missing.iter().map(|sentence| format!("{sentence}, {end}")));
        return Ok((None, missing));
    }
    let unit = told.options["unit"].as_str().and_then(|unit| unit.parse::<Unit>().ok());
    let mut inputs = Vec::new();
    for (place, bytes, format) in &found {
        let args = InputArgs { in_format: format.parse().ok(), unit: None };
        let mut input = input::mesh_of(place, bytes, &args, &session.progress, &mut Vec::new())?;
        input::leave_out(&mut input, &mut Vec::new());
        inputs.push(input);
    }
    let output = (inputs.len() > told.inputs.len()).then(|| inputs.pop()).flatten();
    if let Some(unit) = unit {
        input::bring_to(unit, &mut inputs, &InputArgs { in_format: None, unit: None }, &mut Vec::new());
    }
    let output = output.map(|output| in_unit(output, told.output().and_then(|o| o.unit.as_deref()), unit));
    Ok((scene(told, &inputs, output.as_ref(), session)?, Vec::new()))
}

/// The mesh of the written file in the unit of the run.
fn in_unit(output: Input, own: Option<&str>, unit: Option<Unit>) -> TriMesh {
    let mut mesh = output.loaded.mesh;
    let metres = |unit: Unit| unit.metres();
    if let Some((own, unit)) = own.and_then(|own| own.parse::<Unit>().ok()).zip(unit).filter(|(own, unit)| own != unit)
    {
        let factor = metres(own) / metres(unit);
        mesh.positions.iter_mut().for_each(|p| *p *= factor);
    }
    mesh
}

fn scene(
    told: &RunReport,
    inputs: &[Input],
    output: Option<&TriMesh>,
    session: &Session,
) -> Result<Option<Scene>, Failure> {
    let unit = told.options["unit"].as_str();
    Ok(match (&told.result, inputs, output) {
        (Some(RunResult::Solid { .. }), [_, ..], Some(mesh)) => {
            let operands: Vec<Operand<'_>> = inputs.iter().map(|input| (&input.loaded).into()).collect();
            let seen = SolidSeen { inputs, operands: &operands, mesh, origin: Origin::Files, canal_of: &[] };
            Some(page::of_solid(&seen, told, session)?)
        }
        (Some(RunResult::Comparison { comparison, .. }), [a, b], _) => {
            let sided = comparison.a.closed && comparison.b.closed;
            Some(page::of_comparison([a, b], sided, unit, session)?)
        }
        (Some(RunResult::Decimation { .. }), [before], Some(after)) => {
            Some(page::of_decimation(&before.loaded.mesh, after, unit, session)?)
        }
        (Some(result @ RunResult::Inspection { .. }), [input], _) => {
            Some(page::of_inspection(input, result, unit, session)?)
        }
        _ => None,
    })
}

/// A file of the run, if it is as it was; else a sentence. It is looked for where the run had it, and beside the report.
fn same_file(
    path: &str,
    hash: Option<&str>,
    folder: &Path,
    session: &Session,
) -> Result<Result<(PathBuf, Vec<u8>), String>, Failure> {
    let Some(hash) = hash.filter(|hash| !hash.is_empty()) else { return Ok(Err(format!("{path} was no file"))) };
    let places = [PathBuf::from(path), folder.join(path), folder.join(Path::new(path).file_name().unwrap_or_default())];
    let mut changed = false;
    for place in places {
        session.progress.check()?;
        match std::fs::read(&place) {
            Ok(bytes) if streams::sha256(&bytes) == hash => return Ok(Ok((place, bytes))),
            Ok(_) => changed = true,
            Err(_) => {}
        }
    }
    Ok(Err(match changed {
        true => format!("{path} has changed since the run"),
        false => format!("{path} is not there any more"),
    }))
}
