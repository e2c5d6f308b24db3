//! What `repair`, the booleans and `csg` share: from files to one verified file.

use std::borrow::Cow;
use std::path::Path;

use rayon::prelude::*;
use serde_json::json;

use super::change::{self, Change, Changed};
use super::entries::OutputEntry;
use super::epilogue;
use super::exit::{Asked, Exit, Failure, INPUTS_ALONE};
use super::holes::{self, LeaveArgs};
use super::input::{self, Input};
use super::length::{Scale, Simplify};
use super::map::{self, Map};
use super::output::{in_memory, write_verified};
use super::page::{Origin, SolidSeen};
use super::paint::{self, Arranged};
use super::pick::{self, PickArgs};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::site::Site;
use super::solid_args::SolidArgs;
use super::target::Target;
use super::{backend, doubts, keep, limits, machine, negative, page, summary, table, weights, words};
use crate::fit::{FitOptions, rounded};
use crate::io::{Colours, Format, Loaded, Paint, Unit};
use crate::ldi::Expression;
use crate::mesh::{Bounds, Solid, TriMesh, ValidateOptions, Validity, validate};
use crate::pipeline::{self, Advice, Opened, Operand, Options, Outcome, Precision, TriangleKind, VoxelSize, Work};
use crate::progress::Stage;

/// Meshes and what is to be made of them.
pub struct Job<'a> {
    /// The operands' files, in order.
    pub paths: Vec<&'a Path>,
    /// The operands' names, for `csg`.
    pub names: Vec<String>,
    /// The result in terms of the operands.
    pub expression: Expression,
    /// What is done to that solid.
    pub change: Option<&'a Change>,
    /// Which holes are left open, where that can be asked for.
    pub leave: Option<&'a LeaveArgs>,
    /// Which objects of the one file are taken, where that can be asked for; others are told that they become one.
    pub pick: Option<&'a PickArgs>,
    /// The flags.
    pub args: &'a SolidArgs,
}

/// Runs the pipeline from file to file.
pub fn run(job: &Job<'_>, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let args = job.args;
    args.check()?;
    holes::check(args, job.leave)?;
    if args.output.is_none() && !args.plan && job.change.is_none_or(Change::makes_a_mesh) {
        return Err(Failure::usage("where to write the result is not said: --output OUT")
            .hint("--plan says what it would cost, without an output"));
    }
    let mut target = args.output.as_deref().map(|path| Target::new(path, &args.writing)).transpose()?;
    args.map.as_deref().map_or(Ok(()), super::compare::check_map)?;
    let mut inputs = report
        .timed(Stage::Read, |report| input::read_operands(&job.paths, &args.reading, session, &mut report.warnings))?;
    if let (Some(pick), Some(input)) = (job.pick, inputs.first_mut()) {
        pick.apply(&mut input.loaded, &input.label)?;
        input.entry.parts = input::part_entries(&input.loaded.parts);
        report.warnings.extend(pick::fused(&input.loaded, &input.label));
    }
    for (input, name) in inputs.iter_mut().zip(&job.names) {
        input.entry.name = Some(name.clone());
    }
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    let expression = negative::as_operands(&mut inputs, &job.expression);
    let (options, scale) = options(args, unit, &inputs, target.as_ref())?;
    backend::check_built(args.backend)?;
    report.options = resolved(args, unit, &options);
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    if args.plan {
        return plan(job, &inputs, &expression, (&options, &scale), report);
    }
    target.iter_mut().for_each(|target| target.set_unit(unit));
    make(job, &expression, &inputs, (&options, &scale), target.as_ref(), session, report)
}

/// What the flags ask for, for these inputs.
pub(super) fn options(
    args: &SolidArgs,
    unit: Option<Unit>,
    inputs: &[Input],
    target: Option<&Target>,
) -> Result<(Options, Scale), Failure> {
    let bounds = inputs.iter().filter_map(|input| input.loaded.mesh.bounds()).reduce(|a, b| a.union(&b));
    let diagonal = bounds.as_ref().map_or(0.0, Bounds::diagonal);
    let voxel = args.voxels.size(unit, diagonal)?;
    let longest = bounds.map_or(0.0, |b| b.size().max_element());
    let scale = Scale { unit, diagonal, voxel: Some(voxel.spacing(longest)) };
    let options = Options {
        fit: fit(args, &scale, inputs)?,
        method: args.method.into(),
        orient: args.orient.into(),
        inside: args.inside.into(),
        tolerance: match args.tolerance {
            Some(Simplify::Off) => Some(0.0),
            Some(Simplify::Within(length)) => Some(length.resolve(&scale)?),
            None => None,
        },
        fill: args.fill.into(),
        vote: args.vote.into(),
        collapse: !args.no_collapse,
        // What the textures take is taken already.
        max_memory: machine::memory_cap(args.max_memory).map(|cap| cap.saturating_sub(input::held_by_textures(inputs))),
        backend: args.backend.into(),
        precision: target.map_or(Precision::Double, |target| Precision::of_format(target.options.format)),
        ..Options::new(voxel)
    };
    Ok((options, scale))
}

