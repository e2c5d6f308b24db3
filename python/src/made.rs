//! What the library makes, as arrays of Python: handed over, not copied, where the types allow it.

use std::sync::Arc;

use glam::DVec3;
use meshwright::TriMesh;
use meshwright::cli::within::{GridProduct, MeshProduct, Product};
use meshwright::io::{Colours, TextureMap, Unit};
use meshwright::picture::Image;
use meshwright::pipeline::{TriangleKind, TriangleSource};
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::given::Texture;

/// A product as a dictionary, whose `kind` says what it is.
pub fn product(py: Python<'_>, product: Product) -> PyResult<Bound<'_, PyAny>> {
    match product {
        Product::Mesh(made) => mesh_product(py, *made),
        Product::Grid(made) => grid(py, made),
        Product::Picture(image) => picture(py, image),
    }
}

fn mesh_product(py: Python<'_>, made: MeshProduct) -> PyResult<Bound<'_, PyAny>> {
    let MeshProduct { mesh: triangles, validity, sources, kinds, colours, texture, unit } = made;
    let row = mesh(py, triangles, colours, texture, unit)?;
    row.set_item("validity", serde_json::to_string(&validity).unwrap_or_default())?;
    if let Some(sources) = sources {
        let rows: Vec<i64> = sources
            .iter()
            .flat_map(|source| match *source {
                TriangleSource::Operand { operand, triangle } => [i64::from(operand), i64::from(triangle)],
                TriangleSource::Lid { .. } | TriangleSource::Closed => [-1, -1],
            })
            .collect();
        row.set_item("sources", shaped(py, rows, 2)?)?;
    }
    if let Some(kinds) = kinds {
        let number = |kind: &TriangleKind| TriangleKind::ALL.iter().position(|other| other == kind).unwrap_or(0) as u8;
        row.set_item("kinds", kinds.iter().map(number).collect::<Vec<u8>>().into_pyarray(py))?;
    }
    Ok(row.into_any())
}

/// The arrays of a mesh.
pub fn mesh<'py>(
    py: Python<'py>,
    mesh: TriMesh,
    colours: Option<Colours>,
    texture: Option<TextureMap>,
    unit: Option<Unit>,
) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("kind", "mesh")?;
    let TriMesh { positions, triangles } = mesh;
    row.set_item("vertices", shaped(py, bytemuck::allocation::cast_vec::<DVec3, f64>(positions), 3)?)?;
    row.set_item("faces", shaped(py, triangles.into_flattened(), 3)?)?;
    row.set_item("colours", colours.map(|colours| colour_arrays(py, colours)).transpose()?)?;
    row.set_item("texture", texture.map(|texture| Py::new(py, Texture(Arc::new(texture)))).transpose()?)?;
    row.set_item("unit", unit.map(|unit| unit.to_string()))?;
    Ok(row)
}

/// A list as the rows of an array.
pub fn shaped<T: numpy::Element>(py: Python<'_>, list: Vec<T>, columns: usize) -> PyResult<Bound<'_, PyAny>> {
    let rows = list.len() / columns;
    Ok(list.into_pyarray(py).reshape([rows, columns])?.into_any())
}

fn colour_arrays(py: Python<'_>, colours: Colours) -> PyResult<(&'static str, Bound<'_, PyAny>)> {
    Ok(match colours {
        Colours::Faces(list) => ("face", shaped(py, list.into_flattened(), 4)?),
        Colours::Vertices(list) => ("vertex", shaped(py, list.into_flattened(), 4)?),
        Colours::Corners(list) => {
            let rows = list.len();
            let flat = list.into_flattened().into_flattened();
            let array = Array3::from_shape_vec((rows, 3, 4), flat).map_err(wrong_shape)?;
            ("corner", array.into_pyarray(py).into_any())
        }
    })
}

fn grid(py: Python<'_>, made: GridProduct) -> PyResult<Bound<'_, PyAny>> {
    let GridProduct { values, dims: [x, y, z], origin, spacing, band, unit } = made;
    let row = PyDict::new(py);
    row.set_item("kind", "grid")?;
    row.set_item("values", Array3::from_shape_vec((z, y, x), values).map_err(wrong_shape)?.into_pyarray(py))?;
    row.set_item("origin", origin.to_array())?;
    row.set_item("spacing", spacing)?;
    row.set_item("band", band)?;
    row.set_item("unit", unit.map(|unit| unit.to_string()))?;
    Ok(row.into_any())
}

fn picture(py: Python<'_>, image: Image) -> PyResult<Bound<'_, PyAny>> {
    let row = PyDict::new(py);
    row.set_item("kind", "picture")?;
    let shape = (image.height as usize, image.width as usize, 4);
    row.set_item("pixels", Array3::from_shape_vec(shape, image.rgba).map_err(wrong_shape)?.into_pyarray(py))?;
    Ok(row.into_any())
}

/// Points as rows.
pub fn points(py: Python<'_>, points: Vec<[f64; 3]>) -> PyResult<Bound<'_, PyAny>> {
    let rows = points.len();
    Ok(Array2::from_shape_vec((rows, 3), points.into_flattened()).map_err(wrong_shape)?.into_pyarray(py).into_any())
}

fn wrong_shape(error: numpy::ndarray::ShapeError) -> PyErr {
    pyo3::exceptions::PyRuntimeError::new_err(error.to_string())
}
