//! `field EXPR NAME=FILE... -o OUT`: shapes and lattices of values by an expression.

use std::path::Path;
use std::sync::Arc;

use serde_json::json;

use super::csg::{explain, named_files};
use super::epilogue;
use super::exit::{Asked, Exit, Failure};
use super::field_args::FieldArgs;
use super::field_places::{Place, targets};
use super::given::{Given, Which};
use super::length::{BandChoice, Length, Scale, Simplify};
use super::report::RunReport;
use super::result::{FrameEntry, RunResult};
use super::session::Session;
use super::table::Row;
use super::target::Target;
use super::words::{self, UnitName};
use super::{dropped, input, machine, sdf, solid, summary};
use crate::field::Sampled;
use crate::field::language::{self, LanguageError, Node, Value};
use crate::fit::FitOptions;
use crate::io::{Colours, GridFormat, GridValues, Paint, Unit, WriteOptions};
use crate::mesh::Bounds;
use crate::picture::ramp_colour;
use crate::pipeline::{
    self, Built, FieldBand, FieldBuilder, FieldError, FieldOperand, FieldReport, LimitError, Operand, Options, Outcome,
    Precision, VoxelSize,
};
use crate::progress::Stage;

/// Values in a lattice reach so far from the surface, voxels, unless it is said otherwise.
const USUAL_BAND: f64 = 4.0;

/// Makes what the expression says of the named files.
pub fn run(args: &FieldArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let files = named_files(&args.operands)?;
    let texts = Texts::parse(args, &files)?;
    let paths: Vec<&Path> = files.iter().map(|(_, path)| *path).collect();
    let targets = targets(args)?;
    session.expect_frames(targets.len());
    let mut given = report.timed(Stage::Read, |report| {
        Given::read(&paths, &args.reading, args.max_memory, session, &mut report.warnings)
    })?;
    let unit = given.common_unit(&args.reading, &mut report.warnings);
    given.describe(report);
    for (entry, (name, _)) in report.inputs.iter_mut().zip(&files) {
        entry.name = Some(name.to_string());
    }
    report.timed(Stage::Examine, |report| {
        session.progress.stage(Stage::Examine)?;
        for (which, entry) in given.order.iter().zip(&mut report.inputs) {
            if let Which::Mesh(n) = *which {
                entry.validity = Some(input::examine(&given.meshes[n].loaded, &session.progress)?);
            }
        }
        Ok::<(), Failure>(())
    })?;
    let lattices = lattices(&mut given, args.max_memory)?;
    let operands = operands(&given, &lattices);
    let held: u64 = operands.iter().map(FieldOperand::memory).sum();
    let bounds = operands.iter().filter_map(FieldOperand::bounds).reduce(|a, b| a.union(&b));
    let scale = scale(args, unit, bounds.as_ref())?;
    let options = options(args, &scale, &given, held)?;
    report.options = resolved(args, unit, &options, &scale);
    let mut run = Run {
        args,
        texts: &texts,
        scale: &scale,
        given: &given,
        options: &options,
        held,
        session,
        builder: FieldBuilder::new(&operands, &options, &session.progress),
    };
    for (number, target) in targets.iter().enumerate() {
        run.frame(number, targets.len(), target, report)?;
    }
    let exit = epilogue::measured(session, report, args.max_memory);
    say(session, report, targets.len(), unit);
    Ok(exit)
}

/// The lattices of the expression, in one unit, by the numbers of the grids: the values of the files go over to them.
fn lattices(given: &mut Given, max_memory: Option<u64>) -> Result<Vec<Arc<Sampled>>, Failure> {
    let mut lattices: Vec<Arc<Sampled>> = Vec::new();
    let mut held = 0;
    for n in 0..given.grids.len() {
        let needed = held + given.held() + Sampled::memory_of_file(&given.grids[n].file);
        if let Some(cap) = max_memory.filter(|&cap| needed > cap) {
            return Err(
                Failure::memory(needed, cap, max_memory).hint("for the lattices that are read; a larger --max-memory")
            );
        }
        let grid = &mut given.grids[n];
        let sampled = Sampled::of_file(&grid.file, grid.factor);
        grid.file.values = GridValues::Dense(Vec::new());
        held += sampled.memory();
        lattices.push(Arc::new(sampled));
    }
    Ok(lattices)
}

