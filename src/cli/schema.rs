//! `schema`: what a report may look like, as a JSON schema.

use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::say::print_failure;
use super::streams;

/// The JSON schema (draft 2020-12) of the reports of `--json` and `--report`, made from the types that they are written from.
fn text() -> Result<String, Failure> {
    let mut schema = schemars::generate::SchemaSettings::draft2020_12()
        .for_serialize()
        .into_generator()
        .into_root_schema_for::<RunReport>();
    schema.insert("title".into(), "Report of a run of meshwright".into());
    schema.insert(
        "$comment".into(),
        format!("schema {} of meshwright {}", super::report::SCHEMA, env!("CARGO_PKG_VERSION")).into(),
    );
    serde_json::to_string_pretty(&schema)
        .map(|text| text + "\n")
        .map_err(|error| Failure::internal(format!("the schema cannot be written as JSON: {error}")))
}

/// Prints the schema.
pub fn run() -> Exit {
    match text().and_then(|text| streams::write_stream(text.as_bytes())) {
        Ok(()) => Exit::Done,
        Err(failure) => {
            print_failure(&failure);
            failure.exit
        }
    }
}
