//! The panes of the view as data for the script of the page.

use std::borrow::Cow;

use serde_json::{Value, json};

use super::fewer::{Fewer, fewer};
use super::layers::{Classes, Lines, Marks, Values};
use super::pack::{self, Grid};
use crate::mesh::{Bounds, TriMesh};

/// The most triangles of a pane.
pub const MOST_TRIANGLES: usize = 300_000;

/// The most pieces of one kind of line, and marks.
const MOST_SEGMENTS: usize = 40_000;
const MOST_MARKS: usize = 200;

/// A mesh, and what can be seen on it.
#[derive(Debug, Clone, Default)]
pub struct Pane {
    /// Its name: before, after.
    pub title: String,
    /// The mesh.
    pub mesh: TriMesh,
    /// What its triangles are, one way or the other.
    pub classes: Vec<Classes>,
    /// Numbers over it.
    pub values: Vec<Values>,
    /// Lines over it.
    pub lines: Vec<Lines>,
    /// Places on it.
    pub marks: Vec<Marks>,
    /// The same as a PNG file, for pages without a script and for paper.
    pub picture: Option<Vec<u8>>,
    /// What the picture shows.
    pub caption: String,
}

impl Pane {
    /// What is to be said of its mesh, where not all of it is shown.
    pub(super) fn shown(&self) -> Option<Fewer> {
        fewer(&self.mesh, MOST_TRIANGLES)
    }

    /// The pane as the script takes it.
    pub(super) fn data(&self, less: Option<&Fewer>) -> Value {
        let mesh = less.map_or(&self.mesh, |less| &less.mesh);
        let bounds = self.bounds();
        let grid = Grid::around(&bounds);
        let corners: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
        json!({
            "title": self.title,
            "min": grid.min.to_array(), "max": grid.max.to_array(),
            "vertices": mesh.positions.len(), "triangles": mesh.triangles.len(),
            "positions": grid.points(mesh.positions.iter().copied()),
            "corners": pack::numbers(&corners, 1, 4),
            "classes": self.classes.iter().map(|classes| classes_data(classes, less)).collect::<Vec<_>>(),
            "values": self.values.iter().map(|values| values_data(values, less)).collect::<Vec<_>>(),
            "lines": self.lines.iter().map(|lines| lines_data(lines, &grid)).collect::<Vec<_>>(),
            "marks": self.marks.iter().map(marks_data).collect::<Vec<_>>(),
        })
    }

    /// The box around the mesh and its lines.
    fn bounds(&self) -> Bounds {
        let ends = self.lines.iter().flat_map(|lines| lines.segments.iter().flatten().copied());
        let ends = Bounds::of(ends.filter(|p| p.is_finite()));
        let nothing = Bounds { min: glam::DVec3::ZERO, max: glam::DVec3::ONE };
        let all = [self.mesh.bounds(), ends].into_iter().flatten();
        all.reduce(|a, b| a.union(&b)).unwrap_or(nothing)
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn classes_data(classes: &Classes, less: Option<&Fewer>) -> Value {
    let of: Cow<'_, [u8]> = match less {
        None => Cow::Borrowed(&classes.of),
        Some(less) => less.triangles.iter().map(|&t| classes.of.get(t as usize).copied().unwrap_or(0)).collect(),
    };
    let count = |n: usize| classes.of.iter().filter(|&&class| usize::from(class) == n).count();
    let entry = |(n, (colour, text)): (usize, &([u8; 3], String))| json!([hex(*colour), text, count(n)]);
    let legend: Vec<Value> = classes.legend.iter().enumerate().map(entry).collect();
    json!({ "name": classes.name, "legend": legend, "data": pack::bytes(&of) })
}

/// Values in 255 steps of their scale; 255 stands for none.
fn values_data(values: &Values, less: Option<&Fewer>) -> Value {
    let of: Cow<'_, [f64]> = match less {
        None => Cow::Borrowed(&values.of),
        Some(less) if values.by_triangle => {
            less.triangles.iter().map(|&t| values.of.get(t as usize).copied().unwrap_or(f64::NAN)).collect()
        }
        // Of several vertices the one that is farthest off, so that nothing is hidden.
        Some(less) => {
            let mut of = vec![f64::NAN; less.mesh.positions.len()];
            for (&value, &v) in values.of.iter().zip(&less.vertex_of) {
                let held = &mut of[v as usize];
                if held.is_nan() || held.abs() < value.abs() {
                    *held = value;
                }
            }
            Cow::Owned(of)
        }
    };
    let [low, high] = values.range;
    let step = |value: &f64| match (value - low) / (high - low) {
        share if share.is_finite() => (share.clamp(0.0, 1.0) * 254.0).round() as u8,
        _ if value.is_finite() => 0,
        _ => 255,
    };
    let steps: Vec<u8> = of.iter().map(step).collect();
    json!({
        "name": values.name, "by_triangle": values.by_triangle, "signed": low < 0.0,
        "ends": values.ends, "meaning": values.meaning, "data": pack::bytes(&steps),
    })
}

fn lines_data(lines: &Lines, grid: &Grid) -> Value {
    let every = lines.segments.len().div_ceil(MOST_SEGMENTS).max(1);
    let shown: Vec<_> = lines.segments.iter().step_by(every).flatten().copied().collect();
    json!({
        "name": lines.name, "colour": hex(lines.colour), "all": lines.segments.len(), "count": shown.len() / 2,
        "data": grid.points(shown),
    })
}

fn marks_data(marks: &Marks) -> Value {
    let shown: Vec<Value> =
        marks.marks.iter().take(MOST_MARKS).map(|(at, text)| json!([at.to_array(), text])).collect();
    json!({ "name": marks.name, "colour": hex(marks.colour), "all": marks.marks.len(), "marks": shown })
}
