//! What every writer asks of a mesh.

use super::error::{WriteError, WriteProblem};
use super::format::Format;
use crate::mesh::TriMesh;

/// Checks that there are triangles, that their indices are in range, and that the format holds the coordinates.
pub(super) fn check(mesh: &TriMesh, format: Format) -> Result<(), WriteError> {
    if mesh.triangles.is_empty() {
        return Err(WriteProblem::NoTriangles.into());
    }
    mesh.check().map_err(WriteProblem::Index)?;
    let holds = |x: f64| if format.is_single() { (x as f32).is_finite() } else { x.is_finite() };
    for (vertex, p) in mesh.positions.iter().enumerate() {
        if let Some(value) = p.to_array().into_iter().find(|&x| !holds(x)) {
            return Err(WriteProblem::Coordinate { vertex, value, format }.into());
        }
    }
    Ok(())
}