/// The operands of the expression, in the order given.
fn operands<'a>(given: &'a Given, lattices: &[Arc<Sampled>]) -> Vec<FieldOperand<'a>> {
    let operand = |which: &Which| match *which {
        Which::Mesh(n) => FieldOperand::Mesh((&given.meshes[n].loaded).into()),
        Which::Grid(n) => FieldOperand::Grid(lattices[n].clone()),
    };
    given.order.iter().map(operand).collect()
}

/// The expressions, parsed.
struct Texts<'a> {
    names: Vec<&'a str>,
    field: (&'a str, Node),
    paint: Option<(&'a str, Node)>,
}

impl<'a> Texts<'a> {
    fn parse(args: &'a FieldArgs, files: &[(&'a str, &'a Path)]) -> Result<Self, Failure> {
        let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
        let one = |text: &'a str| match language::parse_some(text, &names) {
            Ok(node) => Ok((text, node)),
            Err(error) => Err(explain(text, &error)),
        };
        let (field, paint) = (one(&args.expression)?, args.paint.as_deref().map(one).transpose()?);
        let texts = Self { names, field, paint };
        let mut used = texts.field.1.operands();
        used.extend(texts.paint.iter().flat_map(|(_, node)| node.operands()));
        let unused = texts.names.iter().enumerate().filter(|(n, _)| !used.contains(n));
        let unused: Vec<String> = unused.map(|(_, name)| name.to_string()).collect();
        if !unused.is_empty() {
            return Err(explain(&args.expression, &LanguageError::UnusedNames { names: unused }));
        }
        match (texts.frame(), args.frames) {
            (Some((text, at)), None) => Err(explain(text, &LanguageError::NoFrame { at })),
            (None, Some(_)) => {
                let failure = Failure::usage("--frames makes a sequence, and the expression has no `t` that changes");
                Err(failure.hint("for example 'morph(a, b, t)'"))
            }
            _ => Ok(texts),
        }
    }

    /// Where `t` stands.
    fn frame(&self) -> Option<(&'a str, usize)> {
        let all = std::iter::once(&self.field).chain(&self.paint);
        all.into_iter().find_map(|(text, node)| Some((*text, node.frame()?.start)))
    }
}

/// What lengths are measured against; without operands only lengths in model units mean something.
fn scale(args: &FieldArgs, unit: Option<Unit>, bounds: Option<&Bounds>) -> Result<Scale, Failure> {
    let diagonal = bounds.map_or(0.0, |bounds| bounds.diagonal());
    let base = Scale { unit, diagonal, voxel: None };
    let voxel = match (&args.voxels.voxel, bounds) {
        (Some(length), _) => Some(length.resolve(&base)?),
        (None, Some(bounds)) => Some(bounds.size().max_element() / f64::from(args.voxels.resolution)),
        (None, None) => None,
    };
    Ok(Scale { voxel, ..base })
}

fn options(args: &FieldArgs, scale: &Scale, given: &Given, held: u64) -> Result<Options, Failure> {
    let voxel = match (&args.voxels.voxel, scale.voxel) {
        (Some(_), Some(h)) => VoxelSize::Length(h),
        _ => VoxelSize::Along(args.voxels.resolution),
    };
    let usual = FitOptions::default();
    // Colours that vary are kept apart by the vertices. Lengths are measured when the voxel is known.
    let keeps_all = args.simplify == Some(Simplify::Off) || args.simplify.is_none() && args.paint.is_some();
    let simplify = if keeps_all { 0.0 } else { usual.simplify };
    Ok(Options {
        fit: (!args.no_fit).then_some(FitOptions { simplify, ..usual }),
        orient: args.orient.into(),
        inside: args.inside.into(),
        collapse: !args.no_collapse,
        // What the lattices and textures of the files take is taken already.
        max_memory: machine::memory_cap(args.max_memory)
            .map(|cap| cap.saturating_sub(held + input::held_by_textures(&given.meshes))),
        ..Options::new(voxel)
    })
}

