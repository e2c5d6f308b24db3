//! The page of files that are only looked at.

use super::facts;
use super::ground::Ground;
use super::scene::before_pane;
use crate::cli::exit::Failure;
use crate::cli::input::{self, Input};
use crate::cli::report::RunReport;
use crate::cli::session::Session;
use crate::io::{Colours, LegendEntry, Rgba};
use crate::mesh::TriMesh;
use crate::page::{Classes, Mood, Page, Pane, Part, Section};

/// The name of the layer that has the colours of a file.
const COLOURS: &str = "Colours of the file";

/// The page of some meshes, and of pictures with what they show. `served`: whether it is told when its tab is shut.
pub fn html_of_files(
    meshes: &[Input],
    pictures: Vec<(Vec<u8>, String)>,
    served: bool,
    report: &mut RunReport,
    session: &Session,
) -> Result<String, Failure> {
    let mut panes = Vec::new();
    for input in meshes {
        let validity = input::examine(&input.loaded, &session.progress)?;
        let entry = report.inputs.iter_mut().find(|entry| entry.path == input.entry.path && entry.validity.is_none());
        if let Some(entry) = entry {
            entry.validity = Some(validity);
        }
        panes.push(pane(input, session)?);
    }
    let unit = super::unit_of(report);
    let names: Vec<&str> = report.inputs.iter().map(|input| super::file_name(&input.path)).collect();
    let sound =
        |input: &crate::cli::entries::InputEntry| input.validity.as_ref().is_none_or(|validity| validity.is_valid());
    let (mood, verdict) = match report.inputs.iter().all(sound) {
        true if meshes.is_empty() => (Mood::Good, "Values over a lattice, in slices.".to_string()),
        true => (Mood::Good, "No defects: what is shown is closed, oriented and without self-intersections.".into()),
        false => (Mood::Careful, "There are defects: the layers show where.".into()),
    };
    let mut sections = facts::first(report, unit);
    sections.retain(|section| !section.parts.is_empty());
    let slices: Vec<Part> = pictures.into_iter().map(|(png, caption)| Part::Picture { png, caption }).collect();
    if !slices.is_empty() {
        sections.insert(0, Section { id: "slices", title: "Slices".into(), parts: slices, folded: false });
    }
    let coloured = panes.iter().any(|pane| pane.classes.iter().any(|classes| classes.name == COLOURS));
    let first = panes.iter().flat_map(|pane| &pane.classes).next().map_or("", |classes| classes.name.as_str());
    let page = Page {
        title: names.join(", "),
        subtitle: format!("Shown by {} {}", report.tool, report.version),
        mood,
        verdict,
        first: Vec::new(),
        view_title: if panes.len() > 1 { "The meshes" } else { "The mesh" }.into(),
        shown_first: if coloured { COLOURS } else { first }.to_string(),
        panes,
        sections,
        report: serde_json::Value::Null,
        made_by: format!("{} {}", report.tool, report.version),
        served,
    };
    Ok(page.html())
}

fn pane(input: &Input, session: &Session) -> Result<Pane, Failure> {
    let ground = Ground::new(std::slice::from_ref(input), &session.progress)?;
    let mut pane = before_pane(&ground, &[], super::file_name(&input.label), &session.progress)?;
    let loaded = &input.loaded;
    if let Some(colours) = loaded.shown_colours() {
        pane.classes.insert(0, coloured(&loaded.mesh, &colours, &loaded.legend));
    }
    Ok(pane)
}

/// The mean colour of each triangle: those of the legend of a map, or else out of 252.
fn coloured(mesh: &TriMesh, colours: &Colours, legend: &[LegendEntry]) -> Classes {
    let mean = |t: usize| {
        let corners: [Rgba; 3] = colours.corners(mesh, t);
        [0, 1, 2].map(|k| (corners.iter().map(|corner| u32::from(corner[k])).sum::<u32>() / 3) as u8)
    };
    let all: Vec<[u8; 3]> = (0..mesh.triangles.len()).map(mean).collect();
    let named: Vec<([u8; 3], String)> =
        legend.iter().take(250).map(|entry| (entry.colour, entry.text.clone())).collect();
    if !named.is_empty() && all.iter().all(|colour| named.iter().any(|(own, _)| own == colour)) {
        let of = all.iter().map(|colour| named.iter().position(|(own, _)| own == colour).unwrap_or(0) as u8).collect();
        return Classes { name: COLOURS.into(), of, legend: named };
    }
    const LEVELS: [u32; 3] = [6, 7, 6];
    let level = |value: u8, levels: u32| (u32::from(value) * (levels - 1) + 127) / 255;
    let of = |colour: &[u8; 3]| {
        let [r, g, b] = [0, 1, 2].map(|k| level(colour[k], LEVELS[k]));
        ((r * LEVELS[1] + g) * LEVELS[2] + b) as u8
    };
    let entry = |n: u32| {
        let steps = [n / (LEVELS[1] * LEVELS[2]), n / LEVELS[2] % LEVELS[1], n % LEVELS[2]];
        ([0, 1, 2].map(|k| (steps[k] * 255 / (LEVELS[k] - 1)) as u8), String::new())
    };
    Classes {
        name: COLOURS.into(),
        of: all.iter().map(of).collect(),
        legend: (0..LEVELS.iter().product()).map(entry).collect(),
    }
}
