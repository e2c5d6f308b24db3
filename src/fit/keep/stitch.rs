//! The kept triangles and what the contour has between them, joined along the border.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::super::crease::{Crease, Spot};
use super::super::cut::{Cut, subdivide};
use super::super::facets::{FacetId, Facets, Side, Sides};
use super::super::surface::{OfSource, Surface, rounded, shape};
use super::border::{Border, NONE, OnBorder};
use super::choose::Kept;
use super::rings::{BorderRing, Stop, matched};

/// A point of the border farther than this, h, from the edge that it is to cut is the wrong one.
const FARTHEST: f64 = 1.5;

/// Vertices of the contour nearer to the border than this, h, go with the kept triangles.
const CLEAR: f64 = 0.5;

/// In place of a component: where the contour is not wanted, whatever it lies on.
const CUT_OFF: u32 = NONE - 1;

/// Where the two do not join.
#[derive(Debug, Clone, Default)]
pub(super) struct Misfit {
    /// Kept triangles near these points, model units, are in the way.
    pub points: Vec<DVec3>,
    /// Components of which the contour knows nothing.
    pub unseen: Vec<u32>,
}

/// A joined surface.
pub(super) struct Joined {
    pub surface: Surface,
    /// The first of its triangles that come from the contour; the ones before are kept.
    pub first: u32,
    /// Those of them that end on the border, with the normal (not unit) that they had in the contour.
    pub seam: Vec<(u32, DVec3)>,
}

/// Joins the kept triangles with what `initial` has between them, or says where that cannot be done.
pub(super) fn joined(
    initial: &Surface,
    facets: &Facets<'_>,
    kept: &Kept,
    border: &Border,
    h: f64,
) -> Result<Joined, Misfit> {
    let labelled = initial.sides.par_iter().zip(&initial.mesh.positions);
    let labels = labelled.map(|(sides, &at)| if facets.is_beyond(at) { CUT_OFF } else { label(sides, kept, border) });
    let labels: Vec<u32> = labels.collect();
    let labels = with_those_beside(initial, border, labels, h);
    let unseen = unseen(&labels, border);
    if !unseen.is_empty() {
        return Err(Misfit { unseen, ..Misfit::default() });
    }
    let points = crossings(initial, kept, border, &labels, h)?;
    let first = initial.mesh.positions.len() as u32;
    let mut cut = Cut::of(initial);
    let crease = |point: &OnBorder, edge: &[u32; 2]| {
        let other =
            edge.iter().find(|&&v| labels[v as usize] == NONE).map_or(Sides::default(), |&v| initial.sides[v as usize]);
        Crease { spot: Spot { at: point.at, sides: other }, sag: 0.0, on_source: true, cosine: 0.0 }
    };
    subdivide(&mut cut, &points.iter().map(|(edge, point)| (*edge, crease(point, edge))).collect::<Vec<_>>());
    let is_other = |t: &[u32; 3]| t.iter().any(|&v| v < first && labels[v as usize] == NONE);
    let others: Vec<u32> =
        (0..cut.origin.len() as u32).filter(|&t| is_other(&cut.surface.mesh.triangles[t as usize])).collect();
    let found: Vec<OnBorder> = points.iter().map(|p| p.1).collect();
    let seam = seam(&cut.surface.mesh.triangles, &others, first, found.len());
    let rings = rings(border, kept, &found, &seam, h)?;
    let joint = Joint { initial, facets, kept, border, cut: &cut, first, found: &found, rings: &rings };
    Ok(joint.assemble(&others))
}

/// The component whose kept triangles a vertex lies on, or [`NONE`].
fn label(sides: &Sides, kept: &Kept, border: &Border) -> u32 {
    let component = |side: Side| {
        let facet = side.facet().index();
        let on_kept = facet < kept.is.len() && kept.is[facet] && kept.reversed[facet] == side.reversed();
        if on_kept { border.component[facet] } else { NONE }
    };
    let mut all = sides.iter().map(component);
    let first = all.next().unwrap_or(NONE);
    if all.all(|c| c == first) { first } else { NONE }
}