/// The options as the report states them, after defaults.
fn resolved(args: &FieldArgs, unit: Option<Unit>, options: &Options, scale: &Scale) -> serde_json::Value {
    json!({
        "expression": args.expression,
        "paint": args.paint,
        "frames": args.frames,
        "voxel": scale.voxel,
        "resolution": args.voxels.voxel.is_none().then_some(args.voxels.resolution),
        "band": args.band.map(|band| band.to_string()),
        "unit": unit.map(|unit| unit.to_string()),
        "orient": format!("{:?}", options.orient).to_lowercase(),
        "inside": options.inside,
        "collapse": options.collapse,
        "fit": options.fit.is_some(),
        "simplify_as_given": args.simplify.map(|simplify| simplify.to_string()),
        "threads": rayon::current_num_threads(),
        "max_memory_bytes": args.max_memory,
        "timeout_seconds": args.common.timeout.map(|timeout| timeout.as_secs_f64()),
    })
}

struct Run<'a> {
    args: &'a FieldArgs,
    texts: &'a Texts<'a>,
    scale: &'a Scale,
    given: &'a Given,
    options: &'a Options,
    /// Bytes that the operands' lattices take.
    held: u64,
    session: &'a Session,
    builder: FieldBuilder<'a>,
}

impl Run<'_> {
    fn frame(&mut self, number: usize, frames: usize, place: &Place, report: &mut RunReport) -> Result<(), Failure> {
        let share = if frames > 1 { number as f64 / (frames - 1) as f64 } else { 0.0 };
        let built = self.build(&self.texts.field, share)?;
        match place {
            Place::Mesh(target) => self.mesh(&built, share, target, report)?,
            Place::Grid(path, format) => self.grid(&built, path, *format, report)?,
        }
        if frames > 1 {
            self.session.tell(&format!("frame {} of {frames}: {}", number + 1, place.path().display()));
        }
        Ok(())
    }

    fn build(&mut self, (text, node): &(&str, Node), share: f64) -> Result<Built, Failure> {
        let named = |error: LanguageError| explain(text, &error);
        let node: Node<Value> = node
            .at_frame(share)
            .and_then(|node| node.resolve(|value, suffix| length(value, suffix, self.scale)))
            .map_err(named)?;
        self.builder.build(&node).map_err(|e| self.failure(&e))
    }

    fn failure(&self, error: &FieldError) -> Failure {
        let labels = self.given.labels();
        let unit = self.scale.unit.map(|unit| unit.to_string());
        if let (FieldError::Limit(LimitError::Memory { needed, .. }), Some(cap), 1..) =
            (error, self.args.max_memory, self.held)
        {
            let lattices = words::bytes(self.held);
            let hint = format!("a larger voxel; the lattices that were read take {lattices} of it");
            return Failure::memory(needed.saturating_add(self.held), cap, self.args.max_memory).hint(hint);
        }
        let asked = Asked { voxel: self.args.voxels.voxel.is_some(), memory: self.args.max_memory };
        Failure::pipeline(error, &labels, unit.as_deref(), asked)
    }

    fn mesh(&mut self, built: &Built, share: f64, target: &Target, report: &mut RunReport) -> Result<(), Failure> {
        let progress = &self.session.progress;
        let precision = Precision::of_format(target.options.format);
        let options = Options { precision, ..self.simplified(built)? };
        let made = pipeline::field_surface(built, &options, progress);
        let (mut outcome, account) = made.map_err(|e| self.failure(&e))?;
        let mut smaller = None;
        if let Some(volume) = self.args.drop_smaller {
            let scale = Scale { voxel: Some(outcome.lattice.h), ..*self.scale };
            let least = volume.resolve(&scale)?;
            (outcome, _) = self.dropped(outcome, least)?;
            smaller = Some(outcome.report.smaller);
        }
        report.options["voxel"] = json!(outcome.lattice.h);
        report.stages.append(&mut outcome.report.stages);
        let fit = outcome.report.fit.take();
        note(report, FrameEntry { field: account, fit, smaller, distance: None, output: None });
        let operands = self.given.operands();
        let paint = match &self.texts.paint {
            Some(text) => {
                let built = self.build(text, share)?;
                let values = pipeline::field_values(&built.field, &outcome.solid.positions);
                Some(painted(&values, self.args.paint_range, report))
            }
            None => pipeline::carry_colours(&outcome.solid, &outcome.sources, &operands),
        };
        let target =
            Target { path: target.path.clone(), options: WriteOptions { unit: self.scale.unit, ..target.options } };
        let carried = || pipeline::carry_texture(&outcome.solid, &outcome.sources, &operands);
        let texture = self.texts.paint.is_none().then(carried).flatten();
        let paint = Paint { colours: paint.as_ref(), texture: texture.as_ref(), beside: None };
        let written = solid::write(&outcome.solid, paint, &target, self.session, report)?;
        report.written(written);
        Ok(())
    }

    fn dropped(&self, outcome: Outcome, least: f64) -> Result<(Outcome, Vec<usize>), Failure> {
        let none: [Operand<'_>; 0] = [];
        let asked = Asked { voxel: self.args.voxels.voxel.is_some(), memory: self.args.max_memory };
        pipeline::drop_smaller(outcome, none, least, &self.session.progress)
            .map_err(|e| Failure::pipeline(&e, &self.given.labels(), None, asked))
    }

    /// The options with `--simplify` in voxels of the lattice that the surface will be made on.
    fn simplified(&self, built: &Built) -> Result<Options, Failure> {
        let mut options = *self.options;
        if let (Some(Simplify::Within(length)), Some(fit)) = (self.args.simplify, &mut options.fit) {
            let h = pipeline::field_spacing(built, self.options).map_err(|e| self.failure(&e))?;
            fit.simplify = length.resolve(&Scale { voxel: Some(h), ..*self.scale })? / h;
        }
        Ok(options)
    }

    fn grid(&self, built: &Built, path: &Path, format: GridFormat, report: &mut RunReport) -> Result<(), Failure> {
        let band = match self.args.band {
            Some(BandChoice::Full) => FieldBand::Full,
            Some(BandChoice::Within(Length::Voxels(count))) => FieldBand::Voxels(count),
            Some(BandChoice::Within(length)) => FieldBand::Length(length.resolve(self.scale)?),
            None if self.texts.field.1.is_measure() => FieldBand::Full,
            None => FieldBand::Voxels(USUAL_BAND),
        };
        let made = pipeline::field_grid(built, band, self.options, &self.session.progress);
        let mut outcome = made.map_err(|e| self.failure(&e))?;
        report.stages.append(&mut outcome.report.stages);
        let output = Some(sdf::write(path, &outcome, self.scale.unit, format, self.session, report)?);
        let field = FieldReport { operands: built.operands.clone(), ..FieldReport::default() };
        note(report, FrameEntry { field, fit: None, smaller: None, distance: Some(outcome.report), output });
        Ok(())
    }
}

