//! The command line: one file a verb. Only this folder prints and knows exit codes.

mod again;
mod args;
mod backend;
mod base;
mod batch;
mod boolean;
mod change;
mod choices;
pub mod class;
mod compare;
mod convert;
mod convert_args;
mod course;
mod csg;
mod decimate;
mod devices;
mod done;
mod doubts;
mod drain;
mod dropped;
mod each;
mod each_check;
mod each_object;
mod each_words;
mod ending;
mod entries;
mod epilogue;
mod exact;
mod examples;
pub mod exit;
mod field;
mod field_args;
mod field_places;
mod files;
mod given;
mod grids;
mod holes;
mod hollow;
mod input;
mod inspect;
mod inspect_args;
mod keep;
mod lead;
mod length;
mod licenses;
mod limits;
mod machine;
mod maker;
mod map;
mod meant;
mod misuse;
mod morphology;
mod negative;
mod next;
mod output;
mod page;
mod paint;
mod pick;
mod preset;
mod progress_bar;
mod render;
mod repair;
mod report;
mod reporting;
mod result;
mod say;
mod schema;
mod sdf;
mod sdf_args;
mod serve;
mod session;
mod shared_args;
mod side;
mod site;
mod slice;
mod solid;
mod solid_args;
mod split;
mod streams;
mod summary;
mod table;
mod target;
mod transform;
mod typed;
mod view;
mod volume;
mod weights;
pub mod within;
mod words;
mod worst;
mod written;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::ldi::Expression;
use crate::morphology::Operation;
use args::Verb;
pub use args::command;
use exit::{Exit, Failure};
use files::{KeptFiles, Made};
use report::RunReport;
use say::print_failure;
use session::Session;
use shared_args::CommonArgs;
use solid_args::SolidArgs;

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    let cli = match args::parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version also come this way; there is nobody to tell if printing fails.
            match misuse::explain(&error, &std::env::args_os().skip(1).collect::<Vec<_>>())
                .filter(|_| error.use_stderr())
            {
                Some(failure) => print_failure(&failure),
                None => drop(error.print()),
            }
            return ExitCode::from(if error.use_stderr() { Exit::Usage } else { Exit::Done }.code());
        }
    };
    // The others never load a graphics driver.
    if !matches!(
        cli.verb,
        Verb::Inspect(_) | Verb::Compare(_) | Verb::Convert(_) | Verb::Render(_) | Verb::Report(_) | Verb::View(_)
    ) {
        machine::quiet_drivers();
    }
    let no_bug = Arc::new(AtomicBool::new(true));
    machine::tame_signals(no_bug.clone());
    std::panic::set_hook(Box::new(move |panic| {
        if backend::expects_panic() {
            return;
        }
        no_bug.store(false, Ordering::SeqCst);
        let place = panic.location().map_or(String::new(), |place| format!(" ({}:{})", place.file(), place.line()));
        let failure = Failure::internal(format!("the program has a bug{place}"))
            .hint("please report it with the command and the file");
        print_failure(&failure);
    }));
    let exit = catch_unwind(AssertUnwindSafe(|| dispatch(&cli.verb, &Host::Program))).unwrap_or(Exit::Internal);
    ExitCode::from(exit.code())
}

/// Where a verb runs.
enum Host {
    /// In a process of its own.
    Program,
    /// In that of a caller.
    Caller(Rc<within::Desk>),
}

