//! A surface that knows what its vertices lie on.

use glam::DVec3;
use rayon::prelude::*;

use super::crease::Spot;
use super::facets::{FacetId, Facets, SMOOTH, Side, Sides};
use crate::mesh::TriMesh;

/// A triangle whose centre lies this part of its height beyond the source is not on it.
const OFF: f64 = 0.05;

/// A surface whose vertices know the facets they lie on.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// The surface, model units; every coordinate is an `f32`.
    pub mesh: TriMesh,
    /// The facets that each vertex lies on.
    pub sides: Vec<Sides>,
    /// For each vertex the vertex of the source that it is.
    pub(super) vertices_of: Vec<OfSource>,
    /// For each triangle the triangle of the source that it was, before flat parts were simplified.
    pub(super) triangles_of: Vec<OfSource>,
}

/// The number of a vertex or triangle of the source, or none, in four bytes: surfaces have millions of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct OfSource(u32);

impl OfSource {
    /// What is none of the source's.
    pub(super) const NONE: Self = Self(u32::MAX);

    /// Number `number` of the source's.
    pub(super) fn new(number: u32) -> Self {
        Self(number)
    }

    /// The number.
    #[inline]
    pub(super) fn number(self) -> Option<u32> {
        (self != Self::NONE).then_some(self.0)
    }
}

impl Surface {
    /// A surface none of whose vertices is one of the source's.
    pub fn new(mesh: TriMesh, sides: Vec<Sides>) -> Self {
        let vertices_of = vec![OfSource::NONE; mesh.positions.len()];
        let triangles_of = vec![OfSource::NONE; mesh.triangles.len()];
        Self { mesh, sides, vertices_of, triangles_of }
    }

    /// The vertex of the source that a vertex is, if it is one.
    pub fn source_vertex(&self, vertex: u32) -> Option<u32> {
        self.vertices_of[vertex as usize].number()
    }

    /// The triangle of the source that a triangle was before flat parts were simplified, if it was one.
    pub fn source_triangle(&self, t: u32) -> Option<u32> {
        self.triangles_of[t as usize].number()
    }

    /// Adds a vertex, and says which vertex of the source it is.
    pub(super) fn add(&mut self, spot: Spot, of: OfSource) {
        self.mesh.positions.push(spot.at);
        self.sides.push(spot.sides);
        self.vertices_of.push(of);
    }

    /// Whether a vertex is one of the source's.
    pub(super) fn is_kept(&self, vertex: u32) -> bool {
        self.source_vertex(vertex).is_some()
    }

    pub(super) fn at(&self, vertex: u32) -> DVec3 {
        self.mesh.positions[vertex as usize]
    }

    pub(super) fn put(&mut self, vertex: u32, spot: Spot) {
        self.mesh.positions[vertex as usize] = spot.at;
        self.sides[vertex as usize] = spot.sides;
    }

    pub(super) fn spot(&self, vertex: u32) -> Spot {
        Spot { at: self.at(vertex), sides: self.sides[vertex as usize] }
    }

    /// The edges, each once, smaller vertex first; the surface must be closed.
    pub(super) fn edges(&self) -> impl ParallelIterator<Item = [u32; 2]> + '_ {
        let halves = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        self.mesh.triangles.par_iter().flat_map_iter(move |t| halves(t).into_iter().filter(|[a, b]| a < b))
    }

    /// Whether all corners are the source's, so that the triangle is not the fit's business.
    pub(super) fn is_kept_triangle(&self, t: u32) -> bool {
        self.mesh.triangles[t as usize].iter().all(|&v| self.is_kept(v))
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

    /// The facets around a vertex, as seen by a triangle with this normal: all of them for one of the source's, which has
    /// more than [`Sides`] hold.
    pub(super) fn facets_at(&self, facets: &Facets<'_>, vertex: u32, normal: DVec3) -> Vec<Side> {
        match self.source_vertex(vertex) {
            Some(own) => facets.around(own).iter().map(|&t| facets.facing(t, normal)).collect(),
            None => self.sides[vertex as usize].iter().collect(),
        }
    }

    /// The facet that a triangle lies on; `None` where nothing is known.
    pub fn facet(&self, facets: &Facets<'_>, t: u32) -> Option<FacetId> {
        let corners = self.spots(t);
        let centre = corners.iter().map(|c| c.at).sum::<DVec3>() / 3.0;
        let normal = shape(corners.map(|c| c.at)).0.normalize_or_zero();
        if let Some(own) = self.source_triangle(t) {
            return Some(facets.walk(facets.facing(own, normal), centre).0.facet());
        }
        let around = self.mesh.triangles[t as usize].map(|v| self.facets_at(facets, v, normal));
        let known = around.iter().filter(|sides| !sides.is_empty()).count();
        // A facet that all corners with any share is it; else the one that faces the same way.
        let votes = |side: Side| around.iter().filter(|sides| sides.contains(&side)).count() == known;
        let off = |side: Side| {
            let plane = facets.plane(side);
            (!votes(side), 1.0 - plane.normal.dot(normal))
        };
        let best = around.iter().flatten().copied().min_by(|p, q| {
            let (p, q) = (off(*p), off(*q));
            p.0.cmp(&q.0).then(p.1.total_cmp(&q.1))
        })?;
        let (side, beyond) = facets.walk(best, centre);
        // Between vertices of the source there may be nothing of it: they do not know the lids that end on them.
        let spans_nothing = self.is_kept_triangle(t)
            && (facets.plane(best).normal.dot(normal) < SMOOTH || beyond > OFF * shape(corners.map(|c| c.at)).1);
        (!spans_nothing).then(|| side.facet())
    }

    /// The corners of a triangle.
    pub(super) fn spots(&self, t: u32) -> [Spot; 3] {
        self.mesh.triangles[t as usize].map(|v| self.spot(v))
    }
}

/// How well a triangle agrees with its facets: the cosine between its normal and that of the facet,
/// of those its corners lie on, whose smooth piece all corners share and that agrees best; `None` where there
/// is no such piece.
pub(super) fn agreement(facets: &Facets<'_>, corners: &[Spot; 3]) -> Option<f64> {
    let normal = shape(corners.map(|c| c.at)).0.normalize_or_zero();
    let has = |corner: &Spot, p: Side| {
        corner.sides.iter().any(|q| p == q || facets.plane(p).normal.dot(facets.plane(q).normal) > SMOOTH)
    };
    let all = corners.iter().flat_map(|c| c.sides.iter());
    all.filter(|&p| corners.iter().all(|c| has(c, p)))
        .map(|p| facets.plane(p).normal.dot(normal))
        .max_by(f64::total_cmp)
}

/// Whether a triangle does not face away from its facets.
pub(super) fn faces_out(facets: &Facets<'_>, corners: &[Spot; 3]) -> bool {
    agreement(facets, corners).is_none_or(|a| a > 0.0)
}

/// A point whose coordinates any format holds unchanged.
pub(crate) fn rounded(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}

/// Twice the area as a vector, and the smallest height.
pub(super) fn shape([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared()).sqrt();
    (normal, normal.length() / longest)
}
