//! `sdf IN -o OUT`: the signed distance to a mesh over a lattice.

use std::path::Path;

use clap::ValueEnum;
use serde_json::json;

use super::backend::BackendChoice;
use super::choices::{InsideChoice, SignChoice};
use super::entries::OutputEntry;
use super::epilogue;
use super::exit::{Asked, Exit, Failure, INPUTS_ALONE};
use super::input::{self, Input};
use super::length::{BandChoice, Scale};
use super::meant;
use super::report::RunReport;
use super::result::RunResult;
use super::sdf_args::SdfArgs;
use super::session::Session;
use super::streams::{self, is_stream};
use super::table::{self, Row};
use super::target::{self, GRID_ENDINGS};
use super::words::{self, UnitName};
use super::{backend, machine, output, summary, weights};
use crate::io::{DistanceSamples, GridFormat, SampleBlocks, Unit};
use crate::lattice::Slot;
use crate::mesh::Validity;
use crate::pipeline::{
    self, DistanceError, DistanceMethod, DistanceOptions, DistanceOutcome, DistancePlan, DistanceReport, DistanceSign,
    LimitError, VoxelSize,
};
use crate::progress::Stage;

/// Makes the field of one file.
pub fn run(args: &SdfArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let format = format(args)?;
    let mut inputs = report
        .timed(Stage::Read, |report| input::read_all(&[&args.input], &args.reading, session, &mut report.warnings))?;
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let Some(input) = inputs.first() else { return Err(Failure::internal("nothing was read")) };
    let validity = report.timed(Stage::Examine, |_| {
        session.progress.stage(Stage::Examine)?;
        input::examine(&input.loaded, &session.progress)
    })?;
    let options = options(args, input, unit, &validity)?;
    report.options = resolved(args, unit, format, &options);
    report.inputs[0].validity = Some(validity.clone());
    let Some((path, format)) = args.output.as_deref().zip(format).filter(|_| !args.plan) else {
        return plan(input, &options, unit, format, args, report);
    };
    report.warnings.extend(doubts(&options, &validity, format));
    if let Ok(plan) = pipeline::plan_distance(&input.loaded.mesh, &options) {
        session.expect(&weights::of_distances(input.loaded.mesh.triangles.len(), plan.seconds, plan.file));
    }
    let mut outcome = pipeline::distance(&input.loaded.mesh, &options, &session.progress)
        .map_err(|e| failure(&e, input, &options, unit, args))?;
    report.stages.append(&mut outcome.report.stages);
    let output = Some(write(path, &outcome, unit, format, session, report)?);
    report.result = Some(RunResult::Distance { distance: outcome.report.clone(), output });
    let exit = epilogue::measured(session, report, args.max_memory);
    say(session, report, &outcome.report, &options, unit);
    Ok(exit)
}

/// The format of the output; everything about it that can be known before the work begins is checked.
fn format(args: &SdfArgs) -> Result<Option<GridFormat>, Failure> {
    let Some(path) = args.output.as_deref() else { return Ok(None) };
    let format = match (args.out_format, GridFormat::from_path(path)) {
        (Some(format), _) | (None, Some(format)) => {
            target::check_extension(path, format.name())?;
            format
        }
        (None, None) if is_stream(path) => {
            return Err(Failure::usage("standard output has no name that tells its format")
                .hint("--out-format says it, for example --out-format nrrd"));
        }
        (None, None) => {
            return Err(target::untold(path, &meant::grid_formats(), &format!("{GRID_ENDINGS}, or give --out-format")));
        }
    };
    Ok(Some(format))
}

fn options(args: &SdfArgs, input: &Input, unit: Option<Unit>, validity: &Validity) -> Result<DistanceOptions, Failure> {
    let bounds = input.loaded.mesh.bounds();
    let (diagonal, longest) = bounds.map_or((0.0, 0.0), |b| (b.diagonal(), b.size().max_element()));
    let voxel = args.voxels.size(unit, diagonal)?;
    let spacing = voxel.spacing(longest);
    let band = match args.band {
        BandChoice::Full => None,
        // A mesh without extent has no voxel; the pipeline says so.
        BandChoice::Within(_) if spacing <= 0.0 => None,
        BandChoice::Within(length) => Some(length.resolve(&Scale { unit, diagonal, voxel: Some(spacing) })?),
    };
    let method = args.method.into();
    let closed = DistanceMethod::is_for_closed(method);
    backend::check_built(args.backend)?;
    if args.backend == BackendChoice::Gpu && method != DistanceMethod::Exact {
        return Err(Failure::usage(
            "a graphics processor measures --method exact only; --backend gpu cannot change that",
        )
        .hint("--method exact --backend gpu, or this method without --backend"));
    }
    if closed {
        pseudonormals_only(args)?;
    }
    let sign = match args.sign {
        Some(SignChoice::Pseudonormal | SignChoice::Winding | SignChoice::Levels)
            if method == DistanceMethod::Robust =>
        {
            return Err(Failure::usage("--method robust goes by the votes; --sign cannot change that")
                .hint("--method exact takes any --sign"));
        }
        Some(sign) => sign.into(),
        None => DistanceSign::suited(validity, method, args.inside.into()),
    };
    if args.inside != InsideChoice::Positive && (closed || sign == DistanceSign::Pseudonormal && args.sign.is_some()) {
        return Err(Failure::usage(
            "by pseudonormals the nearest triangle tells the side; --inside cannot change that",
        )
        .hint("--sign votes, winding and levels go by --inside"));
    }
    let planes = args.planes;
    let (orient, inside, max_memory) = (args.orient.into(), args.inside.into(), machine::memory_cap(args.max_memory));
    Ok(DistanceOptions { voxel, band, method, sign, planes, orient, inside, max_memory, backend: args.backend.into() })
}

