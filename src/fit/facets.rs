//! The source triangles as planes with extents: what the surface is fitted to.

use glam::DVec3;
use rayon::prelude::*;

use crate::contour::Ground;
use crate::mesh::around::Around;
use crate::mesh::neighbours::Neighbours;
use crate::mesh::{Plane, TriMesh};

/// Planes that turn by less (cosine, 20°) belong to one smooth piece.
pub(super) const SMOOTH: f64 = 0.94;

/// Most facets that a walk crosses.
const LONGEST_WALK: usize = 24;

/// The number of a facet: first come the triangles of the source, by their own numbers, then planes without a triangle.
/// [`Facets`] knows which is which.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FacetId(u32);

impl FacetId {
    /// The facet that is the triangle of the source with this number.
    pub fn of_triangle(triangle: u32) -> Self {
        Self(triangle)
    }

    /// Its place among all facets.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A facet seen from one of its sides: the one that looks out of the solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Side(u32);

impl Side {
    /// Facet `facet`, seen against its own normal when `reversed`.
    pub fn new(facet: FacetId, reversed: bool) -> Self {
        Self(facet.0 << 1 | u32::from(reversed))
    }

    /// The facet whose side this is.
    pub fn facet(self) -> FacetId {
        FacetId(self.0 >> 1)
    }

    /// Whether the solid lies on the side of the facet's own normal.
    pub fn reversed(self) -> bool {
        self.0 & 1 == 1
    }
}

/// Most facets that a vertex remembers to lie on.
pub(super) const MOST: usize = 4;

/// Where fewer facets than [`MOST`] are known: the number that no facet has.
const FREE: Side = Side(u32::MAX);

/// The facets that a vertex lies on: one on a face, several on creases and corners, none where
/// nothing is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sides([Side; MOST]);

impl Default for Sides {
    fn default() -> Self {
        Self([FREE; MOST])
    }
}

impl Sides {
    /// A list of the given sides, each once; those after the fourth are left out.
    pub fn of(sides: impl IntoIterator<Item = Side>) -> Self {
        let mut all = Self::default();
        sides.into_iter().for_each(|side| all.add(side));
        all
    }

    /// Adds a side, unless it is in the list or the list is full.
    pub fn add(&mut self, side: Side) {
        if let Some(free) = self.0.iter_mut().find(|s| **s == FREE || **s == side) {
            *free = side;
        }
    }

    /// The sides in the list.
    pub fn iter(&self) -> impl Iterator<Item = Side> + Clone + '_ {
        self.0.iter().copied().take_while(|s| *s != FREE)
    }

    /// Whether the list has no side.
    pub fn is_empty(&self) -> bool {
        self.0[0] == FREE
    }
}

/// What a surface is fitted to: the triangles of the source mesh as planes that end where the triangles do, and after them
/// planes without an end.
pub struct Facets<'a> {
    mesh: &'a TriMesh,
    planes: Vec<Plane>,
    neighbours: Neighbours,
    /// The triangles around each vertex.
    around: Around,
    /// A number for each triangle, or none: simplification keeps different ones apart.
    classes: Vec<u32>,
    /// How far a point is from the surface that is wanted, model units, where that is known.
    target: Option<TargetDistance<'a>>,
    /// Where the surface that is wanted is, model units, if the contour was cut off around that.
    beyond: Option<Beyond<'a>>,
}

/// Whether a point (model units) is beyond the part of space that a contour was made for.
pub type Beyond<'a> = &'a (dyn Fn(DVec3) -> bool + Sync);

/// The target distance: how far a point (model units) is from the surface that is wanted, in model units.
pub type TargetDistance<'a> = &'a (dyn Fn(DVec3) -> f64 + Sync);

/// A crease farther than this, h, from the surface that is wanted is none: the planes belong to something round.
const ASTRAY: f64 = 0.05;

impl<'a> Facets<'a> {
    /// The facets of a source: the triangles of `mesh`, and after them `planes` (model units) for surface that no triangle is
    /// the source of.
    pub fn new(mesh: &'a TriMesh, planes: impl IntoIterator<Item = Plane>) -> Self {
        let count = mesh.triangles.len();
        let mut all: Vec<Plane> = (0..count).into_par_iter().map(|t| Plane::through(mesh.corners(t))).collect();
        all.extend(planes);
        let neighbours = Neighbours::new(&mesh.triangles, mesh.positions.len());
        Self {
            mesh,
            planes: all,
            neighbours,
            around: Around::new(mesh),
            classes: Vec::new(),
            target: None,
            beyond: None,
        }
    }

    /// The same facets with a number, the class, for each triangle: simplification moves no surface over the border between
    /// two classes, so that colours and operands stay apart.
    pub fn with_classes(mut self, classes: Vec<u32>) -> Self {
        self.classes = classes;
        self
    }

