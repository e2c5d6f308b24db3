//! One run of the program: what it says, when it must stop, and the files that it makes.

use std::cell::RefCell;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::ending::Ending;
use super::exit::{Exit, Failure};
use super::files::KeptFiles;
use super::page::Scene;
use super::progress_bar::Meter;
use super::report::RunReport;
use super::say::eprintln_quietly;
use super::shared_args::CommonArgs;
use super::within::Desk;
use super::{machine, streams, typed};
use crate::io::Loaded;
use crate::io::draft::{Draft, flush_folders, publish};
use crate::pipeline::{TriangleKind, TriangleSource};
use crate::progress::{Progress, Stage};

/// One run.
pub struct Session {
    /// When it began.
    pub start: Instant,
    /// Handed to every stage.
    pub progress: Progress,
    /// Whether `-v` was given.
    pub verbose: bool,
    /// Files that must not be written by chance.
    pub kept: KeptFiles,
    /// Where meshes lie that are in memory, of a run within another program.
    desk: Option<Rc<Desk>>,
    quiet: bool,
    meter: Arc<Meter>,
    ending: Ending,
    /// What is said when the files are in their places.
    lines: RefCell<Vec<String>>,
    /// Whether the report is a page.
    pages: bool,
    /// What it shows of the meshes.
    scene: RefCell<Option<Scene>>,
}

/// A file that will get its name at the end of the run.
pub struct Drafted {
    /// To be written.
    pub file: File,
    /// Where it is for now.
    pub path: PathBuf,
}

impl Session {
    /// Sets up threads, signals, the deadline, the cap on memory and the progress bar.
    pub fn new(verb: &str, common: &CommonArgs, max_memory: Option<u64>) -> Result<Self, Failure> {
        let start = Instant::now();
        let meter = Arc::new(Meter::new(verb, common.quiet, common.verbose));
        let flag = Arc::new(AtomicBool::new(false));
        let listening = meter.clone();
        let mut progress = Progress::none().with_flag(flag.clone()).with_listener(move |event| listening.show(event));
        let deadline = common.timeout.and_then(|timeout| start.checked_add(timeout));
        if let Some(deadline) = deadline {
            progress = progress.with_deadline(deadline);
        }
        let ending = Ending::watch(deadline, max_memory, flag)?;
        let fewer = machine::start_threads(common.threads)?;
        let lines = RefCell::new(fewer.iter().map(|line| format!("note: {line}")).collect());
        Ok(Self {
            start,
            progress,
            verbose: common.verbose,
            kept: KeptFiles::default(),
            desk: None,
            quiet: common.quiet,
            meter,
            ending,
            lines,
            pages: wants_page(common),
            scene: RefCell::default(),
        })
    }

    /// One for the owner of a desk: on the caller's threads, without signals and without a word.
    pub fn within(desk: Rc<Desk>, common: &CommonArgs, start: Instant) -> Self {
        let deadline = common.timeout.and_then(|timeout| start.checked_add(timeout));
        let progress = desk.progress.clone();
        Self {
            start,
            progress: deadline.map_or_else(|| progress.clone(), |deadline| progress.clone().with_deadline(deadline)),
            verbose: false,
            kept: KeptFiles::default(),
            desk: Some(desk),
            quiet: true,
            meter: Arc::new(Meter::new("", true, false)),
            ending: Ending::unwatched(),
            lines: RefCell::default(),
            pages: wants_page(common),
            scene: RefCell::default(),
        }
    }

    /// The mesh that lies in memory under this name, if one does; it is handed over.
    pub fn laid(&self, path: &Path) -> Option<Loaded> {
        self.desk.as_ref()?.take(path)
    }

    /// Where the triangles of the mesh come from that will be laid on the desk next, and what they are.
    pub fn lay_sources(&self, sources: Vec<TriangleSource>, kinds: Vec<TriangleKind>) {
        if let Some(desk) = &self.desk {
            desk.lay_sources(sources, kinds);
        }
    }

    /// Whether a mesh lies in memory under this name.
    pub fn holds(&self, path: &Path) -> bool {
        self.desk.as_ref().is_some_and(|desk| desk.holds(path))
    }

