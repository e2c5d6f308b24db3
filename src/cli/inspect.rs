//! `inspect IN`: what is in a file, and what is wrong with it.

use serde_json::json;

use super::choices::{Defect, FillChoice};
use super::entries::CrossingEntry;
use super::exit::{Asked, Exit, Failure};
use super::given::Given;
use super::input::{self, Input};
use super::inspect_args::InspectArgs;
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::{grids, holes, lead, page, summary, table, words};
use crate::arrange::{ArrangeError, crossing_curves};
use crate::io::Unit;
use crate::mesh::{Bounds, MassProperties, Overhang, TriMesh, ValidateOptions, Validity, validate};
use crate::pipeline::{self, HoleClosing, HoleReport, LengthsReport, Options, ThicknessReport, VoxelSize};
use crate::progress::Stage;

/// Looks at one file and prints a table.
pub fn run(args: &InspectArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut given = report
        .timed(Stage::Read, |report| Given::read(&[&args.input], &args.reading, None, session, &mut report.warnings))?;
    let unit = given.common_unit(&args.reading, &mut report.warnings);
    if !given.grids.is_empty() {
        return grids::inspect(args, &given, unit, session, report);
    }
    let Some(input) = given.meshes.first() else { return Err(Failure::internal("nothing was read")) };
    session.progress.stage(Stage::Examine)?;
    let validity = report.timed(Stage::Examine, |_| input::examine(&input.loaded, &session.progress))?;
    report.warnings.extend(closable(input, &validity, session)?);
    report.warnings.extend(summary::size_doubts(&input.loaded, unit));
    report.options = json!({ "unit": unit.map(|unit| unit.to_string()) });
    report.inputs = vec![super::entries::InputEntry { validity: Some(validity.clone()), ..input.entry.clone() }];
    let crossings = crossings(&input.loaded.mesh, &validity, session, report)?;
    let solid = validity.is_oriented_manifold();
    let mass = solid.then(|| MassProperties::of(&input.loaded.mesh)).flatten();
    let overhang = solid.then(|| Overhang::of(&input.loaded.mesh, args.overhang));
    let thickness = match args.thickness {
        true => Some(report.timed(Stage::Thickness, |_| thickness(args, input, unit, session))?),
        false => None,
    };
    let holes = match args.holes {
        true => Some(report.timed(Stage::Fill, |_| holes_of(args, input, unit, session))?),
        false => None,
    };
    let lead = lead::of(args, (input, &validity), unit, session, report)?;
    let result = RunResult::Inspection { mass, overhang, crossings, thickness, holes, lead };
    let name = unit.map(|unit| unit.to_string());
    session.show(report, |_| page::of_inspection(input, &result, name.as_deref(), session))?;
    session.clear_bar();
    let RunResult::Inspection { mass, overhang, crossings, thickness, holes, lead } = &result else {
        return Err(Failure::internal("an inspection was wanted"));
    };
    if !args.common.json {
        let mut rows = summary::inspection(input, &validity, unit);
        rows.extend(
            crossings.iter().filter(|found| found.segments > 0).map(|found| crossing_row(found, name.as_deref())),
        );
        rows.extend(mass.iter().flat_map(|mass| mass_rows(mass, name.as_deref())));
        rows.extend(overhang.iter().map(|found| overhang_row(found, &validity, name.as_deref())));
        rows.extend(thickness.iter().flat_map(|thickness| thickness_rows(thickness, name.as_deref())));
        rows.extend(holes.iter().flat_map(|list| match list.is_empty() {
            true => vec![("hole", "none".to_string())],
            false => holes::rows(list, name.as_deref()),
        }));
        rows.extend(lead::rows(lead, name.as_deref()));
        super::streams::write_stream(table::table(&rows).as_bytes())?;
    }
    report.result = Some(result);
    let found: Vec<String> = failing(&args.fail_on, &validity);
    if found.is_empty() {
        return Ok(Exit::Done);
    }
    Err(Failure::new(Exit::Limit, format!("{} has {}, as --fail-on asks", input.label, words::list(&found))))
}

