//! Which source triangles bound the solid by themselves.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::super::facets::{FacetId, Side};
use super::super::surface::{rounded, shape};
use crate::ldi::Evidence;
use crate::mesh::edges::{Edges, Union, copies};
use crate::mesh::weld::first_of_equal;
use crate::mesh::{Bounds, TriMesh, intersecting_triangles};
use crate::progress::{Progress, Stopped};

/// The least height of a kept triangle, h.
const LEAST_HEIGHT: f64 = 1e-7;

/// The share of a patch's crossings that may not bound the solid: those where a ray touches an edge.
const MOST_DROPPED: f64 = 0.02;

/// The share of a patch's crossings that must bound the solid; the others are on silent rays.
const LEAST_BOUNDING: f64 = 0.2;

/// The source triangles that bound the solid as they are. The default is none.
#[derive(Debug, Clone, Default)]
pub struct Kept {
    /// The source, its coordinates rounded to what any format holds, vertices at the same place joined.
    pub(super) mesh: TriMesh,
    /// Whether a triangle is kept.
    pub(super) is: Vec<bool>,
    /// Whether the solid lies on the side of its normal.
    pub(super) reversed: Vec<bool>,
    /// Whether a triangle meets another one.
    pub(super) meets: Vec<bool>,
}

/// Where triangles that are kept end, and with what.
#[derive(Debug, Clone, Default)]
pub struct Seams {
    /// The triangles that are not kept, model units.
    pub others: Vec<[DVec3; 3]>,
    /// The edges between those that are kept and those that are not, model units; edges with nothing beyond are on rims.
    pub edges: Vec<[DVec3; 2]>,
    /// For each connected part of the edges with one triangle, kept or not, the box around it, model units.
    pub rims: Vec<Bounds>,
}

impl Kept {
    /// Of the triangles of `source` those that meet no other and that, patch by patch, bound the solid by the word of the rays. A
    /// patch has the solid on one side all over, unless it is open; so one word of all its rays will do, and where
    /// they differ, what is near those that say no is left out and the rest asked again. `h` is the voxel spacing, model units.
    ///
    /// # Errors
    /// Only where it was stopped.
    pub fn of(source: &TriMesh, evidence: &Evidence, h: f64, progress: &Progress) -> Result<Self, Stopped> {
        let mut kept = candidates(source, h, progress)?;
        kept.is.iter_mut().zip(&evidence.changed).for_each(|(is, changed)| *is &= !changed);
        let patches = Patches::new(&kept, evidence);
        let mut torn = vec![false; kept.mesh.positions.len()];
        for t in 0..kept.is.len() {
            let tells_no = kept.is[t] && evidence.dropped(t) > 0 && !patches.verdict(t).bounds();
            kept.mesh.triangles[t].iter().filter(|_| tells_no).for_each(|&v| torn[v as usize] = true);
        }
        for t in 0..kept.is.len() {
            kept.is[t] &= patches.verdict(t).bounds() || kept.mesh.triangles[t].iter().all(|&v| !torn[v as usize]);
        }
        let patches = Patches::new(&kept, evidence);
        for t in 0..kept.is.len() {
            let verdict = patches.verdict(t);
            kept.is[t] &= verdict.bounds();
            kept.reversed[t] = verdict.bounding[1] > verdict.bounding[0];
        }
        Ok(kept)
    }

    /// Where the kept triangles end, once they are a manifold with a border.
    pub fn seams(&self) -> Seams {
        let mut tidy = self.clone();
        tidy.tidy();
        let Self { mesh, is, .. } = &tidy;
        let edges = Edges::new(&mesh.triangles, mesh.positions.len());
        let mut seams = Seams::default();
        let mut rims = Union::new(mesh.positions.len());
        let mut on_rims: Vec<u32> = Vec::new();
        edges.each(|edge| {
            let kept = edge.halves().filter(|&half| is[half as usize / 3]).count();
            let Some(half) = edge.halves().next().map(|half| half as usize) else { return };
            let ends = [half % 3, (half + 1) % 3].map(|k| mesh.triangles[half / 3][k]);
            if kept > 0 && (kept < edge.count() || kept > 2) && edge.count() > 1 {
                seams.edges.push(ends.map(|v| mesh.positions[v as usize]));
            }
            if edge.count() == 1 {
                rims.join(ends[0], ends[1]);
                on_rims.extend(ends);
            }
        });
        seams.rims = boxes(&mesh.positions, &mut rims, &on_rims);
        seams.others = (0..is.len()).filter(|&t| !is[t]).map(|t| mesh.corners(t)).collect();
        seams
    }

    /// The corners of a triangle in the order in which they run around the solid's outside.
    pub(super) fn corners(&self, facet: u32) -> [u32; 3] {
        let [a, b, c] = self.mesh.triangles[facet as usize];
        if self.reversed[facet as usize] { [a, c, b] } else { [a, b, c] }
    }

    /// The side of a triangle that looks out of the solid.
    pub(super) fn side(&self, triangle: u32) -> Side {
        Side::new(FacetId::of_triangle(triangle), self.reversed[triangle as usize])
    }

    /// The kept triangles.
    pub(super) fn facets(&self) -> Vec<u32> {
        (0..self.is.len() as u32).filter(|&t| self.is[t as usize]).collect()
    }