/// What `--no-fit`, `--rebuild` and `--simplify` ask for. Colours that vary within triangles would be smeared over the
/// large triangles of simplified flat parts, so with them all triangles are kept unless it is asked for.
fn fit(args: &SolidArgs, scale: &Scale, inputs: &[Input]) -> Result<Option<FitOptions>, Failure> {
    let varying = |input: &Input| matches!(input.loaded.colours, Some(Colours::Vertices(_) | Colours::Corners(_)));
    let usual = FitOptions::default();
    let simplify = match (args.simplify, scale.voxel) {
        (Some(Simplify::Off), _) => 0.0,
        (Some(Simplify::Within(length)), Some(h)) if h > 0.0 => length.resolve(scale)? / h,
        _ if inputs.iter().any(varying) => 0.0,
        _ => usual.simplify,
    };
    let simplify_kept = if args.simplify.is_some() { simplify } else { usual.simplify_kept };
    Ok((!args.no_fit).then_some(FitOptions { rebuild: args.rebuild, simplify, simplify_kept, ..usual }))
}

/// The options as the report states them, after defaults.
pub(super) fn resolved(args: &SolidArgs, unit: Option<Unit>, options: &Options) -> serde_json::Value {
    let (resolution, voxel) = match options.voxel {
        VoxelSize::Along(n) => (Some(n), None),
        VoxelSize::Length(length) => (None, Some(length)),
    };
    json!({
        "resolution": resolution,
        "voxel": voxel,
        "method": options.method,
        "preset": args.preset_in_words(),
        "voxel_as_given": args.voxels.voxel.map(|length| length.to_string()),
        "unit": unit.map(|unit| unit.to_string()),
        "orient": format!("{:?}", options.orient).to_lowercase(),
        "inside": options.inside,
        "tolerance": options.tolerance,
        "fill": format!("{:?}", args.fill).to_lowercase(),
        "vote": options.vote,
        "backend": options.backend,
        "collapse": options.collapse,
        "fit": options.fit.is_some(),
        "precision": options.precision,
        "simplify_voxels": options.fit.map(|fit| fit.simplify),
        "drop_smaller_as_given": args.drop_smaller.map(|volume| volume.to_string()),
        "simplify_as_given": args.simplify.map(|simplify| simplify.to_string()),
        "threads": rayon::current_num_threads(),
        "max_memory_bytes": args.max_memory,
        "timeout_seconds": args.common.timeout.map(|timeout| timeout.as_secs_f64()),
    })
}

pub(super) fn failure(error: &impl Advice, inputs: &[Input], unit: Option<Unit>, args: &SolidArgs) -> Failure {
    let labels: Vec<String> = inputs.iter().map(|input| input.label.clone()).collect();
    let unit = unit.map(|unit| unit.to_string());
    Failure::pipeline(
        error,
        &labels,
        unit.as_deref(),
        Asked { voxel: args.voxels.voxel.is_some(), memory: args.max_memory },
    )
}