fn dispatch(verb: &Verb, host: &Host) -> Exit {
    match verb {
        Verb::Repair(args) => {
            solid(host, "repair", &args.solid, &[&args.input], |session, report| repair::run(args, session, report))
        }
        Verb::Union(args) => booleans(host, "union", args, Expression::union),
        Verb::Intersection(args) => booleans(host, "intersection", args, Expression::intersection),
        Verb::Difference(args) => booleans(host, "difference", args, Expression::difference),
        Verb::Csg(args) => solid(host, "csg", &args.solid, &csg::paths(&args.operands), |session, report| {
            csg::run(args, session, report)
        }),
        Verb::Dilate(args) => grow(host, "dilate", args, Operation::Dilate),
        Verb::Erode(args) => grow(host, "erode", args, Operation::Erode),
        Verb::Open(args) => morphology(host, "open", args, Operation::Open),
        Verb::Close(args) => morphology(host, "close", args, Operation::Close),
        Verb::Canals(args) => solid(host, "canals", &args.solid, &[&args.input], |session, report| {
            morphology::canals(args, session, report)
        }),
        Verb::Thicken(args) => solid(host, "thicken", &args.solid, &[&args.input], |session, report| {
            morphology::thicken(args, session, report)
        }),
        Verb::Sdf(args) => {
            let job = Job {
                inputs: vec![&args.input],
                made: made(args.output.as_ref(), args.force).into_iter().collect(),
                max_memory: args.max_memory,
                plan: args.plan,
                ..Job::new("sdf", &args.common)
            };
            run(host, job, |session, report| sdf::run(args, session, report))
        }
        Verb::Field(args) => {
            let job = Job {
                inputs: csg::paths(&args.operands),
                made: field_places::made(args),
                max_memory: args.max_memory,
                ..Job::new("field", &args.common)
            };
            run(host, job, |session, report| field::run(args, session, report))
        }
        Verb::Hollow(args) => {
            solid(host, "hollow", &args.solid, &[&args.input], |session, report| hollow::run(args, session, report))
        }
        Verb::Decimate(args) => {
            let made = made(Some(&args.output), args.writing.force).into_iter().collect();
            let job = Job { inputs: vec![&args.input], made, ..Job::new("decimate", &args.common) };
            run(host, job, |session, report| decimate::run(args, session, report))
        }
        Verb::Split(args) => {
            let job = Job { inputs: vec![&args.input], ..Job::new("split", &args.common) };
            run(host, job, |session, report| split::run(args, session, report))
        }
        Verb::Inspect(args) => {
            let job = Job { inputs: vec![&args.input], ..Job::new("inspect", &args.common) };
            run(host, job, |session, report| inspect::run(args, session, report))
        }
        Verb::Compare(args) => {
            let made = Made::side("--map", args.map.as_ref()).into_iter().collect();
            let job = Job { inputs: vec![&args.a, &args.b], made, ..Job::new("compare", &args.common) };
            run(host, job, |session, report| compare::run(args, session, report))
        }
        Verb::Convert(args) => {
            let made = made(Some(&args.output), args.writing.force).into_iter().collect();
            let job = Job { inputs: vec![&args.input], made, ..Job::new("convert", &args.common) };
            run(host, job, |session, report| convert::run(args, session, report))
        }
        Verb::Devices(args) => run(host, Job::new("devices", &args.common), |_, report| devices::run(args, report)),
        Verb::Render(args) => {
            let inputs = std::iter::once(&args.input).chain(&args.after).map(AsRef::as_ref).collect();
            let made = made(Some(&args.output), args.force).into_iter().collect();
            let job = Job { inputs, made, ..Job::new("render", &args.common) };
            run(host, job, |session, report| render::run(args, session, report))
        }
        Verb::View(args) => {
            let inputs = args.inputs.iter().map(AsRef::as_ref).collect();
            let made = Made::side("-o", args.output.as_ref()).into_iter().collect();
            let job = Job { inputs, made, max_memory: args.max_memory, ..Job::new("view", &args.common) };
            run(host, job, |session, report| view::run(args, session, report))
        }
        Verb::Report(args) => {
            let page = args.page();
            let made = Made::side("-o", Some(&page)).into_iter().collect();
            let job = Job { inputs: vec![&args.input], made, ..Job::new("report", &args.common) };
            run(host, job, |session, report| again::run(args, session, report))
        }
        Verb::Licenses => licenses::run(),
        Verb::Batch(args) => batch::run(args),
        Verb::Schema => schema::run(),
    }
}

fn booleans(host: &Host, verb: &'static str, args: &boolean::BooleanArgs, expression: fn(usize) -> Expression) -> Exit {
    let paths: Vec<&Path> = args.inputs.iter().map(AsRef::as_ref).collect();
    solid(host, verb, &args.solid, &paths, |session, report| boolean::run(args, expression, session, report))
}

fn grow(host: &Host, verb: &'static str, args: &morphology::GrowArgs, operation: Operation) -> Exit {
    solid(host, verb, &args.morphology.solid, &[&args.morphology.input], |session, report| {
        morphology::grow(args, operation, session, report)
    })
}