/// Where triangles cross; `None` where none do, and where there are too many places.
fn crossings(
    mesh: &TriMesh,
    validity: &Validity,
    session: &Session,
    report: &mut RunReport,
) -> Result<Option<CrossingEntry>, Failure> {
    if validity.self_intersecting_triangles.is_none_or(|count| count == 0) {
        return Ok(None);
    }
    session.progress.stage(Stage::Arrange)?;
    match report.timed(Stage::Arrange, |_| crossing_curves(mesh, &session.progress)) {
        Ok(curves) => {
            let length = curves.iter().map(|[a, b]| a.distance(*b)).sum();
            Ok(Some(CrossingEntry { segments: curves.len(), length }))
        }
        Err(ArrangeError::Stopped(stopped)) => Err(stopped.into()),
        Err(error) => {
            report.warnings.push(format!("where triangles cross is not told: {error}"));
            Ok(None)
        }
    }
}

fn crossing_row(found: &CrossingEntry, unit: words::UnitName<'_>) -> table::Row {
    let (segments, length) = (words::plural(found.segments, "segment"), words::length(found.length, unit));
    ("crossings", format!("triangles cross along {segments}, {length} long in all (`meshwright render` draws them)"))
}

fn mass_rows(mass: &MassProperties, unit: words::UnitName<'_>) -> Vec<table::Row> {
    // Of density 1 the mass is the volume, and moments have the fifth power of a length.
    let moments = |values: [f64; 3]| {
        let values = values.map(words::number).join(" ");
        unit.map_or(values.clone(), |unit| format!("{values} {unit}⁵"))
    };
    let axes: Vec<String> = mass.axes.iter().map(|axis| axis.map(words::number).join(" ")).collect();
    let [xx, xy, xz] = mass.inertia[0];
    let ([_, yy, yz], [_, _, zz]) = (mass.inertia[1], mass.inertia[2]);
    vec![
        ("centre", format!("of mass: {}", words::with_unit(&mass.centre.map(words::number).join(" "), unit))),
        ("inertia", format!("about it, of density 1: xx yy zz {}", moments([xx, yy, zz]))),
        ("inertia", format!("xy xz yz {}", moments([xy, xz, yz]))),
        ("inertia", format!("principal {}", moments(mass.moments))),
        ("inertia", format!("about the axes {}", axes.join(", "))),
    ]
}

fn overhang_row(found: &Overhang, validity: &Validity, unit: words::UnitName<'_>) -> table::Row {
    let share = words::number(100.0 * found.area / validity.area.max(f64::MIN_POSITIVE));
    let degrees = words::number(found.degrees);
    let resting = words::area(found.resting, unit);
    let text = match found.area {
        0.0 => format!("none steeper than {degrees}° with z up; {resting} rests on the plate"),
        area => {
            let area = words::area(area, unit);
            format!("{area} ({share} % of the area) steeper than {degrees}° with z up; {resting} rests on the plate")
        }
    };
    ("overhang", text)
}

fn thickness(
    args: &InspectArgs,
    input: &Input,
    unit: Option<Unit>,
    session: &Session,
) -> Result<ThicknessReport, Failure> {
    let mesh = &input.loaded.mesh;
    let diagonal = mesh.bounds().as_ref().map_or(0.0, Bounds::diagonal);
    let voxel = args.voxels.size(unit, diagonal)?;
    let name = unit.map(|unit| unit.to_string());
    let asked = Asked { voxel: args.voxels.voxel.is_some(), memory: None };
    let failed = |e| Failure::pipeline(&e, std::slice::from_ref(&input.label), name.as_deref(), asked);
    pipeline::thickness(mesh, &Options::new(voxel), &session.progress).map_err(failed)
}

/// The holes, and what would be done over each.
fn holes_of(
    args: &InspectArgs,
    input: &Input,
    unit: Option<Unit>,
    session: &Session,
) -> Result<Vec<HoleReport>, Failure> {
    session.progress.stage(Stage::Fill)?;
    // No voxel is made; the size is needed by none of it.
    let options = Options { fill: args.fill.into(), ..Options::new(VoxelSize::Along(2)) };
    let name = unit.map(|unit| unit.to_string());
    let asked = Asked { voxel: false, memory: None };
    let failed = |e| Failure::pipeline(&e, std::slice::from_ref(&input.label), name.as_deref(), asked);
    let mut holes = pipeline::holes(&input.loaded.mesh, &options, &session.progress).map_err(failed)?;
    if args.fill == FillChoice::None {
        holes.iter_mut().for_each(|hole| hole.closed_by = HoleClosing::LeftOpen);
    }
    Ok(holes)
}

