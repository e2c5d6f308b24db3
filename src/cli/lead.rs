//! What leads from what `inspect` has found to a solid: the worst defects, what a repair would do and lose, and the command to type.

use super::entries::{DetailEntry, WayEntry};
use super::exit::Failure;
use super::input::Input;
use super::inspect_args::InspectArgs;
use super::next;
use super::report::RunReport;
use super::result::Lead;
use super::session::Session;
use super::table::Row;
use super::words::{self, UnitName};
use super::worst::{self, Known};
use crate::io::Unit;
use crate::mesh::{Bounds, Validity};
use crate::pipeline::{self, BooleanError, Foresight, Options, PERCENTILES, Precision, VoxelSize, foresee};
use crate::progress::Stage;

/// As many groups of defects are told of one by one.
const TOLD: usize = 8;

/// Walls and gaps are measured along the rays of a lattice of at most so many voxels along the longest side: enough for shares of them.
const RAYS: u32 = 96;

/// Above this share of rays that pass an open surface there is nothing but a sheet.
const SHEET: f64 = 0.9;

/// What there is to say of a mesh.
pub fn of(
    args: &InspectArgs,
    (input, validity): (&Input, &Validity),
    unit: Option<Unit>,
    session: &Session,
    report: &mut RunReport,
) -> Result<Lead, Failure> {
    if validity.is_valid() || validity.bodies == 0 {
        return Ok(Lead { next: next::without_repair(validity), ..Lead::default() });
    }
    session.progress.stage(Stage::Examine)?;
    let mesh = &input.loaded.mesh;
    let voxel = args.voxels.size(unit, mesh.bounds().as_ref().map_or(0.0, Bounds::diagonal))?;
    let precision = if input.loaded.format.is_single() { Precision::Single } else { Precision::Double };
    let options = Options { precision, ..Options::new(voxel) };
    let foresight = match report.timed(Stage::Fill, |_| foresee(mesh, &options, &session.progress)) {
        Ok(foresight) => foresight,
        Err(BooleanError::Stopped(stopped)) => return Err(stopped.into()),
        Err(error) => {
            report.warnings.push(format!("what a repair would do is not told: {error}"));
            return Ok(Lead::default());
        }
    };
    let detail = report.timed(Stage::Thickness, |_| detail(input, &foresight, &options, session))?;
    let name = unit.map(|unit| unit.to_string());
    let groups = report.timed(Stage::Examine, |_| worst::groups(input, validity, &session.progress))?;
    let known = Known { validity, foresight: &foresight, detail: &detail, unit: name.as_deref() };
    let (worst, further) = worst::entries(&groups, &known);
    let next = next::of_broken(args, (input, validity), (&foresight, &detail), name.as_deref(), session);
    Ok(Lead { worst, further, detail: Some(detail), next })
}

/// Which way a repair goes, and how much is too thin for its voxels.
fn detail(input: &Input, foresight: &Foresight, options: &Options, session: &Session) -> Result<DetailEntry, Failure> {
    let none = |way| DetailEntry { way, voxel: None, thin: None, sheet: false, voxel_that_keeps: None };
    if !foresight.has_voxels() {
        return Ok(none(if foresight.plan.exact { WayEntry::Exact } else { WayEntry::AsItIs }));
    }
    let (mesh, voxel) = (&input.loaded.mesh, foresight.plan.voxel);
    let longest = mesh.bounds().map_or(0.0, |bounds| bounds.size().max_element());
    let rays = ((longest / voxel).ceil() as u32).clamp(2, RAYS);
    let coarse = Options { voxel: VoxelSize::Along(rays), ..*options };
    let mut detail = DetailEntry { voxel: Some(voxel), ..none(WayEntry::Voxels) };
    let found = match pipeline::thickness(mesh, &coarse, &session.progress) {
        Ok(found) => found,
        Err(pipeline::ThicknessError::Stopped(stopped)) => return Err(stopped.into()),
        Err(_) => return Ok(detail),
    };
    detail.sheet = found.walls.count == 0 || found.silent >= SHEET;
    detail.voxel_that_keeps = found.voxel_that_keeps;
    let measured = [&found.walls, &found.gaps].into_iter().filter(|lengths| lengths.count > 0);
    // Between which of the percentiles two voxels lie, of walls or of gaps, of which more are thin.
    let between = measured.map(|lengths| {
        let below = lengths.percentiles.partition_point(|&length| length < 2.0 * voxel);
        let share = |n: usize| PERCENTILES.get(n).map_or(1.0, |percent| *percent as f64 / 100.0);
        [if below == 0 { 0.0 } else { share(below - 1) }, share(below)]
    });
    detail.thin = between.reduce(|a, b| if b[0] > a[0] { b } else { a });
    Ok(detail)
}

