//! Vertices that lie beside a crease move onto it, so that no slivers are left beside it.

use glam::DVec3;
use rayon::prelude::*;

use super::Surface;
use super::crease::{Crease, Place, SMOOTH, crease, nearest};
use super::facets::{Facets, Sides};

/// Vertices nearer to a crease than this, h, move onto it.
const NEAR: f64 = 0.3;

/// Vertices nearer to a corner than this, h, move into it.
const NEAR_CORNER: f64 = 0.35;

/// The least height that a triangle may get by it, h, unless it was lower before.
const LEAST_HEIGHT: f64 = 0.01;

/// By how much a triangle may turn (cosine).
const MOST_TURN: f64 = 0.3;

/// Moves vertices. `edges` are all edges between different smooth pieces,
/// `around` the triangles around each vertex.
pub(super) fn snap(
    surface: &mut Surface,
    facets: &Facets<'_>,
    h: f64,
    edges: &[[u32; 2]],
    around: &super::Around,
) -> Vec<u32> {
    let mut ends: Vec<[u32; 2]> = edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    ends.par_sort_unstable();
    let fans: Vec<&[[u32; 2]]> = ends.chunk_by(|a, b| a[0] == b[0]).collect();
    let mut wishes: Vec<(Place, &[[u32; 2]])> = fans
        .par_iter()
        .filter_map(|fan| wish(surface, facets, h, fan).map(|place| (place, *fan)))
        .collect();
    let way = |w: &(Place, &[[u32; 2]])| w.0.at.distance(surface.at(w.1[0][0]));
    wishes.par_sort_by(|a, b| way(a).total_cmp(&way(b)).then(a.1[0].cmp(&b.1[0])));
    let mut has_moved = vec![false; surface.mesh.positions.len()];
    let mut moved = Vec::new();
    for (mut place, fan) in wishes {
        let vertex = fan[0][0];
        if fan.iter().any(|e| has_moved[e[1] as usize]) {
            let Some(now) = wish(surface, facets, h, fan) else { continue };
            place = now;
        }
        let old = surface.at(vertex);
        surface.mesh.positions[vertex as usize] = super::rounded(place.at);
        let kept = around.of(vertex).iter().all(|&t| keeps_shape(surface, t, vertex, old, h));
        if kept {
            surface.sides[vertex as usize] = place.sides;
            moved.push(vertex);
            has_moved[vertex as usize] = true;
        } else {
            surface.mesh.positions[vertex as usize] = old;
        }
    }
    moved
}

/// Where a vertex should go, given the edges that leave its smooth piece.
fn wish(surface: &Surface, facets: &Facets<'_>, h: f64, fan: &[[u32; 2]]) -> Option<Place> {
    let vertex = fan[0][0];
    let own = surface.place(vertex);
    let sharp = |c: &Crease| c.cosine < SMOOTH;
    let mut nearest_crease: Option<(f64, Crease)> = None;
    let mut met = Sides::default();
    for &[_, other] in fan {
        let Some(found) = crease(facets, h, &own, &surface.place(other)).filter(sharp) else { continue };
        let foot = nearest(found.place.sides.iter().map(|s| facets.plane(s)), own.at)?;
        let distance = foot.distance(own.at);
        if distance < NEAR_CORNER * h {
            let normal = |s| facets.plane(s).normal;
            for side in found.place.sides.iter() {
                if met.iter().all(|m| normal(m).dot(normal(side)) < SMOOTH) {
                    met.add(side);
                }
            }
        }
        if nearest_crease.as_ref().is_none_or(|n| distance < n.0) {
            nearest_crease = Some((distance, found));
        }
    }
    if met.iter().count() > 2 {
        let corner = nearest(met.iter().map(|s| facets.plane(s)), own.at)?;
        let distance = corner.distance(own.at);
        if distance < NEAR_CORNER * h {
            return Some(Place { at: corner, sides: met });
        }
    }
    let (distance, found) = nearest_crease?;
    let foot = nearest(found.place.sides.iter().map(|s| facets.plane(s)), own.at)?;
    (distance < NEAR * h).then_some(Place { at: foot, sides: found.place.sides })
}

/// Whether triangle `t` is still well shaped after `vertex` moved from `old`.
fn keeps_shape(surface: &Surface, t: u32, vertex: u32, old: DVec3, h: f64) -> bool {
    let ids = surface.mesh.triangles[t as usize];
    let now = surface.mesh.corners(t as usize);
    let mut before = now;
    if let Some(k) = ids.iter().position(|&v| v == vertex) {
        before[k] = old;
    }
    let (turned_to, height) = shape(now);
    let (turned_from, least) = shape(before);
    turned_to.dot(turned_from) > MOST_TURN * turned_to.length() * turned_from.length()
        && height >= least.min(LEAST_HEIGHT * h)
}

/// Twice the area as a vector, and the smallest height.
pub(super) fn shape([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared()).sqrt();
    (normal, normal.length() / longest)
}
