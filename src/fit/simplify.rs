//! Fewer triangles for the same surface: collapse of edges that lie on flat or nearly flat parts.
//!
//! A vertex is moved into one of its neighbours, so that vertices stay where they were fitted. In
//! each pass all vertices are judged in parallel and those that may go are taken in the order of
//! their cost, as long as nothing near them has changed.
//!
//! Two things bound how far the surface goes: the distances from the planes of all triangles that went (`quadric`), and, since
//! planes go on where surfaces end, how far each collapse takes the triangles around it from where they were (`deviation`), added
//! up over all that led to a triangle.
//!
//! Triangles that meet are so rare that only the end result is looked at. Where some do, it is done again, and what happens near
//! there (`zone`) is looked at after each pass and taken back if it makes triangles meet.

use glam::DVec3;
use rayon::prelude::*;

use super::FitOptions;
use super::deviation::deviation;
use super::facets::Facets;
use super::quadric::Quadric;

use super::surface::{Surface, agreement, shape};
use super::zone::{Zone, meeting_places};
use crate::mesh::{CollapseRecord, HalfEdges, Submesh, TriMesh, ValidateOptions, intersecting_triangles, validate};
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

/// A collapse that takes the surface away by less than this part of the tolerance does not count: where a surface is finely cut,
/// each is a quarter of the next, and together they are not much more than the last.
const NOTHING: f64 = 0.05;

/// Nor does less than so many steps of `f32`: that far from their plane the vertices of a flat part lie.
const STEPS: f64 = 4.0;

/// Rounds after which all of the surface is looked at after each pass.
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
    /// How far each triangle is from the surface that it stands for, at most, h.
    off: Vec<f32>,
    /// The tolerance, h.
    most: f64,
    /// The same for vertices of the source.
    most_kept: f64,
    /// A deviation that does not count, h.
    nothing: f64,
}

/// A collapse that may be done.
#[derive(Debug, Clone, Copy)]
struct Wish {
    cost: f64,
    vertex: u32,
    half_edge: u32,
}

/// A collapse that was done where triangles may meet.
struct Done {
    vertex: u32,
    to: u32,
    record: CollapseRecord,
    /// What the triangles around the vertex stood for before: those that stay, then the two that vanish.
    off: Vec<(u32, f32)>,
}

/// A simplified surface.
pub(super) struct Simple {
    pub surface: Surface,
    /// How far each triangle is from the surface that it stands for, at most, h.
    pub off: Vec<f32>,
}

/// What is to be simplified, and how.
struct Task<'a> {
    surface: &'a Surface,
    /// How far each triangle is already from the surface that it stands for, h.
    off: &'a [f32],
    facets: &'a Facets<'a>,
    h: f64,
    options: &'a FitOptions,
}

