//! `decimate IN -o OUT --triangles N`: fewer triangles for the same solid.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::epilogue;
use super::exit::{Exit, Failure};
use super::input::{self, Input};
use super::length::{Length, Scale};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs, OutputArgs};
use super::table::Row;
use super::target::Target;
use super::words::{self, UnitName};
use super::{page, solid, summary};
use crate::compare::{CompareOptions, Comparison, compare};
use crate::decimate::{DecimateError, DecimateOptions, DecimateReport, Decimated, decimate};
use crate::fit::rounded;
use crate::io::{Format, Loaded, Paint, Unit};
use crate::mesh::{Bounds, Solid, SolidError, TriMesh};
use crate::pipeline;
use crate::progress::Stage;

/// Samples by which the distance that the surface has moved is told.
const SAMPLES: usize = 4_000;

/// `decimate IN -o OUT`.
#[derive(Debug, Args)]
#[group(id = "how far", args = ["triangles", "ratio", "max_deviation"], required = true, multiple = true)]
pub struct DecimateArgs {
    /// The mesh: a valid solid, such as `repair` writes
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where to write it
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Leave no more triangles than this
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(4..=4_000_000_000), conflicts_with = "ratio")]
    pub triangles: Option<u64>,
    /// Leave this share of the triangles: 0.1, or 10%
    #[arg(long, value_name = "R", value_parser = parse_ratio)]
    pub ratio: Option<f64>,
    /// How far the surface may move, measured both ways (0.1mm, 0.05%)
    #[arg(long, value_name = "LEN")]
    pub max_deviation: Option<Length>,
    /// How the input is read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// How the output is written.
    #[command(flatten)]
    pub writing: OutputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// A share above 0 and below 1, also in percent.
fn parse_ratio(text: &str) -> Result<f64, String> {
    let (number, whole) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
    match number.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number < whole => Ok(number / whole),
        _ => Err("a share between 0 and 1 is needed, such as 0.1 or 10%".into()),
    }
}

/// Decimates one file.
pub fn run(args: &DecimateArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut target = Target::new(&args.output, &args.writing)?;
    let mut inputs = report
        .timed(Stage::Read, |report| input::read_all(&[&args.input], &args.reading, session, &mut report.warnings))?;
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    target.set_unit(unit);
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let Some(mut input) = inputs.pop() else { return Err(Failure::internal("nothing was read")) };
    let moved = prepare(&mut input, target.options.format);
    let options = options(args, &input, unit, target.options.format)?;
    report.options = json!({
        "unit": unit.map(|unit| unit.to_string()),
        "triangles": options.triangles,
        "max_deviation": options.max_deviation,
        "single": options.single,
        "threads": rayon::current_num_threads(),
    });
    let made = report.timed(Stage::Decimate, |_| {
        session.progress.stage(Stage::Decimate)?;
        let Loaded { mesh, colours, texture, .. } = &input.loaded;
        let classes = pipeline::classes_of(mesh, colours.as_ref(), texture.as_ref());
        Ok::<_, Failure>(match Solid::check(mesh.clone(), &session.progress) {
            Ok(solid) => {
                let made = decimate(&solid, &classes, &options, &session.progress);
                made.map(|made| (made, solid.validity().clone())).map_err(|error| failure(error, &input, moved))
            }
            Err(SolidError::NotSolid(what)) => Err(no_solid(&what.validity.problems().join(" "), &input, moved)),
            Err(error) => Err(error.into()),
        })
    })?;
    let (Decimated { solid: made, origins, report: done }, before) = made?;
    let mesh = made.mesh();
    report.inputs[0].validity = Some(before);
    let colours = input.loaded.colours.as_ref();
    let colours = colours.map(|colours| pipeline::carry_to_simpler(mesh, &origins, &input.loaded.mesh, colours));
    let comparison = report.timed(Stage::Compare, |_| {
        let options = CompareOptions { samples: SAMPLES, edge_tolerance: None };
        compare(&input.loaded.mesh, mesh, &options, &session.progress).map(Some)
    })?;
    let name = unit.map(|unit| unit.to_string());
    session.show(report, |_| page::of_decimation(&input.loaded.mesh, mesh, name.as_deref(), session))?;
    let texture = input.loaded.texture.as_ref();
    let texture =
        texture.and_then(|texture| pipeline::carry_texture_to_simpler(mesh, &origins, &input.loaded.mesh, texture));
    let paint = Paint { colours: colours.as_ref(), texture: texture.as_ref(), beside: None };
    report.result =
        Some(RunResult::Decimation { decimate: done.clone(), comparison: comparison.clone(), output: None });
    let written = solid::write(&made, paint, &target, session, report)?;
    report.written(written);
    let missed = !done.reached && options.max_deviation.is_none();
    if !done.reached {
        report.warnings.push(match options.max_deviation {
            None => "no edge is left that could go without changing bodies or tunnels, or making triangles meet".into(),
            Some(_) => "the deviation ended it before the number of triangles was reached".into(),
        });
    }
    epilogue::measured(session, report, None);
    say(session, report, (&done, comparison.as_ref()), name.as_deref());
    Ok(if missed { Exit::Limit } else { Exit::Done })
}

