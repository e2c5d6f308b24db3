//! What is moved and where is cut, and how to take it back.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::crease::{Crease, FLAT, Spot, crease};
use super::cut::{Spared, edges_of, inset};
use super::facets::{Facets, SMOOTH};
use super::snap::snap;
use super::surface::{Surface, rounded};
use super::{FitOptions, FitReport};
use crate::mesh::around::Around;

/// A sharp crease nearer to the surface than this, h, is left out.
const SHARP_SAG: f64 = 0.002;

impl FitOptions {
    /// Whether an edge is to be cut there.
    pub(super) fn wants(&self, crease: &Crease, h: f64) -> bool {
        let sharp = crease.cosine < SMOOTH;
        let least = if sharp { SHARP_SAG } else { self.sag };
        crease.sag > least * h && (crease.on_source || (crease.sag < h && sharp))
    }
}

/// How much is taken back at a bad triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Haste {
    /// The last step first, then the one before.
    StepByStep,
    /// All that was done there.
    AtOnce,
    /// The same within so many rings of triangles around it: what is mended at one end of a row of slivers is wrong at the next.
    Around(u32),
}

/// The state of a fit.
pub(super) struct Fitting<'a> {
    initial: &'a Surface,
    facets: &'a Facets<'a>,
    h: f64,
    options: FitOptions,
    around: Around,
    /// Edges between different facets.
    edges: Vec<[u32; 2]>,
    /// The surface with vertices moved.
    pub surface: Surface,
    /// Whether a vertex has been moved.
    moved: Vec<bool>,
    /// Where edges are cut, sorted.
    pub points: Vec<([u32; 2], Crease)>,
    /// Where nothing is cut any more.
    pub spared: Spared,
    /// Triangles of the initial surface that are other than when they were last judged; `None` for all that
    /// differ from what they were there.
    dirty: Option<FxHashSet<u32>>,
    /// Moved vertices that have been put a little within the solid.
    drawn_back: FxHashSet<u32>,
    /// How often a triangle was bad with nothing left to take back.
    times_bad: FxHashMap<u32, u32>,
    snapped: usize,
    given_up: usize,
}

impl<'a> Fitting<'a> {
    /// Moves vertices and finds where to cut.
    pub(super) fn new(initial: &'a Surface, facets: &'a Facets<'a>, h: f64, options: &FitOptions) -> Self {
        let around = Around::new(&initial.mesh);
        let mut surface = initial.clone();
        let mut moved = vec![false; initial.mesh.positions.len()];
        flatten(&mut surface, facets, h).into_iter().for_each(|v| moved[v as usize] = true);
        let edges = straddling(&surface, facets);
        let snapped = snap(&mut surface, facets, h, &edges, &around);
        snapped.iter().for_each(|&v| moved[v as usize] = true);
        let points = creases(&surface, facets, h, options, edges.par_iter().copied());
        Self {
            initial,
            facets,
            h,
            options: *options,
            around,
            edges,
            surface,
            moved,
            points,
            spared: Spared { triangles: kept_triangles(initial), ..Spared::default() },
            dirty: None,
            drawn_back: FxHashSet::default(),
            times_bad: FxHashMap::default(),
            snapped: snapped.len(),
            given_up: 0,
        }
    }

    /// The triangles, given what they were in the initial surface, that are other than there.
    pub(super) fn changed(&self, origin: &[u32]) -> Vec<u32> {
        let initial = &self.initial.mesh.triangles;
        let mut parts = vec![0u8; initial.len()];
        origin.iter().for_each(|&t| parts[t as usize] += 1);
        let moved = |id: u32| initial[id as usize].iter().any(|&v| self.moved[v as usize]);
        let cut_or_moved = |t: &u32| parts[origin[*t as usize] as usize] > 1 || moved(origin[*t as usize]);
        (0..origin.len() as u32).into_par_iter().filter(cut_or_moved).collect()
    }

    /// Whether a triangle, given what it was in the initial surface, is other than when it was last judged.
    pub(super) fn is_dirty(&self, origin: u32) -> bool {
        self.dirty.as_ref().is_none_or(|dirty| dirty.contains(&origin))
    }

    /// Whether it was taken back since.
    pub(super) fn was_dirtied(&self, origin: u32) -> bool {
        self.dirty.as_ref().is_some_and(|dirty| dirty.contains(&origin))
    }