/// The labels, also for vertices beside the border: they make room for the triangles that end on it.
fn with_those_beside(initial: &Surface, border: &Border, labels: Vec<u32>, h: f64) -> Vec<u32> {
    let mut wishes: Vec<(u32, u32)> = Vec::new();
    for t in &initial.mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            if labels[a as usize] != NONE && labels[b as usize] == NONE {
                wishes.push((b, labels[a as usize]));
            }
        }
    }
    wishes.par_sort_unstable();
    wishes.dedup();
    let mut all = labels;
    let close = wishes.into_par_iter().filter(|&(v, c)| border.component_near(initial.at(v), CLEAR * h) == Some(c));
    close.collect::<Vec<_>>().into_iter().for_each(|(v, c)| all[v as usize] = c);
    all
}

/// The components with a border on which the contour has no vertex.
fn unseen(labels: &[u32], border: &Border) -> Vec<u32> {
    let mut seen = vec![false; border.component.len()];
    labels.iter().filter(|&&c| c < CUT_OFF).for_each(|&c| seen[c as usize] = true);
    let mut open: Vec<u32> = border.segments.iter().map(|s| border.component[s.facet as usize]).collect();
    open.sort_unstable();
    open.dedup();
    open.retain(|&c| !seen[c as usize]);
    open
}

/// Where the contour's edges pass the border: those with one end on kept triangles, smaller vertex first, sorted.
fn crossings(
    initial: &Surface,
    kept: &Kept,
    border: &Border,
    labels: &[u32],
    h: f64,
) -> Result<Vec<([u32; 2], OnBorder)>, Misfit> {
    // Where the contour goes over from one kept component to another, it has bridged a gap between them that the lattice does not
    // hold: both ends go, and no cut is needed there.
    let edges = initial.edges().filter(|[a, b]| (labels[*a as usize] == NONE) != (labels[*b as usize] == NONE));
    let found = edges.map(|edge| {
        let [a, b] = edge.map(|v| initial.at(v));
        let ends = edge.map(|v| labels[v as usize]);
        let inner = if ends[0] == NONE { b } else { a };
        let known = ends[0].min(ends[1]);
        let fits = |on: &OnBorder| {
            let facet = border.segments[on.segment as usize].facet;
            on.off < FARTHEST * h && border.component[facet as usize] == known && kept.is[facet as usize]
        };
        border.crossing(a, b).filter(fits).map(|on| (edge, on)).ok_or(inner)
    });
    let (mut fine, wrong): (Vec<_>, Vec<_>) = found.partition_map(|found| match found {
        Ok(point) => rayon::iter::Either::Left(point),
        Err(point) => rayon::iter::Either::Right(point),
    });
    if !wrong.is_empty() {
        return Err(Misfit { points: wrong, ..Misfit::default() });
    }
    fine.par_sort_unstable_by_key(|p| p.0);
    Ok(fine)
}

/// For each point of the cut, the next one in the direction of the border.
fn seam(triangles: &[[u32; 3]], others: &[u32], first: u32, count: usize) -> Vec<u32> {
    let mut next = vec![NONE; count];
    for &t in others {
        let corners = triangles[t as usize];
        for k in 0..3 {
            let (x, y) = (corners[k], corners[(k + 1) % 3]);
            if x >= first && y >= first {
                next[(y - first) as usize] = x - first;
            }
        }
    }
    next
}

/// All loops of the border with the points of the cut on them.
fn rings(border: &Border, kept: &Kept, found: &[OnBorder], seam: &[u32], h: f64) -> Result<Vec<BorderRing>, Misfit> {
    let at = |v: u32| kept.mesh.positions[v as usize];
    let mut rings: Vec<Option<BorderRing>> = vec![None; border.lengths.len()];
    let mut seen = vec![false; seam.len()];
    let mut wrong: Vec<DVec3> = Vec::new();
    for start in 0..seam.len() {
        let mut points = Vec::new();
        let mut p = start as u32;
        while p != NONE && !std::mem::replace(&mut seen[p as usize], true) {
            points.push(p);
            p = seam[p as usize];
        }
        if points.is_empty() {
            continue;
        }
        match matched(border, at, found, &points, h) {
            Ok((ring, _)) if rings[ring as usize].is_some() => {
                wrong.extend(points.iter().map(|&p| found[p as usize].at))
            }
            Ok((ring, with)) => rings[ring as usize] = Some(with),
            Err(points) => wrong.extend(points.iter().map(|&p| found[p as usize].at)),
        }
    }
    // Where some loops were not matched, others may seem to have none.
    let others_fit = wrong.is_empty();
    for (n, ring) in (0..).zip(&rings) {
        if ring.is_none() && others_fit {
            wrong.extend(border.ring(n).iter().map(|s| at(s.from)));
        }
    }
    if wrong.is_empty() {
        Ok(rings.into_iter().flatten().collect())
    } else {
        Err(Misfit { points: wrong, ..Misfit::default() })
    }
}

