//! `--slice`: a plane through grids, or through the signed distance of meshes.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use glam::DVec3;

use super::entries::InputEntry;
use super::entries::SliceEntry;
use super::exit::Failure;
use super::input::{self, Input};
use super::length::QuantityError;
use super::session::Session;
use super::streams;
use super::words::{self, UnitName};
use crate::io::{FileProblem, GridFile, Unit, read_grid_within};
use crate::mesh::Bounds;
use crate::picture::{
    Axis, Image, RenderError, SliceCaption, SliceColours, SlicePlane, SliceSamples, SliceSize, sample_slice,
};
use crate::sdf::exact::{ExactDistance, PointSign};
use crate::vote::WindingTree;

/// Around a mesh, this part of its longest side is shown.
const MARGIN: f64 = 0.15;

/// `--slice` as typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceChoice {
    axis: Axis,
    at: Location,
}

/// Where on the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Location {
    /// A share of the extent, percent.
    Percent(f64),
    /// In model units.
    Plain(f64),
    /// In a unit of its own.
    Unit(f64, Unit),
}

impl Default for SliceChoice {
    fn default() -> Self {
        Self { axis: Axis::Z, at: Location::Percent(50.0) }
    }
}

impl FromStr for SliceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not an axis, perhaps with a place, such as z, x=50%, y=-1.5 or z=2mm");
        let (axis, at) = text.split_once('=').unwrap_or((text, "50%"));
        let axis = match axis.trim() {
            "x" => Axis::X,
            "y" => Axis::Y,
            "z" => Axis::Z,
            _ => return Err(wrong()),
        };
        let number = at.trim().trim_end_matches(|c: char| c.is_alphabetic() || c == '%');
        let suffix = &at.trim()[number.len()..];
        let value: f64 = number.trim_end().parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(wrong)?;
        let at = match suffix {
            "" => Location::Plain(value),
            "%" => Location::Percent(value),
            unit => Location::Unit(value, unit.parse().map_err(|_| wrong())?),
        };
        Ok(Self { axis, at })
    }
}

impl fmt::Display for SliceChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = self.axis.name();
        match self.at {
            Location::Percent(value) => write!(f, "{axis}={value}%"),
            Location::Plain(value) => write!(f, "{axis}={value}"),
            Location::Unit(value, unit) => write!(f, "{axis}={value}{unit}"),
        }
    }
}

impl SliceChoice {
    /// The axis that the plane is perpendicular to.
    pub fn axis(&self) -> Axis {
        self.axis
    }

    /// The position on the axis, model units, which must lie within `bounds`. `flag` is the one that it was typed after.
    pub fn resolve(&self, flag: &str, bounds: &Bounds, unit: Option<Unit>) -> Result<f64, Failure> {
        let k = self.axis.number();
        let [low, high] = [bounds.min[k], bounds.max[k]];
        let at = match self.at {
            Location::Percent(share) => low + (high - low) * share / 100.0,
            Location::Plain(value) => value,
            Location::Unit(value, own) => {
                let model = unit.ok_or_else(|| QuantityError::UnitUnknown { length: format!("{value}{own}") })?;
                value * (own.metres() / model.metres())
            }
        };
        match (low..=high).contains(&at) {
            true => Ok(at),
            false => {
                let [from, to] = [low, high].map(words::number);
                let name = self.axis.name();
                Err(Failure::usage(format!("{flag} {self} lies outside: {name} goes from {from} to {to}"))
                    .hint(format!("{flag} {name} goes through the middle")))
            }
        }
    }
}

/// A grid as read.
pub struct GridInput {
    /// The content; its unit is the one that `factor` leads to.
    pub file: GridFile,
    /// What brings its lengths to the unit of the run.
    pub factor: f64,
    /// Its entry in the report.
    pub entry: InputEntry,
}