    /// The same facets for a contour that was made for a part of space only and closed along its border: where a point (model units) is beyond
    /// that part, all of the surface that is wanted are triangles that are kept.
    pub fn with_beyond(mut self, beyond: Option<Beyond<'a>>) -> Self {
        self.beyond = beyond;
        self
    }

    /// Whether the contour was made for a part of space only.
    pub(super) fn has_beyond(&self) -> bool {
        self.beyond.is_some()
    }

    /// Whether a point of the contour is where it is not wanted.
    pub(super) fn is_beyond(&self, p: DVec3) -> bool {
        self.beyond.is_some_and(|beyond| beyond(p))
    }

    /// The same facets with a judge of creases. Planes that touch something round meet beside it, and a crease there would be
    /// wrong; the target distance tells.
    pub fn with_target(mut self, target: TargetDistance<'a>) -> Self {
        self.target = Some(target);
        self
    }

    /// Whether a point is on the surface that is wanted, as far as is known.
    pub(super) fn is_on_target(&self, p: DVec3, h: f64) -> bool {
        self.target.is_none_or(|off| off(p) < ASTRAY * h)
    }

    /// Whether there are any classes.
    pub(super) fn has_classes(&self) -> bool {
        !self.classes.is_empty()
    }

    /// The class of a side's triangle, if it has one.
    pub(super) fn class(&self, side: Side) -> Option<u32> {
        self.classes.get(side.facet().index()).copied()
    }

    /// The triangles around a vertex of the source.
    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        self.around.of(vertex)
    }

    /// The triangle of the source across an edge (corner k to the next) of one; `None` where there is none, or several.
    pub(super) fn across(&self, triangle: u32, edge: usize) -> Option<u32> {
        self.neighbours.across(triangle, edge).map(|across| across.triangle)
    }

    /// The number of triangles of the source: facets from here on have no extent.
    pub fn triangles(&self) -> usize {
        self.neighbours.len()
    }

    /// The triangle of the source that a facet is; `None` for a plane without one.
    pub fn triangle(&self, facet: FacetId) -> Option<u32> {
        (facet.index() < self.triangles()).then_some(facet.0)
    }

    /// The facet that a vertex of a contour lies on, where it is known.
    pub fn facet_on(&self, ground: Ground) -> Option<FacetId> {
        match ground {
            Ground::Unknown => None,
            Ground::Triangle(triangle) => Some(FacetId(triangle)),
            Ground::Plane(number) => Some(FacetId(self.triangles() as u32 + number)),
        }
    }

    /// The plane of a side, its normal looking out of the solid. Its normal is zero where the
    /// triangle has no area.
    #[inline]
    pub fn plane(&self, side: Side) -> Plane {
        let plane = self.planes[side.facet().index()];
        if side.reversed() { Plane { normal: -plane.normal, offset: -plane.offset } } else { plane }
    }

    /// The side of a triangle of the source that looks the way of `normal`.
    pub(super) fn facing(&self, triangle: u32, normal: DVec3) -> Side {
        let facet = FacetId::of_triangle(triangle);
        Side::new(facet, self.planes[facet.index()].normal.dot(normal) < 0.0)
    }

    /// Walks over the source from `side` towards `p` without leaving the smooth piece: the facet
    /// over which `p` lies, or the last one before a crease or border, and how far beyond its end
    /// `p` then lies, model units.
    pub(super) fn walk(&self, side: Side, p: DVec3) -> (Side, f64) {
        let mut at = side;
        let mut last = 0.0;
        for _ in 0..LONGEST_WALK {
            let Some((edge, beyond)) = self.exit(at, p) else { return (at, 0.0) };
            last = beyond;
            let Some(across) = self.neighbours.across(at.facet().0, edge) else { return (at, beyond) };
            let next = Side::new(FacetId(across.triangle), at.reversed() != across.turned);
            if self.plane(next).normal.dot(self.plane(at).normal) < SMOOTH {
                return (at, beyond);
            }
            at = next;
        }
        (at, last)
    }

    /// The edge of a side's triangle that `p` lies farthest beyond, seen along the normal, and by how much; `None`
    /// over the triangle and for facets without extent.
    fn exit(&self, side: Side, p: DVec3) -> Option<(usize, f64)> {
        let facet = side.facet().index();
        if facet >= self.triangles() {
            return None;
        }
        let corners = self.mesh.corners(facet);
        let normal = self.planes[facet].normal;
        let beyond = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let outward = (b - a).cross(normal);
            let far = outward.normalize_or_zero().dot(p - a);
            // On the edge itself, so that no walk goes to and fro.
            if far * far < 1e-18 * outward.length_squared() { 0.0 } else { far }
        };
        let far = [beyond(0), beyond(1), beyond(2)];
        let k = (0..3).max_by(|&i, &j| far[i].total_cmp(&far[j]))?;
        (far[k] > 0.0).then_some((k, far[k]))
    }
}
