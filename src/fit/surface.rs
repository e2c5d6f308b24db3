//! A surface that knows what its vertices lie on.

use glam::DVec3;

use super::crease::{Place, SMOOTH};
use super::facets::{Facets, Side, Sides};
use crate::mesh::TriMesh;

/// A surface whose vertices know the facets they lie on.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// The surface, model units; every coordinate is an `f32`.
    pub mesh: TriMesh,
    /// One for each vertex.
    pub sides: Vec<Sides>,
}

impl Surface {
    pub(super) fn at(&self, vertex: u32) -> DVec3 {
        self.mesh.positions[vertex as usize]
    }

    pub(super) fn put(&mut self, vertex: u32, place: Place) {
        self.mesh.positions[vertex as usize] = place.at;
        self.sides[vertex as usize] = place.sides;
    }

    pub(super) fn place(&self, vertex: u32) -> Place {
        Place { at: self.at(vertex), sides: self.sides[vertex as usize] }
    }

    /// Whether the corners of a triangle have facets of one smooth piece, or one of them none.
    pub(super) fn is_smooth(&self, facets: &Facets<'_>, t: u32) -> bool {
        let [a, b, c] = self.mesh.triangles[t as usize].map(|v| self.sides[v as usize]);
        let near = |p: Side, q: Side| facets.plane(p).normal.dot(facets.plane(q).normal) > SMOOTH;
        let any = a.is_empty() || b.is_empty() || c.is_empty();
        if any || a.iter().any(|p| b.iter().any(|q| p == q) && c.iter().any(|r| p == r)) {
            return true;
        }
        a.iter().any(|p| b.iter().any(|q| near(p, q) && c.iter().any(|r| near(q, r) && near(p, r))))
    }

    /// The facet that a triangle lies on; `None` where nothing is known.
    pub fn facet(&self, facets: &Facets<'_>, t: u32) -> Option<u32> {
        let corners = self.places(t);
        let centre = corners.iter().map(|c| c.at).sum::<DVec3>() / 3.0;
        let normal = shape(corners.map(|c| c.at)).0.normalize_or_zero();
        let known = corners.iter().filter(|c| !c.sides.is_empty()).count();
        // A facet that all corners with any share is it; else the one that faces the same way.
        let votes = |side: Side| corners.iter().filter(|c| c.sides.iter().any(|s| s == side)).count() == known;
        let off = |side: Side| {
            let plane = facets.plane(side);
            (!votes(side), 1.0 - plane.normal.dot(normal))
        };
        let all = corners.iter().flat_map(|c| c.sides.iter());
        let best = all.min_by(|p, q| {
            let (p, q) = (off(*p), off(*q));
            p.0.cmp(&q.0).then(p.1.total_cmp(&q.1))
        })?;
        Some(facets.walk(best, centre).0.facet())
    }

    /// The corners of a triangle.
    pub(super) fn places(&self, t: u32) -> [Place; 3] {
        self.mesh.triangles[t as usize].map(|v| self.place(v))
    }
}

/// How well a triangle agrees with its facets: the cosine between its normal and that of the facet,
/// of those its corners lie on, whose smooth piece all corners share and that agrees best; `None` where there
/// is no such piece.
pub(super) fn agreement(facets: &Facets<'_>, corners: &[Place; 3]) -> Option<f64> {
    let normal = shape(corners.map(|c| c.at)).0.normalize_or_zero();
    let has = |corner: &Place, p: Side| {
        corner.sides.iter().any(|q| p == q || facets.plane(p).normal.dot(facets.plane(q).normal) > SMOOTH)
    };
    let all = corners.iter().flat_map(|c| c.sides.iter());
    all.filter(|&p| corners.iter().all(|c| has(c, p)))
        .map(|p| facets.plane(p).normal.dot(normal))
        .max_by(f64::total_cmp)
}

/// Whether a triangle does not face away from its facets.
pub(super) fn faces_out(facets: &Facets<'_>, corners: &[Place; 3]) -> bool {
    agreement(facets, corners).is_none_or(|a| a > 0.0)
}

/// A point whose coordinates any format holds unchanged.
pub(super) fn rounded(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}

/// Twice the area as a vector, and the smallest height.
pub(super) fn shape([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared()).sqrt();
    (normal, normal.length() / longest)
}