/// One more result.
fn note(report: &mut RunReport, frame: FrameEntry) {
    match &mut report.result {
        Some(RunResult::Field { frames }) => frames.push(frame),
        other => *other = Some(RunResult::Field { frames: vec![frame] }),
    }
}

/// A length of an expression in model units.
fn length(value: f64, suffix: &str, scale: &Scale) -> Result<f64, String> {
    if value == 0.0 {
        return Ok(0.0);
    }
    let length: Length = format!("{}{suffix}", value.abs()).parse().map_err(|e| format!("{e}"))?;
    let unmeasured = scale.diagonal <= 0.0 && matches!(length, Length::Percent(_));
    if unmeasured || scale.voxel.is_none() && matches!(length, Length::Voxels(_)) {
        return Err(format!(
            "`{length}` cannot be measured: no file is given{}",
            match length {
                Length::Voxels(_) => ", and no --voxel",
                _ => "",
            }
        ));
    }
    length.resolve(scale).map(|length| length.copysign(value)).map_err(|e| e.to_string())
}

/// The colours of the values, and a line on what they stand for.
fn painted(values: &[f64], range: Option<(f64, f64)>, report: &mut RunReport) -> Colours {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) =
        range.unwrap_or_else(|| (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)));
    let note =
        format!("colours stand for values from {} (violet) to {} (yellow)", words::number(low), words::number(high));
    if !report.warnings.contains(&note) {
        report.warnings.push(note);
    }
    let size = if high == low { 1.0 } else { high - low };
    let colour = |value: &f64| {
        let [r, g, b] = ramp_colour((value - low) / size);
        [r, g, b, 255]
    };
    Colours::Vertices(values.iter().map(colour).collect())
}

