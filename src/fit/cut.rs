//! Triangles that reach over a crease are cut along it.
//!
//! An edge between different smooth pieces gets a vertex where the crease is. A triangle with two
//! such edges is cut in two by the way between their vertices, and that way lies on the crease; one
//! with three is cut in three, around the corner. So creases become paths of edges by themselves,
//! as in marching over a triangulation by labels.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::crease::{Crease, FLAT, Spot, crease, nearest};
use super::facets::{Facets, Sides};
use super::surface::{OfSource, Surface, faces_out, rounded, shape};

/// A corner nearer to a point of a crease than this, h, is that point.
const SAME: f64 = 0.02;

/// A surface whose triangles know which triangle they were.
pub(super) struct Cut {
    pub surface: Surface,
    /// The triangle before cutting, for each triangle.
    pub origin: Vec<u32>,
    /// Triangles before cutting in which more than their own edges was cut.
    pub centred: Vec<u32>,
}

impl Cut {
    /// A surface that is not cut yet.
    pub(super) fn of(surface: &Surface) -> Self {
        let count = surface.mesh.triangles.len() as u32;
        Self { surface: surface.clone(), origin: (0..count).collect(), centred: Vec::new() }
    }
}

/// What must be left alone.
#[derive(Debug, Clone, Default)]
pub(super) struct Spared {
    /// Edges of the first surface that must not be cut, smaller vertex first.
    pub edges: FxHashSet<[u32; 2]>,
    /// Triangles of the first surface in which nothing but their own edges is cut.
    pub triangles: FxHashSet<u32>,
    /// Triangles of the first surface beside another sheet, whose creases stay a little within the solid, and the edges that are
    /// cut there.
    pub inset: FxHashSet<u32>,
    /// See `inset`.
    pub inset_edges: FxHashSet<[u32; 2]>,
}

/// How far within the solid a crease stays where another sheet has its crease in the same place, h.
const INSET: f64 = 0.02;

/// A place on a crease, moved a little into the solid.
pub(super) fn inset(spot: Spot, facets: &Facets<'_>, h: f64) -> Spot {
    let outward: DVec3 = spot.sides.iter().map(|s| facets.plane(s).normal).sum();
    Spot { at: spot.at - outward.normalize_or_zero() * (INSET * h), ..spot }
}

/// Cuts `surface` at the points given for some of its edges (smaller vertex first), then the edges that this
/// made, and puts corners in where creases meet.
pub(super) fn cut(
    surface: &Surface,
    facets: &Facets<'_>,
    h: f64,
    points: &[([u32; 2], Crease)],
    spared: &Spared,
    wanted: impl Fn(&Crease) -> bool + Sync,
) -> Cut {
    let first = surface.mesh.positions.len() as u32;
    let mut cut = Cut::of(surface);
    let within = |&(edge, crease): &([u32; 2], Crease)| match spared.inset_edges.contains(&edge) {
        true => (edge, Crease { spot: inset(crease.spot, facets, h), ..crease }),
        false => (edge, crease),
    };
    match spared.inset.is_empty() {
        true => subdivide(&mut cut, points),
        false => subdivide(&mut cut, &points.iter().map(within).collect::<Vec<_>>()),
    }
    let again: Vec<([u32; 2], Crease)> = second_points(&cut, facets, h, first, spared, wanted);
    let edges: FxHashSet<[u32; 2]> = again.iter().map(|p| p.0).collect();
    let has_cut = |t: &[u32; 3]| edges_of(t).iter().any(|e| edges.contains(e));
    let touched = cut.surface.mesh.triangles.iter().zip(&cut.origin).filter(|(t, _)| has_cut(t));
    cut.centred = touched.map(|(_, &origin)| origin).collect();
    subdivide(&mut cut, &again);
    raise_corners(&mut cut, facets, h, first, spared);
    cut
}

/// The edges of a triangle, smaller vertex first.
pub(super) fn edges_of(t: &[u32; 3]) -> [[u32; 2]; 3] {
    [0, 1, 2].map(|k| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])])
}