    /// Takes back, step by step, what was done at the initial triangles `bad`: first vertices
    /// inside, then cuts, then moves, then all of this around them. For those that are `touching` another sheet the first step
    /// is to stay a little within the solid.
    pub(super) fn undo(&mut self, bad: &[u32], touching: &[u32], centred: &[u32], haste: Haste) {
        let at_once = haste != Haste::StepByStep;
        let is_centred: FxHashSet<u32> = centred.iter().copied().collect();
        let is_cut: FxHashSet<[u32; 2]> = self.points.iter().map(|p| p.0).collect();
        let mut dirty: FxHashSet<u32> = bad.iter().copied().collect();
        let mut back: FxHashSet<u32> = FxHashSet::default();
        for &t in bad {
            let ids = self.initial.mesh.triangles[t as usize];
            if !at_once && touching.binary_search(&t).is_ok() && self.spared.inset.insert(t) {
                dirty.extend(self.draw_back(ids));
                continue;
            }
            self.given_up += 1;
            if let Haste::Around(rings) = haste {
                back.extend(self.spare_around(t, rings));
                continue;
            }
            if is_centred.contains(&t) && self.spared.triangles.insert(t) && !at_once {
                continue;
            }
            let cut: Vec<[u32; 2]> = edges_of(&ids).into_iter().filter(|e| is_cut.contains(e)).collect();
            if !cut.is_empty() {
                self.spared.edges.extend(&cut);
                cut.iter().for_each(|e| {
                    dirty.extend(self.around.of(e[0]).iter().filter(|t| self.around.of(e[1]).contains(t)))
                });
            }
            if !cut.is_empty() && !at_once {
                continue;
            }
            if ids.iter().any(|&v| self.moved[v as usize]) {
                back.extend(ids);
            } else {
                // What is wrong here comes from beside it: wider each time.
                let rings = self.times_bad.entry(t).or_insert(0);
                *rings += 1;
                let rings = *rings;
                back.extend(self.spare_around(t, rings));
            }
        }
        for &v in &back {
            self.surface.put(v, self.initial.spot(v));
            self.moved[v as usize] = false;
            dirty.extend(self.around.of(v));
        }
        let touched = |e: &[u32; 2]| back.contains(&e[0]) || back.contains(&e[1]);
        self.points.retain(|(e, _)| !touched(e) && !self.spared.edges.contains(e));
        let again = self.edges.par_iter().copied().filter(|e| touched(e) && !self.spared.edges.contains(e));
        let new = creases(&self.surface, self.facets, self.h, &self.options, again);
        self.points.extend(new);
        self.points.par_sort_unstable_by_key(|p| p.0);
        // What is cut in a triangle also depends on the triangles beside it.
        let corners = dirty.iter().flat_map(|&t| self.initial.mesh.triangles[t as usize]);
        self.dirty = Some(corners.flat_map(|v| self.around.of(v)).copied().collect());
    }

    /// Spares all initial triangles within so many rings around one of them; returns their vertices.
    fn spare_around(&mut self, t: u32, rings: u32) -> Vec<u32> {
        let mut near: Vec<u32> = vec![t];
        for _ in 0..rings {
            let corners = near.iter().flat_map(|&t| self.initial.mesh.triangles[t as usize]);
            near = corners.flat_map(|v| self.around.of(v)).copied().collect();
            near.sort_unstable();
            near.dedup();
        }
        let mut vertices = Vec::new();
        for t in near {
            let ids = self.initial.mesh.triangles[t as usize];
            self.spared.triangles.insert(t);
            self.spared.edges.extend(edges_of(&ids));
            vertices.extend(ids);
        }
        vertices
    }

    /// Lets what was moved and will be cut at an initial triangle stay a little within the solid; returns the triangles around.
    fn draw_back(&mut self, ids: [u32; 3]) -> Vec<u32> {
        self.spared.inset_edges.extend(edges_of(&ids));
        for v in ids {
            if self.moved[v as usize] && self.drawn_back.insert(v) {
                let spot = inset(self.surface.spot(v), self.facets, self.h);
                self.surface.put(v, Spot { at: rounded(spot.at), ..spot });
            }
        }
        ids.iter().flat_map(|&v| self.around.of(v)).copied().collect()
    }

    /// Whether no vertex of one initial triangle is a neighbour of one of the other's.
    pub(super) fn are_apart(&self, a: u32, b: u32) -> bool {
        let corners = |t: u32| self.initial.mesh.triangles[t as usize];
        let near = corners(a).into_iter().flat_map(|v| self.around.of(v)).flat_map(|&t| corners(t));
        let other = corners(b);
        !near.into_iter().any(|v| other.contains(&v))
    }

    /// What was done.
    pub(super) fn report(&self) -> FitReport {
        FitReport { moved: self.snapped, inserted: self.points.len(), given_up: self.given_up, ..FitReport::default() }
    }
}

/// Moves vertices that lie beside the plane of their one facet onto it.
fn flatten(surface: &mut Surface, facets: &Facets<'_>, h: f64) -> Vec<u32> {
    let (sides, vertices_of, positions) = (&surface.sides, &surface.vertices_of, &mut surface.mesh.positions);
    let moved = positions.par_iter_mut().zip(sides).enumerate().filter_map(|(v, (at, sides))| {
        if vertices_of[v].number().is_some() {
            return None;
        }
        let mut own = sides.iter();
        let (Some(side), None) = (own.next(), own.next()) else { return None };
        let plane = facets.plane(side);
        let distance = plane.distance(*at);
        (distance.abs() > (1e-6 * h).max(at.abs().max_element() * 2.4e-7) && distance.abs() < 0.05 * h).then(|| {
            *at = rounded(*at - plane.normal * distance);
            v as u32
        })
    });
    moved.collect()
}

/// The triangles that are the source's.
fn kept_triangles(surface: &Surface) -> FxHashSet<u32> {
    (0..surface.mesh.triangles.len() as u32).filter(|&t| surface.is_kept_triangle(t)).collect()
}

/// The edges between different facets.
fn straddling(surface: &Surface, facets: &Facets<'_>) -> Vec<[u32; 2]> {
    let differ = |a: u32, b: u32| {
        let (x, y) = (surface.sides[a as usize], surface.sides[b as usize]);
        let known = !x.is_empty() && !y.is_empty();
        let is_kept = surface.is_kept(a) && surface.is_kept(b);
        known
            && !is_kept
            && x.iter().all(|p| {
                let p = facets.plane(p).normal;
                y.iter().all(|q| p.dot(facets.plane(q).normal) < FLAT)
            })
    };
    surface.edges().filter(|&[a, b]| differ(a, b)).collect()
}

/// The points at which edges are to be cut.
fn creases(
    surface: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    edges: impl ParallelIterator<Item = [u32; 2]>,
) -> Vec<([u32; 2], Crease)> {
    let found = edges.filter_map(|edge| {
        let found = crease(facets, h, &surface.spot(edge[0]), &surface.spot(edge[1]))?;
        options.wants(&found, h).then_some((edge, found))
    });
    let mut found: Vec<_> = found.collect();
    found.par_sort_unstable_by_key(|p| p.0);
    found
}