/// Says what was read, what became of it, and what came out.
fn say(session: &Session, report: &RunReport, frames: usize, unit: Option<Unit>) {
    let name = unit.map(|unit| unit.to_string());
    let unit: UnitName<'_> = name.as_deref();
    let mut rows: Vec<Row> = summary::input_rows(report);
    let last = match &report.result {
        Some(RunResult::Field { frames }) => frames.last(),
        _ => None,
    };
    if let Some(frame) = last {
        for operand in &frame.field.operands {
            let label = report.inputs.get(operand.operand).and_then(|input| input.name.clone()).unwrap_or_default();
            let how = match operand.made {
                "exact" => "its exact distance",
                "repaired" => "repaired first, then its exact distance",
                "robust" => "the smooth distance of a repair",
                "levels" => "distance with sides level by level",
                _ => "its values, interpolated",
            };
            rows.push(("done", format!("{label}: {how}")));
        }
        let smaller = frame.smaller.as_ref().and_then(|smaller| dropped::smaller(smaller, unit));
        rows.extend(smaller.map(|text| ("dropped", text)));
    }
    if let Some(distance) = last.and_then(|frame| frame.distance.as_ref()) {
        rows.push(("voxel", summary::voxel(distance.voxel, distance.dims, unit)));
        let [low, high] = distance.range.map(|value| words::number(value.into()));
        if let Some(output) = report.output() {
            rows.push(("result", format!("{}: {low} to {high}; {}", output.path, words::bytes(output.bytes))));
        }
    }
    if frames > 1 {
        rows.push(("frames", words::count(frames)));
    }
    rows.extend(summary::result_rows(report, unit));
    epilogue::say(session, report, rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_keep_their_sign_and_need_something_to_be_measured_by() {
        let scale = Scale { unit: None, diagonal: 50.0, voxel: Some(0.25) };
        assert_eq!(length(-2.0, "h", &scale), Ok(-0.5));
        assert_eq!(length(0.0, "mm", &scale), Ok(0.0));
        assert_eq!(length(2.0, "%", &scale), Ok(1.0));
        assert!(length(1.0, "mm", &scale).unwrap_err().contains("unit"));
        let nothing = Scale { unit: None, diagonal: 0.0, voxel: None };
        assert!(length(1.0, "%", &nothing).is_err() && length(1.0, "h", &nothing).is_err());
        assert_eq!(length(-3.0, "", &nothing), Ok(-3.0));
    }
}