/// The grid in the bytes of a path. What the reader found odd goes to `notes`.
/// More memory than `max_memory` is refused before it is taken.
pub fn grid_of(
    path: &Path,
    bytes: &[u8],
    max_memory: Option<u64>,
    notes: &mut Vec<String>,
) -> Result<GridInput, Failure> {
    let name = (!streams::is_stream(path)).then_some(path);
    let file = read_grid_within(bytes, None, name, max_memory).map_err(|error| match *error.problem {
        FileProblem::Memory { needed, allowed } => {
            let hint = format!("for {} alone; a larger --max-memory, or a coarser lattice", streams::label(path));
            Failure::memory(needed, allowed, max_memory).hint(hint)
        }
        _ => match error.hint() {
            Some(hint) => Failure::input(error.to_string()).hint(hint),
            None => Failure::input(error.to_string()),
        },
    })?;
    let label = streams::label(path);
    notes.extend(file.warnings.iter().map(|warning| format!("{label}: {warning}")));
    let entry = InputEntry {
        path: label,
        name: None,
        format: file.format.to_string(),
        bytes: Some(bytes.len() as u64),
        sha256: Some(streams::sha256(bytes)),
        unit: file.unit.map(|unit| unit.to_string()),
        parts: Vec::new(),
        negative_parts: Vec::new(),
        warnings: file.warnings.clone(),
        validity: None,
    };
    Ok(GridInput { file, factor: 1.0, entry })
}

/// A field to slice.
pub struct Field<'a> {
    /// How the input is called.
    label: &'a str,
    unit: Option<Unit>,
    bounds: Bounds,
    value: Box<dyn Fn(DVec3) -> f64 + Sync + 'a>,
}

impl<'a> Field<'a> {
    /// The values of a grid, linear between voxels and nothing beyond.
    pub fn of_grid(grid: &'a GridInput) -> Self {
        let (file, factor) = (&grid.file, grid.factor);
        let lattice = file.lattice();
        let extent = DVec3::from(file.dims.map(|count| (count - 1) as f64)) * file.spacing;
        let bounds = Bounds { min: file.origin * factor, max: (file.origin + extent) * factor };
        let at_voxel = |voxel| file.at(voxel).map_or(f64::NAN, f64::from);
        let value = Box::new(move |p: DVec3| {
            let place = lattice.to_lattice(p / factor);
            if lattice.holds(place) { lattice.interpolate(place, at_voxel).value * factor } else { f64::NAN }
        });
        Self { label: &grid.entry.path, unit: file.unit, bounds, value }
    }

    /// The exact signed distance of a mesh: by pseudonormals for a valid solid, else by the winding number.
    pub fn of_mesh(input: &'a Input, session: &Session) -> Result<Self, Failure> {
        let mesh = &input.loaded.mesh;
        let valid = input::examine(&input.loaded, &session.progress)?.is_valid();
        let sign = match valid {
            true => PointSign::Pseudonormal,
            false => PointSign::Winding(WindingTree::new(mesh, 0..mesh.triangles.len(), &session.progress)?),
        };
        let bounds = mesh.bounds().ok_or_else(|| Failure::input(RenderError::Empty.to_string()))?;
        let margin = MARGIN * bounds.size().max_element();
        let bounds = Bounds { min: bounds.min - margin, max: bounds.max + margin };
        let exact = ExactDistance::of(mesh, sign);
        let value = Box::new(move |p| exact.at(p).map_or(f64::NAN, |nearest| nearest.signed));
        Ok(Self { label: &input.label, unit: input.loaded.unit, bounds, value })
    }
}

impl SliceEntry {
    /// The entry in words.
    pub fn words(&self, unit: UnitName<'_>) -> String {
        let at = words::length(self.at, unit);
        let (full, step) = (words::length(self.full, unit), words::length(self.step, unit));
        let range = match self.range.map(|range| range.map(words::number)) {
            Some([low, high]) => words::with_unit(&format!("{low} to {high}"), unit),
            None => "no values".into(),
        };
        let (path, axis) = (&self.path, self.axis);
        format!(
            "{path}: slice {axis} = {at}: {range}; blue inside, orange outside, full at ± {full}; lines every {step}"
        )
    }
}

