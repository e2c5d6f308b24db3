//! Questions that no verb asks: what is in a file, and what is nearest to points.

use std::path::PathBuf;

use meshwright::glam::DVec3;
use meshwright::io::{self, DistanceSamples, Format, GridFormat, Loaded, Unit};
use meshwright::mesh::{ValidateOptions, validate};
use meshwright::sdf::exact::{ExactDistance, Nearest, PointSign};
use meshwright::vote::WindingTree;
use meshwright::{Progress, TriMesh};
use numpy::{IntoPyArray, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde_json::json;

use crate::given::{GivenMesh, Vertices};
use crate::made;
use crate::work::{self, Hearing};

/// Reads a file. Returns `(failure, mesh, warnings)`.
#[pyfunction]
#[pyo3(signature = (path, in_format=None))]
pub fn read<'py>(py: Python<'py>, path: PathBuf, in_format: Option<&str>) -> PyResult<Bound<'py, PyTuple>> {
    let format = match in_format.map(str::parse::<Format>).transpose() {
        Ok(format) => format,
        Err(error) => return failed(py, "usage", &error.to_string(), None),
    };
    let quiet = Hearing { hear: None, threads: None };
    let read = work::beside(py, quiet, move |_| match format {
        Some(format) => io::read_as(path, format),
        None => io::read(path),
    })?;
    match read {
        Err(error) => failed(py, "input", &error.to_string(), error.hint()),
        Ok(loaded) => {
            let Loaded { mesh, colours, texture, unit, parts, warnings, .. } = loaded;
            let row = made::mesh(py, mesh, colours, texture, unit)?;
            let parts: Vec<_> =
                parts.into_iter().map(|part| (part.name, part.triangles.start, part.triangles.end)).collect();
            row.set_item("parts", parts)?;
            (None::<String>, row, warnings).into_pyobject(py)
        }
    }
}

fn failed<'py>(py: Python<'py>, class: &str, message: &str, hint: Option<&str>) -> PyResult<Bound<'py, PyTuple>> {
    let failure = json!({ "class": class, "message": message, "hint": hint }).to_string();
    (failure, None::<String>, Vec::<String>::new()).into_pyobject(py)
}

/// What of a mesh is nearest to points. Returns `(failure, (signed, points, triangles))`.
#[pyfunction]
#[pyo3(signature = (mesh, points, threads=None))]
pub fn nearest<'py>(
    py: Python<'py>,
    mesh: GivenMesh<'py>,
    points: Vertices<'py>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyTuple>> {
    let loaded = match mesh.loaded() {
        Ok(loaded) => loaded,
        Err(failure) => return (failure.to_string(), None::<String>).into_pyobject(py),
    };
    let points = points.positions();
    let found = work::beside(py, Hearing { hear: None, threads }, move |progress| {
        let sign = side_of(&loaded.mesh, &progress);
        sign.map(|sign| ExactDistance::of(&loaded.mesh, sign).at_all(&points))
    })?;
    let Some(found) = found else {
        let failure = json!({ "class": "interrupted", "message": "interrupted" });
        return (failure.to_string(), None::<String>).into_pyobject(py);
    };
    let all = |value: fn(&Nearest) -> f64, without: f64| -> Vec<f64> {
        found.iter().map(|nearest| nearest.as_ref().map_or(without, value)).collect()
    };
    let places = found.iter().map(|nearest| nearest.as_ref().map_or([f64::NAN; 3], |nearest| nearest.point.to_array()));
    let triangles: Vec<i64> =
        found.iter().map(|nearest| nearest.as_ref().map_or(-1, |nearest| i64::from(nearest.triangle))).collect();
    let signed = all(|nearest| nearest.signed, f64::INFINITY).into_pyarray(py);
    let places = made::points(py, places.collect())?;
    (None::<String>, (signed, places, triangles.into_pyarray(py))).into_pyobject(py)
}

/// Writes values over a lattice (planes of z, rows of y; where the first lies, how far they are apart, and the band) to a file. Returns a failure or `None`.
#[pyfunction]
#[pyo3(signature = (path, values, lattice, unit=None, format=None))]
pub fn write_grid(
    py: Python<'_>,
    path: PathBuf,
    values: PyReadonlyArray3<'_, f32>,
    lattice: ([f64; 3], f64, Option<f64>),
    unit: Option<&str>,
    format: Option<&str>,
) -> PyResult<Option<String>> {
    let (origin, spacing, band) = lattice;
    let usage = |message: String| json!({ "class": "usage", "message": message }).to_string();
    let format = match format.map(str::parse::<GridFormat>).transpose() {
        Ok(format) => format.or_else(|| GridFormat::from_path(&path)),
        Err(error) => return Ok(Some(usage(error.to_string()))),
    };
    let unit = match unit.map(str::parse::<Unit>).transpose() {
        Ok(unit) => unit,
        Err(error) => return Ok(Some(usage(error.to_string()))),
    };
    let Some(format) = format else {
        return Ok(Some(usage(format!(
            "the name {} does not tell its format: .vti, .nrrd, .npy or .vdb",
            path.display()
        ))));
    };
    let view = values.as_array();
    let shape = [view.shape()[2], view.shape()[1], view.shape()[0]];
    let flat: Vec<f32> = view.iter().copied().collect();
    let written = work::beside(py, Hearing { hear: None, threads: None }, move |_| {
        let size = shape[0] * shape[1];
        let plane = |z: usize, out: &mut Vec<f32>| {
            out.extend_from_slice(&flat[z * size..(z + 1) * size]);
        };
        let origin = DVec3::from_array(origin);
        let samples = DistanceSamples { origin, spacing, dims: shape, unit, band, plane: &plane, blocks: None };
        io::write_grid_as(path, &samples, format)
    })?;
    Ok(written.err().map(|error| json!({ "class": "write", "message": error.to_string() }).to_string()))
}

/// How the side of a point is told: by pseudonormals for a valid solid, else by winding numbers; `None` when the work is to stop.
fn side_of(mesh: &TriMesh, progress: &Progress) -> Option<PointSign> {
    let options = ValidateOptions { self_intersections: true, weld: false };
    let validity = validate(mesh, &options, progress).ok()?;
    if validity.is_valid() {
        return Some(PointSign::Pseudonormal);
    }
    WindingTree::new(mesh, 0..mesh.triangles.len(), progress).ok().map(PointSign::Winding)
}
