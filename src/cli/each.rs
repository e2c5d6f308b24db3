//! `repair --each`: every object of a file by itself, and all else of the file as it is.

use std::collections::BTreeSet;
use std::slice;

use super::each_check::{self, Written};
use super::each_object::{self, Done, Mesh};
use super::entries::{AsideEntry, InputEntry, ObjectDone, ObjectEntry, PartEntry};
use super::exit::{Exit, Failure};
use super::input::{self, Input};
use super::output::{unencoded, write_judged};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::solid::{self, Job};
use super::streams::{is_stream, label, sha256};
use super::target::Target;
use super::{backend, each_words, epilogue, paint, summary, words};
use crate::io::{self, Format, Scene, Unit};
use crate::progress::Stage;

/// Repairs every object, or those that are picked, and writes the file.
pub fn run(job: &Job<'_>, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let args = job.args;
    args.check()?;
    let mut target = target(job)?;
    backend::check_built(args.backend)?;
    let (mut scene, entry) = report.timed(Stage::Read, |_| read(job, session))?;
    let label = entry.path.clone();
    report.inputs = vec![entry];
    report.warnings.extend(scene.warnings.iter().map(|warning| format!("{label}: {warning}")));
    let unit = unit(&scene, job, &label, &mut report.warnings);
    target.set_unit(unit);
    let picked = picked(job, &scene, &label)?;
    session.expect_frames(picked.len());
    let is_kept = scene.is_kept_by(target.options.format);
    let (mut entries, mut lost, mut is_whole) = (Vec::new(), BTreeSet::new(), true);
    for number in 0..scene.objects.len() {
        let mut entry = entry_of(&scene, number);
        if picked.contains(&number) {
            session.progress.check()?;
            let loses = scene.objects[number].loses.clone();
            is_whole &= work_on(&mut scene, number, &mut entry, (job, &target, unit), session, report)?;
            if entry.done == ObjectDone::Repaired {
                lost.extend(loses);
            }
        }
        entries.push(entry);
    }
    refuse_where_nothing_is_solid(&entries)?;
    if is_kept && !lost.is_empty() {
        let lost: Vec<String> = lost.into_iter().map(str::to_owned).collect();
        report.warnings.push(format!("repaired objects have no longer: {}", words::list(&lost)));
    }
    let aside = scene.aside.iter().map(|aside| AsideEntry { what: aside.what.clone(), name: aside.name.clone() });
    let aside = aside.collect();
    let format = scene.format;
    report.result = Some(RunResult::Objects { objects: entries, aside, output: None });
    write(scene, &target, session, report)?;
    let exit = epilogue::measured(session, report, args.max_memory);
    session.say(super::table::table(&each_words::rows(report, format, &target, unit)).trim_end());
    if session.verbose {
        let rows: Vec<_> = summary::stages(report).collect();
        session.say(super::table::table(&rows).trim_end());
    }
    Ok(if is_whole { exit } else { Exit::Limit })
}

