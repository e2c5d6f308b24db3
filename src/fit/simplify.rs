//! Fewer triangles for the same surface: collapse of edges that lie on flat or nearly flat parts.
//!
//! A vertex is moved into one of its neighbours, so that vertices stay where they were fitted. In
//! each pass all vertices are judged in parallel and those that may go are taken in the order of
//! their cost, as long as nothing near them has changed.

use glam::DVec3;
use rayon::prelude::*;

use super::FitOptions;
use super::facets::Facets;
use super::quadric::Quadric;
use super::surface::{Surface, agreement, shape};
use crate::mesh::{HalfEdges, Shape, TriMesh, ValidateOptions, intersecting_triangles, validate};
use crate::progress::{Progress, Stopped};

/// By how much a triangle may turn away from the facets of its corners (one minus the cosine,
/// 12°), unless the triangles it replaces did so already.
const TURN: f64 = 0.022;

/// Vertices of more edges than this take no more.
const MOST_EDGES: usize = 96;

/// The least height of a triangle, h, unless the ones before were lower.
const LEAST_HEIGHT: f64 = 5e-3;

/// A triangle lies on a facet when its corners are nearer to the facet's plane than this, h.
const ON_FACET: f64 = 1e-3;

/// Triangles lower than this, h, have no plane of their own.
const FLAT_HEIGHT: f64 = 0.02;

/// Cosine of the most that a triangle over a crease may turn in one collapse.
const STILL_FACING: f64 = 0.3;

/// Times that neighbourhoods are frozen, each time twice as far.
const MOST_ROUNDS: u32 = 6;

/// Passes after which the rest stays.
const MOST_PASSES: usize = 200;

/// The surface while it is simplified.
struct Work<'a> {
    surface: &'a Surface,
    facets: &'a Facets<'a>,
    edges: HalfEdges,
    quadrics: Vec<Quadric>,
    /// Lattice units.
    at: Vec<DVec3>,
    /// Squared tolerance, h².
    most: f64,
    /// The same for vertices of the source.
    most_kept: f64,
}

/// A collapse that may be done.
#[derive(Debug, Clone, Copy)]
struct Wish {
    cost: f64,
    vertex: u32,
    half_edge: u32,
}