/// Brings the mesh into the form that can be decimated: shared vertices, and the numbers of the output's format. Returns how far
/// vertices moved for these.
fn prepare(input: &mut Input, format: Format) -> f64 {
    let loaded = &mut input.loaded;
    if loaded.format.repeats_vertices() {
        loaded.weld();
    }
    let mut moved = 0f64;
    if format.is_single() {
        for p in &mut loaded.mesh.positions {
            let to = rounded(*p);
            moved = moved.max(p.distance(to));
            *p = to;
        }
    }
    moved
}

fn options(args: &DecimateArgs, input: &Input, unit: Option<Unit>, format: Format) -> Result<DecimateOptions, Failure> {
    let mesh: &TriMesh = &input.loaded.mesh;
    let diagonal = mesh.bounds().as_ref().map_or(0.0, Bounds::diagonal);
    let max_deviation = match args.max_deviation {
        Some(length @ Length::Voxels(_)) => {
            return Err(Failure::usage(format!("`{length}` is given in voxels, and decimate has none"))
                .hint("a LEN such as 0.1mm, 0.05% (of the diagonal) or 0.1 (in the file's units)"));
        }
        Some(length) => Some(length.resolve(&Scale { unit, diagonal, voxel: None })?),
        None => None,
    };
    let share = args.ratio.map(|ratio| ((mesh.triangles.len() as f64 * ratio).round() as usize).max(4));
    Ok(DecimateOptions {
        triangles: args.triangles.map(|count| count as usize).or(share),
        max_deviation,
        single: format.is_single(),
    })
}

fn failure(error: DecimateError, input: &Input, moved: f64) -> Failure {
    let problems = match error {
        DecimateError::Stopped(stopped) => return stopped.into(),
        DecimateError::Deviation(_) => return Failure::usage(error.to_string()),
        DecimateError::NotManifold(error) => error.to_string(),
        DecimateError::Invalid(state) => state.problems().join(" "),
    };
    no_solid(&problems, input, moved)
}

/// The failure for what is no solid.
fn no_solid(problems: &str, input: &Input, moved: f64) -> Failure {
    let problems = problems.trim_end_matches('.');
    let failure =
        Failure::input(format!("{} is no valid solid, and only these are decimated: {problems}", input.label));
    failure.hint(match moved > 0.0 {
        true => format!(
            "`meshwright repair` makes one; or it is the output's format, which holds single precision and moves vertices by {}: \
             OBJ, PLY, OFF and 3MF keep them",
            words::number(moved)
        ),
        false => "`meshwright repair` makes one".into(),
    })
}

fn say(
    session: &Session,
    report: &RunReport,
    (done, comparison): (&DecimateReport, Option<&Comparison>),
    unit: UnitName<'_>,
) {
    let mut rows: Vec<Row> = summary::input_rows(report);
    let (before, after) = (words::plural(done.before, "triangle"), words::count(done.after));
    rows.push(("done", format!("{before} became {after} ({})", words::percent(done.after, done.before))));
    let found = comparison.and_then(|found| Some((found.symmetric.as_ref()?, found.diagonal)));
    if let Some((found, diagonal)) = found {
        let (mean, most) = (words::length(found.mean, unit), words::length(found.max, unit));
        let share = words::number(100.0 * found.max / diagonal);
        rows.push(("moved", format!("by {mean} in the mean, at most {most} ({share} % of the diagonal)")));
    }
    rows.extend(summary::result_rows(report, unit));
    epilogue::say(session, report, rows);
}
