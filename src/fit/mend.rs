//! Triangles that cutting has turned over are mended: an edge is turned, or a vertex goes into its neighbour.
//!
//! A corner can lie beyond an edge of the triangle that it was put into, on the flat part next to
//! it; the edge between them is turned. Two points of a crease can stand in the wrong order; one
//! goes into the other.

use glam::DVec3;
use rayon::prelude::*;

use super::crease::{Spot, nearest};
use super::cut::Cut;
use super::facets::{Facets, SMOOTH, Sides};
use super::surface::{agreement, faces_out, rounded, shape};
use crate::mesh::HalfEdges;

/// The least height, h, of the triangles that it makes.
const LEAST_HEIGHT: f64 = 1e-3;

/// How often each wrong triangle is tried: what is beside it may have been mended since.
const PASSES: usize = 3;

/// Where on the way between two neighbours a vertex is tried.
const SHARES: [f64; 3] = [0.5, 0.2, 0.8];

/// Mends the triangles among `changed` that face away from their facets or are too thin. Returns the
/// triangles that it changed, by the numbers they have after.
pub(super) fn mend(cut: &mut Cut, facets: &Facets<'_>, h: f64, changed: &[u32]) -> Vec<u32> {
    let spots = |t: &[u32; 3]| t.map(|v| cut.surface.spot(v));
    let wrong: Vec<u32> = changed
        .par_iter()
        .copied()
        .filter(|&t| !fits(facets, h, &spots(&cut.surface.mesh.triangles[t as usize])))
        .collect();
    if wrong.is_empty() {
        return Vec::new();
    }
    let vertices = cut.surface.mesh.positions.len();
    let Ok(edges) = HalfEdges::new(&cut.surface.mesh.triangles, vertices) else { return Vec::new() };
    let mut mending = Mending { edges, cut, facets, h };
    let mut touched = Vec::new();
    for _ in 0..PASSES {
        let before = touched.len();
        wrong.iter().for_each(|&t| touched.extend(mending.triangle(t)));
        if touched.len() == before {
            break;
        }
    }
    touched.sort_unstable();
    touched.dedup();
    mending.finish(&touched)
}

/// Whether a triangle faces the way of its facets and is not too thin.
fn fits(facets: &Facets<'_>, h: f64, corners: &[Spot; 3]) -> bool {
    shape(corners.map(|c| c.at)).1 > LEAST_HEIGHT * h && faces_out(facets, corners)
}

/// Whether of triangles, fit or not before and after, more are fit and none no longer is.
fn betters(fits: impl Iterator<Item = (bool, bool)>) -> bool {
    let mut gained = false;
    for (before, after) in fits {
        if before && !after {
            return false;
        }
        gained |= after && !before;
    }
    gained
}

struct Mending<'a> {
    edges: HalfEdges,
    cut: &'a mut Cut,
    facets: &'a Facets<'a>,
    h: f64,
}

