//! Simplification of a source mesh that is right already.

use super::FitOptions;
use super::facets::{FacetId, Facets, Side, Sides};
use super::simplify::simplified;
use super::surface::{OfSource, Surface};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// What [`simplified_source`] makes.
#[derive(Debug, Clone, PartialEq)]
pub struct SimpleSource {
    /// The simplified solid.
    pub mesh: TriMesh,
    /// For each triangle of the simplified solid the triangle of the source that it lies on.
    pub of: Vec<Option<u32>>,
}

/// Simplifies the flat parts of a valid solid within [`FitOptions::simplify_kept`]. `classes` is empty or has a number for
/// each triangle; triangles of different numbers are kept apart. `h` is the voxel spacing that the tolerance refers to, model
/// units. There is no result where the mesh is no valid solid, as it is or with coordinates in `f32`.
///
/// # Errors
/// Only a stop.
pub fn simplified_source(
    mesh: &TriMesh,
    classes: Vec<u32>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<Option<SimpleSource>, Stopped> {
    let facets = Facets::new(mesh, []).with_classes(classes);
    let vertices_of = (0..mesh.positions.len() as u32).map(OfSource::new).collect();
    let surface = Surface { vertices_of, ..Surface::new(mesh.clone(), own_sides(mesh)) };
    let options = FitOptions { simplify: options.simplify_kept, ..*options };
    let untouched = vec![0.0; mesh.triangles.len()];
    let simple = simplified((&surface, &untouched), &facets, h, &options, progress)?;
    let Some(simple) = simple.map(|simple| simple.surface) else { return Ok(None) };
    let on = |t: u32| simple.facet(&facets, t).and_then(|facet| facets.triangle(facet));
    let of = (0..simple.mesh.triangles.len() as u32).map(on).collect();
    Ok(Some(SimpleSource { mesh: simple.mesh, of }))
}

/// The triangles that each vertex of a mesh lies on, as facets of the mesh itself.
pub(super) fn own_sides(mesh: &TriMesh) -> Vec<Sides> {
    let mut sides = vec![Sides::default(); mesh.positions.len()];
    for (t, corners) in (0..).zip(&mesh.triangles) {
        corners.iter().for_each(|&v| sides[v as usize].add(Side::new(FacetId::of_triangle(t), false)));
    }
    sides
}