/// [`collapsed`] within the tolerance (0 for not at all), so that no triangles meet; `off` is how far each triangle is already from
/// the surface that it stands for, h. `None` when the surface as given is no valid solid.
pub(super) fn simplified(
    (surface, off): (&Surface, &[f32]),
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<Option<Simple>, Stopped> {
    let as_it_is = || {
        let solid = is_solid(&surface.mesh, true, progress)?;
        Ok(solid.then(|| Simple { surface: surface.clone(), off: off.to_vec() }))
    };
    if options.simplify <= 0.0 {
        return as_it_is();
    }
    let task = Task { surface, off, facets, h, options };
    let frozen = class_borders(surface, facets);
    let mut zone = Zone::nothing(h);
    for round in 0..=MOST_ROUNDS {
        let simple = collapsed(&task, (&frozen, &zone), progress)?;
        let bad = intersecting_triangles(&simple.surface.mesh, progress)?;
        if bad.is_empty() {
            match is_solid(&simple.surface.mesh, false, progress)? {
                true => return Ok(Some(simple)),
                false => break,
            }
        }
        zone.add(&meeting_places(&simple.surface.mesh, &bad, h, progress)?, h);
        if round + 1 == MOST_ROUNDS {
            zone = Zone::Everything;
        }
    }
    as_it_is()
}

/// Whether the mesh is valid, also in a format that merges equal positions; without looking for
/// intersections if there are known to be none.
fn is_solid(mesh: &TriMesh, self_intersections: bool, progress: &Progress) -> Result<bool, Stopped> {
    let mut validity = validate(mesh, &ValidateOptions { self_intersections, weld: true }, progress)?;
    validity.self_intersecting_triangles.get_or_insert(0);
    Ok(validity.is_valid())
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

/// Collapses edges as long as the surface stays within the tolerance of where it was. Vertices in `frozen` stay, and within the
/// zone no triangles meet afterwards.
fn collapsed(task: &Task<'_>, (frozen, zone): (&[bool], &Zone), progress: &Progress) -> Result<Simple, Stopped> {
    let &Task { surface, off, .. } = task;
    let Some(mut work) = Work::new(task) else { return Ok(Simple { surface: surface.clone(), off: off.to_vec() }) };
    let mut frozen = frozen.to_vec();
    let mut active: Vec<u32> = (0..work.at.len() as u32).filter(|&v| !frozen[v as usize]).collect();
    let mut locked = vec![0u32; work.at.len()];
    let mut watch = Watch::new(surface, zone);
    for pass in 1..=MOST_PASSES as u32 {
        progress.check()?;
        let mut wishes: Vec<Wish> = active.par_iter().with_min_len(64).filter_map(|&v| work.wish(v)).collect();
        wishes.par_sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.half_edge.cmp(&b.half_edge)));
        let mut collapses = 0;
        let mut next = Vec::new();
        let mut done: Vec<Done> = Vec::new();
        for wish in &wishes {
            let vertex = wish.vertex;
            if locked[vertex as usize] == pass {
                next.push(vertex);
                continue;
            }
            let ring: Vec<u32> = work.edges.ring(vertex).map(|e| work.edges.target(e)).collect();
            let before = watch.is_on().then(|| work.done(wish));
            if work.collapse(wish) {
                collapses += 1;
                ring.iter().for_each(|&v| locked[v as usize] = pass);
                next.extend(ring);
                done.extend(before.filter(|before| watch.sees(surface, &work.edges, before.record.changed())));
            }
        }
        if !done.is_empty() {
            work.take_back(done, &watch, progress)?.into_iter().for_each(|v| frozen[v as usize] = true);
        }
        if collapses == 0 {
            break;
        }
        next.par_sort_unstable();
        next.dedup();
        active = next.into_iter().filter(|&v| !frozen[v as usize] && work.edges.is_live_vertex(v)).collect();
    }
    Ok(work.finish())
}

/// Which triangles reach into a zone.
struct Watch<'a> {
    zone: &'a Zone,
    /// For each triangle, or nothing where the zone is.
    is: Vec<bool>,
}

impl<'a> Watch<'a> {
    fn new(surface: &Surface, zone: &'a Zone) -> Self {
        let touches = |t: usize| zone.touches(surface.mesh.corners(t));
        let count = if zone.is_nothing() { 0 } else { surface.mesh.triangles.len() };
        Self { zone, is: (0..count).into_par_iter().map(touches).collect() }
    }

    fn is_on(&self) -> bool {
        !self.is.is_empty()
    }

    /// Whether one of these triangles, which have just changed, reaches into the zone.
    fn sees(&mut self, surface: &Surface, edges: &HalfEdges, changed: &[u32]) -> bool {
        for &t in changed {
            self.is[t as usize] |= self.zone.touches(edges.triangle(t).map(|v| surface.at(v)));
        }
        changed.iter().any(|&t| self.is[t as usize])
    }
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
    let corners = surface.spots(t as u32);
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

impl<'a> Work<'a> {
    /// `None` when the surface is no closed manifold.
    fn new(task: &Task<'a>) -> Option<Self> {
        let &Task { surface, off, facets, h, options } = task;
        let edges = HalfEdges::new(&surface.mesh.triangles, surface.mesh.positions.len()).ok()?;
        let at: Vec<DVec3> = surface.mesh.positions.par_iter().map(|p| *p / h).collect();
        let quadrics = quadrics(surface, facets, h, &edges);
        let largest = at.par_iter().map(|p| p.abs().max_element()).reduce(|| 0.0, f64::max);
        let nothing = (NOTHING * options.simplify).max(STEPS * f64::from(f32::EPSILON) * largest);
        Some(Self {
            surface,
            facets,
            edges,
            quadrics,
            off: off.to_vec(),
            at,
            most: options.simplify,
            most_kept: options.simplify_kept,
            nothing,
        })
    }

    fn finish(self) -> Simple {
        let Self { surface, edges, .. } = self;
        let compacted = edges.compacted();
        let positions = compacted.vertices.iter().map(|&v| surface.at(v)).collect();
        let sides = compacted.vertices.iter().map(|&v| surface.sides[v as usize]).collect();
        let vertices_of = compacted.vertices.iter().map(|&v| surface.vertices_of[v as usize]).collect();
        let live = (0..edges.triangle_ids()).filter(|&t| edges.is_live_triangle(t as u32));
        let (triangles_of, off) = live.map(|t| (surface.triangles_of[t], self.off[t])).unzip();
        Simple {
            surface: Surface {
                mesh: TriMesh { positions, triangles: compacted.triangles },
                sides,
                vertices_of,
                triangles_of,
            },
            off,
        }
    }