fn plan(
    job: &Job<'_>,
    inputs: &[Input],
    expression: &Expression,
    (options, scale): (&Options, &Scale),
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let (args, unit) = (job.args, scale.unit);
    let failed = |e: &dyn Advice| failure(&e, inputs, unit, args);
    // Of negative parts the plan of a change knows nothing: their difference comes first.
    let operands = || inputs.iter().take(expression.operand_count()).map(|input| Operand::from(&input.loaded));
    let planned = |options: &Options| {
        let mesh = &inputs[0].loaded.mesh;
        if let Some(maker) = job.change.and_then(Change::instead) {
            return maker.plan(mesh, options, scale, &failed);
        }
        match (pipeline::plan(operands(), options), job.change) {
            (Ok(plan), Some(change)) => Ok(plan.then(change.plan(mesh, &options.surface(), scale, &failed)?)),
            (plan, _) => plan.map_err(|e| failed(&e)),
        }
    };
    let plan = planned(options)?;
    report.result = Some(RunResult::Plan { plan });
    if !args.common.json {
        let unit = unit.map(|unit| unit.to_string());
        let text = table::table(&summary::plan(&plan, unit.as_deref()));
        super::streams::write_stream(text.as_bytes())?;
    }
    if let Some(cap) = options.max_memory.filter(|&cap| plan.memory > cap && plan.least_memory <= cap) {
        report.warnings.push(format!(
            "about {} of memory may be needed, and {} can be had: a run that takes a quarter more than that is ended",
            words::bytes(plan.memory),
            words::bytes(cap)
        ));
    }
    match options.max_memory {
        Some(cap) if plan.least_memory > cap => {
            let coarsest = Options { voxel: VoxelSize::Along(2), ..*options };
            let alone = planned(&coarsest).is_ok_and(|plan| plan.least_memory > cap);
            let hint = if alone { INPUTS_ALONE } else { "a lower --resolution, or a larger voxel" };
            Err(Failure::memory(plan.least_memory, cap, args.max_memory).hint(hint))
        }
        _ => Ok(Exit::Done),
    }
}

fn make(
    job: &Job<'_>,
    expression: &Expression,
    inputs: &[Input],
    (options, scale): (&Options, &Scale),
    target: Option<&Target>,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let args = job.args;
    let unit = scale.unit;
    report.timed(Stage::Examine, |report| {
        session.progress.stage(Stage::Examine)?;
        let progress = &session.progress;
        inputs.par_iter().zip(&mut report.inputs).try_for_each(|(input, entry)| {
            entry.validity = Some(input::examine(&input.loaded, progress)?);
            Ok::<(), Failure>(())
        })
    })?;
    let operands: Vec<Operand<'_>> = inputs.iter().map(|input| (&input.loaded).into()).collect();
    let meshes: Vec<&TriMesh> = operands.iter().map(|operand| operand.mesh).collect();
    if let Ok(work) = Work::of(&meshes, options) {
        session.expect(&weights::of_solid(report.verb, &work, options.fit.as_ref()));
    }
    let failed = |e: &dyn Advice| failure(&e, inputs, unit, args);
    let (surface, progress) = (&options.surface(), &session.progress);
    let site = Site { operands: &operands, surface, scale, failed: &failed, progress };
    let Changed { mut outcome, mut canal_of } = made(job, expression, options, &site, report)?;
    if let Some(volume) = args.drop_smaller {
        let least = volume.resolve(scale)?;
        let dropped = pipeline::drop_smaller(outcome, operands.iter().copied(), least, &session.progress);
        let left;
        (outcome, left) = dropped.map_err(|e| failed(&e))?;
        if !canal_of.is_empty() {
            canal_of = left.into_iter().map(|t| canal_of[t]).collect();
        }
    }
    let opened = holes::opened(args, job.leave, &mut outcome, scale)?;
    report.stages.append(&mut outcome.report.stages);
    report.warnings.extend(outcome.report.warnings.iter().map(ToString::to_string));
    report.result = Some(RunResult::solid(outcome.report.clone()));
    let lost = limits::lost(report);
    let writes = target.is_some() || args.map.is_some();
    let withheld = writes && !lost.is_empty() && !args.keeps_partial();
    if let Some(path) = args.map.as_ref().filter(|_| !withheld) {
        let kinds = outcome.kinds(operands.iter().copied());
        let map = Map { mesh: &outcome.solid, kinds, canal_of: &canal_of };
        report.timed(Stage::Map, |_| map::write(path, &map.opened(opened.as_ref()), session))?;
    }
    show((inputs, &operands), &outcome, opened.as_ref(), &canal_of, session, report)?;
    if target.is_some_and(|target| session.desk_for(&target.path).is_some()) {
        let kinds = outcome.kinds(operands.iter().copied());
        lay_sources(&outcome, kinds, opened.as_ref(), session);
    }
    if let Some(target) = target.filter(|_| !withheld) {
        let written = match &opened {
            None => {
                let paint =
                    Paint { colours: outcome.colours.as_ref(), texture: outcome.texture.as_ref(), beside: None };
                write(&outcome.solid, paint, target, session, report)?
            }
            Some(opened) => write_open(opened, &outcome, &operands, target, session, report)?,
        };
        report.written(written);
    }
    let guessed = limits::guessed(report);
    report.warnings.extend(guessed.iter().cloned());
    report.warnings.extend(opened.as_ref().map(|_| holes::left_open(&outcome.report.holes)));
    let exit = epilogue::measured(session, report, args.max_memory);
    report.warnings.extend(lost.iter().filter(|_| !withheld).cloned());
    let name = unit.map(|unit| unit.to_string());
    summary::say(session, report, name.as_deref());
    change::list(job.change, report, &args.common, name.as_deref())?;
    if withheld {
        session.speak();
        return Err(keep::withheld(&lost, args.output.as_deref(), &doubts::better(report, name.as_deref())));
    }
    let is_whole = guessed.is_none() && lost.is_empty() && opened.is_none();
    Ok(if is_whole { exit } else { Exit::Limit })
}