fn thickness_rows(found: &ThicknessReport, unit: words::UnitName<'_>) -> Vec<table::Row> {
    let described = |lengths: &LengthsReport| {
        if lengths.count == 0 {
            return "none".to_string();
        }
        let [first, _, _, half, _, most] = lengths.percentiles.map(|length| words::length(length, unit));
        let thin = words::percent((lengths.thin * lengths.count as f64).round() as usize, lengths.count);
        let least = words::length(lengths.least, unit);
        format!("thinnest {least}, 1 % under {first}, half under {half}, 95 % under {most}; {thin} under 2 voxels")
    };
    let mut rows = vec![("walls", described(&found.walls)), ("gaps", described(&found.gaps))];
    if let (Some(voxel), Some(resolution)) = (found.voxel_that_keeps, found.resolution_that_keeps) {
        let voxel = words::with_unit(&words::rounded_down(voxel), unit);
        let kept = format!("a voxel of {voxel} (--resolution {resolution}) puts two into 99 % of the walls and gaps");
        rows.push(("keeps", kept));
    } else if found.walls.count + found.gaps.count > 0 {
        let finest = words::with_unit(&words::rounded_up(found.finest), unit);
        rows.push((
            "keeps",
            format!(
                "no voxel is small enough to put two into 99 % of the walls and gaps; the finest possible is {finest}"
            ),
        ));
    }
    if found.silent > 0.0 {
        rows.push(("not counted", format!("{:.1} % of the rays, which met an open surface", 100.0 * found.silent)));
    }
    rows
}

/// For formats with shared vertices: how many open edges only come from vertices stored apart.
fn closable(input: &Input, validity: &Validity, session: &Session) -> Result<Option<String>, Failure> {
    if validity.open_edges == 0 || input.loaded.format.repeats_vertices() {
        return Ok(None);
    }
    let options = ValidateOptions { self_intersections: false, weld: true };
    let welded = validate(&input.loaded.mesh, &options, &session.progress)?;
    let closed = validity.open_edges.saturating_sub(welded.open_edges);
    Ok((closed > 0).then(|| {
        format!(
            "{} of the {} close when vertices at the same place are joined (repair does)",
            words::count(closed),
            words::plural(validity.open_edges, "open edge")
        )
    }))
}

/// The defects asked for that the mesh has, in words.
fn failing(asked: &[Defect], validity: &Validity) -> Vec<String> {
    let all = [
        Defect::Open,
        Defect::Nonmanifold,
        Defect::Inconsistent,
        Defect::Degenerate,
        Defect::Duplicate,
        Defect::SelfIntersecting,
        Defect::InsideOut,
    ];
    let wanted = |defect: &Defect| asked.contains(defect) || asked.contains(&Defect::Any);
    all.iter().filter(|defect| wanted(defect)).filter_map(|defect| words_for(*defect, validity)).collect()
}

fn words_for(defect: Defect, validity: &Validity) -> Option<String> {
    let several = |n: usize, word: &str| (n > 0).then(|| words::plural(n, word));
    match defect {
        Defect::Open => several(validity.open_edges, "open edge"),
        Defect::Nonmanifold => several(validity.nonmanifold_edges, "non-manifold edge")
            .or_else(|| (validity.nonmanifold_vertices > 0).then(|| "non-manifold vertices".to_string())),
        Defect::Inconsistent => several(validity.inconsistent_edges, "inconsistent edge"),
        Defect::Degenerate => several(validity.degenerate_triangles, "degenerate triangle"),
        Defect::Duplicate => several(validity.duplicate_triangles, "repeated triangle"),
        Defect::SelfIntersecting => {
            several(validity.self_intersecting_triangles.unwrap_or(0), "self-intersecting triangle")
        }
        Defect::InsideOut => (validity.volume < 0.0).then(|| "a volume below zero".to_string()),
        Defect::Any => None,
    }
}