    /// The desk on which the result of this name is laid, if it does not become a file.
    pub fn desk_for(&self, path: &Path) -> Option<&Desk> {
        self.desk.as_deref().filter(|_| Desk::takes(path))
    }

    /// What the report will show of the meshes, where it is a page; `look` is asked only then.
    pub fn show(
        &self,
        report: &mut RunReport,
        look: impl FnOnce(&RunReport) -> Result<Scene, Failure>,
    ) -> Result<(), Failure> {
        if self.pages {
            self.progress.stage(Stage::Draw)?;
            let scene = report.timed(Stage::Draw, |report| look(report))?;
            self.scene.replace(Some(scene));
        }
        Ok(())
    }

    /// What was shown, handed over.
    pub fn take_scene(&self) -> Option<Scene> {
        self.scene.take()
    }

    /// Whether it is one within another program.
    pub fn is_within(&self) -> bool {
        self.desk.is_some()
    }

    /// The command that was typed; nothing within another program.
    pub fn command(&self) -> Option<String> {
        self.desk.is_none().then(typed::command)
    }

    /// A line for the user at the end, when all files are in their places, unless `-q`.
    pub fn say(&self, line: &str) {
        self.lines.borrow_mut().push(line.to_owned());
    }

    /// A line for the user now, unless `-q`.
    pub fn tell(&self, line: &str) {
        if !self.quiet {
            self.meter.above(|| eprintln_quietly(line));
        }
    }

    /// So many results will be made one after the other.
    pub fn expect_frames(&self, frames: usize) {
        self.meter.expect_frames(frames);
    }

    /// The stages that will come, and the seconds that each may take.
    pub fn expect(&self, seconds: &[(Stage, f64)]) {
        self.meter.expect(seconds);
    }

    /// Takes the progress bar away.
    pub fn clear_bar(&self) {
        self.meter.clear();
    }

    /// A file that [`Session::publish`] will name `path`, and that will be gone if the run ends before.
    pub fn draft(&self, path: &Path) -> Result<Drafted, Failure> {
        let mut state = self.ending.lock();
        let (draft, file) = Draft::new(path).map_err(|error| streams::unwritable(path, &error))?;
        let path = draft.temporary().to_owned();
        state.drafts.push(draft);
        Ok(Drafted { file, path })
    }

    /// An error when the run was to stop before its files get their names; without files nothing is undone any more.
    pub fn check_files(&self) -> Result<(), Failure> {
        let files = !self.ending.lock().drafts.is_empty();
        if files { Ok(self.progress.check()?) } else { Ok(()) }
    }

    /// Makes a folder for files that [`Session::publish`] will name; it is gone again if the run ends before.
    pub fn make_folder(&self, path: &Path) -> Result<(), Failure> {
        let mut state = self.ending.lock();
        std::fs::create_dir(path).map_err(|error| streams::unwritable(path, &error))?;
        state.folder = Some(path.to_owned());
        Ok(())
    }

    /// Removes all files that have not got their names.
    pub fn discard(&self) {
        self.ending.lock().discard();
    }

    /// The last, indivisible step: gives all files their names, or none. After it, nothing can undo the run, which ends
    /// with `exit`.
    pub fn publish(&self, exit: Exit) -> Result<(), Failure> {
        let mut state = self.ending.lock();
        let drafts = std::mem::take(&mut state.drafts);
        let targets: Vec<PathBuf> = drafts.iter().map(|draft| draft.target().to_owned()).collect();
        publish(drafts).map_err(|(number, error)| streams::unwritable(&targets[number], &error))?;
        state.folder = None;
        state.finished = Some(exit);
        drop(state);
        flush_folders(targets.iter().map(PathBuf::as_path));
        Ok(())
    }

    /// Prints what was said.
    pub fn speak(&self) {
        for line in self.lines.take() {
            self.tell(&line);
        }
    }
}

fn wants_page(common: &CommonArgs) -> bool {
    common.report.as_deref().is_some_and(typed::is_page)
}

impl Drop for Session {
    /// Also when the work panics, nothing stays behind.
    fn drop(&mut self) {
        self.discard();
    }
}
