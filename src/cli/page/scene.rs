//! What a page shows of the meshes of a run.

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::defects::Known;
use super::fates::Fates;
use super::ground::{Ground, INPUT, input_class};
use super::seen::{Origin, SolidSeen};
use super::shown::Scene;
use crate::cli::entries::InputEntry;
use crate::cli::exit::Failure;
use crate::cli::input::Input;
use crate::cli::map;
use crate::cli::report::RunReport;
use crate::cli::result::RunResult;
use crate::cli::session::Session;
use crate::cli::words::{self, UnitName};
use crate::compare::deviation_map;
use crate::io::Colours;
use crate::mesh::{TriMesh, Validity};
use crate::page::{self, Classes, Histogram, Lines, Marks, Pane, Row, Table, Values};
use crate::picture::{Painted, RenderError, RenderOptions, render};
use crate::pipeline::{HoleReport, Report, TriangleKind, TriangleSource};
use crate::progress::Progress;

const WHAT_IT_IS: &str = "What each triangle is";
const DISTANCE: &str = "Distance from the other";
const CANALS: &str = "Canals";
const THICKNESS: &str = "Thickness of walls";
const CHOOSE: &str = "Choosing a row shows the place in the view.";

/// As many surfaces are measured one by one.
const MOST_BODIES: usize = 30;

/// Of a verb that has made a solid.
pub fn of_solid(seen: &SolidSeen<'_>, report: &RunReport, session: &Session) -> Result<Scene, Failure> {
    let progress = &session.progress;
    let unit = super::unit_of(report);
    let ground = Ground::new(seen.inputs, progress)?;
    let pipeline = report.pipeline();
    let holes = pipeline.map_or(&[][..], |pipeline| &pipeline.holes);
    let mut before = before_pane(&ground, holes, "Before", progress)?;
    let mut after = Pane { title: "After".into(), mesh: seen.mesh.clone(), ..Pane::default() };
    let fates = origin_layers(seen, &ground, &mut before, &mut after, progress)?;
    if let Some(pipeline) = pipeline {
        let boxes = regions(pipeline);
        before.lines.extend(boxes.iter().cloned());
        after.lines.extend(boxes);
        after.marks.extend(hole_marks(holes));
        after.marks.extend(canal_marks(pipeline));
    }
    let is_closed = |input: &InputEntry| input.validity.as_ref().is_some_and(Validity::is_oriented_manifold);
    let sided = seen.inputs.len() == 1 && report.inputs.iter().all(is_closed);
    let mut charts = distances(&mut before, &mut after, sided, ["input", "result"], unit, progress)?;
    // In a result with holes left open a ray may find no other side.
    if pipeline.is_some_and(|pipeline| triangles(pipeline) == seen.mesh.triangles.len()) {
        charts.extend(thickness(&mut after, unit, progress)?);
    }
    let known = Known { ground: &ground, holes, pipeline, fates: fates.as_ref(), made: true, unit };
    let mut scene = Scene {
        charts,
        bodies: bodies(seen.mesh, unit, progress)?,
        defects: Some(known.table()),
        defects_title: "Defects, and what became of each".into(),
        defects_text: CHOOSE.into(),
        view_title: "Before and after".into(),
        first: if after.classes.iter().any(|classes| classes.name == CANALS) { CANALS } else { WHAT_IT_IS }.into(),
        panes: Vec::new(),
    };
    // A list of canals leaves the mesh as it is.
    let canals = pipeline.and_then(|pipeline| pipeline.canals.as_ref());
    scene.panes = match canals.filter(|canals| canals.removed.is_empty()) {
        Some(_) => {
            (scene.view_title, after.title, after.caption) = ("The canals".into(), "The solid".into(), String::new());
            vec![after]
        }
        None => vec![before, after],
    };
    Ok(scene)
}

fn triangles(pipeline: &Report) -> usize {
    TriangleKind::ALL.into_iter().map(|kind| pipeline.triangles.count(kind)).sum()
}

