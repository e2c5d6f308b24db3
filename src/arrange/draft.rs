//! A surface on the fine lattice on its way to numbers that a file can hold.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::extract::Face;
use super::fine::Fine;
use super::near::Near;
use super::refine::Refined;
use crate::mesh::TriMesh;
use crate::mesh::weld::canonical;

/// What a vertex of a draft is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// A vertex of the input by its number, where the input has it.
    Own(u32),
    /// A vertex of the input that has been put on the lattice.
    Placed,
    /// Any other vertex on the lattice.
    Moved,
    /// A point that was made, and where it is exactly, steps.
    Made(DVec3),
}

/// A closed surface whose vertices have places of their own on the fine lattice.
#[derive(Debug, Clone, Default)]
pub(crate) struct Draft {
    pub(crate) places: Vec<[i32; 3]>,
    pub(crate) kinds: Vec<Kind>,
    /// Counter-clockwise seen from outside.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// A triangle of the input that each triangle lies on.
    pub(crate) sources: Vec<u32>,
    /// For each triangle whether it may cross others; two for which that is not so do not cross each other.
    pub(crate) fresh: Vec<bool>,
}

/// What the vertices of an arrangement are, and what points that are made snap to.
pub(crate) struct Rounding<'a> {
    pub(crate) fine: &'a Fine,
    /// For each vertex of the arrangement what it is.
    pub(crate) kinds: &'a [Kind],
    /// The positions of the input's vertices as the result may have them, model units.
    pub(crate) input: &'a [DVec3],
    /// Points that are made near a vertex become it.
    pub(crate) near: Option<&'a Near>,
    /// Whether points that are made stay where they are exactly.
    pub(crate) exact: bool,
}

impl Draft {
    /// An extracted surface, rounded; points that come to one place become one vertex. `source` tells where a triangle of the arrangement's input
    /// comes from.
    pub(crate) fn new(refined: &Refined, faces: &[Face], rounding: &Rounding<'_>, source: impl Fn(u32) -> u32) -> Self {
        let mut draft = Self::default();
        let mut at: FxHashMap<[i32; 3], u32> = FxHashMap::default();
        let mut of: FxHashMap<u32, u32> = FxHashMap::default();
        for face in faces {
            let corners = face.corners.map(|p| {
                *of.entry(p).or_insert_with(|| {
                    let (place, kind) = rounding.rounded(refined, p);
                    let v = *at.entry(place).or_insert_with(|| draft.add(place, kind));
                    if matches!(kind, Kind::Own(_)) && !matches!(draft.kinds[v as usize], Kind::Own(_)) {
                        draft.kinds[v as usize] = kind;
                    }
                    v
                })
            });
            let [a, b, c] = corners;
            if a != b && b != c && c != a {
                draft.push(corners, source(face.cover.triangle), true);
            }
        }
        draft.cancel();
        draft
    }

    pub(crate) fn add(&mut self, place: [i32; 3], kind: Kind) -> u32 {
        self.places.push(place);
        self.kinds.push(kind);
        self.places.len() as u32 - 1
    }

    pub(crate) fn push(&mut self, corners: [u32; 3], source: u32, fresh: bool) {
        self.triangles.push(corners);
        self.sources.push(source);
        self.fresh.push(fresh);
    }

    /// Gives a triangle other corners.
    pub(crate) fn change(&mut self, triangle: usize, corners: [u32; 3]) {
        self.fresh[triangle] |= self.triangles[triangle] != corners;
        self.triangles[triangle] = corners;
    }

    /// Makes one vertex of those at one place, and takes out what that leaves without area.
    pub(crate) fn weld(&mut self) {
        let mut at: FxHashMap<[i32; 3], u32> = FxHashMap::default();
        let first: Vec<u32> = (0..).zip(&self.places).map(|(v, &place)| *at.entry(place).or_insert(v)).collect();
        for t in 0..self.triangles.len() {
            self.change(t, self.triangles[t].map(|v| first[v as usize]));
        }
        let keep: Vec<bool> = self.triangles.iter().map(|[a, b, c]| a != b && b != c && c != a).collect();
        self.retain(&keep);
        self.cancel();
    }

    /// Takes out triangles that meet their like turned over: rounding made one of the two sides of something thin of them.
    fn cancel(&mut self) {
        let key = |t: &[u32; 3]| {
            let (sorted, even) = canonical(*t);
            (sorted, if even { 1 } else { -1 })
        };
        let mut left: FxHashMap<[u32; 3], i32> = FxHashMap::default();
        for t in &self.triangles {
            let (sorted, way) = key(t);
            *left.entry(sorted).or_default() += way;
        }
        let keep: Vec<bool> = self
            .triangles
            .iter()
            .map(|t| {
                let (sorted, way) = key(t);
                let left = left.entry(sorted).or_default();
                let keep = *left * way > 0;
                *left -= if keep { way } else { 0 };
                keep
            })
            .collect();
        self.retain(&keep);
    }

    fn retain(&mut self, keep: &[bool]) {
        fn kept<T>(list: &mut Vec<T>, keep: &[bool]) {
            let mut each = keep.iter();
            list.retain(|_| each.next() == Some(&true));
        }
        kept(&mut self.triangles, keep);
        kept(&mut self.sources, keep);
        kept(&mut self.fresh, keep);
    }

    /// The mesh with the numbers of the result, model units. `input`: the positions of the input's vertices as the result may have them.
    pub(crate) fn mesh(&self, fine: &Fine, input: &[DVec3]) -> TriMesh {
        let position = |(&place, &kind): (&[i32; 3], &Kind)| match kind {
            Kind::Own(v) => input[v as usize],
            Kind::Made(exact) if !fine.single && fine.settled(exact) == place => exact * fine.step,
            _ => fine.point(place),
        };
        let positions = self.places.iter().zip(&self.kinds).map(position).collect();
        TriMesh { positions, triangles: self.triangles.clone() }
    }
}

impl Rounding<'_> {
    /// Where a point goes, and what it is there.
    fn rounded(&self, refined: &Refined, point: u32) -> ([i32; 3], Kind) {
        let vertex = |v: u32, place: [i32; 3]| {
            let kind = self.kinds[v as usize];
            // Where the result has it, which need not be what its place would be rounded to.
            let at = match kind {
                Kind::Own(own) => self.fine.place(self.input[own as usize]),
                _ => place,
            };
            (self.fine.settled(DVec3::from_array(at.map(f64::from))), kind)
        };
        if let Some(place) = refined.points.vertex(point) {
            return vertex(point, place);
        }
        let at = refined.points.approximate(point);
        if let Some(v) = self.near.and_then(|near| near.nearest(at)) {
            return vertex(v, refined.facets.vertices[v as usize]);
        }
        (self.fine.settled(at), if self.exact { Kind::Made(at) } else { Kind::Moved })
    }
}
