//! `inspect IN`: what is in a file, and what is wrong with it.

use serde_json::json;

use super::args::InspectArgs;
use super::choices::Defect;
use super::exit::{Asked, Exit, Failure};
use super::given::Given;
use super::input::{self, Input};
use super::length::Scale;
use super::report::RunReport;
use super::session::Session;
use super::{grids, summary, words};
use crate::io::Unit;
use crate::mesh::{Bounds, ValidateOptions, Validity, validate};
use crate::pipeline::{self, LengthsReport, Options, ThicknessReport, VoxelSize};

/// Looks at one file and prints a table.
pub fn run(args: &InspectArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let mut given = report
        .timed("read", |report| Given::read(&[&args.input], &args.reading, None, session, &mut report.warnings))?;
    let unit = given.common_unit(&args.reading, &mut report.warnings);
    if !given.grids.is_empty() {
        return grids::inspect(args, &given, unit, session, report);
    }
    let Some(input) = given.meshes.first() else { return Err(Failure::internal("nothing was read")) };
    session.progress.stage("examine")?;
    let validity = report.timed("examine", |_| input::examine(&input.loaded, session))?;
    report.warnings.extend(closable(input, &validity, session)?);
    report.warnings.extend(summary::size_doubts(&input.loaded, unit));
    report.options = json!({ "unit": unit.map(|unit| unit.to_string()) });
    report.inputs = vec![super::report::InputEntry { validity: Some(validity.clone()), ..input.entry.clone() }];
    if args.thickness {
        report.thickness = Some(report.timed("thickness", |_| thickness(args, input, unit, session))?);
    }
    session.clear_bar();
    if !args.common.json {
        let mut rows = summary::inspection(input, &validity, unit);
        let name = unit.map(|unit| unit.to_string());
        rows.extend(report.thickness.iter().flat_map(|thickness| thickness_rows(thickness, name.as_deref())));
        super::output::write_stream(summary::table(&rows).as_bytes())?;
    }
    let found: Vec<String> = failing(&args.fail_on, &validity);
    if found.is_empty() {
        return Ok(Exit::Done);
    }
    Err(Failure::new(Exit::Limit, format!("{} has {}, as --fail-on asks", input.label, words::list(&found))))
}

fn thickness(
    args: &InspectArgs,
    input: &Input,
    unit: Option<Unit>,
    session: &Session,
) -> Result<ThicknessReport, Failure> {
    let mesh = &input.loaded.mesh;
    let diagonal = mesh.bounds().as_ref().map_or(0.0, Bounds::diagonal);
    let voxel = match &args.voxel {
        Some(length) => VoxelSize::Length(length.resolve(&Scale { unit, diagonal, voxel: None })?),
        None => VoxelSize::Along(args.resolution),
    };
    let name = unit.map(|unit| unit.to_string());
    let asked = Asked { voxel: args.voxel.is_some(), memory: None };
    let failed = |e| Failure::pipeline(&e, std::slice::from_ref(&input.label), name.as_deref(), asked);
    pipeline::thickness(mesh, &Options::new(voxel), &session.progress).map_err(failed)
}

fn thickness_rows(found: &ThicknessReport, unit: words::UnitName<'_>) -> Vec<summary::Row> {
    let described = |lengths: &LengthsReport| {
        if lengths.count == 0 {
            return "none".to_string();
        }
        let [first, _, _, half, _, most] = lengths.percentiles.map(|length| words::length(length, unit));
        let thin = words::percent((lengths.thin * lengths.count as f64).round() as usize, lengths.count);
        format!("1 % under {first}, half under {half}, 95 % under {most}; {thin} under 2 voxels")
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
    if validity.open_edges == 0 || input::is_soup_format(input.loaded.format) {
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