    /// Lets go of triangles until the others are a manifold with a border: at most two at an edge, that run
    /// against each other, and one fan at a vertex.
    pub(super) fn tidy(&mut self) {
        loop {
            let facets = self.facets();
            let triangles: Vec<[u32; 3]> = facets.iter().map(|&t| self.corners(t)).collect();
            let edges = Edges::new(&triangles, self.mesh.positions.len());
            let mut gone: Vec<u32> = Vec::new();
            edges.each(|edge| {
                let mut halves = edge.halves();
                let fine = match (edge.count(), halves.next(), halves.next()) {
                    (1, ..) => true,
                    (2, Some(a), Some(b)) => edges.runs_up(a) != edges.runs_up(b),
                    _ => false,
                };
                if !fine {
                    gone.extend(edge.halves().map(|half| facets[half as usize / 3]));
                }
            });
            let fans = edges.connectivity().fans;
            let torn = |t: &[u32; 3]| t.iter().any(|&v| fans[v as usize] > 1);
            gone.extend(triangles.iter().zip(&facets).filter(|(t, _)| torn(t)).map(|(_, &facet)| facet));
            if gone.is_empty() {
                return;
            }
            gone.iter().for_each(|&t| self.is[t as usize] = false);
        }
    }
}

/// The boxes around the connected parts of `vertices`, in the order of their first vertices.
fn boxes(positions: &[DVec3], parts: &mut Union, vertices: &[u32]) -> Vec<Bounds> {
    let mut number: FxHashMap<u32, usize> = FxHashMap::default();
    let mut boxes: Vec<Bounds> = Vec::new();
    for &v in vertices {
        let p = positions[v as usize];
        let n = *number.entry(parts.root(v)).or_insert(boxes.len());
        match boxes.get_mut(n) {
            Some(all) => (all.min, all.max) = (all.min.min(p), all.max.max(p)),
            None => boxes.push(Bounds { min: p, max: p }),
        }
    }
    boxes
}

/// The triangles that have an area and meet no other. Of several copies of a triangle the first is one; vertices at the
/// same place count as one.
fn candidates(source: &TriMesh, h: f64, progress: &Progress) -> Result<Kept, Stopped> {
    let positions: Vec<DVec3> = source.positions.iter().map(|&p| rounded(p)).collect();
    let first = first_of_equal(&positions);
    let mut triangles: Vec<[u32; 3]> = source.triangles.iter().map(|t| t.map(|v| first[v as usize])).collect();
    for [copy, _] in copies(&triangles, positions.len()) {
        // Without edges, it is no neighbour to anyone.
        triangles[copy as usize] = [triangles[copy as usize][0]; 3];
    }
    let mut is: Vec<bool> =
        triangles.par_iter().map(|t| shape(t.map(|v| positions[v as usize])).1 > LEAST_HEIGHT * h).collect();
    let single: Vec<u32> = (0..is.len() as u32).filter(|&t| is[t as usize]).collect();
    let mesh = TriMesh { triangles: single.iter().map(|&t| triangles[t as usize]).collect(), positions };
    let mut meets = vec![false; is.len()];
    intersecting_triangles(&mesh, progress)?.into_iter().for_each(|n| meets[single[n as usize] as usize] = true);
    is.iter_mut().zip(&meets).for_each(|(is, meets)| *is &= !meets);
    Ok(Kept { reversed: vec![false; is.len()], is, meets, mesh: TriMesh { triangles, ..mesh } })
}

/// The crossings of a patch.
#[derive(Debug, Clone, Copy, Default)]
struct Verdict {
    crossed: u32,
    dropped: u32,
    bounding: [u32; 2],
}

impl Verdict {
    fn bounds(&self) -> bool {
        let [more, less] = [self.bounding[0].max(self.bounding[1]), self.bounding[0].min(self.bounding[1])];
        let share = |part: u32| f64::from(part) / f64::from(self.crossed.max(1));
        more > 0 && share(self.dropped + less) <= MOST_DROPPED && share(more) >= LEAST_BOUNDING
    }
}

/// Triangles joined over edges that two of the soup share, and what the rays say of them.
struct Patches {
    patch: Vec<u32>,
    verdicts: Vec<Verdict>,
}

impl Patches {
    fn new(kept: &Kept, evidence: &Evidence) -> Self {
        let mut union = Union::new(kept.is.len());
        let edges = Edges::new(&kept.mesh.triangles, kept.mesh.positions.len());
        edges.each(|edge| {
            let mut halves = edge.halves();
            let (2, Some(a), Some(b)) = (edge.count(), halves.next(), halves.next()) else { return };
            if edges.runs_up(a) != edges.runs_up(b) && kept.is[a as usize / 3] && kept.is[b as usize / 3] {
                union.join(a / 3, b / 3);
            }
        });
        let patch: Vec<u32> = (0..kept.is.len() as u32).map(|t| union.root(t)).collect();
        let mut verdicts = vec![Verdict::default(); patch.len()];
        for (t, &patch) in patch.iter().enumerate() {
            let verdict = &mut verdicts[patch as usize];
            verdict.crossed += evidence.crossed[t];
            verdict.dropped += evidence.dropped(t);
            (0..2).for_each(|k| verdict.bounding[k] += evidence.bounding[t][k]);
        }
        Self { patch, verdicts }
    }

    fn verdict(&self, triangle: usize) -> Verdict {
        self.verdicts[self.patch[triangle] as usize]
    }
}
