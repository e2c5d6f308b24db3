//! How a run ended, in one line.

use crate::cli::report::RunReport;
use crate::cli::result::RunResult;
use crate::cli::words::{self, UnitName};
use crate::mesh::Validity;
use crate::page::Mood;

use super::file_name;

/// The verdict on a run.
pub(super) fn verdict(report: &RunReport, unit: UnitName<'_>) -> (Mood, String) {
    if let Some(error) = &report.error {
        let hint = error.hint.as_ref().map_or(String::new(), |hint| format!(" What to try: {hint}."));
        return (Mood::Bad, format!("{}.{hint}", sentence(&error.message)));
    }
    let careful = if report.exit == 0 { Mood::Good } else { Mood::Careful };
    match &report.result {
        Some(RunResult::Solid { .. }) => solid(report, unit),
        Some(RunResult::Decimation { decimate, comparison, .. }) => {
            let moved = comparison.as_ref().and_then(|found| found.symmetric.as_ref()).map_or(String::new(), |found| {
                format!("; the surface moved by at most {}", words::length(found.max, unit))
            });
            let (before, after) = (words::plural(decimate.before, "triangle"), words::count(decimate.after));
            let rest = if decimate.reached { "" } else { "; the number asked for was not reached" };
            (careful, format!("{before} became {after}{moved}{rest}. The result is a valid solid."))
        }
        Some(RunResult::Comparison { comparison, .. }) => {
            let text = comparison.symmetric.as_ref().map_or("There was nothing to compare.".into(), |found| {
                let [mean, most] = [found.mean, found.max].map(|x| words::length(x, unit));
                match found.max == 0.0 {
                    true => "The two surfaces are the same.".into(),
                    false => format!("The two surfaces are {mean} apart in the mean, {most} at most."),
                }
            });
            (careful, text)
        }
        Some(RunResult::Inspection { .. }) => inspection(report, careful),
        Some(RunResult::Plan { .. } | RunResult::DistancePlan { .. }) => {
            (careful, "This is a plan: nothing was made.".into())
        }
        _ => match report.output() {
            Some(output) => (careful, format!("{} was written.", file_name(&output.path))),
            None => (careful, "Done.".into()),
        },
    }
}

fn solid(report: &RunReport, unit: UnitName<'_>) -> (Mood, String) {
    let of_file = |validity: &Validity, path: &str| {
        let (triangles, volume) = (words::plural(validity.triangles, "triangle"), words::volume(validity.volume, unit));
        match validity.is_valid() {
            true => format!(
                "{} is a closed, oriented solid without self-intersections ({triangles}, volume {volume}), checked on the written file.",
                file_name(path)
            ),
            false => format!("{} is written, and is no solid: {}", file_name(path), validity.problems().join(" ")),
        }
    };
    let output = report.output().and_then(|output| Some((output.validity.as_ref()?, output.path.as_str())));
    let text = output.map(|(validity, path)| of_file(validity, path));
    let sound = output.is_none_or(|(validity, _)| validity.is_valid());
    let canals = report.pipeline().and_then(|pipeline| pipeline.canals.as_ref());
    let text = match (text, canals) {
        (None, Some(found)) => format!("{} found; nothing was changed.", words::plural(found.canals.len(), "canal")),
        (None, None) => "The solid was made, and not written.".into(),
        (Some(text), _) => text,
    };
    match (report.exit, sound) {
        (0, true) => (Mood::Good, text),
        _ => (Mood::Careful, format!("{text} There is something to look at: the notes below say what.")),
    }
}

fn inspection(report: &RunReport, careful: Mood) -> (Mood, String) {
    let Some((input, validity)) = report.inputs.first().and_then(|input| Some((input, input.validity.as_ref()?)))
    else {
        return (careful, "Looked at.".into());
    };
    let name = file_name(&input.path);
    match validity.is_valid() {
        true => (careful, format!("{name} is a closed, oriented solid without self-intersections.")),
        false => (Mood::Careful, format!("{name} is no valid solid. {}", validity.problems().join(" "))),
    }
}

/// The text with a large letter at its beginning, without a full stop at its end.
fn sentence(text: &str) -> String {
    let text = text.trim_end_matches('.');
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