/// Lays over both where the triangles come from, and draws the result so.
fn origin_layers(
    seen: &SolidSeen<'_>,
    ground: &Ground,
    before: &mut Pane,
    after: &mut Pane,
    progress: &Progress,
) -> Result<Option<Fates>, Failure> {
    let Origin::Known(sources, kinds) = &seen.origin else {
        let layer = kept_layer(seen.mesh, &ground.mesh);
        let colour = |&class: &u8| {
            let [r, g, b] = layer.legend[usize::from(class)].0;
            [r, g, b, 255]
        };
        after.picture =
            picture(seen.mesh, Some(Colours::Faces(layer.of.iter().map(colour).collect())), false, progress)?;
        after.caption = "made: light what is kept, orange what is not in the input".into();
        after.classes.push(layer);
        return Ok(None);
    };
    after.classes.push(kinds_layer(kinds));
    after.classes.extend(canal_layer(seen.canal_of));
    if let Some(classes) = ground.by_input() {
        let class = |source: &TriangleSource| match *source {
            TriangleSource::Operand { operand, .. } if (operand as usize) < ground.inputs.len() => {
                input_class(operand as usize)
            }
            _ => 0,
        };
        let of = sources.iter().map(class).collect();
        after.classes.push(Classes { name: INPUT.into(), of, legend: ground.input_legend() });
        before.classes.push(classes);
    }
    after.picture = picture(seen.mesh, Some(map::colours(kinds)), false, progress)?;
    after.caption =
        "made: light what is kept, orange what is rebuilt, magenta what is made up, blue what is cut".into();
    let counts: Vec<usize> = seen.operands.iter().map(|operand| operand.mesh.triangles.len()).collect();
    Ok(Some(Fates::new(&counts, sources, kinds)))
}

/// Which triangles are those of the input, as single precision has them.
fn kept_layer(mesh: &TriMesh, input: &TriMesh) -> Classes {
    let key = |mesh: &TriMesh, t: usize| {
        // 0 and -0 are one.
        let mut corners = mesh.corners(t).map(|p| (p.as_vec3() + glam::Vec3::ZERO).to_array().map(f32::to_bits));
        corners.sort_unstable();
        corners
    };
    let own: FxHashSet<_> = (0..input.triangles.len()).map(|t| key(input, t)).collect();
    let of = (0..mesh.triangles.len()).map(|t| u8::from(!own.contains(&key(mesh, t)))).collect();
    let [kept, other] = [TriangleKind::Kept, TriangleKind::Rebuilt].map(|kind| map::KINDS[kind as usize]);
    let legend =
        vec![(kept, map::meaning(TriangleKind::Kept)), (other, "not in the input: cut, rebuilt or made up".into())];
    Classes { name: WHAT_IT_IS.into(), of, legend }
}

/// Of `inspect`.
pub fn of_inspection(
    input: &Input,
    result: &RunResult,
    unit: UnitName<'_>,
    session: &Session,
) -> Result<Scene, Failure> {
    let progress = &session.progress;
    let ground = Ground::new(std::slice::from_ref(input), progress)?;
    let none = Vec::new();
    let holes = match result {
        RunResult::Inspection { holes: Some(holes), .. } => holes,
        _ => &none,
    };
    let known = Known { ground: &ground, holes, pipeline: None, fates: None, made: false, unit };
    let mut pane = before_pane(&ground, holes, "The mesh", progress)?;
    let mut scene = Scene { defects: Some(known.table()), ..Scene::default() };
    if let RunResult::Inspection { mass: Some(_), .. } = result {
        scene.charts.extend(thickness(&mut pane, unit, progress)?);
    }
    scene.first = pane.classes.first().map_or(String::new(), |classes| classes.name.clone());
    scene.bodies = bodies(&ground.mesh, unit, progress)?;
    scene.defects_title = "Defects".into();
    scene.defects_text = CHOOSE.into();
    scene.view_title = "The mesh".into();
    scene.panes = vec![pane];
    Ok(scene)
}

/// Of `compare`: the reference, and what is judged.
pub fn of_comparison(
    [a, b]: [&Input; 2],
    sided: bool,
    unit: UnitName<'_>,
    session: &Session,
) -> Result<Scene, Failure> {
    let pane = |title: &str, input: &Input| Pane {
        title: format!("{title}: {}", super::file_name(&input.label)),
        mesh: input.loaded.mesh.clone(),
        ..Pane::default()
    };
    pair(pane("A", a), pane("B", b), sided, ["A", "B"], unit, session)
}

