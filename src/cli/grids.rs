//! `inspect` and `convert` for lattices of values.

use std::path::Path;

use serde_json::json;

use super::choices::AnyFormat;
use super::convert_args::ConvertArgs;
use super::entries::GridEntry;
use super::exit::{Exit, Failure};
use super::given::Given;
use super::inspect_args::InspectArgs;
use super::meant;
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::slice::GridInput;
use super::streams::{self, is_direct};
use super::table::{self, Row};
use super::target::{self, GRID_ENDINGS};
use super::words::{self, UnitName};
use super::{machine, output};
use crate::io::{DistanceSamples, Format, GridFile, GridFormat, GridMeasures, GridValues, Unit};
use crate::progress::Stage;

impl GridEntry {
    fn of(file: &GridFile, measures: &GridMeasures) -> Self {
        Self {
            dims: file.dims,
            origin: file.origin.to_array(),
            spacing: file.spacing,
            band: file.band,
            range: measures.range.map(f64::from),
            inside: measures.below_zero,
            inside_volume: measures.below_zero as f64 * file.spacing.powi(3),
            stored: measures.stored,
        }
    }
}

/// Looks at one lattice and prints a table.
pub fn inspect(
    args: &InspectArgs,
    given: &Given,
    unit: Option<Unit>,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let Some(grid) = given.grids.first() else { return Err(Failure::internal("nothing was read")) };
    if args.thickness || !args.fail_on.is_empty() || args.voxels.is_set() {
        let what = "--thickness, --fail-on, --resolution and --voxel are about the triangles of a mesh, and a lattice has none";
        return Err(Failure::usage(format!("{}: {what}", grid.entry.path)));
    }
    report.options = json!({ "unit": unit.map(|unit| unit.to_string()) });
    given.describe(report);
    let found = report.timed(Stage::Examine, |_| {
        session.progress.stage(Stage::Examine)?;
        Ok::<_, Failure>(GridEntry::of(&grid.file, &grid.file.measures()))
    })?;
    report.result = Some(RunResult::Lattice { grid: found.clone() });
    session.clear_bar();
    if !args.common.json {
        let name = unit.map(|unit| unit.to_string());
        streams::write_stream(table::table(&rows(grid, &found, name.as_deref())).as_bytes())?;
    }
    Ok(Exit::Done)
}

fn rows(grid: &GridInput, found: &GridEntry, unit: UnitName<'_>) -> Vec<Row> {
    let entry = &grid.entry;
    let [x, y, z] = found.dims;
    let all: usize = found.dims.iter().product();
    let last: [f64; 3] = std::array::from_fn(|k| found.origin[k] + found.spacing * (found.dims[k] - 1) as f64);
    let size: [f64; 3] = std::array::from_fn(|k| last[k] - found.origin[k]);
    let place = |p: [f64; 3]| p.map(words::number).join(" ");
    let [low, high] = found.range.map(words::number);
    let mut rows = vec![
        ("file", format!("{}, {}, {}", entry.path, entry.format, words::bytes(entry.bytes.unwrap_or(0)))),
        ("holds", "values over a lattice, not a mesh (`field a a=FILE -o OUT` makes one of them)".into()),
        ("unit", unit.map_or("not stated in the file".into(), str::to_string)),
        ("voxels", format!("{x} x {y} x {z}, {} in all", words::count(all))),
        ("voxel size", words::length(found.spacing, unit)),
        ("size", words::size(size, unit)),
        ("box", format!("{} to {}, from the first voxel to the last", place(found.origin), place(last))),
        ("values", words::with_unit(&format!("{low} to {high}"), unit)),
    ];
    if let Some(band) = found.band {
        rows.push(("band", format!("values are cut off at ± {}", words::length(band, unit))));
    }
    if (found.stored as usize) < all {
        rows.push((
            "stored",
            format!("{} one by one, the rest in boxes", words::plural(found.stored as usize, "voxel")),
        ));
    }
    let inside = match found.inside {
        0 => "no value is below zero, so there is no inside".into(),
        n => {
            let volume = words::volume(found.inside_volume, unit);
            format!("{} below zero, a volume of about {volume}", words::plural(n as usize, "voxel"))
        }
    };
    rows.push(("inside", inside));
    rows
}

