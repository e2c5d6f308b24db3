//! Vertices that lie beside a crease move onto it, so that no slivers are left beside it.

use rayon::prelude::*;

use super::crease::{Crease, Spot, crease, nearest};
use super::facets::{Facets, SMOOTH, Sides};
use super::surface::{Surface, faces_out, rounded, shape};
use crate::mesh::around::Around;

/// Vertices nearer to a crease than this, h, move onto it.
const NEAR: f64 = 0.3;

/// Vertices nearer to a corner than this, h, move into it.
const NEAR_CORNER: f64 = 0.35;

/// The least height that a triangle may get by it, h, unless it was lower before.
const LEAST_HEIGHT: f64 = 0.01;

/// Moves vertices. `edges` are all edges between different smooth pieces,
/// `around` the triangles around each vertex.
pub(super) fn snap(
    surface: &mut Surface,
    facets: &Facets<'_>,
    h: f64,
    edges: &[[u32; 2]],
    around: &Around,
) -> Vec<u32> {
    let mut ends: Vec<[u32; 2]> = edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    ends.par_sort_unstable();
    let fans: Vec<&[[u32; 2]]> = ends.chunk_by(|a, b| a[0] == b[0]).filter(|fan| !surface.is_kept(fan[0][0])).collect();
    let mut wishes: Vec<(Vec<Spot>, &[[u32; 2]])> = fans
        .par_iter()
        .map(|fan| (wish(surface, facets, h, fan), *fan))
        .filter(|(spots, _)| !spots.is_empty())
        .collect();
    let way = |w: &(Vec<Spot>, &[[u32; 2]])| w.0[0].at.distance(surface.at(w.1[0][0]));
    wishes.par_sort_by(|a, b| way(a).total_cmp(&way(b)).then(a.1[0].cmp(&b.1[0])));
    let mut has_moved = vec![false; surface.mesh.positions.len()];
    let mut moved = Vec::new();
    for (mut spots, fan) in wishes {
        let vertex = fan[0][0];
        if fan.iter().any(|e| has_moved[e[1] as usize]) {
            spots = wish(surface, facets, h, fan);
        }
        let old = surface.spot(vertex);
        let fits = |surface: &Surface| around.of(vertex).iter().all(|&t| parts_fit(surface, facets, h, t));
        let taken = spots.into_iter().any(|spot| {
            surface.put(vertex, Spot { at: rounded(spot.at), ..spot });
            fits(surface)
        });
        if taken {
            moved.push(vertex);
            has_moved[vertex as usize] = true;
        } else {
            surface.put(vertex, old);
        }
    }
    moved
}

/// Where a vertex may go, the best place first, given the edges that leave its smooth piece: into a
/// corner, straight onto the nearest crease, or along one of the edges onto it.
fn wish(surface: &Surface, facets: &Facets<'_>, h: f64, fan: &[[u32; 2]]) -> Vec<Spot> {
    let own = surface.spot(fan[0][0]);
    let foot = |sides: &Sides| nearest(sides.iter().map(|s| facets.plane(s)), own.at);
    let mut met = Sides::default();
    let mut spots: Vec<(f64, Spot)> = Vec::new();
    for &[_, other] in fan {
        let found = crease(facets, h, &own, &surface.spot(other)).filter(|c| c.cosine < SMOOTH);
        let Some(Crease { spot: Spot { at, sides }, .. }) = found else { continue };
        let Some(foot) = foot(&sides).filter(|&p| facets.is_on_target(p, h)) else { continue };
        let straight = foot.distance(own.at);
        if straight < NEAR_CORNER * h {
            let normal = |s| facets.plane(s).normal;
            for side in sides.iter() {
                if met.iter().all(|m| normal(m).dot(normal(side)) < SMOOTH) {
                    met.add(side);
                }
            }
        }
        if straight < NEAR * h {
            spots.push((straight, Spot { at: foot, sides }));
            spots.push((straight.max(at.distance(own.at)) + NEAR * h, Spot { at, sides }));
        }
    }
    if met.iter().count() > 2
        && let Some(corner) = foot(&met).filter(|c| c.distance(own.at) < NEAR_CORNER * h && facets.is_on_target(*c, h))
    {
        spots.push((-1.0, Spot { at: corner, sides: met }));
    }
    spots.retain(|p| p.0 < 3.0 * NEAR * h);
    spots.sort_by(|a, b| a.0.total_cmp(&b.0));
    spots.into_iter().map(|p| p.1).collect()
}

/// Whether what a triangle will be cut into faces the way of its facets and is not too thin.
fn parts_fit(surface: &Surface, facets: &Facets<'_>, h: f64, t: u32) -> bool {
    let [a, b, c] = surface.spots(t);
    let fits = |corners: [Spot; 3]| shape(corners.map(|c| c.at)).1 >= LEAST_HEIGHT * h && faces_out(facets, &corners);
    let on = |x: &Spot, y: &Spot| crease(facets, h, x, y).map(|c| c.spot);
    let cuts = [on(&a, &b), on(&b, &c), on(&c, &a)];
    for turn in 0..3 {
        let [a, b, c] = [[a, b, c], [b, c, a], [c, a, b]][turn];
        match [0, 1, 2].map(|k| cuts[(turn + k) % 3]) {
            [Some(m), None, None] => return fits([a, m, c]) && fits([m, b, c]),
            [Some(m), Some(n), None] => {
                return fits([m, b, n]) && (fits([a, m, n]) && fits([a, n, c]) || fits([a, m, c]) && fits([m, n, c]));
            }
            _ => {}
        }
    }
    cuts[0].is_some() || fits([a, b, c])
}
