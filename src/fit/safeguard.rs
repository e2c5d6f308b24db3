//! What must not have happened: triangles that vanished, turned over, or meet others.

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::facets::Facets;
use super::surface::{Surface, agreement, shape};
use crate::mesh::{TriMesh, intersecting_triangles, self_intersections};
use crate::progress::{Progress, Stopped};

/// The least height of a triangle, h: some steps of `f32` at the largest lattices.
const LEAST_HEIGHT: f64 = 2e-4;

/// The triangles of `surface` among `changed` that are too thin or turned over against the facets
/// they lie on. `before` gives the normal that a triangle must at least agree with where nothing is
/// known of its facets.
pub(super) fn misshapen(
    surface: &Surface,
    facets: &Facets<'_>,
    h: f64,
    changed: &[u32],
    before: impl Fn(u32) -> DVec3 + Sync,
) -> Vec<u32> {
    let wrong = |&t: &u32| {
        let corners = surface.spots(t);
        let (normal, height) = shape(corners.map(|c| c.at));
        let low = height.is_nan() || height < LEAST_HEIGHT * h;
        low || agreement(facets, &corners).unwrap_or_else(|| normal.dot(before(t))) <= 0.0
    };
    changed.par_iter().copied().filter(wrong).collect()
}

/// The triangles among `changed` with a corner where another vertex is, too: in formats without indices
/// the two would become one.
pub(super) fn coincident(mesh: &TriMesh, changed: &[u32]) -> Vec<u32> {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let key = |v: u32| (mesh.positions[v as usize] + 0.0).to_array().map(f64::to_bits);
    let mut mine: Vec<u32> = changed.iter().flat_map(|&t| mesh.triangles[t as usize]).collect();
    mine.par_sort_unstable();
    mine.dedup();
    let mut first: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let mut shared: FxHashSet<u32> = FxHashSet::default();
    for v in mine {
        let known = *first.entry(key(v)).or_insert(v);
        shared.extend([known, v].into_iter().filter(|_| known != v));
    }
    let other = |v: &u32| used[*v as usize] && first.get(&key(*v)).is_some_and(|known| known != v);
    let others: Vec<u32> = (0..used.len() as u32).into_par_iter().filter(other).collect();
    shared.extend(others.into_iter().map(|v| first[&key(v)]));
    let touches = |t: &u32| mesh.triangles[*t as usize].iter().any(|v| shared.contains(v));
    if shared.is_empty() { Vec::new() } else { changed.iter().copied().filter(touches).collect() }
}

/// Pieces of space, in h, by which triangles that could meet are found.
const BLOCK: f64 = 4.0;

/// The triangles that meet others, ascending. Pairs of triangles that are both not `changed` are known to be
/// apart.
pub(super) fn meeting(mesh: &TriMesh, h: f64, changed: &[u32], progress: &Progress) -> Result<Vec<u32>, Stopped> {
    if 4 * changed.len() > mesh.triangles.len() {
        return intersecting_triangles(mesh, progress);
    }
    let size = BLOCK * h;
    let block = |p: DVec3| (p / size).floor().as_ivec3();
    let blocks = |t: usize| {
        let corners = mesh.corners(t);
        let low = block(corners[0].min(corners[1]).min(corners[2]));
        let high = block(corners[0].max(corners[1]).max(corners[2]));
        let steps = high - low + 1;
        (0..steps.x * steps.y * steps.z)
            .map(move |k| low + IVec3::new(k % steps.x, k / steps.x % steps.y, k / (steps.x * steps.y)))
    };
    let touched: FxHashSet<IVec3> = changed.iter().flat_map(|&t| blocks(t as usize)).collect();
    // Most triangles span two blocks a side at most: one look from their lowest block.
    let steps = || (0..8).map(|k| IVec3::new(k & 1, k >> 1 & 1, k >> 2));
    let below: FxHashSet<IVec3> = touched.iter().flat_map(|&b| steps().map(move |s| b - s)).collect();
    let is_near = |t: usize| {
        let corners = mesh.corners(t);
        let low = block(corners[0].min(corners[1]).min(corners[2]));
        let high = block(corners[0].max(corners[1]).max(corners[2]));
        match (high - low).max_element() {
            0 => touched.contains(&low),
            1 => below.contains(&low),
            _ => blocks(t).any(|b| touched.contains(&b)),
        }
    };
    let near: Vec<u32> = (0..mesh.triangles.len() as u32).into_par_iter().filter(|&t| is_near(t as usize)).collect();
    let part = mesh.submesh(&near).mesh;
    Ok(intersecting_triangles(&part, progress)?.into_iter().map(|t| near[t as usize]).collect())
}

/// Which of the triangles `bad`, ascending, meet, or share a place with, one that is `apart` from them.
pub(super) fn touching(
    mesh: &TriMesh,
    bad: &[u32],
    apart: impl Fn(u32, u32) -> bool,
    progress: &Progress,
) -> Result<Vec<u32>, Stopped> {
    let part = mesh.submesh(bad).mesh;
    let pairs = self_intersections(&part, progress)?.into_iter().map(|pair| pair.map(|t| bad[t as usize]));
    let mut all: Vec<u32> = pairs.filter(|&[a, b]| apart(a, b)).flatten().collect();
    let mut at: FxHashMap<[u64; 3], Vec<u32>> = FxHashMap::default();
    for &t in bad {
        for p in mesh.corners(t as usize) {
            at.entry((p + 0.0).to_array().map(f64::to_bits)).or_default().push(t);
        }
    }
    all.extend(at.values().filter(|same| same[1..].iter().any(|&t| apart(same[0], t))).flatten());
    all.sort_unstable();
    all.dedup();
    Ok(all)
}