/// Refuses another sign for what goes by pseudonormals.
fn pseudonormals_only(args: &SdfArgs) -> Result<(), Failure> {
    let name = args.method.to_possible_value().map_or_else(String::new, |value| value.get_name().to_string());
    if matches!(args.sign, None | Some(SignChoice::Pseudonormal)) {
        return Ok(());
    }
    Err(Failure::usage(format!("--method {name} goes by pseudonormals; --sign cannot change that"))
        .hint("--method exact takes any --sign"))
}

/// The options as the report states them, after defaults.
fn resolved(
    args: &SdfArgs,
    unit: Option<Unit>,
    format: Option<GridFormat>,
    options: &DistanceOptions,
) -> serde_json::Value {
    let (resolution, voxel) = match options.voxel {
        VoxelSize::Along(n) => (Some(n), None),
        VoxelSize::Length(length) => (None, Some(length)),
    };
    json!({
        "resolution": resolution,
        "voxel": voxel,
        "voxel_as_given": args.voxels.voxel.map(|length| length.to_string()),
        "band": options.band,
        "band_as_given": args.band.to_string(),
        "planes": options.planes,
        "method": options.method,
        "sign": options.sign,
        "orient": format!("{:?}", options.orient).to_lowercase(),
        "inside": options.inside,
        "out_format": format.map(|format| format.to_string()),
        "unit": unit.map(|unit| unit.to_string()),
        "threads": rayon::current_num_threads(),
        "max_memory_bytes": args.max_memory,
        "timeout_seconds": args.common.timeout.map(|timeout| timeout.as_secs_f64()),
    })
}

/// What a user should know before trusting the field.
fn doubts(options: &DistanceOptions, validity: &Validity, format: GridFormat) -> Vec<String> {
    let mut sentences = Vec::new();
    if options.sign == DistanceSign::Pseudonormal && !validity.is_valid() {
        sentences.push(
            "the surface is no valid solid: by pseudonormals a place is inside or outside as seen from the nearest triangle"
                .to_string(),
        );
    }
    if !format.says_where() {
        sentences.push(format!("{format} has no place for origin, spacing and unit; --report has them"));
    }
    sentences
}

/// What to try when more memory would be needed than `allowed`.
fn smaller(input: &Input, options: &DistanceOptions, allowed: u64) -> &'static str {
    let coarsest = DistanceOptions { voxel: VoxelSize::Along(2), ..*options };
    match pipeline::plan_distance(&input.loaded.mesh, &coarsest) {
        Ok(plan) if plan.memory > allowed => INPUTS_ALONE,
        _ => "a narrower --band, or a lower --resolution",
    }
}

fn failure(
    error: &DistanceError,
    input: &Input,
    options: &DistanceOptions,
    unit: Option<Unit>,
    args: &SdfArgs,
) -> Failure {
    let unit = unit.map(|unit| unit.to_string());
    match error {
        DistanceError::Limit(LimitError::Memory { needed, allowed, .. }) => {
            Failure::memory(*needed, *allowed, args.max_memory).hint(smaller(input, options, *allowed))
        }
        _ => {
            let asked = Asked { voxel: args.voxels.voxel.is_some(), memory: args.max_memory };
            Failure::pipeline(error, std::slice::from_ref(&input.label), unit.as_deref(), asked)
        }
    }
}

fn plan(
    input: &Input,
    options: &DistanceOptions,
    unit: Option<Unit>,
    format: Option<GridFormat>,
    args: &SdfArgs,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let mut plan =
        pipeline::plan_distance(&input.loaded.mesh, options).map_err(|e| failure(&e, input, options, unit, args))?;
    if format == Some(GridFormat::Vdb) {
        plan.file = tree_bytes(&plan, options);
    }
    report.result = Some(RunResult::DistancePlan { plan });
    if !args.common.json {
        let unit = unit.map(|unit| unit.to_string());
        streams::write_stream(table::table(&plan_rows(&plan, unit.as_deref())).as_bytes())?;
    }
    match options.max_memory {
        Some(cap) if plan.memory > cap => {
            Err(Failure::memory(plan.memory, cap, args.max_memory).hint(smaller(input, options, cap)))
        }
        _ => Ok(Exit::Done),
    }
}

