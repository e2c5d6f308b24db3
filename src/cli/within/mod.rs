//! A verb within another program, such as an interpreter: what it reads and makes may lie in memory, nothing is printed, no signal is listened to, and
//! the process goes on.
//!
//! ```
//! use meshwright::cli::within::{Call, Product, call};
//! use meshwright::{Progress, io};
//!
//! let mug = io::read("testdata/broken_mug.obj")?;
//! let answer = call(Call {
//!     arguments: ["repair", "<mesh>", "-o", "<result>.ply", "--resolution", "64"].map(Into::into).to_vec(),
//!     meshes: vec![("<mesh>".into(), mug)],
//!     progress: Progress::none(),
//! })
//! .map_err(|refusal| refusal.failure.message)?;
//! let [Product::Mesh(made)] = answer.products.as_slice() else { panic!("one mesh is made") };
//! assert!(made.validity.is_valid() && answer.report["exit"] == 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod desk;
mod flags;
mod product;

use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::rc::Rc;
use std::time::Instant;

use super::args::Verb;
use super::exit::{Exit, Failure};
use super::files::KeptFiles;
use super::report::RunReport;
use super::session::Session;
use super::{Host, Job, args, dispatch, misuse, reporting};
use crate::io::Loaded;
use crate::progress::Progress;
pub(super) use desk::Desk;
pub use flags::{Flag, flags};
pub use product::{GridProduct, MeshProduct, Product};

/// What is asked for.
pub struct Call {
    /// The verb and its arguments, as on the command line. A path whose name begins with `<result>` stands for memory; its extension says the format
    /// whose numbers the result is to have.
    pub arguments: Vec<OsString>,
    /// Meshes that lie in memory, by the names that `arguments` call them.
    pub meshes: Vec<(String, Loaded)>,
    /// Hears how far the work is, and stops it.
    pub progress: Progress,
}

/// What came of it.
pub struct Answer {
    /// What was made and not written to a file, in order.
    pub products: Vec<Product>,
    /// The report, as `--json` prints it.
    pub report: serde_json::Value,
    /// Whether a stated limit does not hold ([`Exit::Limit`]), or all is well.
    pub exit: Exit,
}

/// Why there is no answer.
pub struct Refusal {
    /// What went wrong.
    pub failure: Failure,
    /// What was found until then; nothing where the arguments were not understood.
    pub report: Option<serde_json::Value>,
}

impl From<Failure> for Box<Refusal> {
    fn from(failure: Failure) -> Self {
        Self::new(Refusal { failure, report: None })
    }
}

/// Runs one verb on the threads of the caller's pool. Files that the arguments name are read and written as by the program.
///
/// # Errors
/// What makes the program end with an exit status above 0, apart from results that do not keep a stated limit and are made all the same.
pub fn call(call: Call) -> Result<Answer, Box<Refusal>> {
    let Call { mut arguments, meshes, progress } = call;
    arguments.insert(0, env!("CARGO_PKG_NAME").into());
    arguments.extend(["--json", "--quiet"].map(OsString::from));
    let parsed = args::parse(arguments.iter().cloned()).map_err(|error| misunderstood(&error, &arguments[1..]))?;
    if let Verb::Batch(_) | Verb::View(_) | Verb::Licenses | Verb::Schema = parsed.verb {
        return Err(Failure::usage("this verb is for the command line alone").into());
    }
    let meshes = meshes.into_iter().map(|(name, loaded)| (PathBuf::from(name), loaded));
    let desk = Rc::new(Desk::new(meshes, progress));
    catch_unwind(AssertUnwindSafe(|| dispatch(&parsed.verb, &Host::Caller(desk.clone()))))
        .map_err(|_| Failure::internal("the program has a bug").hint("please report it with the call and the mesh"))?;
    desk.answer()
}

fn misunderstood(error: &clap::Error, arguments: &[OsString]) -> Failure {
    misuse::explain(error, arguments).unwrap_or_else(|| misuse::in_words(error))
}

/// Runs one verb for the owner of a desk, and lays the answer there.
pub(super) fn run(
    mut job: Job<'_>,
    desk: &Rc<Desk>,
    work: impl FnOnce(&Session, &mut RunReport) -> Result<Exit, Failure>,
) -> Exit {
    job.inputs.retain(|path| !desk.holds(path));
    job.made.retain(|made| !Desk::takes(&made.path));
    let mut report = RunReport::new(job.verb);
    let start = Instant::now();
    let done = job.check().and_then(|()| {
        let mut session = Session::within(desk.clone(), job.common, start);
        session.kept = KeptFiles::of(&job.inputs, &job.made);
        let exit = work(&session, &mut report)?;
        session.progress.check()?;
        report.close(&Ok(exit), start);
        reporting::to_file(&report, job.common, &session)?;
        session.publish(exit)?;
        Ok(exit)
    });
    if let Err(failure) = &done {
        report.close(&Err(failure.clone()), start);
    }
    let exit = done.as_ref().map_or_else(|failure| failure.exit, |exit| *exit);
    desk.close(done, &report);
    exit
}
