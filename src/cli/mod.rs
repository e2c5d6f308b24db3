//! The command line: one file a verb. Only this folder prints and knows exit codes.

mod args;
mod backend;
mod boolean;
mod change;
mod choices;
mod compare;
mod convert;
mod csg;
mod csg_parser;
mod devices;
mod exit;
mod field;
mod field_args;
mod given;
mod input;
mod inspect;
mod length;
mod limits;
mod morphology;
mod negative;
mod output;
mod progress_bar;
mod render;
mod repair;
mod report;
mod sdf;
mod session;
mod slice;
mod solid;
mod summary;
mod words;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;

use crate::ldi::Expression;
use crate::morphology::Operation;
use args::{Cli, CommonArgs, SolidArgs, Verb};
use exit::{Exit, Failure};
use report::RunReport;
use session::{Session, print_failure};

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version also come this way; there is nobody to tell if printing fails.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { Exit::Usage } else { Exit::Done }.code());
        }
    };
    std::panic::set_hook(Box::new(|panic| {
        if backend::expects_panic() {
            return;
        }
        let place = panic.location().map_or(String::new(), |place| format!(" ({}:{})", place.file(), place.line()));
        let failure = Failure::internal(format!("the program has a bug{place}"))
            .hint("please report it with the command and the file");
        print_failure(&failure);
    }));
    let exit = catch_unwind(AssertUnwindSafe(|| dispatch(&cli.verb))).unwrap_or(Exit::Internal);
    ExitCode::from(exit.code())
}

fn dispatch(verb: &Verb) -> Exit {
    match verb {
        Verb::Repair(args) => {
            solid("repair", &args.solid, &[&args.input], |session, report| repair::run(args, session, report))
        }
        Verb::Union(args) => booleans("union", args, Expression::union),
        Verb::Intersection(args) => booleans("intersection", args, Expression::intersection),
        Verb::Difference(args) => booleans("difference", args, Expression::difference),
        Verb::Csg(args) => {
            solid("csg", &args.solid, &csg::paths(&args.operands), |session, report| csg::run(args, session, report))
        }
        Verb::Dilate(args) => grow("dilate", args, Operation::Dilate),
        Verb::Erode(args) => grow("erode", args, Operation::Erode),
        Verb::Open(args) => morphology("open", args, Operation::Open),
        Verb::Close(args) => morphology("close", args, Operation::Close),
        Verb::Canals(args) => {
            solid("canals", &args.solid, &[&args.input], |session, report| morphology::canals(args, session, report))
        }
        Verb::Thicken(args) => {
            solid("thicken", &args.solid, &[&args.input], |session, report| morphology::thicken(args, session, report))
        }
        Verb::Sdf(args) => run("sdf", &args.common, &[&args.input], args.output.as_deref(), |session, report| {
            sdf::run(args, session, report)
        }),
        Verb::Field(args) => {
            run("field", &args.common, &csg::paths(&args.operands), Some(&args.output), |session, report| {
                field::run(args, session, report)
            })
        }
        Verb::Inspect(args) => {
            run("inspect", &args.common, &[&args.input], None, |session, report| inspect::run(args, session, report))
        }
        Verb::Compare(args) => {
            run("compare", &args.common, &[&args.a, &args.b], args.map.as_deref(), |session, report| {
                compare::run(args, session, report)
            })
        }
        Verb::Convert(args) => run("convert", &args.common, &[&args.input], Some(&args.output), |session, report| {
            convert::run(args, session, report)
        }),
        Verb::Devices(args) => run("devices", &args.common, &[], None, |_, report| devices::run(args, report)),
        Verb::Render(args) => {
            let inputs: Vec<&Path> = std::iter::once(&args.input).chain(&args.after).map(AsRef::as_ref).collect();
            run("render", &args.common, &inputs, Some(&args.output), |session, report| {
                render::run(args, session, report)
            })
        }
    }
}

fn booleans(verb: &'static str, args: &args::BooleanArgs, expression: fn(usize) -> Expression) -> Exit {
    let paths: Vec<&Path> = args.inputs.iter().map(AsRef::as_ref).collect();
    solid(verb, &args.solid, &paths, |session, report| boolean::run(args, expression, session, report))
}

fn grow(verb: &'static str, args: &args::GrowArgs, operation: Operation) -> Exit {
    solid(verb, &args.morphology.solid, &[&args.morphology.input], |session, report| {
        morphology::grow(args, operation, session, report)
    })
}

fn morphology(verb: &'static str, args: &args::MorphologyArgs, operation: Operation) -> Exit {
    solid(verb, &args.solid, &[&args.input], |session, report| morphology::run(args, operation, None, session, report))
}

fn solid(
    verb: &'static str,
    args: &SolidArgs,
    inputs: &[&Path],
    work: impl FnOnce(&Session, &mut RunReport) -> Result<Exit, Failure>,
) -> Exit {
    run(verb, &args.common, inputs, args.output.as_deref(), work)
}

/// Runs one verb within a session, writes its report, and prints its error.
fn run(
    verb: &'static str,
    common: &CommonArgs,
    inputs: &[&Path],
    output: Option<&Path>,
    work: impl FnOnce(&Session, &mut RunReport) -> Result<Exit, Failure>,
) -> Exit {
    let ready = report::check_report_target(common, inputs, output).and_then(|()| Session::new(common));
    let session = match ready {
        Ok(session) => session,
        Err(failure) => {
            print_failure(&failure);
            return failure.exit;
        }
    };
    let mut report = RunReport::new(verb);
    let outcome = work(&session, &mut report);
    session.clear_bar();
    // Here alone, so that no verb can keep a warning to itself, nor a run that fails.
    report.warnings.iter().for_each(|warning| session.say(&format!("note: {warning}")));
    report.close(&outcome, session.start);
    let emitted = report.emit(common);
    let exit = match (&outcome, &emitted) {
        (Err(failure), _) | (Ok(Exit::Done), Err(failure)) => failure.exit,
        (Ok(exit), _) => *exit,
    };
    for failure in [outcome.err(), emitted.err()].into_iter().flatten() {
        print_failure(&failure);
    }
    exit
}