/// Where edges are to be cut that end in a point inserted before, the `first` of these vertices.
fn second_points(
    cut: &Cut,
    facets: &Facets<'_>,
    h: f64,
    first: u32,
    spared: &Spared,
    wanted: impl Fn(&Crease) -> bool + Sync,
) -> Vec<([u32; 2], Crease)> {
    let triangles = cut.surface.mesh.triangles.par_iter().zip(&cut.origin);
    let mut edges: Vec<([u32; 2], bool, bool)> = triangles
        .filter(|(t, _)| t.iter().any(|&v| v >= first))
        .flat_map_iter(|(t, origin)| {
            let (spared, inset) = (spared.triangles.contains(origin), spared.inset.contains(origin));
            edges_of(t).map(|edge| (edge, spared, inset))
        })
        .filter(|(edge, ..)| edge[1] >= first)
        .collect();
    edges.par_sort_unstable();
    // An edge is there once for each of its triangles.
    let pairs: Vec<&[([u32; 2], bool, bool)]> = edges.chunk_by(|a, b| a.0 == b.0).collect();
    let free = pairs.into_par_iter().filter(|pair| pair.iter().all(|(_, spared, _)| !spared));
    let spot = |v: u32| cut.surface.spot(v);
    let found = free.filter_map(|pair| {
        let edge = pair[0].0;
        let found = crease(facets, h, &spot(edge[0]), &spot(edge[1])).filter(&wanted)?;
        let within = pair.iter().any(|(.., inset)| *inset);
        let spot = if within { inset(found.spot, facets, h) } else { found.spot };
        Some((edge, Crease { spot, ..found }))
    });
    found.collect()
}

/// Cuts triangles at points on their edges.
pub(super) fn subdivide(cut: &mut Cut, points: &[([u32; 2], Crease)]) {
    let Cut { surface: Surface { mesh, sides, vertices_of, triangles_of }, origin, .. } = cut;
    let first = mesh.positions.len() as u32;
    let ids: FxHashMap<[u32; 2], u32> = points.iter().zip(first..).map(|(&(edge, _), id)| (edge, id)).collect();
    mesh.positions.extend(points.iter().map(|(_, c)| rounded(c.spot.at)));
    sides.extend(points.iter().map(|(_, c)| c.spot.sides));
    vertices_of.resize(mesh.positions.len(), OfSource::NONE);
    let on = |a: u32, b: u32| ids.get(&[a.min(b), a.max(b)]).copied();
    let cuts_of = |&[a, b, c]: &[u32; 3]| {
        let cuts = [on(a, b), on(b, c), on(c, a)];
        cuts.iter().any(Option::is_some).then_some(cuts)
    };
    let cuts: Vec<Option<[Option<u32>; 3]>> = mesh.triangles.par_iter().map(cuts_of).collect();
    let mut triangles = Vec::with_capacity(mesh.triangles.len() + 2 * points.len());
    let mut origins = Vec::with_capacity(triangles.capacity());
    let mut parts_of = Vec::with_capacity(triangles.capacity());
    for (((&corners, cuts), &id), &of) in mesh.triangles.iter().zip(cuts).zip(origin.iter()).zip(triangles_of.iter()) {
        match cuts {
            Some(cuts) => split(corners, cuts, &mesh.positions, &mut triangles),
            None => triangles.push(corners),
        }
        origins.resize(triangles.len(), id);
        parts_of.resize(triangles.len(), of);
    }
    *triangles_of = parts_of;
    mesh.triangles = triangles;
    *origin = origins;
}

/// Puts a vertex into triangles whose corners lie on creases that meet in a corner not yet there.
fn raise_corners(cut: &mut Cut, facets: &Facets<'_>, h: f64, first: u32, spared: &Spared) {
    let surface = &cut.surface;
    let found: Vec<(u32, Spot)> = (0..surface.mesh.triangles.len() as u32)
        .into_par_iter()
        .filter(|&t| !surface.is_smooth(facets, t) && !spared.triangles.contains(&cut.origin[t as usize]))
        .filter_map(|t| Some((t, corner(facets, h, surface.spots(t))?)))
        .collect();
    let mut waiting: FxHashMap<u32, Spot> = found.iter().copied().collect();
    let halves = found.iter().flat_map(|&(t, _)| halves(surface.mesh.triangles[t as usize]).map(|half| (half, t)));
    let with_half: FxHashMap<[u32; 2], u32> = halves.collect();
    for (t, _) in found {
        let Some(spot) = waiting.remove(&t) else { continue };
        let within = spared.inset.contains(&cut.origin[t as usize]);
        let spot = if within { inset(spot, facets, h) } else { spot };
        let spot = Spot { at: rounded(spot.at), ..spot };
        let corners = cut.surface.mesh.triangles[t as usize];
        match corners.into_iter().find(|&v| cut.surface.at(v).distance(spot.at) < SAME * h) {
            // A point inserted that close is meant to be the corner.
            Some(v) if v >= first => cut.surface.put(v, spot),
            Some(_) => continue,
            None => {
                let ([a, b, c], z) = (corners, cut.surface.mesh.positions.len() as u32);
                let next = cut.surface.mesh.triangles.len() as u32;
                cut.surface.add(spot, OfSource::NONE);
                cut.surface.mesh.triangles[t as usize] = [a, b, z];
                cut.surface.mesh.triangles.extend([[b, c, z], [c, a, z]]);
                cut.origin.extend([cut.origin[t as usize]; 2]);
                cut.surface.triangles_of.extend([cut.surface.triangles_of[t as usize]; 2]);
                reach_out(cut, facets, h, vec![t, next, next + 1], (&mut waiting, &with_half));
            }
        }
        cut.centred.push(cut.origin[t as usize]);
    }
}