/// All that is needed to put the two together.
struct Joint<'a> {
    initial: &'a Surface,
    facets: &'a Facets<'a>,
    kept: &'a Kept,
    border: &'a Border,
    cut: &'a Cut,
    first: u32,
    found: &'a [OnBorder],
    rings: &'a [BorderRing],
}

impl Joint<'_> {
    fn assemble(&self, others: &[u32]) -> Joined {
        let mut surface = Surface::default();
        let of_source = self.add_kept_vertices(&mut surface);
        let of_point = self.add_points(&mut surface, &of_source);
        self.add_kept_triangles(&mut surface, &of_source, &of_point);
        let mut of_home = vec![NONE; self.first as usize];
        let fills = self.fills(&of_source, &of_point);
        let mut normals = Vec::new();
        let first = surface.mesh.triangles.len() as u32;
        for &t in others {
            let corners = self.cut.surface.mesh.triangles[t as usize];
            let normal = shape(self.initial.mesh.corners(self.cut.origin[t as usize] as usize)).0;
            let ids = corners.map(|v| {
                if v >= self.first {
                    return of_point[(v - self.first) as usize];
                }
                if of_home[v as usize] == NONE {
                    of_home[v as usize] = surface.mesh.positions.len() as u32;
                    surface.add(self.initial.spot(v), OfSource::NONE);
                }
                of_home[v as usize]
            });
            let seam_edge = (0..3).find(|&k| corners[k] >= self.first && corners[(k + 1) % 3] >= self.first);
            let between = seam_edge.map(|k| {
                let y = corners[(k + 1) % 3] - self.first;
                (k, fills[y as usize].as_slice())
            });
            match between {
                Some((k, fill)) if !fill.is_empty() => {
                    let (x, y, z) = (ids[k], ids[(k + 1) % 3], ids[(k + 2) % 3]);
                    // From x back to y, against the direction of the border.
                    let way: Vec<u32> = [x].into_iter().chain(fill.iter().rev().copied()).chain([y]).collect();
                    for pair in way.windows(2) {
                        normals.push((surface.mesh.triangles.len() as u32, normal));
                        surface.mesh.triangles.push([pair[0], pair[1], z]);
                    }
                }
                _ => {
                    if corners.iter().any(|&v| v >= self.first) {
                        normals.push((surface.mesh.triangles.len() as u32, normal));
                    }
                    surface.mesh.triangles.push(ids);
                }
            }
        }
        surface.triangles_of.resize(surface.mesh.triangles.len(), OfSource::NONE);
        Joined { surface, first, seam: normals }
    }

    /// The vertices of the kept triangles, and which one each vertex of the source has become.
    fn add_kept_vertices(&self, surface: &mut Surface) -> Vec<u32> {
        let mut of_source = vec![NONE; self.kept.mesh.positions.len()];
        for facet in self.kept.facets() {
            for v in self.kept.mesh.triangles[facet as usize] {
                if of_source[v as usize] == NONE {
                    of_source[v as usize] = surface.mesh.positions.len() as u32;
                    surface.add(
                        Spot { at: self.kept.mesh.positions[v as usize], sides: Sides::default() },
                        OfSource::new(v),
                    );
                }
            }
        }
        // What a vertex shares with its neighbours in the contour are the facets that are not kept.
        for kept_ones in [false, true] {
            for (t, corners) in self.kept.mesh.triangles.iter().enumerate() {
                if self.kept.is[t] == kept_ones {
                    for id in corners.iter().map(|&v| of_source[v as usize]).filter(|&id| id != NONE) {
                        surface.sides[id as usize].add(self.kept.side(t as u32));
                    }
                }
            }
        }
        of_source
    }

    /// The points of the cut, those on a vertex of the source being that vertex.
    fn add_points(&self, surface: &mut Surface, of_source: &[u32]) -> Vec<u32> {
        let mut of_point = vec![NONE; self.found.len()];
        for ring in self.rings {
            for &(point, segment, at) in &ring.places {
                let facet = self.border.segments[segment as usize].facet;
                let mut sides = self.cut.surface.sides[(self.first + point) as usize];
                sides.add(self.kept.side(facet));
                if let Some(across) = self.facets.across(facet, self.edge_of(segment)) {
                    sides = Sides::of(
                        [Side::new(FacetId::of_triangle(across), self.kept.reversed[facet as usize])]
                            .into_iter()
                            .chain(sides.iter()),
                    );
                }
                of_point[point as usize] = surface.mesh.positions.len() as u32;
                surface.add(Spot { at: rounded(at), sides }, OfSource::NONE);
            }
            for &(point, stop) in &ring.points {
                if let Stop::Vertex(v) = ring.stops[stop as usize] {
                    of_point[point as usize] = of_source[v as usize];
                }
            }
        }
        of_point
    }

    /// Which edge (corner k to the next) of its triangle in the source a segment is.
    fn edge_of(&self, segment: u32) -> usize {
        let segment = &self.border.segments[segment as usize];
        let corners = self.kept.mesh.triangles[segment.facet as usize];
        let is = |k: &usize| {
            let pair = [corners[*k], corners[(*k + 1) % 3]];
            pair == [segment.from, segment.to] || pair == [segment.to, segment.from]
        };
        (0..3).find(is).unwrap_or(0)
    }

    /// The kept triangles, cut where the contour's points lie on their edges.
    fn add_kept_triangles(&self, surface: &mut Surface, of_source: &[u32], of_point: &[u32]) {
        let mut on_edges: FxHashMap<u32, Vec<(u32, Vec<u32>)>> = FxHashMap::default();
        for ring in self.rings {
            let mut segment = ring.first;
            for (n, stop) in ring.stops.iter().enumerate() {
                match stop {
                    Stop::Vertex(_) => segment += u32::from(n > 0),
                    Stop::Point(point) => {
                        let list = on_edges.entry(self.border.segments[segment as usize].facet).or_default();
                        match list.last_mut().filter(|(s, _)| *s == segment) {
                            Some((_, points)) => points.push(*point),
                            None => list.push((segment, vec![*point])),
                        }
                    }
                }
            }
        }
        for facet in self.kept.facets() {
            let mut parts = vec![self.kept.corners(facet).map(|v| of_source[v as usize])];
            for (segment, points) in on_edges.get(&facet).into_iter().flatten() {
                let segment = &self.border.segments[*segment as usize];
                let (from, to) = (of_source[segment.from as usize], of_source[segment.to as usize]);
                let ids: Vec<u32> = points.iter().map(|&p| of_point[p as usize]).collect();
                fan(&mut parts, from, to, &ids);
            }
            surface.mesh.triangles.extend(parts);
            surface.triangles_of.resize(surface.mesh.triangles.len(), OfSource::new(facet));
        }
    }

    /// For each point of the cut, the vertices of the source between it and the next point.
    fn fills(&self, of_source: &[u32], of_point: &[u32]) -> Vec<Vec<u32>> {
        let mut fills = vec![Vec::new(); self.found.len()];
        for ring in self.rings {
            let count = ring.stops.len() as u32;
            for (k, &(point, stop)) in ring.points.iter().enumerate() {
                let next = ring.points[(k + 1) % ring.points.len()].1;
                let steps = (next + count - stop - 1) % count;
                let id = |stop: u32| match ring.stops[(stop % count) as usize] {
                    Stop::Vertex(v) => of_source[v as usize],
                    Stop::Point(p) => of_point[p as usize],
                };
                fills[point as usize] = (1..=steps).map(|s| id(stop + s)).collect();
            }
        }
        fills
    }
}

/// Cuts the one of `parts` with the edge from `from` to `to` at the points `ids` on it.
fn fan(parts: &mut Vec<[u32; 3]>, from: u32, to: u32, ids: &[u32]) {
    let on = |t: &[u32; 3]| (0..3).find(|&k| t[k] == from && t[(k + 1) % 3] == to);
    let Some((n, k)) = parts.iter().enumerate().find_map(|(n, t)| Some((n, on(t)?))) else { return };
    let apex = parts.swap_remove(n)[(k + 2) % 3];
    let way: Vec<u32> = [from].into_iter().chain(ids.iter().copied()).chain([to]).collect();
    parts.extend(way.windows(2).map(|pair| [pair[0], pair[1], apex]));
}
