//! `convert IN -o OUT`: the same triangles in another format.

use serde_json::json;

use super::args::ConvertArgs;
use super::choices::AnyFormat;
use super::exit::{Exit, Failure};
use super::given::Given;
use super::input;
use super::output::{Target, write_verified};
use super::report::{OutputEntry, RunReport};
use super::session::Session;
use super::{grids, keep, words};
use crate::io::{Carried, Colours, Format, Loaded};
use crate::mesh::{TriMesh, ValidateOptions, Validity, validate};

/// Reads one file and writes it again.
pub fn run(args: &ConvertArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut given = report
        .timed("read", |report| Given::read(&[&args.input], &args.reading, None, session, &mut report.warnings))?;
    let unit = given.common_unit(&args.reading, &mut report.warnings);
    if !given.grids.is_empty() {
        return grids::convert(args, &given, unit, session, report);
    }
    let inputs = given.meshes;
    if let (None, Some(AnyFormat::Grid(_))) = (args.writing.out_format, AnyFormat::from_path(&args.output)) {
        return Err(grids::no_field(&input::label(&args.input), &args.output));
    }
    let mut target = Target::new(&args.output, &args.writing)?;
    target.set_unit(unit);
    report.options = json!({
        "unit": unit.map(|unit| unit.to_string()),
        "ascii": args.writing.ascii,
        "out_format": target.options.format.to_string(),
    });
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let Some(input) = inputs.first() else { return Err(Failure::internal("nothing was read")) };
    if input.loaded.parts.len() > 1 {
        report.warnings.push(format!("the {} objects of the input become one", input.loaded.parts.len()));
    }
    let lost = |colours| lost_colours(colours, &input.loaded.mesh, target.options.format);
    report.warnings.extend(input.loaded.colours.as_ref().and_then(lost));
    report.warnings.extend(target.unit_note());
    let before = state(&input.loaded.mesh, session)?;
    let (entry, after) = report.timed("write and verify", |_| {
        write_verified(&target, &input.loaded.mesh, input.loaded.colours.as_ref(), session, |read| {
            check_close(read, &input.loaded.mesh, target.options.factor())?;
            check_colours(read, &input.loaded)?;
            let after = state(&read.mesh, session)?;
            let keeps = args.keeping.keep_partial || args.writing.force;
            match is_mostly_lost(&before, &after) && !keeps {
                true => Err(keep::withheld(
                    &losses(&before, &after),
                    Some(&args.output),
                    "obj, ply, off and 3mf keep all digits",
                )),
                false => Ok(after),
            }
        })
    })?;
    let triangles = after.triangles;
    report.inputs[0].validity = Some(before.clone());
    report.output = Some(OutputEntry { validity: Some(after.clone()), ..entry });
    let lost = losses(&before, &after);
    report.warnings.extend(lost.iter().cloned());
    session.clear_bar();
    session.say(&format!(
        "{}: {}, as {}{}",
        args.output.display(),
        words::plural(triangles, "triangle"),
        target.options.format,
        target.options.unit_in_file().map_or(String::new(), |unit| format!(", in {unit}"))
    ));
    Ok(if lost.is_empty() { Exit::Done } else { Exit::Limit })
}

/// Counts that rounding could worsen; equal positions are one vertex, as STL has it anyway.
fn state(mesh: &TriMesh, session: &Session) -> Result<Validity, Failure> {
    let options = ValidateOptions { self_intersections: false, weld: true };
    Ok(validate(mesh, &options, &session.progress)?)
}

/// Whether the file holds the mesh, times a factor, up to the rounding of its numbers.
fn check_close(read: &Loaded, mesh: &TriMesh, factor: f64) -> Result<(), Failure> {
    let close = |a: glam::DVec3, b: glam::DVec3| (a - b).abs().max_element() <= 1e-6 * a.abs().max_element();
    let same = read.mesh.triangles.len() == mesh.triangles.len()
        && (0..mesh.triangles.len()).all(|t| {
            let (a, b) = (mesh.corners(t).map(|p| p * factor), read.mesh.corners(t));
            (0..3).all(|i| close(a[i], b[i]))
        });
    if same { Ok(()) } else { Err(Failure::internal("the file does not hold what was written to it; it was removed")) }
}

/// Whether the file has the colours, where its format holds them.
fn check_colours(read: &Loaded, given: &Loaded) -> Result<(), Failure> {
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

/// More than this share of the triangles or vertices lost by rounding is no copy of the shape any more.
const MOST_LOST: f64 = 0.1;

/// Whether the rounding to the format's numbers has lost much of the shape.
fn is_mostly_lost(before: &Validity, after: &Validity) -> bool {
    let vertices = |validity: &Validity| validity.vertices - validity.unused_vertices;
    let share = |lost: usize, of: usize| lost as f64 > MOST_LOST * of as f64;
    share(after.degenerate_triangles.saturating_sub(before.degenerate_triangles), before.triangles)
        || share(vertices(before).saturating_sub(vertices(after)), vertices(before))
}

/// What the rounding to the format's numbers made worse.
fn losses(before: &Validity, after: &Validity) -> Vec<String> {
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
