//! `convert IN -o OUT`: the same triangles in another format, or in another place and size.

use serde_json::json;

use super::args::ConvertArgs;
use super::exit::{Exit, Failure};
use super::input;
use super::output::{Target, write_verified};
use super::report::{OutputEntry, RunReport};
use super::session::Session;
use super::{transform, words};
use crate::io::{Carried, Colours, Format, Loaded};
use crate::mesh::{TriMesh, ValidateOptions, Validity, validate};

/// Reads one file and writes it again, scaled, turned and moved if that was asked for.
pub fn run(args: &ConvertArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut target = Target::new(&args.output, &args.writing)?;
    let mut inputs =
        report.timed("read", |report| input::read_all(&[&args.input], &args.reading, session, &mut report.warnings))?;
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    target.set_unit(unit);
    report.options = json!({
        "unit": unit.map(|unit| unit.to_string()),
        "ascii": args.writing.ascii,
        "out_format": target.options.format.to_string(),
    });
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let Some(input) = inputs.first_mut() else { return Err(Failure::internal("nothing was read")) };
    let before = state(&input.loaded.mesh, session)?;
    let done = transform::apply(&args.transform, &mut input.loaded, unit)?;
    if let Some(done) = &done {
        report.options["transform"] = json!(done);
    }
    if input.loaded.parts.len() > 1 {
        report.warnings.push(format!("the {} objects of the input become one", input.loaded.parts.len()));
    }
    let lost = |colours| lost_colours(colours, &input.loaded.mesh, target.options.format);
    report.warnings.extend(input.loaded.colours.as_ref().and_then(lost));
    let placed = if done.is_some() { state(&input.loaded.mesh, session)? } else { before.clone() };
    let (entry, after) = report.timed("write and verify", |_| {
        write_verified(&target, &input.loaded.mesh, input.loaded.colours.as_ref(), session, |read| {
            check_close(read, &input.loaded.mesh)?;
            check_colours(read, &input.loaded)?;
            state(&read.mesh, session)
        })
    })?;
    let triangles = after.triangles;
    report.inputs[0].validity = Some(before);
    report.output = Some(OutputEntry { validity: Some(after.clone()), ..entry });
    let lost = losses(&placed, &after);
    report.warnings.extend(lost.iter().cloned());
    session.clear_bar();
    session.say(&format!(
        "{}: {}, as {}{}{}",
        args.output.display(),
        words::plural(triangles, "triangle"),
        target.options.format,
        unit.map_or(String::new(), |unit| format!(", in {unit}")),
        done.map_or(String::new(), |done| format!("; {}", done.words(unit)))
    ));
    Ok(if lost.is_empty() { Exit::Done } else { Exit::Limit })
}

/// Counts that rounding could worsen; equal positions are one vertex, as STL has it anyway.
pub(super) fn state(mesh: &TriMesh, session: &Session) -> Result<Validity, Failure> {
    let options = ValidateOptions { self_intersections: false, weld: true };
    Ok(validate(mesh, &options, &session.progress)?)
}

/// Whether the file holds the mesh, up to the rounding of its numbers.
pub(super) fn check_close(read: &Loaded, mesh: &TriMesh) -> Result<(), Failure> {
    let close = |a: glam::DVec3, b: glam::DVec3| (a - b).abs().max_element() <= 1e-6 * a.abs().max_element();
    let same = read.mesh.triangles.len() == mesh.triangles.len()
        && (0..mesh.triangles.len()).all(|t| {
            let (a, b) = (mesh.corners(t), read.mesh.corners(t));
            (0..3).all(|i| close(a[i], b[i]))
        });
    if same { Ok(()) } else { Err(Failure::internal("the file does not hold what was written to it; it was removed")) }
}

/// Whether the file has the colours, where its format holds them.
pub(super) fn check_colours(read: &Loaded, given: &Loaded) -> Result<(), Failure> {
    let Some(colours) = &given.colours else { return Ok(()) };
    let same = |found: &Colours| {
        (0..given.mesh.triangles.len()).all(|t| colours.corners(&given.mesh, t) == found.corners(&read.mesh, t))
    };
    match colours.carried_by(read.format, &given.mesh) {
        Carried::Wholly if !read.colours.as_ref().is_some_and(same) => {
            Err(Failure::internal("the file does not hold the colours that were written to it; it was removed"))
        }
        _ => Ok(()),
    }
}

/// What becomes of colours that the format has no place for.
pub(super) fn lost_colours(colours: &Colours, mesh: &TriMesh, format: Format) -> Option<String> {
    match colours.carried_by(format, mesh) {
        Carried::Wholly => None,
        Carried::Roughly => Some(format!("{format} has no place for colours of this kind; they were averaged")),
        Carried::Not => Some(format!("{format} holds no colours; they are left out")),
    }
}

/// What the rounding to the format's numbers made worse.
pub(super) fn losses(before: &Validity, after: &Validity) -> Vec<String> {
    let mut sentences = Vec::new();
    if after.degenerate_triangles > before.degenerate_triangles {
        let more = after.degenerate_triangles - before.degenerate_triangles;
        sentences.push(format!(
            "{} lost their area by rounding to the numbers of the format",
            words::plural(more, "triangle")
        ));
    }
    if after.vertices - after.unused_vertices < before.vertices - before.unused_vertices {
        let fewer = before.vertices - before.unused_vertices - (after.vertices - after.unused_vertices);
        sentences
            .push(format!("{} fell together by rounding to the numbers of the format", words::plural(fewer, "vertex")));
    }
    sentences
}
