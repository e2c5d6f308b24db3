//! The command to type after `inspect`.

use super::entries::{DetailEntry, NextEntry};
use super::input::Input;
use super::inspect_args::InspectArgs;
use super::session::Session;
use super::typed::{line, named};
use super::words::{self, UnitName};
use crate::mesh::Validity;
use crate::pipeline::Foresight;

/// Above this share of walls or gaps under two voxels a smaller voxel is worth it: rays that graze edges make up to about 0.04 of short spans on any shape.
const WORTH: f64 = 0.05;

/// No smaller voxel is proposed than makes so many of them along the longest side.
const FINEST: f64 = 1024.0;

/// Of a valid mesh, and of one without any surface.
pub fn without_repair(validity: &Validity) -> Vec<NextEntry> {
    let what = match validity.is_valid() {
        true => "nothing to repair: it is a closed, oriented solid",
        false => "nothing can be made of it: no triangle has an area",
    };
    vec![NextEntry { command: None, what: what.into() }]
}

/// Of a mesh that is no solid: the likeliest first.
pub fn of_broken(
    args: &InspectArgs,
    (input, validity): (&Input, &Validity),
    (foresight, detail): (&Foresight, &DetailEntry),
    unit: UnitName<'_>,
    session: &Session,
) -> Vec<NextEntry> {
    let path = args.input.to_string_lossy();
    // A mesh that lies in memory has no name to type.
    let is_typed = session.command().is_some();
    // What begins as a flag would be taken for one.
    let file = if path.starts_with('-') && path != "-" { format!("./{path}") } else { path.into_owned() };
    let entry = |verb: &str, made: &str, flags: Vec<String>, what: String| {
        let output = match file.as_str() {
            "-" => format!("{made}.{}", input.loaded.format),
            file => named(file, made),
        };
        let words = [verb.into(), file.clone(), "-o".into(), output].into_iter();
        let command = line(words.chain(flags).chain(reading(args)));
        NextEntry { command: is_typed.then_some(command), what }
    };
    if detail.sheet {
        let least = if args.voxels.is_set() { "5h" } else { "2%" };
        let flags = [vec!["--min".into(), least.into()], voxels(args)].concat();
        let what = "makes a wall of it: it is an open surface that encloses nothing, of which `repair` makes no solid";
        return vec![entry("thicken", "thick", flags, what.into())];
    }
    let (flags, what) = match finer(detail, foresight, unit) {
        Some(voxel) => {
            let what =
                format!("makes a solid of it; a voxel of {voxel} is half of what 99 % of the walls and gaps measure");
            (vec!["--voxel".into(), voxel], what)
        }
        None if validity.is_oriented_manifold() && validity.volume < 0.0 => {
            (voxels(args), "turns it over: it is inside out".into())
        }
        None => (voxels(args), "makes a solid of it".into()),
    };
    let mut next = vec![entry("repair", "repaired", flags.clone(), what)];
    let objects = input.loaded.parts.len();
    if objects > 1 && input.loaded.format.has_objects() {
        let what = format!("repairs {} one by one, and keeps them apart", words::plural(objects, "object"));
        next.push(entry("repair", "repaired", [vec!["--each".into()], flags.clone()].concat(), what));
    }
    let buried = foresight.standing.left_out;
    if buried > 0 {
        let what = format!(
            "makes a void of what lies inside others and is left out else: {}",
            words::plural(buried, "surface")
        );
        next.push(entry("repair", "repaired", [vec!["--inside".into(), "odd".into()], flags].concat(), what));
    }
    next
}

/// The flags for the size of voxels, where it is not the usual one.
fn voxels(args: &InspectArgs) -> Vec<String> {
    match (args.voxels.voxel, args.voxels.resolution) {
        (Some(length), _) => vec!["--voxel".into(), length.to_string()],
        (None, _) if !args.voxels.is_set() => Vec::new(),
        (None, resolution) => vec!["--resolution".into(), resolution.to_string()],
    }
}

/// The flags that say how the file is read.
fn reading(args: &InspectArgs) -> Vec<String> {
    let format = args.reading.in_format.iter().flat_map(|format| ["--in-format".into(), format.to_string()]);
    format.chain(args.reading.unit.iter().flat_map(|unit| ["--unit".into(), unit.to_string()])).collect()
}

/// A smaller voxel that holds nearly all walls and gaps, where many would not be held.
fn finer(detail: &DetailEntry, foresight: &Foresight, unit: UnitName<'_>) -> Option<String> {
    let worth = detail.thin.is_some_and(|[low, _]| low >= WORTH);
    let keeps = detail.voxel_that_keeps.filter(|&keeps| worth && keeps < foresight.plan.voxel)?;
    let along = foresight.plan.dims.into_iter().max().map_or(0.0, f64::from) * foresight.plan.voxel / keeps;
    (along <= FINEST).then(|| words::with_unit(&words::rounded_down(keeps), unit).replace(' ', ""))
}
