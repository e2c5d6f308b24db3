//! The end of a run that has made something: what it took, and its summary.

use super::exit::Exit;
use super::report::RunReport;
use super::session::Session;
use super::summary;
use super::table::{Row, table};

/// Notes what the run has taken, and takes the bar away. The exit status says whether it took more memory than it was allowed.
pub fn measured(session: &Session, report: &mut RunReport, max_memory: Option<u64>) -> Exit {
    report.measure(session.start);
    session.clear_bar();
    let beyond = super::limits::beyond_memory(report, max_memory);
    let exit = if beyond.is_none() { Exit::Done } else { Exit::Limit };
    report.warnings.extend(beyond);
    exit
}

/// Says what `rows` tell of the run, how long it took, and with `-v` how long each stage took.
pub fn say(session: &Session, report: &RunReport, mut rows: Vec<Row>) {
    rows.push(summary::time(report));
    if session.verbose {
        rows.extend(summary::stages(report));
    }
    session.say(table(&rows).trim_end());
}