/// [`collapsed`] within the tolerance (0 for not at all) as often as it takes until no triangles meet:
/// each time the neighbourhoods of those that do stay as they were. `None` when the surface as given is
/// no valid solid.
pub(super) fn simplified(
    surface: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<Option<Surface>, Stopped> {
    let mut frozen = class_borders(surface, facets);
    if options.tolerance > 0.0 {
        for round in 0..MOST_ROUNDS {
            let simple = collapsed(surface, facets, h, options, &frozen, progress)?;
            let bad = intersecting_triangles(&simple.mesh, progress)?;
            if bad.is_empty() && is_solid(&simple.mesh, false, progress)? {
                return Ok(Some(simple));
            }
            freeze(&mut frozen, surface, &simple, &bad, 2.0 * h * f64::from(1 << round));
        }
    }
    Ok(is_solid(&surface.mesh, true, progress)?.then(|| surface.clone()))
}

/// Whether the mesh is valid, also in a format that merges equal positions; without looking for
/// intersections if there are known to be none.
fn is_solid(mesh: &TriMesh, self_intersections: bool, progress: &Progress) -> Result<bool, Stopped> {
    let mut validity = validate(mesh, &ValidateOptions { self_intersections, weld: true }, progress)?;
    validity.self_intersecting_triangles.get_or_insert(0);
    Ok(validity.is_valid())
}

/// Freezes the vertices within `reach` of the triangles `bad` of the simplified surface.
fn freeze(frozen: &mut [bool], surface: &Surface, simple: &Surface, bad: &[u32], reach: f64) {
    let around = |&t: &u32| {
        let corners = simple.mesh.corners(t as usize);
        let bounds = corners.bounds();
        (bounds.min - reach, bounds.max + reach, corners)
    };
    let boxes: Vec<(DVec3, DVec3, [DVec3; 3])> = bad.iter().map(around).collect();
    let is_near = |p: DVec3, (low, high, corners): &(DVec3, DVec3, [DVec3; 3])| {
        p.cmpge(*low).all() && p.cmple(*high).all() && corners.nearest(p).0.distance(p) <= reach
    };
    frozen.par_iter_mut().zip(&surface.mesh.positions).for_each(|(frozen, p)| {
        *frozen |= boxes.iter().any(|one| is_near(*p, one));
    });
}

/// The vertices between triangles of different classes.
fn class_borders(surface: &Surface, facets: &Facets<'_>) -> Vec<bool> {
    let mut border = vec![false; surface.mesh.positions.len()];
    if facets.has_classes() {
        for t in &surface.mesh.triangles {
            let mut classes = t.iter().flat_map(|&v| surface.facets_at(facets, v, DVec3::Z)).map(|s| facets.class(s));
            let first = classes.next();
            if classes.any(|class| Some(class) != first) {
                t.iter().for_each(|&v| border[v as usize] = true);
            }
        }
    }
    border
}

/// Collapses edges as long as the surface stays within the tolerance of where it was. Vertices in `frozen` stay.
fn collapsed(
    surface: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    frozen: &[bool],
    progress: &Progress,
) -> Result<Surface, Stopped> {
    let Ok(edges) = HalfEdges::new(&surface.mesh.triangles, surface.mesh.positions.len()) else {
        return Ok(surface.clone());
    };
    let at: Vec<DVec3> = surface.mesh.positions.par_iter().map(|p| *p / h).collect();
    let quadrics = quadrics(surface, facets, h, &edges);
    let (most, most_kept) = (options.tolerance.powi(2), options.kept_tolerance.powi(2));
    let mut work = Work { surface, facets, edges, quadrics, at, most, most_kept };
    let mut active: Vec<u32> = (0..work.at.len() as u32).filter(|&v| !frozen[v as usize]).collect();
    let mut locked = vec![0u32; work.at.len()];
    for pass in 1..=MOST_PASSES as u32 {
        progress.check()?;
        let mut wishes: Vec<Wish> = active.par_iter().with_min_len(64).filter_map(|&v| work.wish(v)).collect();
        wishes.par_sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.half_edge.cmp(&b.half_edge)));
        let mut done = 0;
        let mut next = Vec::new();
        for wish in &wishes {
            let vertex = wish.vertex;
            if locked[vertex as usize] == pass {
                next.push(vertex);
                continue;
            }
            let ring: Vec<u32> = work.edges.ring(vertex).map(|e| work.edges.target(e)).collect();
            if work.collapse(wish.half_edge) {
                done += 1;
                ring.iter().for_each(|&v| locked[v as usize] = pass);
                next.extend(ring);
            }
        }
        if done == 0 {
            break;
        }
        next.par_sort_unstable();
        next.dedup();
        active = next.into_iter().filter(|&v| !frozen[v as usize] && work.edges.is_live_vertex(v)).collect();
    }
    let compacted = work.edges.compacted();
    let positions = compacted.vertices.iter().map(|&v| surface.at(v)).collect();
    let sides = compacted.vertices.iter().map(|&v| surface.sides[v as usize]).collect();
    let kept = compacted.vertices.iter().map(|&v| surface.kept[v as usize]).collect();
    let live = (0..work.edges.triangle_ids()).filter(|&t| work.edges.is_live_triangle(t as u32));
    let facets = live.map(|t| surface.facets[t]).collect();
    Ok(Surface { mesh: TriMesh { positions, triangles: compacted.triangles }, sides, kept, facets })
}

/// For each vertex the distances from the planes of its triangles.
fn quadrics(surface: &Surface, facets: &Facets<'_>, h: f64, edges: &HalfEdges) -> Vec<Quadric> {
    let of_triangle = |t: usize| plane(surface, facets, h, t).map(|(n, p)| Quadric::plane(n, p / h));
    let all: Vec<Option<Quadric>> = (0..surface.mesh.triangles.len()).into_par_iter().map(of_triangle).collect();
    let of = |v: usize| {
        let mut sum = Quadric::default();
        edges.ring(v as u32).filter_map(|e| all[e as usize / 3]).for_each(|q| sum += q);
        sum
    };
    (0..surface.mesh.positions.len()).into_par_iter().map(of).collect()
}

/// The plane of a triangle, as normal and point: that of the facet it lies on, if it does, since its own is
/// only as good as its height; none for thin ones.
fn plane(surface: &Surface, facets: &Facets<'_>, h: f64, t: usize) -> Option<(DVec3, DVec3)> {
    let corners = surface.places(t as u32);
    let (normal, height) = shape(corners.map(|c| c.at));
    let normal = normal.normalize_or_zero();
    let on = |s: &super::Side| corners.iter().all(|c| facets.plane(*s).distance(c.at).abs() < ON_FACET * h);
    let agrees = |s: &super::Side| facets.plane(*s).normal.dot(normal);
    let around = surface.mesh.triangles[t].into_iter().flat_map(|v| surface.facets_at(facets, v, normal));
    let known = around.filter(on).max_by(|a, b| agrees(a).total_cmp(&agrees(b)));
    match known {
        Some(side) => Some((facets.plane(side).normal, facets.plane(side).normal * facets.plane(side).offset)),
        None => (height > FLAT_HEIGHT * h).then_some((normal, corners[0].at)),
    }
}