/// It as rows of the table.
pub fn rows(lead: &Lead, unit: UnitName<'_>) -> Vec<Row> {
    let (told, rest) = lead.worst.split_at(lead.worst.len().min(TOLD));
    let mut rows: Vec<Row> = told.iter().map(|entry| ("worst", of_group(entry, unit))).collect();
    let mut more: Vec<(&str, usize, usize)> =
        lead.further.iter().map(|entry| (entry.kind.as_str(), entry.groups, entry.count)).collect();
    for entry in rest {
        match more.iter_mut().find(|(kind, ..)| *kind == entry.kind) {
            Some((_, groups, count)) => (*groups, *count) = (*groups + 1, *count + entry.count),
            None => more.push((&entry.kind, 1, entry.count)),
        }
    }
    if !more.is_empty() {
        let groups = more.iter().map(|(_, groups, _)| groups).sum();
        let kinds: Vec<String> = more.iter().map(|(kind, _, count)| worst::called(kind, *count)).collect();
        rows.push(("worst", format!("and {}: {}", words::plural(groups, "other group"), words::list(&kinds))));
    }
    rows.extend(lead.detail.iter().map(|detail| ("detail", of_detail(detail, unit))));
    for entry in &lead.next {
        rows.extend(entry.command.iter().map(|command| ("next", command.clone())));
        rows.push(("next", entry.what.clone()));
    }
    rows
}

fn of_group(entry: &super::entries::WorstEntry, unit: UnitName<'_>) -> String {
    let length = match entry.length > 0.0 {
        true => format!(", {} long", words::length(entry.length, unit)),
        false => String::new(),
    };
    let size = match entry.size > 0.0 {
        true => format!(", {} across", words::length(entry.size, unit)),
        false => String::new(),
    };
    let place = words::around(entry.at.into());
    format!("{}{length}{size}, around {place}: {}", worst::called(&entry.kind, entry.count), entry.repair)
}

fn of_detail(detail: &DetailEntry, unit: UnitName<'_>) -> String {
    let voxel = match (detail.way, detail.voxel) {
        (WayEntry::AsItIs, _) => return "nothing is lost: every surface stays as it is".into(),
        (WayEntry::Exact, _) | (_, None) => {
            return "nothing is lost: the exact way, without voxels".into();
        }
        (WayEntry::Voxels, Some(voxel)) => voxel,
    };
    if detail.sheet {
        return "nothing would be made: along nearly all rays there is nothing but an open surface".into();
    }
    let [voxel, least] = [voxel, 2.0 * voxel].map(|x| words::length(x, unit));
    let percent = |share: f64| format!("{} %", words::number(100.0 * share));
    let share = match detail.thin {
        Some([low, _]) if low > 0.0 => format!("more than {} of the walls or gaps are thinner", percent(low)),
        Some([_, high]) => format!("fewer than {} of the walls and of the gaps are thinner", percent(high)),
        None => "how thick the walls are could not be measured".into(),
    };
    format!("where surface is made anew, from voxels of {voxel}, walls and gaps under {least} may be lost; {share}")
}
