//! From the contour to the surface that is returned: facets, merging, fit, and where each face comes from.

use glam::IVec3;
use rayon::prelude::*;

use super::{Precision, SurfaceOptions, TriangleSource};
use crate::contour::{Collapsed, Contour, ContourVertex, Crossing, Ground, LatticeEdge, Merge, collapse_same_voxel};
use crate::fit::{Facets, Side, Sides, Surface};
use crate::lattice::{DistanceField, Lattice, brick_of};
use crate::ldi::edge_crossing;
use crate::mesh::{Plane, TriMesh, ValidateOptions, validate};
use crate::progress::{Progress, Stopped};
use crate::survey::{Soup, Survey};
use crate::vote::{Lid, Winding};

/// Before a fit, vertices of a voxel are merged where they stay this near to their planes, h. Larger ones
/// (0.02) show in the mean error of curved parts.
const FLAT: f64 = 0.01;

/// Where the solid ends over a hole, on the lattice edge between two voxels; nowhere along the border of the survey's domain.
fn lid(survey: &Survey, winding: &Winding<'_>, inside: IVec3, outside: IVec3) -> Option<Lid> {
    if !survey.domain.holds(brick_of(outside)) {
        return None;
    }
    // A stop shows again at the next check.
    winding.crossing(inside, outside, &survey.expression).ok().flatten()
}

/// The crossings of lattice edges for the contour: with the surface, or with a lid over a hole.
pub(super) fn crossings<'a>(
    survey: &'a Survey,
    winding: &'a Winding<'_>,
    distance: &'a DistanceField,
) -> impl Fn(LatticeEdge) -> Option<Crossing> + Sync + 'a {
    move |edge| {
        let lower_inside = distance.grid.get(edge.voxel) < 0.0;
        if let Some((t, hit)) = edge_crossing(&survey.spans, edge.voxel, edge.axis as usize, lower_inside) {
            return Some(Crossing { t, triangle: Some(hit.triangle()) });
        }
        let upper = edge.voxel + IVec3::AXES[edge.axis as usize];
        let (inside, outside) = if lower_inside { (edge.voxel, upper) } else { (upper, edge.voxel) };
        let t = lid(survey, winding, inside, outside)?.t;
        Some(Crossing { t: if lower_inside { t } else { 1.0 - t }, triangle: None })
    }
}

/// Puts the contour's vertices that lie over holes on a plane of their own each: that of the lid there. Returns these planes.
pub(super) fn lids(
    contour: &mut Contour,
    survey: &Survey,
    winding: &Winding<'_>,
    progress: &Progress,
) -> Result<Vec<Plane>, Stopped> {
    let bare: Vec<usize> =
        (0..contour.vertices.len()).filter(|&v| contour.vertices[v].ground == Ground::Unknown).collect();
    let found = bare.par_iter().map(|&v| {
        progress.check()?;
        let ContourVertex { voxel, outside, .. } = contour.vertices[v];
        Ok(lid(survey, winding, voxel, outside).map(|lid| {
            let at = survey.lattice.to_model(voxel.as_dvec3().lerp(outside.as_dvec3(), lid.t));
            (v, Plane { normal: lid.normal, offset: lid.normal.dot(at) })
        }))
    });
    let found: Vec<Option<(usize, Plane)>> = found.collect::<Result<_, Stopped>>()?;
    let mut planes = Vec::new();
    for (v, plane) in found.into_iter().flatten() {
        contour.vertices[v].ground = Ground::Plane(planes.len() as u32);
        planes.push(plane);
    }
    Ok(planes)
}

/// Merges the vertices of each voxel and notes the facets that vertices lie on.
pub(super) fn merged(
    contour: Contour,
    facets: &Facets<'_>,
    lattice: &Lattice,
    options: &SurfaceOptions,
    progress: &Progress,
) -> Result<Surface, Stopped> {
    let merge = match (options.collapse, options.fit.is_some()) {
        (false, _) => {
            let sides = contour.vertices.iter().map(|v| Sides::of(side(v, facets))).collect();
            return Ok(Surface::new(contour.mesh, sides));
        }
        (true, true) => Merge::Flat { within: FLAT },
        (true, false) => Merge::All,
    };
    let plane = |ground: Ground| {
        let plane = facets.plane(Side::new(facets.facet_on(ground)?, false));
        (plane.normal != glam::DVec3::ZERO).then_some(plane)
    };
    let collapsed = collapse_same_voxel(contour, lattice, &plane, merge, progress)?;
    let sides = sides(&collapsed, facets);
    Ok(Surface::new(collapsed.contour.mesh, sides))
}

/// The side of the facet that a vertex of the raw contour lies on.
fn side(vertex: &ContourVertex, facets: &Facets<'_>) -> Option<Side> {
    let facet = facets.facet_on(vertex.ground)?;
    let normal = facets.plane(Side::new(facet, false)).normal;
    Some(Side::new(facet, normal.dot((vertex.outside - vertex.voxel).as_dvec3()) < 0.0))
}

/// The facets that the vertices of a merged contour lie on.
fn sides(collapsed: &Collapsed, facets: &Facets<'_>) -> Vec<Sides> {
    let members = |v: usize| &collapsed.members[collapsed.starts[v] as usize..collapsed.starts[v + 1] as usize];
    (0..collapsed.contour.mesh.positions.len())
        .into_par_iter()
        .map(|v| Sides::of(members(v).iter().filter_map(|&m| side(&collapsed.raw[m as usize], facets))))
        .collect()
}

/// Where the triangles of a surface come from.
pub(super) fn sources(surface: &Surface, facets: &Facets<'_>, soup: &Soup) -> Vec<TriangleSource> {
    let source = |t: u32| {
        let own = surface.facet(facets, t).and_then(|facet| facets.triangle(facet));
        own.map_or(TriangleSource::Closed, |own| TriangleSource::in_soup(soup, own))
    };
    (0..surface.mesh.triangles.len() as u32).into_par_iter().map(source).collect()
}

/// The mesh of a surface, with the `f64` coordinates of `source` at the vertices that are its own, where they may be had and where
/// nothing touches for it.
pub(super) fn with_own_numbers(
    surface: Surface,
    source: &TriMesh,
    precision: Precision,
    progress: &Progress,
) -> Result<TriMesh, Stopped> {
    let mut positions = surface.mesh.positions.clone();
    for (p, v) in positions.iter_mut().zip(0..) {
        if let Some(own) = surface.source_vertex(v) {
            *p = source.positions[own as usize];
        }
    }
    if precision == Precision::Single || positions == surface.mesh.positions {
        return Ok(surface.mesh);
    }
    let own = TriMesh { positions, triangles: surface.mesh.triangles.clone() };
    let options = ValidateOptions { self_intersections: true, weld: true };
    Ok(if validate(&own, &options, progress)?.is_valid() { own } else { surface.mesh })
}