/// Of `decimate`.
pub fn of_decimation(
    before: &TriMesh,
    after: &TriMesh,
    unit: UnitName<'_>,
    session: &Session,
) -> Result<Scene, Failure> {
    let pane = |title: &str, mesh: &TriMesh| Pane { title: title.into(), mesh: mesh.clone(), ..Pane::default() };
    pair(pane("Before", before), pane("After", after), true, ["input", "result"], unit, session)
}

fn pair(
    mut one: Pane,
    mut two: Pane,
    sided: bool,
    names: [&str; 2],
    unit: UnitName<'_>,
    session: &Session,
) -> Result<Scene, Failure> {
    let progress = &session.progress;
    let charts = distances(&mut one, &mut two, sided, names, unit, progress)?;
    for (pane, other) in [(&mut one, names[1]), (&mut two, names[0])] {
        let colours = pane
            .values
            .first()
            .map(|values| Colours::Vertices(values.of.iter().map(|d| shade(*d, values.range[1])).collect()));
        pane.picture = picture(&pane.mesh, colours, false, progress)?;
        pane.caption = format!("the redder, the farther from the {other}").replace("the A", "A").replace("the B", "B");
    }
    let view_title = if names[0] == "A" { "The two meshes" } else { "Before and after" }.into();
    Ok(Scene { panes: vec![one, two], view_title, first: DISTANCE.into(), charts, ..Scene::default() })
}

/// From light grey to dark red.
fn shade(distance: f64, most: f64) -> [u8; 4] {
    let share = if most > 0.0 { (distance.abs() / most).min(1.0) } else { 0.0 };
    let mix = |from: f64, to: f64| (from + (to - from) * share).round() as u8;
    [mix(216.0, 165.0), mix(221.0, 30.0), mix(227.0, 0.0), 255]
}

/// What was read, with its defects.
pub(super) fn before_pane(
    ground: &Ground,
    holes: &[HoleReport],
    title: &str,
    progress: &Progress,
) -> Result<Pane, Failure> {
    let mut pane =
        Pane { title: title.into(), mesh: ground.mesh.clone(), lines: ground.lines.clone(), ..Pane::default() };
    if ground.wrong.of.iter().any(|&class| class > 0) {
        pane.classes.push(ground.wrong.clone());
    }
    pane.marks.extend(hole_marks(holes));
    pane.picture = picture(&ground.mesh, None, true, progress)?;
    pane.caption = match ground.clusters.is_empty() {
        true => "as read".into(),
        false => "as read: open edges red, edges with more than two triangles magenta, crossing triangles yellow, inner sides rust red".into(),
    };
    Ok(pane)
}

fn kinds_layer(kinds: &[TriangleKind]) -> Classes {
    let legend = TriangleKind::ALL.map(|kind| (map::KINDS[kind as usize], map::meaning(kind)));
    Classes { name: WHAT_IT_IS.into(), of: kinds.iter().map(|&kind| kind as u8).collect(), legend: legend.into() }
}

fn canal_layer(canal_of: &[u32]) -> Option<Classes> {
    let most = canal_of.iter().copied().max().filter(|&most| most > 0)?;
    let shown = most.min(200);
    let canal = |n: u32| (map::CANALS[(n as usize - 1) % map::CANALS.len()], format!("canal {n}"));
    let legend = std::iter::once((map::KINDS[0], "no canal".to_string())).chain((1..=shown).map(canal)).collect();
    Some(Classes { name: CANALS.into(), of: canal_of.iter().map(|&n| n.min(shown) as u8).collect(), legend })
}

fn hole_marks(holes: &[HoleReport]) -> Option<Marks> {
    let several = holes.iter().any(|hole| hole.operand > 0);
    let text = |hole: &HoleReport| match several {
        true => format!("{}.{}", hole.operand + 1, hole.number),
        false => hole.number.to_string(),
    };
    let marks = holes.iter().map(|hole| (DVec3::from(hole.centre), text(hole))).collect();
    (!holes.is_empty()).then(|| Marks { name: "Holes".into(), colour: [170, 51, 0], marks })
}