impl Mending<'_> {
    fn fits(&self, t: [u32; 3]) -> bool {
        fits(self.facets, self.h, &t.map(|v| self.cut.surface.spot(v)))
    }

    fn at(&self, v: u32) -> DVec3 {
        self.cut.surface.mesh.positions[v as usize]
    }

    /// Mends one triangle if it can; returns the triangles that are other than before.
    fn triangle(&mut self, t: u32) -> Vec<u32> {
        if !self.edges.is_live_triangle(t) || self.fits(self.edges.triangle(t)) {
            return Vec::new();
        }
        let halves = [3 * t, 3 * t + 1, 3 * t + 2];
        if let Some(&e) = halves.iter().find(|&&e| self.turn_fits(e)) {
            let both = vec![t, self.edges.twin(e) / 3];
            self.edges.flip(e);
            return both;
        }
        let mut ways: Vec<(f64, u32)> = halves
            .iter()
            .flat_map(|&e| [e, self.edges.twin(e)])
            .map(|e| (self.at(self.edges.origin(e)).distance(self.at(self.edges.target(e))), e))
            .collect();
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(_, e)) = ways.iter().find(|&&(_, e)| self.collapse_fits(e)) else { return self.slide(t) };
        let mut star: Vec<u32> = self.edges.ring(self.edges.origin(e)).map(|e| e / 3).collect();
        self.edges.collapse_unchecked(e);
        star.retain(|&t| self.edges.is_live_triangle(t));
        star
    }

    /// Moves a corner of a triangle along its crease, between its neighbours there, if that makes all
    /// triangles around it fit; returns these.
    fn slide(&mut self, t: u32) -> Vec<u32> {
        for v in self.edges.triangle(t) {
            let own = self.cut.surface.spot(v);
            let neighbours: Vec<u32> =
                self.edges.ring(v).map(|e| self.edges.target(e)).filter(|&w| self.lies_on_all(w, &own.sides)).collect();
            if self.cut.surface.is_kept(v) || own.sides.iter().count() != 2 || neighbours.len() < 2 {
                continue;
            }
            let before: Vec<bool> = self.edges.ring(v).map(|e| self.fits(self.edges.triangle(e / 3))).collect();
            let ends = (0..neighbours.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
            let between =
                ends.flat_map(|[i, j]| SHARES.map(|s| self.at(neighbours[i]).lerp(self.at(neighbours[j]), s)));
            for target in between.collect::<Vec<_>>() {
                let Some(at) = nearest(own.sides.iter().map(|s| self.facets.plane(s)), target) else { continue };
                self.cut.surface.put(v, Spot { at: rounded(at), ..own });
                let now = self.edges.ring(v).map(|e| self.fits(self.edges.triangle(e / 3)));
                if betters(before.iter().copied().zip(now)) {
                    return self.edges.ring(v).map(|e| e / 3).collect();
                }
            }
            self.cut.surface.put(v, own);
        }
        Vec::new()
    }

    /// Whether a vertex lies on the smooth pieces of all `sides`.
    fn lies_on_all(&self, vertex: u32, sides: &Sides) -> bool {
        let normal = |s| self.facets.plane(s).normal;
        let on = &self.cut.surface.sides[vertex as usize];
        sides.iter().all(|s| on.iter().any(|o| normal(o).dot(normal(s)) > SMOOTH))
    }

    fn turn_fits(&self, e: u32) -> bool {
        let (a, b) = (self.edges.origin(e), self.edges.target(e));
        if self.cut.surface.is_kept(a) && self.cut.surface.is_kept(b) {
            return false;
        }
        let (c, d) = (self.edges.apex(e), self.edges.apex(self.edges.twin(e)));
        let known = |t: [u32; 3]| agreement(self.facets, &t.map(|v| self.cut.surface.spot(v))).is_some_and(|a| a > 0.5);
        [[a, d, c], [d, b, c]].into_iter().all(|t| self.fits(t) && known(t)) && self.edges.can_flip(e)
    }

    /// Whether the origin of a half-edge may go into its target: the target must lie on all smooth
    /// pieces that the origin lies on.
    fn collapse_fits(&self, e: u32) -> bool {
        let (from, to) = (self.edges.origin(e), self.edges.target(e));
        if self.cut.surface.is_kept(from) {
            return false;
        }
        let kept = self.lies_on_all(to, &self.cut.surface.sides[from as usize]);
        let gone = [e / 3, self.edges.twin(e) / 3];
        let after = |t: u32| {
            let moved = self.edges.triangle(t).map(|v| if v == from { to } else { v });
            gone.contains(&t) || self.fits(moved)
        };
        let star = self.edges.ring(from).map(|e| (self.fits(self.edges.triangle(e / 3)), after(e / 3)));
        kept && betters(star) && self.edges.can_collapse(e)
    }

    /// Writes the triangles back.
    fn finish(self, touched: &[u32]) -> Vec<u32> {
        let mut number = 0;
        let mut renumbered = Vec::with_capacity(touched.len());
        let mut triangles = Vec::with_capacity(self.edges.live_triangles());
        let mut origin = Vec::with_capacity(triangles.capacity());
        let mut triangles_of = Vec::with_capacity(triangles.capacity());
        let mut next = touched.iter().peekable();
        for t in 0..self.edges.triangle_ids() as u32 {
            let is_touched = next.next_if_eq(&&t).is_some();
            if !self.edges.is_live_triangle(t) {
                continue;
            }
            if is_touched {
                renumbered.push(number);
            }
            triangles.push(self.edges.triangle(t));
            origin.push(self.cut.origin[t as usize]);
            triangles_of.push(self.cut.surface.triangles_of[t as usize]);
            number += 1;
        }
        self.cut.surface.mesh.triangles = triangles;
        self.cut.surface.triangles_of = triangles_of;
        self.cut.origin = origin;
        renumbered
    }
}
