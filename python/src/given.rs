//! Arrays of Python as meshes of the library: copied once.

use std::sync::Arc;

use meshwright::glam::DVec3;
use meshwright::io::{self, ArraysError, Colours, Loaded, TextureMap, Unit};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use serde_json::{Value, json};

/// Textures, which Python hands on and does not look into.
#[pyclass(frozen, module = "meshwright")]
pub struct Texture(pub Arc<TextureMap>);

/// Vertices of either precision.
#[derive(FromPyObject)]
pub enum Vertices<'py> {
    /// `float64`
    Double(PyReadonlyArray2<'py, f64>),
    /// `float32`
    Single(PyReadonlyArray2<'py, f32>),
}

/// Triangles of one type of whole numbers, or polygons, one after the other, each after the number of its corners.
#[derive(FromPyObject)]
pub enum Faces<'py> {
    /// `uint32`
    U32(PyReadonlyArray2<'py, u32>),
    /// `int32`
    I32(PyReadonlyArray2<'py, i32>),
    /// `int64`
    I64(PyReadonlyArray2<'py, i64>),
    /// `uint64`
    U64(PyReadonlyArray2<'py, u64>),
    /// Polygons.
    Polygons(PyReadonlyArray1<'py, i64>),
}

/// Colours: red, green, blue, alpha of faces or vertices, or of the corners of faces.
#[derive(FromPyObject)]
pub enum GivenColours<'py> {
    /// Of vertices or faces, as the word says.
    Of((String, PyReadonlyArray2<'py, u8>)),
    /// Of corners.
    Corners((String, PyReadonlyArray3<'py, u8>)),
}

/// A mesh under a name.
#[derive(FromPyObject)]
pub struct GivenMesh<'py> {
    /// What arguments call it.
    #[pyo3(item)]
    pub name: String,
    #[pyo3(item)]
    vertices: Vertices<'py>,
    #[pyo3(item)]
    faces: Faces<'py>,
    #[pyo3(item)]
    colours: Option<GivenColours<'py>>,
    #[pyo3(item)]
    texture: Option<Bound<'py, Texture>>,
    #[pyo3(item)]
    unit: Option<String>,
}

impl GivenMesh<'_> {
    /// The mesh, or why there is none.
    pub fn loaded(&self) -> Result<Loaded, Value> {
        let positions = self.vertices.positions();
        let told = |error: ArraysError| {
            let class = if matches!(error, ArraysError::Nothing(_)) { "empty" } else { "bad-array" };
            json!({ "class": class, "message": format!("{}: {error}", self.name) })
        };
        let mut loaded = match &self.faces {
            Faces::Polygons(polygons) => {
                let polygons = polygons.as_array();
                let numbers: Option<Vec<u32>> = polygons.iter().map(|&n| u32::try_from(n).ok()).collect();
                let numbers = numbers.ok_or_else(|| self.negative())?;
                io::of_polygons(positions, &numbers).map_err(told)?
            }
            faces => {
                let triangles = faces.triangles().ok_or_else(|| self.negative())?;
                io::of_triangles(positions, triangles).map_err(told)?
            }
        };
        if let Some(unit) = &self.unit {
            loaded.unit =
                Some(unit.parse::<Unit>().map_err(|error| json!({ "class": "usage", "message": error.to_string() }))?);
        }
        self.paint(&mut loaded)?;
        Ok(loaded)
    }

    fn negative(&self) -> Value {
        let message = format!("{}: a face refers to a vertex of a negative or too large number", self.name);
        json!({ "class": "bad-array", "message": message })
    }

    /// Gives the mesh its colours and textures, where their lists fit it.
    fn paint(&self, loaded: &mut Loaded) -> Result<(), Value> {
        let (vertices, triangles) = (loaded.mesh.positions.len(), loaded.mesh.triangles.len());
        if let Some(colours) = &self.colours {
            let colours = colours.colours();
            let (fits, what) = match &colours {
                Colours::Faces(list) => (list.len() == triangles, "face"),
                Colours::Vertices(list) => (list.len() == vertices, "vertex"),
                Colours::Corners(list) => (list.len() == triangles, "corner"),
            };
            match fits {
                true => loaded.colours = Some(colours),
                false => loaded.warnings.push(format!(
                    "the colours are left out: there is not one for each {what} of the mesh as it is read"
                )),
            }
        }
        match self.texture.as_ref().map(|texture| texture.get().0.clone()) {
            Some(texture) if texture.material_of.len() == triangles => loaded.texture = Some(texture.as_ref().clone()),
            Some(_) => loaded.warnings.push("the textures are left out: they belong to other triangles".into()),
            None => {}
        }
        Ok(())
    }
}

impl Vertices<'_> {
    /// As the library has them.
    pub fn positions(&self) -> Vec<DVec3> {
        match self {
            Self::Double(array) => rows(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]])),
            Self::Single(array) => {
                rows(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]].map(f64::from)))
            }
        }
    }
}

fn rows(rows: impl Iterator<Item = [f64; 3]>) -> Vec<DVec3> {
    rows.map(DVec3::from_array).collect()
}

impl Faces<'_> {
    /// Triangles; `None` where a number is negative or beyond 32 bits.
    fn triangles(&self) -> Option<Vec<[u32; 3]>> {
        macro_rules! of {
            ($array:expr) => {
                $array
                    .as_array()
                    .rows()
                    .into_iter()
                    .map(|row| Some([row[0].try_into().ok()?, row[1].try_into().ok()?, row[2].try_into().ok()?]))
                    .collect()
            };
        }
        match self {
            Self::U32(array) => Some(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect()),
            Self::I32(array) => of!(array),
            Self::I64(array) => of!(array),
            Self::U64(array) => of!(array),
            Self::Polygons(_) => None,
        }
    }
}

impl GivenColours<'_> {
    fn colours(&self) -> Colours {
        match self {
            Self::Of((kind, array)) => {
                let list = array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2], row[3]]).collect();
                if kind == "vertex" { Colours::Vertices(list) } else { Colours::Faces(list) }
            }
            Self::Corners((_, array)) => {
                let array = array.as_array();
                let corner = |t: usize, k: usize| [0, 1, 2, 3].map(|channel| array[[t, k, channel]]);
                Colours::Corners((0..array.shape()[0]).map(|t| [0, 1, 2].map(|k| corner(t, k))).collect())
            }
        }
    }
}