impl Work<'_> {
    /// The best collapse of a vertex into a neighbour.
    fn wish(&self, vertex: u32) -> Option<Wish> {
        if !self.edges.is_live_vertex(vertex) {
            return None;
        }
        let mut best: [(f64, f64, u32); 3] = [(f64::INFINITY, 0.0, 0); 3];
        for e in self.edges.ring(vertex) {
            let to = self.edges.target(e);
            let cost = self.cost(vertex, to);
            let entry = (cost, self.at[to as usize].distance_squared(self.at[vertex as usize]), e);
            if cost <= self.most && self.edges.valence(to) < MOST_EDGES {
                let place = best.iter().position(|b| entry.0 < b.0 || (entry.0 == b.0 && entry.1 < b.1));
                if let Some(k) = place {
                    best[k..].rotate_right(1);
                    best[k] = entry;
                }
            }
        }
        let worst = self.worst(vertex);
        best.iter().take_while(|b| b.0.is_finite()).find(|b| self.allowed(vertex, b.2, worst)).map(|b| Wish {
            cost: b.0,
            vertex,
            half_edge: b.2,
        })
    }

    /// What it costs to move `vertex` into `to`. Coarse, so that on flat parts the shortest edges go first.
    fn cost(&self, vertex: u32, to: u32) -> f64 {
        let p = self.at[to as usize];
        let cost = self.quadrics[vertex as usize].at(p) + self.quadrics[to as usize].at(p);
        if self.surface.is_kept(vertex) && (cost > self.most_kept || self.most_kept == 0.0) {
            return f64::INFINITY;
        }
        let length = p.distance_squared(self.at[vertex as usize]);
        cost + 1e-9 * length.min(1e3)
    }

    /// The worst turn and the least height of the triangles around a vertex.
    fn worst(&self, vertex: u32) -> (f64, f64) {
        self.edges.ring(vertex).fold((TURN, LEAST_HEIGHT), |worst, e| {
            let t = self.edges.triangle(e / 3);
            let (turn, height) = self.turn(t, t);
            (worst.0.max(turn), worst.1.min(height))
        })
    }

    /// Whether the triangles that stay keep facing where their facets do, and the mesh a manifold.
    fn allowed(&self, vertex: u32, half_edge: u32, (turn, height): (f64, f64)) -> bool {
        let to = self.edges.target(half_edge);
        let own = [half_edge / 3, self.edges.twin(half_edge) / 3];
        let fine = self.edges.ring(vertex).filter(|e| !own.contains(&(e / 3))).all(|e| {
            let before = self.edges.triangle(e / 3);
            let after = before.map(|v| if v == vertex { to } else { v });
            let (turned, low) = self.turn(after, before);
            low >= height && (turned <= turn || self.cuts_off(after, before))
        });
        fine && self.edges.can_collapse(half_edge)
    }

    /// Whether a triangle cuts off a crease, as it did before, and still faces the same way: it may turn as it
    /// likes, for the crease will be put back.
    fn cuts_off(&self, t: [u32; 3], before: [u32; 3]) -> bool {
        let places = |t: [u32; 3]| t.map(|v| self.surface.place(v));
        let normal = |t: [u32; 3]| shape(t.map(|v| self.at[v as usize])).0.normalize_or_zero();
        let apart = |t: [u32; 3]| {
            t.iter().all(|&v| !self.surface.sides[v as usize].is_empty())
                && agreement(self.facets, &places(t)).is_none()
        };
        normal(t).dot(normal(before)) > STILL_FACING && apart(before) && apart(t)
    }

    /// By how much a triangle faces away from the facets of its corners: for each corner the facet
    /// that agrees best, and of these the worst; one minus the cosine. And its height. For corners without
    /// facets `before` is asked.
    fn turn(&self, t: [u32; 3], before: [u32; 3]) -> (f64, f64) {
        let (normal, height) = shape(t.map(|v| self.at[v as usize]));
        let normal = normal.normalize_or_zero();
        let mut worst = 0.0f64;
        for v in t {
            let sides = &self.surface.sides[v as usize];
            let agreement = if sides.is_empty() {
                let (normal_before, _) = shape(before.map(|v| self.at[v as usize]));
                normal.dot(normal_before.normalize_or_zero())
            } else {
                sides.iter().map(|s| self.facets.plane(s).normal.dot(normal)).fold(-1.0, f64::max)
            };
            worst = worst.max(1.0 - agreement);
        }
        (worst, height)
    }

    fn collapse(&mut self, half_edge: u32) -> bool {
        if !self.edges.can_collapse(half_edge) {
            return false;
        }
        let (vertex, to) = (self.edges.origin(half_edge), self.edges.target(half_edge));
        if self.cost(vertex, to) > self.most {
            return false;
        }
        let quadric = self.quadrics[vertex as usize];
        self.quadrics[to as usize] += quadric;
        self.edges.collapse_unchecked(half_edge);
        true
    }
}
