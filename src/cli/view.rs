//! `view FILE...`: meshes, maps and slices of grids in a browser.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::entries::OutputEntry;
use super::epilogue;
use super::exit::{Exit, Failure};
use super::given::{Given, Which};
use super::length::parse_size;
use super::page;
use super::report::RunReport;
use super::result::RunResult;
use super::serve::Served;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs};
use super::slice::{self, Field, SliceChoice, SliceWords};
use super::{side, streams, target};
use crate::progress::{Stage, Stopped};

/// As many meshes have room beside each other.
const MOST: usize = 4;

/// The size of slices, pixels.
const SLICE: [u32; 2] = [900, 700];

/// `view FILE...`.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Meshes, maps, and grids (VTI, NRRD, NPY, VDB), of which slices are shown
    #[arg(value_name = "FILE", required = true, num_args = 1..)]
    pub inputs: Vec<PathBuf>,
    /// Write the page to this file, instead of serving it
    #[arg(short, long, value_name = "OUT.html")]
    pub output: Option<PathBuf>,
    /// Of grids the slice: z (through the middle), x=50%, y=1.5 or z=2mm [default: z]
    #[arg(long, value_name = "AXIS[=AT]", allow_hyphen_values = true)]
    pub slice: Option<SliceChoice>,
    /// Refuse grids that would take more memory (500M, 2G)
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
    /// How the inputs are read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Shows the files.
pub fn run(args: &ViewArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    args.output.as_deref().map_or(Ok(()), |output| target::check_extension(output, "html"))?;
    if args.output.is_none() && session.is_within() {
        return Err(
            Failure::usage("within another program nothing is served").hint("-o OUT.html writes the page to a file")
        );
    }
    let paths: Vec<&Path> = args.inputs.iter().map(AsRef::as_ref).collect();
    let mut given = report.timed(Stage::Read, |report| {
        Given::read(&paths, &args.reading, args.max_memory, session, &mut report.warnings)
    })?;
    let unit = given.common_unit(&args.reading, &mut report.warnings).map(|unit| unit.to_string());
    if given.meshes.len() > MOST {
        return Err(Failure::usage(format!(
            "{} meshes were given, and {MOST} have room beside each other",
            given.meshes.len()
        )));
    }
    given.describe(report);
    report.options = json!({ "unit": unit, "slice": args.slice.map(|slice| slice.to_string()) });
    let text = report.timed(Stage::Draw, |report| {
        session.progress.stage(Stage::Draw)?;
        let pictures = slices(&given, args, session)?;
        page::html_of_files(&given.meshes, pictures, args.output.is_none(), report, session)
    })?;
    epilogue::measured(session, report, args.max_memory);
    match &args.output {
        Some(output) => write(output, &text, session, report)?,
        None => serve(&text, session)?,
    }
    Ok(Exit::Done)
}

/// The slices of the grids, as PNG files with what they show.
fn slices(given: &Given, args: &ViewArgs, session: &Session) -> Result<Vec<(Vec<u8>, String)>, Failure> {
    let grids = given.order.iter().filter_map(|which| match *which {
        Which::Grid(n) => Some(Field::of_grid(&given.grids[n])),
        Which::Mesh(_) => None,
    });
    let fields: Vec<Field<'_>> = grids.collect();
    if fields.is_empty() {
        return Ok(Vec::new());
    }
    let drawn = slice::draw(&fields, &args.slice.unwrap_or_default(), SLICE, &SliceWords::default(), session)?;
    let encoded = drawn.into_iter().map(|(image, entry)| {
        let png = image.to_png().map_err(|e| Failure::internal(format!("the picture cannot be encoded: {e}")))?;
        Ok((png, entry.words(given.unit_of(&entry.path).as_deref())))
    });
    encoded.collect()
}

fn write(output: &Path, text: &str, session: &Session, report: &mut RunReport) -> Result<(), Failure> {
    side::write_side(output, text.as_bytes(), session)?;
    let label = streams::label(output);
    session.say(&format!("{label}: open it in a browser"));
    let output = OutputEntry {
        path: label,
        format: "html".into(),
        bytes: text.len() as u64,
        sha256: streams::sha256(text.as_bytes()),
        unit: None,
        validity: None,
    };
    report.result = Some(RunResult::Page { output, missing: Vec::new() });
    Ok(())
}

/// Serves the page; that its reader ends it is how it ends well.
fn serve(text: &str, session: &Session) -> Result<(), Failure> {
    let served = Served::open()?;
    session.clear_bar();
    session.tell("open this address in a browser on this machine; it ends with the tab, or with Ctrl-C");
    streams::write_stream(format!("{}\n", served.address()).as_bytes())?;
    match served.run(text, &session.progress) {
        Ok(()) => Ok(()),
        Err(stopped @ (Stopped::Interrupted | Stopped::Deadline)) => Err(stopped.into()),
    }
}
