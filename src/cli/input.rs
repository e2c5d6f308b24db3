//! Reading: files and standard input, their units and their state.

use std::io::Read;
use std::path::Path;

use rayon::prelude::*;

use super::entries::{InputEntry, PartEntry};
use super::exit::{Exit, Failure};
use super::session::Session;
use super::shared_args::InputArgs;
use super::streams::is_stream;
use super::streams::label;
use super::streams::plain_reason;
use super::streams::sha256;
use super::words;
use crate::io::{self, Loaded, Part, TextureMap, Unit};
use crate::mesh::{Validity, validate};
use crate::progress::{Progress, Stage};

/// One mesh as read.
pub struct Input {
    /// What the user called it: a path, or "standard input".
    pub label: String,
    /// The content.
    pub loaded: Loaded,
    /// Its entry in the report; the validity is filled in later.
    pub entry: InputEntry,
}

/// Bytes of memory that the textures of all inputs take.
pub fn held_by_textures(inputs: &[Input]) -> u64 {
    inputs.iter().filter_map(|input| input.loaded.texture.as_ref()).map(TextureMap::bytes).sum()
}

/// Reads every path, in order; the standard input at most once. What the readers found odd goes to `notes`, and so
/// does what the files would take away from the rest.
pub fn read_all(
    paths: &[&Path],
    args: &InputArgs,
    session: &Session,
    notes: &mut Vec<String>,
) -> Result<Vec<Input>, Failure> {
    let mut inputs = read_operands(paths, args, session, notes)?;
    inputs.iter_mut().for_each(|input| leave_out(input, notes));
    Ok(inputs)
}

/// The same, but the inputs keep what is to be taken away from them.
pub fn read_operands(
    paths: &[&Path],
    args: &InputArgs,
    session: &Session,
    notes: &mut Vec<String>,
) -> Result<Vec<Input>, Failure> {
    check_streams(paths, session)?;
    session.progress.stage(Stage::Read)?;
    let progress = &session.progress;
    let laid: Vec<Option<Loaded>> = paths.iter().map(|path| session.laid(path)).collect();
    let read = |(path, laid): (&&Path, Option<Loaded>)| {
        let mut own = Vec::new();
        let input = match laid {
            Some(loaded) => described(label(path), loaded, &mut own),
            None => mesh_of(path, &bytes_of(path, progress)?, args, progress, &mut own)?,
        };
        Ok((input, own))
    };
    // Each by itself: of several that fail the first is told.
    let read: Vec<Result<(Input, Vec<String>), Failure>> = paths.par_iter().zip(laid).map(read).collect();
    read.into_iter()
        .map(|input| {
            let (input, own) = input?;
            notes.extend(own);
            Ok(input)
        })
        .collect()
}

/// Refuses to read standard input twice, and what cannot be read.
pub fn check_streams(paths: &[&Path], session: &Session) -> Result<(), Failure> {
    match paths.iter().filter(|path| is_stream(path)).count() {
        0 | 1 => paths.iter().filter(|path| !session.holds(path)).try_for_each(|path| super::files::check_input(path)),
        _ => Err(Failure::usage("standard input (`-`) can be read only once")),
    }
}

/// All bytes of a path.
pub fn bytes_of(path: &Path, progress: &Progress) -> Result<Vec<u8>, Failure> {
    progress.check()?;
    let bytes = if is_stream(path) { read_stream() } else { std::fs::read(path) };
    let bytes = bytes.map_err(|e| match e.kind() {
        std::io::ErrorKind::OutOfMemory => {
            Failure::new(Exit::Memory, format!("{}: there is no room for it in memory", label(path)))
        }
        _ => Failure::input(format!("cannot read {}: {}", label(path), plain_reason(&e))),
    })?;
    progress.check()?;
    Ok(bytes)
}

/// The mesh in the bytes of a path. What the reader found odd goes to `notes`.
pub fn mesh_of(
    path: &Path,
    bytes: &[u8],
    args: &InputArgs,
    progress: &Progress,
    notes: &mut Vec<String>,
) -> Result<Input, Failure> {
    let label = label(path);
    let stream = is_stream(path);
    let name = (!stream).then_some(path);
    let loaded = io::read_bytes(bytes, args.in_format, name).map_err(|e| unreadable(&label, stream, args, &e))?;
    progress.check()?;
    let mut input = described(label, loaded, notes);
    input.entry.format = input.loaded.format.to_string();
    input.entry.bytes = Some(bytes.len() as u64);
    input.entry.sha256 = Some(sha256(bytes));
    Ok(input)
}

