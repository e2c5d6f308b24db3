//! Meshes from the arrays of another program.

use glam::DVec3;

use super::error::FileError;
use super::format::Format;
use super::loaded::Loaded;
use super::soup::Soup;
use crate::mesh::{IndexError, TriMesh};

/// Why arrays make no mesh.
#[derive(Debug, thiserror::Error)]
pub enum ArraysError {
    /// A triangle refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// A polygon refers to a vertex that is not there.
    #[error("polygon {polygon} refers to vertex {vertex}, and there are {vertices}")]
    Polygon {
        /// Number of the polygon, from 0.
        polygon: usize,
        /// The vertex it refers to.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// The list of polygons ends within one.
    #[error("polygon {polygon} has {corners} corners, and the list ends before the last of them")]
    Cut {
        /// Number of the polygon, from 0.
        polygon: usize,
        /// The corners that it says it has.
        corners: u32,
    },
    /// No triangle is left.
    #[error(transparent)]
    Nothing(#[from] FileError),
}

/// A mesh of these vertices and triangles, as a reader would give it: triangles at vertices whose coordinates are no finite numbers are left out, with a
/// warning.
///
/// # Errors
/// A triangle refers to a vertex that is not there, or none is left.
pub fn of_triangles(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Loaded, ArraysError> {
    let mesh = TriMesh::new(positions, triangles)?;
    let mut soup = Soup::new();
    (soup.positions, soup.triangles) = (mesh.positions, mesh.triangles);
    Ok(soup.finish(Format::Obj, None)?)
}

/// A mesh of these vertices and polygons, as a reader would give it. `polygons` has for each polygon the number of its corners, and then these.
///
/// # Errors
/// A polygon refers to a vertex that is not there, the list ends within one, or no triangle is left.
pub fn of_polygons(positions: Vec<DVec3>, polygons: &[u32]) -> Result<Loaded, ArraysError> {
    let mut soup = Soup::new();
    soup.positions = positions;
    let vertices = soup.positions.len();
    let mut rest = polygons;
    let mut polygon = 0;
    while let Some((&corners, after)) = rest.split_first() {
        let Some((face, next)) = after.split_at_checked(corners as usize) else {
            return Err(ArraysError::Cut { polygon, corners });
        };
        if let Some(&vertex) = face.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Err(ArraysError::Polygon { polygon, vertex, vertices });
        }
        soup.face(face);
        (rest, polygon) = (next, polygon + 1);
    }
    Ok(soup.finish(Format::Obj, None)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec3> {
        vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y]
    }

    #[test]
    fn polygons_become_triangles() {
        let loaded = of_polygons(square(), &[4, 0, 1, 2, 3, 3, 0, 2, 1]).expect("a mesh");
        assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 1]]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let told = |polygons: &[u32]| of_polygons(square(), polygons).expect_err("no mesh").to_string();
        assert!(told(&[3, 0, 1, 9]).starts_with("polygon 0 refers to vertex 9"));
        assert!(told(&[3, 0, 1, 2, 4, 0]).starts_with("polygon 1 has 4 corners"));
        assert!(matches!(of_polygons(square(), &[]), Err(ArraysError::Nothing(_))));
        assert!(matches!(of_triangles(square(), vec![[0, 1, 4]]), Err(ArraysError::Index(_))));
    }

    #[test]
    fn triangles_at_no_place_are_left_out_with_a_warning() {
        let mut positions = square();
        positions[3].x = f64::NAN;
        let loaded = of_triangles(positions, vec![[0, 1, 2], [0, 2, 3]]).expect("a mesh");
        assert_eq!((loaded.mesh.triangles.len(), loaded.warnings.len()), (1, 1));
    }
}