/// The sides of a triangle in the direction in which they run.
fn halves([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Where a triangle beside those around a new corner wants the same corner, the edge between them is turned, so that it gets
/// that one. `rim` are the triangles around the corner, which is the last vertex of each.
fn reach_out(
    cut: &mut Cut,
    facets: &Facets<'_>,
    h: f64,
    mut rim: Vec<u32>,
    (waiting, with_half): (&mut FxHashMap<u32, Spot>, &FxHashMap<[u32; 2], u32>),
) {
    let mut around: Vec<u32> = rim.iter().map(|&n| cut.surface.mesh.triangles[n as usize][0]).collect();
    while let Some(n) = rim.pop() {
        let [x, y, z] = cut.surface.mesh.triangles[n as usize];
        let Some(&t) = with_half.get(&[y, x]) else { continue };
        let same = |spot: &Spot| spot.at.distance(cut.surface.at(z)) < SAME * h;
        if !waiting.get(&t).is_some_and(same) {
            continue;
        }
        let Some(&w) = cut.surface.mesh.triangles[t as usize].iter().find(|v| ![x, y].contains(v)) else { continue };
        let both = [[w, y, z], [x, w, z]];
        if !around.contains(&w) && both.iter().all(|t| faces_out(facets, &t.map(|v| cut.surface.spot(v)))) {
            waiting.remove(&t);
            around.push(w);
            cut.surface.mesh.triangles[t as usize] = both[0];
            cut.surface.mesh.triangles[n as usize] = both[1];
            cut.centred.push(cut.origin[t as usize]);
            rim.extend([t, n]);
        }
    }
}

/// The corner in which the creases through three points meet.
fn corner(facets: &Facets<'_>, h: f64, three: [Spot; 3]) -> Option<Spot> {
    let normal = |s| facets.plane(s).normal;
    let mut sides = Sides::default();
    for side in three.iter().flat_map(|p| p.sides.iter()) {
        if sides.iter().all(|o| normal(o).dot(normal(side)) < FLAT) {
            sides.add(side);
        }
    }
    if sides.iter().count() < 3 {
        return None;
    }
    let middle = three.iter().map(|p| p.at).sum::<DVec3>() / 3.0;
    let mut at = nearest(sides.iter().map(|s| facets.plane(s)), middle)?;
    let mut beyond = 0.0f64;
    for _ in 0..3 {
        let walked: Vec<_> = sides.iter().map(|s| facets.walk(s, at)).collect();
        beyond = walked.iter().map(|w| w.1).fold(0.0, f64::max);
        sides = Sides::of(walked.into_iter().map(|w| w.0));
        at = nearest(sides.iter().map(|s| facets.plane(s)), middle)?;
    }
    let reach = three.iter().map(|p| p.at.distance(at)).fold(0.0, f64::max);
    (reach < 2.0 * h && facets.is_on_target(at, h) && (beyond < 0.05 * h || reach < h)).then_some(Spot { at, sides })
}

/// Cuts a triangle at points on some of its edges (corner k to the next).
fn split(corners: [u32; 3], cuts: [Option<u32>; 3], at: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    for turn in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(turn + k) % 3]);
        let [ab, bc, ca] = [0, 1, 2].map(|k| cuts[(turn + k) % 3]);
        match (ab, bc, ca) {
            (Some(m), None, None) => return triangles.extend([[a, m, c], [m, b, c]]),
            (Some(m), Some(n), Some(o)) => return triangles.extend([[a, m, o], [m, b, n], [o, n, c], [m, n, o]]),
            (Some(m), Some(n), None) => {
                triangles.push([m, b, n]);
                let height = |t: [u32; 3]| shape(t.map(|v| at[v as usize])).1;
                let across = [[a, m, n], [a, n, c]];
                let other = [[a, m, c], [m, n, c]];
                let least = |pair: [[u32; 3]; 2]| height(pair[0]).min(height(pair[1]));
                return triangles.extend(if least(across) >= least(other) { across } else { other });
            }
            _ => {}
        }
    }
}