fn canal_marks(pipeline: &Report) -> Option<Marks> {
    let canals = &pipeline.canals.as_ref().filter(|canals| !canals.canals.is_empty())?.canals;
    let marks = canals.iter().map(|canal| (DVec3::from(canal.position), canal.number.to_string())).collect();
    Some(Marks { name: CANALS.into(), colour: [0, 90, 140], marks })
}

/// The boxes of thin and doubtful places.
pub fn regions(pipeline: &Report) -> Vec<Lines> {
    let thin = pipeline.thin.regions.iter().map(|region| (region.min, region.max));
    let doubtful = pipeline.vote.doubtful_regions.iter().map(|region| (region.min, region.max));
    let boxes = |list: Vec<([f64; 3], [f64; 3])>| {
        list.into_iter().flat_map(|(min, max)| page::box_edges(min.into(), max.into())).collect::<Vec<_>>()
    };
    let layer = |name: &str, colour, list| Lines { name: name.into(), colour, segments: boxes(list) };
    let all = [
        layer("Thin walls and gaps", [148, 0, 120], thin.collect()),
        layer("Doubtful regions", [0, 130, 90], doubtful.collect()),
    ];
    all.into_iter().filter(|lines| !lines.segments.is_empty()).collect()
}

/// Lays how far each is from the other over both. `sided`: whether inside and outside of the first are known. The charts tell the same.
fn distances(
    one: &mut Pane,
    two: &mut Pane,
    sided: bool,
    [name_one, name_two]: [&str; 2],
    unit: UnitName<'_>,
    progress: &Progress,
) -> Result<Vec<Histogram>, Failure> {
    let maps = [deviation_map(&one.mesh, &two.mesh, progress)?, deviation_map(&two.mesh, &one.mesh, progress)?];
    let [Some(of_one), Some(of_two)] = maps else { return Ok(Vec::new()) };
    let diagonal = one.mesh.bounds().map_or(0.0, |bounds| bounds.diagonal());
    let all = of_one.distances.iter().chain(&of_two.distances).map(|d| d.abs()).filter(|d| d.is_finite());
    let most = all.fold(0.0, f64::max);
    if most <= UNMOVED * diagonal {
        return Ok(Vec::new());
    }
    // Most of the colours for most of the surface: a few far vertices have the last one.
    let full = of_one.range.max(of_two.range).max(most / 4.0);
    let mut charts = Vec::new();
    let both = [(one, of_one, name_two), (two, of_two, name_one)];
    for (pane, found, other) in both {
        let the = if other.len() == 1 { other.to_string() } else { format!("the {other}") };
        let of = if sided { found.distances } else { found.distances.iter().map(|d| d.abs()).collect() };
        charts.extend(moved_chart(&pane.mesh, &of, (&pane.title, &the), diagonal, unit));
        let beyond = if full < most { "or more" } else { "" };
        let end = format!("{} {beyond}", words::length(full, unit)).trim_end().to_string();
        let (range, ends) = match sided {
            true => ([-full, full], [format!("{end} inside"), format!("{end} outside")]),
            false => ([0.0, full], ["0".into(), end]),
        };
        let meaning = "How far each vertex is from the nearest point of the other surface.".into();
        pane.values.push(Values { name: DISTANCE.into(), of, by_triangle: false, range, ends, meaning });
    }
    Ok(charts)
}

/// What is nearer than this part of the diagonal has not moved: single precision alone moves so far.
const UNMOVED: f64 = 1e-6;

fn moved_chart(
    mesh: &TriMesh,
    distances: &[f64],
    (title, other): (&str, &str),
    diagonal: f64,
    unit: UnitName<'_>,
) -> Option<Histogram> {
    let of_triangle = |t: usize| mesh.triangles[t].map(|v| distances[v as usize].abs()).iter().sum::<f64>() / 3.0;
    let all: Vec<(f64, f64)> = (0..mesh.triangles.len()).map(|t| (of_triangle(t), area(mesh, t))).collect();
    let least = UNMOVED * diagonal;
    let whole: f64 = all.iter().map(|(_, area)| area).sum();
    let moved: f64 = all.iter().filter(|(d, _)| *d > least).map(|(_, area)| area).sum();
    let most = all.iter().map(|(d, _)| *d).filter(|d| d.is_finite()).fold(0.0, f64::max);
    let chart = Histogram::of(all.into_iter().filter(|(d, _)| *d > least), [0.0, most], 32)?;
    let share = words::number(((1.0 - moved / whole) * 10_000.0).round() / 100.0);
    let rest = format!("{title}: {share} % of the area lies on {other}; this is how far the rest is from it.");
    let axis = words::with_unit("distance", unit.map(|unit| format!("({unit})")).as_deref());
    Some(Histogram { title: rest, axis, whole: "of that rest".into(), ..chart })
}

