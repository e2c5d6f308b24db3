//! Reports that were written before, read again.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::entries::InputEntry;
use super::exit::{Exit, Failure};
use super::report::{RunReport, SCHEMA};
use super::result::{Lead, RunResult};
use crate::pipeline::StageTime;

/// The verbs whose reports there may be.
const VERBS: [&str; 19] = [
    "repair",
    "union",
    "intersection",
    "difference",
    "csg",
    "dilate",
    "erode",
    "open",
    "close",
    "canals",
    "thicken",
    "sdf",
    "field",
    "hollow",
    "decimate",
    "split",
    "inspect",
    "compare",
    "convert",
];

/// What all reports have.
#[derive(Deserialize)]
struct Written {
    schema: u32,
    version: String,
    verb: String,
    exit: u8,
    error: Option<WrittenError>,
    options: Value,
    inputs: Vec<InputEntry>,
    result: Option<Value>,
    warnings: Vec<String>,
    stages: Vec<StageTime>,
    seconds: f64,
    peak_memory_bytes: Option<u64>,
}

#[derive(Deserialize)]
struct WrittenError {
    message: String,
    hint: Option<String>,
}

/// The report of a run from its JSON. `label`: what the file is called.
pub fn read(json: &Value, label: &str) -> Result<RunReport, Failure> {
    let is_ours = json["tool"] == env!("CARGO_PKG_NAME");
    if !is_ours {
        return Err(Failure::input(format!("{label} is no report of {}", env!("CARGO_PKG_NAME")))
            .hint("--report FILE.json, or --json, makes one"));
    }
    let written: Written = serde_json::from_value(json.clone()).map_err(|error| unlike(label, &error))?;
    if written.schema != SCHEMA {
        return Err(Failure::input(format!("{label} is of schema {}, and schema {SCHEMA} is read", written.schema))
            .hint("the program of the version that it names makes a page of it"));
    }
    let verb = VERBS.into_iter().find(|verb| *verb == written.verb);
    let Some(verb) = verb else {
        return Err(Failure::input(format!("{label} is the report of `{}`, of which there is no page", written.verb)));
    };
    let mut report = RunReport::new(verb);
    report.version = written.version.into();
    report.exit = written.exit;
    report.error = written.error.map(|error| {
        let failure = Failure::new(Exit::Limit, error.message);
        match error.hint {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    });
    report.result = match &written.result {
        Some(value) => result(value).map_err(|error| unlike(label, &error))?,
        None => None,
    };
    (report.options, report.inputs, report.warnings) = (written.options, written.inputs, written.warnings);
    (report.stages, report.seconds, report.peak_memory_bytes) =
        (written.stages, written.seconds, written.peak_memory_bytes);
    Ok(report)
}

fn unlike(label: &str, error: &serde_json::Error) -> Failure {
    Failure::input(format!("{label} is not as reports of this version are: {error}"))
        .hint("the program of the version that it names makes a page of it")
}

/// The result, of the verbs of which a page has more than what all reports have.
fn result(value: &Value) -> serde_json::Result<Option<RunResult>> {
    fn field<T: DeserializeOwned>(value: &Value, name: &str) -> serde_json::Result<T> {
        T::deserialize(&value[name])
    }
    Ok(match value["kind"].as_str() {
        Some("solid") => {
            Some(RunResult::Solid { pipeline: Box::new(field(value, "pipeline")?), output: field(value, "output")? })
        }
        Some("comparison") => {
            Some(RunResult::Comparison { comparison: field(value, "comparison")?, output: field(value, "output")? })
        }
        Some("decimation") => Some(RunResult::Decimation {
            decimate: field(value, "decimate")?,
            comparison: field(value, "comparison")?,
            output: field(value, "output")?,
        }),
        Some("inspection") => Some(RunResult::Inspection {
            mass: field(value, "mass")?,
            overhang: field(value, "overhang")?,
            crossings: field(value, "crossings")?,
            thickness: field(value, "thickness")?,
            holes: field(value, "holes")?,
            lead: Lead::deserialize(value)?,
        }),
        _ => None,
    })
}