/// A mesh with its entry in the report, as one that lies in memory. What its reader found odd goes to `notes`.
pub fn described(label: String, loaded: Loaded, notes: &mut Vec<String>) -> Input {
    notes.extend(loaded.warnings.iter().map(|warning| format!("{label}: {warning}")));
    let entry = InputEntry {
        path: label.clone(),
        name: None,
        format: "memory".into(),
        bytes: None,
        sha256: None,
        unit: loaded.unit.map(|unit| unit.to_string()),
        parts: part_entries(&loaded.parts),
        negative_parts: loaded.negative.as_ref().map_or(Vec::new(), |negative| part_entries(&negative.parts)),
        warnings: loaded.warnings.clone(),
        validity: None,
    };
    Input { label, loaded, entry }
}

/// Parts as the report lists them.
pub fn part_entries(parts: &[Part]) -> Vec<PartEntry> {
    parts.iter().map(|part| PartEntry { name: part.name.clone(), triangles: part.triangles.len() }).collect()
}

fn read_stream() -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Why a file cannot be read.
pub(super) fn unreadable(label: &str, stream: bool, args: &InputArgs, error: &io::FileError) -> Failure {
    let text = error.to_string();
    let message = if text.contains(label) { text } else { format!("{label}: {text}") };
    let failure = Failure::input(message);
    match args.in_format {
        None if stream => failure.hint("--in-format says what standard input holds, for example --in-format stl"),
        Some(format) => failure.hint(format!("it was read as {format}, as --in-format says")),
        None => match error.hint() {
            Some(hint) => failure.hint(hint),
            None => failure,
        },
    }
}

/// The state of a mesh as its file holds it.
pub fn examine(loaded: &Loaded, progress: &Progress) -> Result<Validity, Failure> {
    Ok(validate(&loaded.mesh, &loaded.validate_options(), progress)?)
}

/// Brings all inputs to one unit and says which. Files that carry none are taken to be in
/// `--unit`, or in the unit of the others; nothing is rescaled without a line about it.
pub fn common_unit(inputs: &mut [Input], args: &InputArgs, notes: &mut Vec<String>) -> Option<Unit> {
    let unit = inputs.iter().find_map(|input| input.loaded.unit).or(args.unit)?;
    bring_to(unit, inputs, args, notes);
    Some(unit)
}

/// Brings all inputs to `unit` and says which.
pub fn bring_to(unit: Unit, inputs: &mut [Input], args: &InputArgs, notes: &mut Vec<String>) {
    let own: Vec<Unit> = inputs.iter().filter_map(|input| input.loaded.unit).collect();
    match args.unit {
        Some(asked) if own.len() == inputs.len() && own.iter().any(|unit| *unit != asked) => {
            notes.push(format!("--unit {asked} is not used: the files carry their own unit"));
        }
        _ => {}
    }
    for input in inputs {
        let own = match (input.loaded.unit, args.unit) {
            (Some(own), _) => own,
            (None, Some(asked)) => asked,
            (None, None) => {
                notes.push(without_unit(&input.label, unit));
                unit
            }
        };
        if own != unit {
            notes.push(rescaled(&input.label, own, unit));
        }
        input.loaded.rescale(own, unit);
    }
}

/// A line on an input in another unit than the rest.
pub fn rescaled(label: &str, own: Unit, unit: Unit) -> String {
    let factor = words::factor(own.metres() / unit.metres());
    let [own, unit] = [own, unit].map(words::several);
    format!("{label} is in {own}; it was rescaled to {unit} (times {factor})")
}

/// A line on an input without a unit beside others.
pub fn without_unit(label: &str, unit: Unit) -> String {
    format!("{label} carries no unit; its numbers are taken as {}", words::several(unit))
}

/// For what has nothing to subtract from: forgets the negative parts, and says which.
pub fn leave_out(input: &mut Input, notes: &mut Vec<String>) {
    if input.loaded.negative.take().is_some() {
        notes.push(format!(
            "{}: {} left out; repair and the booleans subtract them",
            input.label,
            named(&input.entry.negative_parts)
        ));
    }
}

/// "2 negative parts (`a`, `b`)".
fn named(parts: &[PartEntry]) -> String {
    let names: Vec<String> =
        parts.iter().filter(|part| !part.name.is_empty()).map(|part| format!("`{}`", part.name)).collect();
    let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
    format!("{}{names}", words::plural(parts.len(), "negative part"))
}