fn area(mesh: &TriMesh, t: usize) -> f64 {
    let [a, b, c] = mesh.corners(t);
    (b - a).cross(c - a).length() / 2.0
}

/// Lays the thickness of walls over a closed mesh.
fn thickness(pane: &mut Pane, unit: UnitName<'_>, progress: &Progress) -> Result<Option<Histogram>, Failure> {
    let of = page::wall_thickness(&pane.mesh, progress)?;
    let mut sorted: Vec<f64> = of.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(&most) = sorted.last() else { return Ok(None) };
    let thick = sorted[sorted.len() * 9 / 10];
    let thick = if thick > 0.0 { thick } else { most };
    let weighted = of.iter().enumerate().map(|(t, &value)| (value, area(&pane.mesh, t)));
    let chart = Histogram::of(weighted, [0.0, most], 32).map(|chart| Histogram {
        title: format!("Thickness of walls, from the middle of each triangle straight through to the other side; a twentieth of all triangles is under {}.", words::length(sorted[sorted.len() / 20], unit)),
        axis: words::with_unit("thickness", unit.map(|unit| format!("({unit})")).as_deref()),
        whole: "of the area".into(),
        ..chart
    });
    pane.values.push(Values {
        name: THICKNESS.into(),
        of,
        by_triangle: true,
        range: [thick, 0.0],
        ends: [format!("{} or more", words::length(thick, unit)), "0".into()],
        meaning: "From the middle of each triangle straight through to the other side.".into(),
    });
    Ok(chart)
}

fn bodies(mesh: &TriMesh, unit: UnitName<'_>, progress: &Progress) -> Result<Option<Table>, Failure> {
    let (list, all) = page::bodies_of(mesh, MOST_BODIES, progress)?;
    if list.is_empty() {
        return Ok(None);
    }
    let row = |(n, body): (usize, &page::BodyMeasures)| {
        let v = &body.validity;
        let size = v
            .bounds
            .map_or(String::new(), |[min, max]| words::size(std::array::from_fn(|axis| max[axis] - min[axis]), unit));
        let what = match (v.is_closed(), v.volume < 0.0) {
            (false, _) => "open",
            (true, false) => "body",
            (true, true) => "void",
        };
        let genus = v.genus.map_or("not closed".into(), |genus| words::count(genus.max(0) as usize));
        let cells = vec![
            (n + 1).to_string(),
            what.into(),
            words::count(v.triangles),
            size,
            words::volume(v.volume, unit),
            words::area(v.area, unit),
            genus,
        ];
        let place = v.bounds.map(|[min, max]| {
            let (min, max) = (DVec3::from(min), DVec3::from(max));
            page::Place { at: (min + max) / 2.0, size: min.distance(max), from: DVec3::ZERO }
        });
        Row { cells, place }
    };
    let rows = list.iter().enumerate().map(row).collect();
    let head = ["Surface", "What", "Triangles", "Size", "Volume", "Area", "Tunnels"].map(String::from).into();
    Ok(Some(Table { head, rows, more: all - list.len() }))
}

/// A picture for pages without a script, and for paper; none of a mesh that cannot be drawn.
fn picture(
    mesh: &TriMesh,
    colours: Option<Colours>,
    defects: bool,
    progress: &Progress,
) -> Result<Option<Vec<u8>>, Failure> {
    let options = RenderOptions { width: 720, height: 560, defects, ..RenderOptions::default() };
    match render(Painted { mesh, colours: colours.as_ref(), is_map: true }, &options, progress) {
        Ok(image) => Ok(image.to_png().ok()),
        Err(RenderError::Stopped(stopped)) => Err(stopped.into()),
        Err(_) => Ok(None),
    }
}
