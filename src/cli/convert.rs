//! `convert IN -o OUT`: the same triangles in another format, or in another place and size.

use serde_json::json;

use super::choices::AnyFormat;
use super::convert_args::ConvertArgs;
use super::entries::OutputEntry;
use super::exit::{Exit, Failure};
use super::given::Given;
use super::keep::{self};
use super::output::write_verified;
use super::paint::{self, Arranged};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::target::Target;
use super::transform::{self};
use super::{grids, streams, words};
use crate::io::{Loaded, Paint};
use crate::mesh::{TriMesh, ValidateOptions, Validity, validate};
use crate::progress::Stage;

/// Reads one file and writes it again, scaled, turned and moved if that was asked for.
pub fn run(args: &ConvertArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut given = report
        .timed(Stage::Read, |report| Given::read(&[&args.input], &args.reading, None, session, &mut report.warnings))?;
    let unit = given.common_unit(&args.reading, &mut report.warnings);
    if !given.grids.is_empty() {
        return grids::convert(args, &given, unit, session, report);
    }
    let mut inputs = given.meshes;
    if let (None, Some(AnyFormat::Grid(_))) = (args.writing.out_format, AnyFormat::from_path(&args.output)) {
        return Err(grids::no_field(&streams::label(&args.input), &args.output));
    }
    let mut target = Target::new(&args.output, &args.writing)?;
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
    let Loaded { mesh, colours, texture, .. } = &input.loaded;
    let paint = Paint { colours: colours.as_ref(), texture: texture.as_ref(), beside: None };
    report.warnings.extend(paint::lost(mesh, &paint, &target));
    report.warnings.extend(target.unit_note());
    let placed = if done.is_some() { state(mesh, session)? } else { before.clone() };
    let arranged = Arranged::new(mesh, &paint, target.options.format);
    let (entry, after) = report.timed(Stage::WriteAndVerify, |_| {
        write_verified(&target, &arranged.mesh, arranged.paint(), session, |read| {
            check_close(read, &arranged.mesh, target.options.factor())?;
            paint::check_colours(read, &arranged.mesh, &arranged.paint())?;
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
    report.inputs[0].validity = Some(before);
    report.result = Some(RunResult::Conversion { output: OutputEntry { validity: Some(after.clone()), ..entry } });
    let lost = losses(&placed, &after);
    report.warnings.extend(lost.iter().cloned());
    session.clear_bar();
    session.say(&format!(
        "{}: {}, as {}{}{}",
        args.output.display(),
        words::plural(triangles, "triangle"),
        target.options.format,
        target.options.unit_in_file().map_or(String::new(), |unit| format!(", in {unit}")),
        done.map_or(String::new(), |done| format!("; {}", done.words(unit)))
    ));
    Ok(if lost.is_empty() { Exit::Done } else { Exit::Limit })
}

/// Counts that rounding could worsen; equal positions are one vertex, as STL has it anyway.
pub(super) fn state(mesh: &TriMesh, session: &Session) -> Result<Validity, Failure> {
    let options = ValidateOptions { self_intersections: false, weld: true };
    Ok(validate(mesh, &options, &session.progress)?)
}

/// Whether the file holds the mesh, times a factor, up to the rounding of its numbers.
pub(super) fn check_close(read: &Loaded, mesh: &TriMesh, factor: f64) -> Result<(), Failure> {
    let close = |a: glam::DVec3, b: glam::DVec3| (a - b).abs().max_element() <= 1e-6 * a.abs().max_element();
    let same = read.mesh.triangles.len() == mesh.triangles.len()
        && (0..mesh.triangles.len()).all(|t| {
            let (a, b) = (mesh.corners(t).map(|p| p * factor), read.mesh.corners(t));
            (0..3).all(|i| close(a[i], b[i]))
        });
    if same { Ok(()) } else { Err(Failure::internal("the file does not hold what was written to it; it was removed")) }
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