/// The bytes of a file that leaves out what lies beyond the band. Blocks reach about five voxels farther than it on
/// either side, as counted on meshes of all sorts.
fn tree_bytes(plan: &DistancePlan, options: &DistanceOptions) -> u64 {
    const BEYOND: f64 = 5.0;
    let share = options.band.map_or(1.0, |band| band / (band + BEYOND * plan.voxel));
    (4.0 * plan.stored as f64 * share) as u64
}

fn plan_rows(plan: &DistancePlan, unit: UnitName<'_>) -> Vec<Row> {
    vec![
        ("voxel", summary::voxel(plan.voxel, plan.dims, unit)),
        ("stored", format!("about {}", words::plural(plan.stored as usize, "voxel"))),
        ("file", format!("about {}", words::bytes(plan.file))),
        ("memory", format!("about {}", words::bytes(plan.memory))),
        ("time", format!("about {} on one core", words::seconds(plan.seconds))),
    ]
}

fn samples<'a>(
    outcome: &DistanceOutcome,
    unit: Option<Unit>,
    plane: &'a (dyn Fn(usize, &mut Vec<f32>) + Sync),
    blocks: &'a SampleBlocks<'a>,
) -> DistanceSamples<'a> {
    let lattice = &outcome.field.lattice;
    DistanceSamples {
        origin: lattice.origin,
        spacing: lattice.h,
        dims: lattice.dims.to_array().map(|count| count as usize),
        unit,
        band: outcome.report.band,
        plane,
        blocks: Some(blocks),
    }
}

/// Writes a field.
pub(super) fn write(
    path: &Path,
    outcome: &DistanceOutcome,
    unit: Option<Unit>,
    format: GridFormat,
    session: &Session,
    report: &mut RunReport,
) -> Result<OutputEntry, Failure> {
    let plane = |z: usize, values: &mut Vec<f32>| outcome.plane(z, values);
    let (field, bricks) = (&outcome.field, &outcome.field.grid.bricks);
    let blocks = SampleBlocks {
        stored: bricks.active(),
        values: &|n| field.grid.values[n].map(|value| field.length(value) as f32),
        inside: &|brick| bricks.slot(brick) == Slot::Inside,
    };
    let samples = samples(outcome, unit, &plane, &blocks);
    report.timed(Stage::WriteAndVerify, |_| {
        session.progress.stage(Stage::Write)?;
        output::write_grid(path, &samples, format, session)
    })
}

/// Says what was read, how the field was made, and what came out.
fn say(
    session: &Session,
    report: &RunReport,
    distance: &DistanceReport,
    options: &DistanceOptions,
    unit: Option<Unit>,
) {
    let name = unit.map(|unit| unit.to_string());
    let unit = name.as_deref();
    let mut rows = summary::input_rows(report);
    let side = match options.sign {
        DistanceSign::Pseudonormal => "sides by the normal at the nearest point",
        DistanceSign::Votes => "sides by the votes of the rays",
        DistanceSign::Winding => "sides by the winding number",
        DistanceSign::Levels => "sides by outlines in planes along z",
    };
    let reach = match distance.band {
        Some(band) => format!("within {} of the surface, ± that beyond", words::length(band, unit)),
        None => "everywhere".into(),
    };
    let how = match options.method {
        DistanceMethod::Exact => "distance to the nearest triangle",
        DistanceMethod::Characteristics => "distance to the nearest triangle, by characteristics",
        DistanceMethod::Prism => "distance to the nearest triangle, by prisms",
        DistanceMethod::Robust => "smooth distance, marched outwards",
    };
    rows.push(("done", format!("{how} {reach}; {side}")));
    if let Some(made_by) = distance.made_by.as_ref().filter(|made_by| made_by.adapter.is_some()) {
        let doubtful = made_by.doubtful.unwrap_or(0) as usize;
        let again = format!("{} again by the main processor", words::plural(doubtful, "voxel"));
        rows.push(("done", format!("{}; {again}", backend::words(made_by, "measured"))));
    }
    rows.push(("voxel", summary::voxel(distance.voxel, distance.dims, unit)));
    if let Some(output) = report.output() {
        let [low, high] = distance.range.map(|value| words::number(value.into()));
        let range = words::with_unit(&format!("{low} to {high}"), unit);
        rows.push(("result", format!("{}: {range}, negative inside; {}", output.path, words::bytes(output.bytes))));
    }
    epilogue::say(session, report, rows);
}