/// Repairs an object, and notes what was done. Returns whether the result is what the object describes.
fn work_on(
    scene: &mut Scene,
    number: usize,
    entry: &mut ObjectEntry,
    (job, target, unit): (&Job<'_>, &Target, Option<Unit>),
    session: &Session,
    report: &mut RunReport,
) -> Result<bool, Failure> {
    let mut input = object_input(scene, number, report);
    let (options, scale) = solid::options(job.args, unit, slice::from_ref(&input), Some(target))?;
    if report.options.is_null() {
        report.options = solid::resolved(job.args, unit, &options);
    }
    input.entry.validity = Some(input::examine(&input.loaded, &session.progress)?);
    let is_kept = scene.is_kept_by(target.options.format);
    let repaired = each_object::repaired(job, &input, (&options, &scale), is_kept, session)?;
    report.stages.extend(repaired.stages);
    report.warnings.extend(repaired.warnings.iter().map(|warning| format!("{}: {warning}", input.label)));
    (entry.before, entry.pipeline) = (input.entry.validity.take(), repaired.pipeline);
    let mesh = match repaired.done {
        Done::Kept(mesh) => {
            entry.done = ObjectDone::Kept;
            mesh
        }
        Done::Repaired(mesh) => {
            entry.done = ObjectDone::Repaired;
            Some(mesh)
        }
        Done::Left(why) => {
            (entry.done, entry.why) = (ObjectDone::Left, Some(why));
            None
        }
    };
    if let Some(Mesh { mesh, colours, texture }) = mesh {
        scene.replace(number, mesh, colours, texture);
    }
    Ok(repaired.is_whole)
}

/// Where the result goes: a format that holds objects.
fn target(job: &Job<'_>) -> Result<Target, Failure> {
    if job.args.fill == super::choices::FillChoice::None {
        return Err(Failure::usage("--each makes a solid of every object, and --fill none leaves holes open")
            .hint("leave one of the two away"));
    }
    let Some(path) = job.args.output.as_deref() else {
        return Err(Failure::usage("where to write the result is not said: --output OUT"));
    };
    let target = Target::new(path, &job.args.writing)?;
    match target.options.format {
        format if format.has_objects() => Ok(target),
        format => Err(Failure::usage(format!("{format} holds one mesh, and --each keeps objects apart"))
            .hint("3mf, glb, gltf and obj hold objects; without --each all are fused into one solid")),
    }
}

/// The objects of the file.
fn read(job: &Job<'_>, session: &Session) -> Result<(Scene, InputEntry), Failure> {
    let Some(path) = job.paths.first() else { return Err(Failure::internal("there is no input")) };
    input::check_streams(&[path], session)?;
    session.progress.stage(Stage::Read)?;
    let bytes = input::bytes_of(path, &session.progress)?;
    let (label, name) = (label(path), (!is_stream(path)).then_some(*path));
    let reading = &job.args.reading;
    let scene = io::read_scene(&bytes, reading.in_format, name)
        .map_err(|error| input::unreadable(&label, is_stream(path), reading, &error))?;
    session.progress.check()?;
    let triangles = |object: Option<usize>| object.map_or(0, |n| scene.objects[n].mesh.triangles.len());
    let part = |part: &io::ScenePart| PartEntry { name: part.name.clone(), triangles: triangles(part.object) };
    let entry = InputEntry {
        path: label,
        name: None,
        format: scene.format.to_string(),
        bytes: Some(bytes.len() as u64),
        sha256: Some(sha256(&bytes)),
        unit: scene.unit.map(|unit| unit.to_string()),
        parts: scene.parts.iter().map(part).collect(),
        negative_parts: Vec::new(),
        warnings: scene.warnings.clone(),
        validity: None,
    };
    Ok((scene, entry))
}

/// The unit of the file; for one that states none that of `--unit`.
fn unit(scene: &Scene, job: &Job<'_>, label: &str, notes: &mut Vec<String>) -> Option<Unit> {
    match (scene.unit, job.args.reading.unit) {
        (Some(own), Some(asked)) if own != asked => {
            notes.push(format!("--unit {asked} is not used: {label} carries its own unit"));
            Some(own)
        }
        (own, asked) => own.or(asked),
    }
}

/// The numbers of the objects that are picked.
fn picked(job: &Job<'_>, scene: &Scene, label: &str) -> Result<BTreeSet<usize>, Failure> {
    let names: Vec<&str> = scene.parts.iter().map(|part| part.name.as_str()).collect();
    let Some(parts) = job.pick.map(|pick| pick.numbers(&names, label)).transpose()?.flatten() else {
        return Ok((0..scene.objects.len()).collect());
    };
    let object = |number: usize| {
        scene.parts[number].object.ok_or_else(|| {
            Failure::usage(format!(
                "the object {} (`{}`) moves with a skeleton and is not repaired",
                number + 1,
                names[number]
            ))
        })
    };
    parts.into_iter().map(object).collect()
}

fn entry_of(scene: &Scene, number: usize) -> ObjectEntry {
    ObjectEntry {
        name: scene.objects[number].name.clone(),
        places: scene.places_of(number),
        done: ObjectDone::NotPicked,
        why: None,
        before: None,
        after: None,
        pipeline: None,
    }
}

/// An object as the input of a pipeline.
fn object_input(scene: &Scene, number: usize, report: &RunReport) -> Input {
    let object = &scene.objects[number];
    let label = &report.inputs[0].path;
    let label = match object.name.as_str() {
        "" => format!("{label}, object {}", number + 1),
        name => format!("{label}, object {} (`{name}`)", number + 1),
    };
    let part = io::Part { name: object.name.clone(), triangles: 0..object.mesh.triangles.len() };
    let loaded = io::Loaded {
        mesh: object.mesh.clone(),
        colours: object.colours.clone(),
        texture: object.texture.clone(),
        legend: Vec::new(),
        scale: None,
        format: scene.format,
        unit: scene.unit,
        parts: vec![part],
        negative: None,
        warnings: Vec::new(),
    };
    let entry = InputEntry { path: label.clone(), parts: Vec::new(), ..report.inputs[0].clone() };
    Input { label, loaded, entry }
}

/// A file of which no object could be made a solid is not written.
fn refuse_where_nothing_is_solid(entries: &[ObjectEntry]) -> Result<(), Failure> {
    let done = |wanted: ObjectDone| entries.iter().filter(move |entry| entry.done == wanted);
    let first = done(ObjectDone::Left).find_map(|entry| entry.why.clone());
    match first {
        Some(why) if done(ObjectDone::Repaired).chain(done(ObjectDone::Kept)).next().is_none() => {
            let exit = if why.contains("--keep-partial") { Exit::Limit } else { Exit::Input };
            let all = words::plural(done(ObjectDone::Left).count(), "object");
            Err(Failure::new(exit, format!("nothing can be repaired of {all}; of the first: {why}")))
        }
        _ => Ok(()),
    }
}

/// Writes the scene, verified.
fn write(scene: Scene, target: &Target, session: &Session, report: &mut RunReport) -> Result<(), Failure> {
    let format = target.options.format;
    let is_kept = scene.is_kept_by(format);
    if !is_kept {
        report.warnings.extend(scene.lost_elsewhere.iter().cloned());
        report.warnings.extend(each_words::left_out(&scene.aside, format));
        report.warnings.extend(target.unit_note());
    }
    let count = scene.objects.len();
    let (scene, notes) = scene.suited_to(format).map_err(|problem| Failure::new(Exit::Memory, problem.to_string()))?;
    report.warnings.extend(notes);
    let flat = (format == Format::Obj).then(|| io::flattened(&scene));
    if let Some(flat) = &flat {
        let paint = io::Paint { colours: flat.colours.as_ref(), texture: flat.texture.as_ref(), beside: None };
        report.warnings.extend(paint::lost(&flat.mesh, &paint, target));
    }
    let RunReport { result, stages, .. } = report;
    let Some(RunResult::Objects { objects, output, .. }) = result else { return Ok(()) };
    let start = std::time::Instant::now();
    let written = Written { scene: &scene, target, is_kept };
    let (entry, validities) = write_judged(
        target,
        |beside, out| {
            io::encode_scene(&scene, &target.options, beside, out).map_err(|error| unencoded(&target.path, &error))
        },
        session,
        |bytes| each_check::judge(bytes, &written, objects, count, session),
    )?;
    if let Some(texture) = flat.as_ref().and_then(|flat| flat.texture.as_ref()) {
        paint::write_beside(target, texture, session)?;
    }
    for (entry, validity) in objects.iter_mut().zip(validities) {
        entry.after = validity;
    }
    *output = Some(entry);
    stages.push(crate::pipeline::StageTime { stage: Stage::WriteAndVerify, seconds: start.elapsed().as_secs_f64() });
    Ok(())
}