    /// What is needed to take a collapse back that is about to be done.
    fn done(&self, wish: &Wish) -> Done {
        Done {
            vertex: wish.vertex,
            to: self.edges.target(wish.half_edge),
            record: self.edges.record(wish.half_edge),
            off: self.edges.ring(wish.vertex).map(|e| (e / 3, self.off[e as usize / 3])).collect(),
        }
    }

    /// Takes collapses of one pass back that made triangles meet; none met before. Returns the vertices that are there again.
    fn take_back(&mut self, mut done: Vec<Done>, watch: &Watch<'_>, progress: &Progress) -> Result<Vec<u32>, Stopped> {
        let mut back = Vec::new();
        loop {
            let live = |t: &u32| watch.is[*t as usize] && self.edges.is_live_triangle(*t);
            let near: Vec<u32> = (0..watch.is.len() as u32).into_par_iter().filter(live).collect();
            let triangles = near.iter().map(|&t| self.edges.triangle(t)).collect();
            let part = Submesh::of(&self.surface.mesh.positions, triangles).mesh;
            let mut bad = vec![false; watch.is.len()];
            intersecting_triangles(&part, progress)?.iter().for_each(|&t| bad[near[t as usize] as usize] = true);
            let harmful = |one: &Done| one.record.changed().iter().any(|&t| bad[t as usize]);
            let (gone, stay): (Vec<Done>, Vec<Done>) = done.into_iter().partition(harmful);
            if gone.is_empty() {
                return Ok(back);
            }
            for one in gone {
                let quadric = self.quadrics[one.vertex as usize];
                self.quadrics[one.to as usize] -= quadric;
                self.edges.undo(&one.record);
                one.off.iter().for_each(|&(t, off)| self.off[t as usize] = off);
                back.push(one.vertex);
            }
            done = stay;
        }
    }

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
            if cost <= self.most * self.most && self.edges.valence(to) < MOST_EDGES {
                let spot = best.iter().position(|b| entry.0 < b.0 || (entry.0 == b.0 && entry.1 < b.1));
                if let Some(k) = spot {
                    best[k..].rotate_right(1);
                    best[k] = entry;
                }
            }
        }
        let worst = self.worst(vertex);
        let fits = |b: &&(f64, f64, u32)| self.allowed(vertex, b.2, worst) && self.after(b.2, |_| ()).is_some();
        best.iter().take_while(|b| b.0.is_finite()).find(fits).map(|b| Wish { cost: b.0, vertex, half_edge: b.2 })
    }

    /// How far the triangles around the origin of a half-edge would be from the surface that they stand for when it has gone; `None`
    /// for too far.
    fn after(&self, half_edge: u32, result: impl FnMut(f64)) -> Option<()> {
        let most = self.most.max(self.nothing);
        deviation((&self.edges, &self.at, &self.off), half_edge, (self.nothing, most), result)
    }

    /// What it costs to move `vertex` into `to`. Coarse, so that on flat parts the shortest edges go first.
    fn cost(&self, vertex: u32, to: u32) -> f64 {
        let p = self.at[to as usize];
        let cost = self.quadrics[vertex as usize].at(p) + self.quadrics[to as usize].at(p);
        if self.surface.is_kept(vertex) && (self.most_kept == 0.0 || cost > self.most_kept * self.most_kept) {
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
        let spots = |t: [u32; 3]| t.map(|v| self.surface.spot(v));
        let normal = |t: [u32; 3]| shape(t.map(|v| self.at[v as usize])).0.normalize_or_zero();
        let apart = |t: [u32; 3]| {
            t.iter().all(|&v| !self.surface.sides[v as usize].is_empty()) && agreement(self.facets, &spots(t)).is_none()
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

    fn collapse(&mut self, wish: &Wish) -> bool {
        let &Wish { vertex, half_edge, .. } = wish;
        let to = self.edges.target(half_edge);
        if !self.edges.can_collapse(half_edge) || self.cost(vertex, to) > self.most * self.most {
            return false;
        }
        let mut after = Vec::with_capacity(self.edges.valence(vertex));
        if self.after(half_edge, |off| after.push(off as f32)).is_none() {
            return false;
        }
        let quadric = self.quadrics[vertex as usize];
        self.quadrics[to as usize] += quadric;
        let mut e = half_edge;
        for off in after {
            e = self.edges.twin(self.edges.prev(e));
            self.off[e as usize / 3] = off;
        }
        self.edges.collapse_unchecked(half_edge);
        true
    }
}