fn morphology(host: &Host, verb: &'static str, args: &morphology::MorphologyArgs, operation: Operation) -> Exit {
    solid(host, verb, &args.solid, &[&args.input], |session, report| {
        morphology::run(args, operation, None, session, report)
    })
}

fn solid(
    host: &Host,
    verb: &'static str,
    args: &SolidArgs,
    inputs: &[&Path],
    work: impl FnOnce(&Session, &mut RunReport) -> Result<Exit, Failure>,
) -> Exit {
    let output = made(args.output.as_ref(), args.writing.force);
    let job = Job {
        inputs: inputs.to_vec(),
        made: output.into_iter().chain(Made::side("--map", args.map.as_ref())).collect(),
        max_memory: args.max_memory,
        plan: args.plan,
        ..Job::new(verb, &args.common)
    };
    run(host, job, work)
}

fn made(output: Option<&PathBuf>, force: bool) -> Option<Made> {
    Made::side("-o", output).map(|made| Made { force, ..made })
}

/// What is known of a run before it starts.
struct Job<'a> {
    verb: &'static str,
    common: &'a CommonArgs,
    /// What it reads.
    inputs: Vec<&'a Path>,
    /// What it writes, the report left out.
    made: Vec<Made>,
    max_memory: Option<u64>,
    /// Nothing is to be done.
    plan: bool,
}

impl<'a> Job<'a> {
    fn new(verb: &'static str, common: &'a CommonArgs) -> Self {
        Self { verb, common, inputs: Vec::new(), made: Vec::new(), max_memory: None, plan: false }
    }

    /// Looks at all files of the run.
    fn check(&mut self) -> Result<(), Failure> {
        reporting::check_streams(self.common, self.made.iter().map(|made| made.path.as_path()))?;
        let report = Made::side("--report", self.common.report.as_ref());
        if self.plan {
            let files: Vec<Made> = std::mem::take(&mut self.made).into_iter().chain(report).collect();
            files::check(&self.inputs, &files)?;
            reporting::check_name(self.common)?;
            return files::prepare(files.iter().filter(|file| file.flag == "--report"));
        }
        self.made.extend(report);
        files::check(&self.inputs, &self.made)?;
        reporting::check_name(self.common)?;
        files::prepare(&self.made)
    }
}

fn run(host: &Host, job: Job<'_>, work: impl FnOnce(&Session, &mut RunReport) -> Result<Exit, Failure>) -> Exit {
    match host {
        Host::Program => run_program(job, work),
        Host::Caller(desk) => within::run(job, desk, work),
    }
}

/// Runs one verb within a session, writes its report, gives all files their names, and prints what there is to say.
fn run_program(mut job: Job<'_>, work: impl FnOnce(&Session, &mut RunReport) -> Result<Exit, Failure>) -> Exit {
    let ready = job.check().and_then(|()| Session::new(job.verb, job.common, job.max_memory));
    let session = match ready {
        Ok(mut session) => {
            session.kept = KeptFiles::of(&job.inputs, &job.made);
            session
        }
        Err(failure) => {
            print_failure(&failure);
            return failure.exit;
        }
    };
    let mut report = RunReport::new(job.verb);
    let outcome = work(&session, &mut report);
    session.clear_bar();
    // Here alone, so that no verb can keep a warning to itself, nor a run that fails.
    let notes: Vec<String> = report.warnings.iter().map(|warning| format!("note: {warning}")).collect();
    let outcome = outcome.and_then(|exit| {
        session.check_files()?;
        report.close(&Ok(exit), session.start);
        reporting::emit(&report, job.common, &session)?;
        session.publish(exit)?;
        Ok(exit)
    });
    let failure = match outcome {
        Ok(exit) => {
            session.speak();
            notes.iter().for_each(|note| session.tell(note));
            return exit;
        }
        Err(failure) => failure,
    };
    notes.iter().for_each(|note| session.tell(note));
    // Of a run that failed there is nothing but its report.
    session.discard();
    report.close(&Err(failure.clone()), session.start);
    let reported = reporting::emit(&report, job.common, &session).and_then(|()| session.publish(failure.exit));
    for failure in std::iter::once(&failure).chain(reported.as_ref().err()) {
        print_failure(failure);
    }
    failure.exit
}
