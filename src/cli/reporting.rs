//! Where the report goes.

use std::path::Path;

use super::exit::Failure;
use super::report::RunReport;
use super::session::Session;
use super::shared_args::CommonArgs;
use super::streams::is_stream;
use super::typed::is_page;

/// Writes the report where `--json` and `--report` want it: the file first, because a stream cannot be taken back.
pub fn emit(report: &RunReport, common: &CommonArgs, session: &Session) -> Result<(), Failure> {
    to_file(report, common, session)?;
    if common.json {
        super::streams::write_stream(text(report)?.as_bytes())?;
    }
    Ok(())
}

/// Writes the report where `--report` wants it.
pub fn to_file(report: &RunReport, common: &CommonArgs, session: &Session) -> Result<(), Failure> {
    match &common.report {
        Some(path) => {
            let text = if is_page(path) { super::page::html(report, session)? } else { text(report)? };
            super::side::write_side(path, text.as_bytes(), session)
        }
        None => Ok(()),
    }
}

fn text(report: &RunReport) -> Result<String, Failure> {
    let mut text = serde_json::to_string_pretty(report)
        .map_err(|e| Failure::internal(format!("the report cannot be written as JSON: {e}")))?;
    text.push('\n');
    Ok(text)
}

/// Refuses two things on standard output, and a report without a name.
pub fn check_streams<'a>(common: &CommonArgs, made: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    if common.json && made.into_iter().any(is_stream) {
        return Err(Failure::usage("--json and `-o -` both want standard output")
            .hint("--report FILE.json writes the report to a file"));
    }
    match &common.report {
        Some(report) if is_stream(report) => {
            Err(Failure::usage("--report wants a file").hint("--json writes the report to standard output"))
        }
        _ => Ok(()),
    }
}

/// Refuses a report that is named as something else.
pub fn check_name(common: &CommonArgs) -> Result<(), Failure> {
    let name = common.report.as_ref().filter(|report| !is_page(report));
    name.map_or(Ok(()), |report| super::target::check_extension(report, "json"))
}