/// How slices are turned, and what is written around them.
#[derive(Debug, Clone, Copy, Default)]
pub struct SliceWords<'a> {
    /// Whether the y axis of the model points up.
    pub y_up: bool,
    /// Titles in the order of the slices, instead of the names of the files.
    pub titles: &'a [String],
    /// Whether there are no words, no axes and no bar.
    pub plain: bool,
}

/// Draws all fields on the same plane in the same colours.
pub fn draw(
    fields: &[Field<'_>],
    choice: &SliceChoice,
    size: [u32; 2],
    how: &SliceWords<'_>,
    session: &Session,
) -> Result<Vec<(Image, SliceEntry)>, Failure> {
    let bounds = fields.iter().map(|field| field.bounds).reduce(|a, b| a.union(&b));
    let bounds = bounds.ok_or_else(|| Failure::internal("there is no field to slice"))?;
    let unit = fields.iter().find_map(|field| field.unit);
    let at = choice.resolve("--slice", &bounds, unit)?;
    let plane = SlicePlane::through(&bounds, choice.axis, at, how.y_up);
    let size = SliceSize { pixels: size, plain: how.plain };
    let sample = |field: &Field<'_>| sample_slice(&field.value, &plane, size, &session.progress);
    let samples: Vec<SliceSamples> = fields.iter().map(sample).collect::<Result<_, _>>().map_err(failure)?;
    let colours = SliceColours::up_to(samples.iter().map(SliceSamples::farthest).fold(0.0, f64::max));
    let entry = |field: &Field<'_>, samples: &SliceSamples| SliceEntry {
        path: field.label.to_owned(),
        axis: choice.axis.name(),
        at,
        range: samples.range(),
        full: colours.full,
        step: colours.step,
    };
    let name = unit.map(|unit| unit.to_string());
    let caption = |(n, field): (usize, &Field<'_>)| {
        let file = words::file_name(field.label);
        let place = words::length(at, name.as_deref());
        let own = format!("{file}, {} = {place}", choice.axis.name());
        let title = how.titles.get(n).cloned().unwrap_or(own);
        SliceCaption { title, unit: name.clone().unwrap_or_default() }
    };
    let captions = fields.iter().enumerate().map(caption);
    let drawn = fields.iter().zip(&samples).zip(captions);
    Ok(drawn.map(|((field, samples), caption)| (samples.draw(&colours, &caption), entry(field, samples))).collect())
}

/// Why there is no picture.
pub fn failure(error: RenderError) -> Failure {
    match error {
        RenderError::Stopped(stopped) => stopped.into(),
        RenderError::Empty => Failure::input(error.to_string()),
        RenderError::Size { .. } => Failure::usage(error.to_string()).hint("a smaller --width or --height"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_as_typed() {
        let bounds = Bounds { min: DVec3::new(0.0, -2.0, 10.0), max: DVec3::new(4.0, 2.0, 30.0) };
        for (text, unit, at) in [
            ("z", None, 20.0),
            ("x=25%", None, 1.0),
            ("y=-1.5", None, -1.5),
            ("z=2cm", Some(Unit::Millimetre), 20.0),
            (" x = 3 ", None, 3.0),
        ] {
            let choice: SliceChoice = text.parse().unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(choice.resolve("--slice", &bounds, unit).ok(), Some(at), "{text}");
            assert_eq!(choice.to_string().parse(), Ok(choice));
        }
        for text in ["", "w", "z=", "z=a", "z=1h", "z=nan", "1", "z=1=2"] {
            assert!(text.parse::<SliceChoice>().is_err(), "{text}");
        }
        for text in ["x=5", "x=-1%", "y=1mm"] {
            let choice: SliceChoice = text.parse().expect("it can be read");
            assert!(choice.resolve("--slice", &bounds, None).is_err(), "{text}");
        }
        assert_eq!(SliceChoice::default().to_string(), "z=50%");
    }
}