/// The format for lattices that `convert` is to write, or why there is none.
fn target(args: &ConvertArgs, label: &str) -> Result<GridFormat, Failure> {
    let named = AnyFormat::from_path(&args.output);
    let makes_a_mesh = |format: Format| {
        Failure::usage(format!("{label} holds values over a lattice, and {format} holds a mesh")).hint(format!(
            "`meshwright field a a={label} -o {}` makes a mesh of the places where the values are zero",
            args.output.display()
        ))
    };
    match args.writing.out_format.or(named) {
        Some(AnyFormat::Grid(format)) => Ok(format),
        Some(AnyFormat::Mesh(format)) => Err(makes_a_mesh(format)),
        None if streams::is_stream(&args.output) => {
            Err(Failure::usage("standard output has no name that tells its format")
                .hint("--out-format says it, for example --out-format nrrd"))
        }
        None => {
            let endings = format!("{GRID_ENDINGS}, or give --out-format");
            Err(target::untold(&args.output, &meant::grid_formats(), &endings))
        }
    }
}

/// Writes one lattice in another format.
pub fn convert(
    args: &ConvertArgs,
    given: &Given,
    unit: Option<Unit>,
    session: &Session,
    report: &mut RunReport,
) -> Result<Exit, Failure> {
    let Some(grid) = given.grids.first() else { return Err(Failure::internal("nothing was read")) };
    let format = target(args, &grid.entry.path)?;
    target::check_extension(&args.output, format.name())?;
    if args.writing.ascii {
        return Err(Failure::usage("--ascii is for STL and PLY; lattices are written as bytes"));
    }
    report.options = json!({ "unit": unit.map(|unit| unit.to_string()), "out_format": format.to_string() });
    given.describe(report);
    let file = &grid.file;
    check_room(file, format)?;
    if !format.says_where() {
        report.warnings.push(format!(
            "{format} has no place for origin, spacing and unit; `inspect --json` of the input has them"
        ));
    }
    let plane = |z: usize, values: &mut Vec<f32>| file.plane(z, values);
    let samples = DistanceSamples {
        origin: file.origin,
        spacing: file.spacing,
        dims: file.dims,
        unit,
        band: file.band.or_else(|| band_of(file)),
        plane: &plane,
        blocks: None,
    };
    let entry = report.timed(Stage::WriteAndVerify, |_| {
        session.progress.stage(Stage::Write)?;
        output::write_grid(&args.output, &samples, format, session)
    })?;
    session.clear_bar();
    let name = unit.filter(|_| format.says_where()).map_or(String::new(), |unit| format!(", in {unit}"));
    let [x, y, z] = file.dims;
    session.say(&format!("{}: {x} x {y} x {z} voxels, as {format}{name}, {}", entry.path, words::bytes(entry.bytes)));
    report.result = Some(RunResult::Conversion { output: entry });
    Ok(Exit::Done)
}

/// The band of a level set whose values end at its background.
fn band_of(file: &GridFile) -> Option<f64> {
    let GridValues::Sparse(values) = &file.values else { return None };
    let [low, high] = file.measures().range;
    (values.background > 0.0 && high <= values.background && low >= -values.background)
        .then_some(f64::from(values.background))
}

/// Refuses to take a sparse lattice apart into more blocks than there is memory for.
fn check_room(file: &GridFile, format: GridFormat) -> Result<(), Failure> {
    let needed = 4 * file.dims.iter().map(|&count| count as u64).product::<u64>();
    match machine::memory_cap(None) {
        Some(cap) if format == GridFormat::Vdb && needed > cap => {
            Err(Failure::memory(needed, cap, None).hint("nrrd and vti are written plane by plane, with little memory"))
        }
        _ => Ok(()),
    }
}

/// Why a mesh does not become a lattice by `convert`.
pub fn no_field(label: &str, output: &Path) -> Failure {
    let place = if is_direct(output) { "OUT".into() } else { output.display().to_string() };
    Failure::usage(format!("{label} holds a mesh, and {} holds values over a lattice", output.display()))
        .hint(format!("`meshwright sdf {label} -o {place}` makes the distances to a mesh"))
}