/// The solid that is asked for.
pub(super) fn made(
    job: &Job<'_>,
    expression: &Expression,
    options: &Options,
    site: &Site<'_>,
    report: &mut RunReport,
) -> Result<Changed, Failure> {
    if let Some(maker) = job.change.and_then(Change::instead) {
        return maker.make(options, site, report).map(Changed::from);
    }
    let made = pipeline::boolean(site.operands.iter().copied(), expression, options, site.progress);
    match job.change {
        None => made.map(Changed::from).map_err(|e| (site.failed)(&e)),
        Some(change) => change.apply(made, site, report),
    }
}

/// Has the report show the result, where it is a page.
fn show(
    (inputs, operands): (&[Input], &[Operand<'_>]),
    outcome: &Outcome,
    opened: Option<&Opened>,
    canal_of: &[u32],
    session: &Session,
    report: &mut RunReport,
) -> Result<(), Failure> {
    let look = |report: &RunReport| {
        let kinds = outcome.kinds(operands.iter().copied());
        let (mesh, sources, kinds) = match opened {
            None => (outcome.solid.mesh(), outcome.sources.clone(), kinds),
            Some(Opened { mesh, triangles }) => {
                let of = triangles.iter().map(|&t| (outcome.sources[t as usize], kinds[t as usize]));
                let (sources, kinds) = of.unzip();
                (mesh, sources, kinds)
            }
        };
        let origin = Origin::Known(sources, kinds);
        page::of_solid(&SolidSeen { inputs, operands, mesh, origin, canal_of }, report, session)
    };
    session.show(report, look)
}

/// Tells the owner of a desk where the triangles of the result come from.
fn lay_sources(outcome: &Outcome, kinds: Vec<TriangleKind>, opened: Option<&Opened>, session: &Session) {
    match opened {
        None => session.lay_sources(outcome.sources.clone(), kinds),
        Some(opened) => {
            let (sources, kinds) =
                opened.triangles.iter().map(|&t| (outcome.sources[t as usize], kinds[t as usize])).unzip();
            session.lay_sources(sources, kinds);
        }
    }
}

/// Writes the result and judges the written file.
pub(super) fn write<'a>(
    solid: &'a Solid,
    paint: impl Into<Paint<'a>>,
    target: &Target,
    session: &Session,
    report: &mut RunReport,
) -> Result<OutputEntry, Failure> {
    let paint = paint.into();
    if let Some(desk) = session.desk_for(&target.path) {
        let validity = solid.validity().clone();
        desk.lay_mesh(solid, validity.clone(), &paint, target.options.unit);
        return Ok(OutputEntry { validity: Some(validity), ..in_memory(target.options.unit) });
    }
    write_judged((solid, paint), target, session, report, |read, stored, moved| {
        judge(read, solid, stored, moved, session)
    })
}

/// Writes what is left of a result in which holes are open.
fn write_open(
    opened: &Opened,
    outcome: &Outcome,
    operands: &[Operand<'_>],
    target: &Target,
    session: &Session,
    report: &mut RunReport,
) -> Result<OutputEntry, Failure> {
    let sources: Vec<_> = opened.triangles.iter().map(|&t| outcome.sources[t as usize]).collect();
    let colours = pipeline::carry_colours(&opened.mesh, &sources, operands);
    let texture = pipeline::carry_texture(&opened.mesh, &sources, operands);
    let paint = Paint { colours: colours.as_ref(), texture: texture.as_ref(), beside: None };
    if let Some(desk) = session.desk_for(&target.path) {
        let options = ValidateOptions { self_intersections: true, weld: false };
        let validity = validate(&opened.mesh, &options, &session.progress)?;
        desk.lay_mesh(&opened.mesh, validity.clone(), &paint, target.options.unit);
        return Ok(OutputEntry { validity: Some(validity), ..in_memory(target.options.unit) });
    }
    write_judged((&opened.mesh, paint), target, session, report, |read, (made, factor), _| {
        check_same(&read.mesh, made, factor)?;
        Ok(validate(&read.mesh, &read.validate_options(), &session.progress)?)
    })
}

/// Writes a mesh, reads it, and has it judged: with the mesh as the format holds it, the factor between the two, and how far vertices moved for it.
fn write_judged<'a>(
    (mesh, paint): (&'a TriMesh, Paint<'a>),
    target: &Target,
    session: &Session,
    report: &mut RunReport,
    judge: impl FnOnce(&Loaded, (&TriMesh, f64), Option<f64>) -> Result<Validity, Failure>,
) -> Result<OutputEntry, Failure> {
    report.warnings.extend(paint::lost(mesh, &paint, target));
    let arranged = Arranged::new(mesh, &paint, target.options.format);
    let (stored, moved) = stored(&arranged.mesh, target.options.format);
    if let Some(moved) = moved {
        report.warnings.push(rounding(moved, target.options.format));
    }
    // Of several frames it is said once.
    let of_unit = target.unit_note().filter(|note| !report.warnings.contains(note));
    report.warnings.extend(of_unit);
    let factor = target.options.factor();
    let (entry, validity) = report.timed(Stage::WriteAndVerify, |_| {
        write_verified(target, &stored, arranged.paint(), session, |read| judge(read, (&stored, factor), moved))
    })?;
    Ok(OutputEntry { validity: Some(validity), ..entry })
}

/// The mesh with the numbers that a format holds, and how far the farthest vertex moves for it, model units.
fn stored(mesh: &TriMesh, format: Format) -> (Cow<'_, TriMesh>, Option<f64>) {
    let moved = mesh.positions.iter().map(|&p| p.distance(rounded(p))).fold(0.0, f64::max);
    if !format.is_single() || moved == 0.0 {
        return (Cow::Borrowed(mesh), None);
    }
    let positions = mesh.positions.iter().map(|&p| rounded(p)).collect();
    (Cow::Owned(TriMesh { positions, triangles: mesh.triangles.clone() }), Some(moved))
}

fn rounding(moved: f64, format: Format) -> String {
    format!(
        "{format} holds single precision: so far from the origin it moves vertices by up to {}; OBJ, PLY, OFF and 3MF keep them",
        words::number(moved)
    )
}

/// Whether the file as read back holds the mesh that was made, times a factor, and keeps the program's promise. `moved`: how far
/// rounding to the numbers of the format moved vertices.
fn judge(
    read: &Loaded,
    solid: &Solid,
    (made, factor): (&TriMesh, f64),
    moved: Option<f64>,
    session: &Session,
) -> Result<Validity, Failure> {
    check_same(&read.mesh, made, factor)?;
    // Vertex for vertex it is the mesh that has been checked already.
    if !read.format.repeats_vertices() && *solid == read.mesh {
        return Ok(solid.validity().clone());
    }
    let validity = validate(&read.mesh, &read.validate_options(), &session.progress)?;
    if validity.is_valid() {
        return Ok(validity);
    }
    let failure = Failure::not_solid(&validity);
    Err(match moved {
        Some(moved) => failure.hint(format!(
            "{} moves vertices by up to {} so far from the origin: write OBJ, PLY, OFF or 3MF, or move the model to the origin first",
            read.format,
            words::number(moved)
        )),
        None => failure,
    })
}

/// Whether two meshes have the same triangles, in the same order, at exactly the same places, times a factor.
fn check_same(read: &TriMesh, made: &TriMesh, factor: f64) -> Result<(), Failure> {
    let same = read.triangles.len() == made.triangles.len()
        && (0..made.triangles.len()).all(|t| read.corners(t) == made.corners(t).map(|p| p * factor));
    if same { Ok(()) } else { Err(Failure::internal("the file does not hold what was written to it; it was removed")) }
}
