//! The facets of an arrangement: the triangles of its input on the fine lattice, each place taken once.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::plane::{Plane, normal};
use crate::mesh::weld::canonical;

/// A triangle of the input that covers a facet or a piece of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cover {
    /// The number of the triangle.
    pub triangle: u32,
    /// Whether it faces the other way than the facet or the piece.
    pub reversed: bool,
}

/// Triangles with an area over lattice vertices, no two of them over the same three.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facets {
    /// Places of the vertices, each once.
    pub(crate) vertices: Vec<[i32; 3]>,
    /// The vertices of each facet.
    pub(crate) corners: Vec<[u32; 3]>,
    /// Where the covers of each facet begin; one entry more than there are facets.
    starts: Vec<u32>,
    covers: Vec<Cover>,
}

impl Facets {
    /// The facets of triangles over vertices that may share places. Triangles without an area are left out: they cover nothing.
    pub(crate) fn new(places: &[[i32; 3]], triangles: &[[u32; 3]]) -> (Self, Vec<u32>) {
        let mut first: FxHashMap<[i32; 3], u32> = FxHashMap::default();
        let mut vertices = Vec::new();
        let number = |&place: &[i32; 3]| {
            *first.entry(place).or_insert_with(|| {
                vertices.push(place);
                vertices.len() as u32 - 1
            })
        };
        let numbers: Vec<u32> = places.iter().map(number).collect();
        let mut keyed: Vec<([u32; 3], Cover)> = triangles
            .par_iter()
            .enumerate()
            .filter(|(_, t)| normal(t.map(|v| places[v as usize])) != [0; 3])
            .map(|(triangle, t)| {
                let (sorted, even) = canonical(t.map(|v| numbers[v as usize]));
                (sorted, Cover { triangle: triangle as u32, reversed: !even })
            })
            .collect();
        // By triangles, but copies together with the first.
        keyed.par_sort_unstable();
        let mut groups: Vec<(u32, usize, usize)> = Vec::new();
        let mut at = 0;
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            groups.push((same[0].1.triangle, at, at + same.len()));
            at += same.len();
        }
        groups.par_sort_unstable();
        let mut facets = Self { vertices, starts: vec![0], ..Self::default() };
        for (triangle, from, to) in groups {
            let turned = keyed[from].1.reversed;
            facets.corners.push(triangles[triangle as usize].map(|v| numbers[v as usize]));
            let covers = keyed[from..to].iter().map(|&(_, c)| Cover { reversed: c.reversed != turned, ..c });
            facets.covers.extend(covers);
            facets.starts.push(facets.covers.len() as u32);
        }
        (facets, numbers)
    }

    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// The triangles that cover a facet; the first of them faces as it does.
    pub(crate) fn covers(&self, facet: u32) -> &[Cover] {
        &self.covers[self.starts[facet as usize] as usize..self.starts[facet as usize + 1] as usize]
    }

    pub(crate) fn places(&self, facet: u32) -> [[i32; 3]; 3] {
        self.corners[facet as usize].map(|v| self.vertices[v as usize])
    }

    pub(crate) fn plane(&self, facet: u32) -> Plane {
        Plane::through(self.places(facet))
    }
}
