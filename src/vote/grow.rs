//! Which bricks are stored: those that hold crossings, and those that the surface grows into where
//! it has none (the closure of a hole).

use std::sync::Arc;

use glam::IVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::tally::{Jury, Votes};
use crate::lattice::{BRICK_VOXELS, Bricks, Domain, Grid, brick_of, index_in_brick};
use crate::ldi::Spans;
use crate::progress::{Progress, Stopped};

type BrickVotes = Box<[Votes; BRICK_VOXELS]>;

/// The six face neighbours of a brick, and for each the axis across the brick's face towards it and
/// the layer of voxels, 0 to 7, that forms that face.
const FACES: [(IVec3, usize, usize); 6] = [
    (IVec3::NEG_X, 0, 0),
    (IVec3::X, 0, 7),
    (IVec3::NEG_Y, 1, 0),
    (IVec3::Y, 1, 7),
    (IVec3::NEG_Z, 2, 0),
    (IVec3::Z, 2, 7),
];

/// Votes on all voxels near the surface. Any two neighbouring voxels of which one is inside and
/// the other outside lie in active bricks; every inactive brick has the class of the voxels next
/// to it. What is beyond the jury's domain is outside: sheets that face one another can hold a winding number above ½ far beyond their box.
pub fn vote_near_surface(jury: &Jury<'_>, progress: &Progress) -> Result<Grid<Votes>, Stopped> {
    let mut known: FxHashMap<IVec3, BrickVotes> = FxHashMap::default();
    let mut uniform: FxHashMap<IVec3, bool> = FxHashMap::default();
    let mut wanted = bricks_with_crossings(jury.spans);
    wanted.retain(|&brick| jury.domain.holds(brick));
    if jury.winding.reaches_beyond() {
        // All of the border may lie inside.
        wanted.extend(jury.domain.at_lattice_border());
        wanted.sort_unstable_by_key(|b| (b.z, b.y, b.x));
        wanted.dedup();
    }
    let mut skin = Vec::new();
    while !wanted.is_empty() || !skin.is_empty() {
        let votes = vote(jury, &wanted, progress)?;
        known.extend(wanted.iter().copied().zip(votes));
        known.extend(skin.iter().map(|&brick| (brick, jury.inside(brick))));
        for brick in wanted.iter().chain(&skin) {
            uniform.remove(brick);
        }
        let probes = neighbours_in_doubt(&wanted, &known, &uniform);
        let probed = vote(jury, &probes, progress)?;
        let mut next = Vec::new();
        for (brick, votes) in probes.into_iter().zip(probed) {
            if votes.iter().all(|v| v.is_inside == votes[0].is_inside) {
                uniform.insert(brick, votes[0].is_inside);
            } else {
                next.push(brick);
            }
        }
        skin.clear();
        if next.is_empty() {
            next = conflicts(&known, &mut uniform, jury.domain);
            skin = border_inside(&known, &mut uniform, jury.domain, &mut next);
        }
        next.sort_unstable_by_key(|b| (b.z, b.y, b.x));
        next.dedup();
        wanted = next;
    }
    Ok(assemble(known))
}

fn vote(jury: &Jury<'_>, bricks: &[IVec3], progress: &Progress) -> Result<Vec<BrickVotes>, Stopped> {
    let checked = |&brick: &IVec3| progress.check().and_then(|()| jury.brick(brick));
    bricks.par_iter().map(checked).collect()
}

/// The bricks of each crossing and of the voxels before and behind it, sorted.
fn bricks_with_crossings(spans: &[Spans]) -> Vec<IVec3> {
    let sets: Vec<FxHashSet<IVec3>> = spans
        .par_iter()
        .map(|spans| {
            let layers = &spans.layers;
            let direction = layers.direction;
            let factor = layers.factor as i32;
            let mut set = FxHashSet::default();
            let mut last = [IVec3::MIN; 3];
            for ray in 0..layers.ray_count() {
                let hits = layers.of(ray);
                if hits.is_empty() {
                    continue;
                }
                let (i, j) = layers.indices(ray);
                let (u, v) = layers.position(ray);
                for hit in hits {
                    // Conversion rounds down, but for what is beyond the lattice anyway.
                    let t = hit.depth as i32;
                    let before = direction.unshear_voxel(i.div_euclid(factor), j.div_euclid(factor), t);
                    let behind = before + direction.vector();
                    let itself = direction.unshear(u, v, hit.depth).as_ivec3();
                    for (last, p) in last.iter_mut().zip([before, behind, itself]) {
                        let brick = brick_of(p);
                        if *last != brick {
                            set.insert(brick);
                            *last = brick;
                        }
                    }
                }
            }
            set
        })
        .collect();
    let mut all: Vec<IVec3> = sets.into_iter().flatten().collect();
    all.sort_unstable_by_key(|b| (b.z, b.y, b.x));
    all.dedup();
    all
}

/// What the 64 voxels of a brick next to one of its faces are.
struct Face {
    inside: bool,
    uniform: bool,
    unanimous: bool,
}

fn face(votes: &[Votes; BRICK_VOXELS], axis: usize, side: usize) -> Face {
    let stride = [1usize, 8, 64];
    let (a, b) = (stride[(axis + 1) % 3], stride[(axis + 2) % 3]);
    let start = side * stride[axis];
    let inside = votes[start].is_inside;
    let (mut uniform, mut unanimous) = (true, true);
    for v in (0..64).map(|k| votes[start + (k & 7) * a + (k >> 3) * b]) {
        uniform &= v.is_inside == inside;
        unanimous &= v.unanimous();
    }
    Face { inside, uniform, unanimous }
}

/// Bricks beside the `fresh` ones into which the surface may go on: across a face whose voxels
/// differ, or on which the directions do not all agree.
fn neighbours_in_doubt(
    fresh: &[IVec3],
    known: &FxHashMap<IVec3, BrickVotes>,
    uniform: &FxHashMap<IVec3, bool>,
) -> Vec<IVec3> {
    let mut found = Vec::new();
    for &brick in fresh {
        for (step, axis, side) in FACES {
            let other = brick + step;
            if known.contains_key(&other) || uniform.contains_key(&other) {
                continue;
            }
            let face = face(&known[&brick], axis, side);
            if !face.uniform || !face.unanimous {
                found.push(other);
            }
        }
    }
    found.sort_unstable_by_key(|b| (b.z, b.y, b.x));
    found.dedup();
    found
}

/// Sets the class of the inactive bricks beside active ones; returns those that have to become
/// active because their neighbours disagree about them, or because two of them that touch differ.
fn conflicts(
    known: &FxHashMap<IVec3, BrickVotes>,
    uniform: &mut FxHashMap<IVec3, bool>,
    domain: &Domain,
) -> Vec<IVec3> {
    let mut bricks: Vec<IVec3> = known.keys().copied().collect();
    bricks.sort_unstable_by_key(|b| (b.z, b.y, b.x));
    let mut next = Vec::new();
    for &brick in &bricks {
        for (step, axis, side) in FACES {
            let other = brick + step;
            if !known.contains_key(&other) {
                let face = face(&known[&brick], axis, side);
                if !domain.holds(other) {
                    uniform.insert(other, false);
                }
                if *uniform.entry(other).or_insert(face.inside) != face.inside || !face.uniform {
                    next.push(other);
                }
            }
        }
    }
    let mut tiles: Vec<(IVec3, bool)> = uniform.iter().map(|(&b, &inside)| (b, inside)).collect();
    tiles.sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
    for &(brick, inside) in &tiles {
        if inside && domain.is_at_lattice_border(brick) {
            next.push(brick);
        }
        for step in [IVec3::X, IVec3::Y, IVec3::Z] {
            if uniform.get(&(brick + step)).is_some_and(|&other| other != inside) {
                next.extend([brick, brick + step]);
            }
        }
    }
    next
}

/// The inactive bricks along the border of the domain within the lattice that lie inside, sorted: there the contour is closed, whatever the rays say. What must
/// become active beside them goes to `next`; what is in there is left out.
fn border_inside(
    known: &FxHashMap<IVec3, BrickVotes>,
    uniform: &mut FxHashMap<IVec3, bool>,
    domain: &Domain,
    next: &mut Vec<IVec3>,
) -> Vec<IVec3> {
    let mut found: FxHashSet<IVec3> = FxHashSet::default();
    let at_border = uniform.iter().filter(|&(&brick, &inside)| inside && domain.is_at_inner_border(brick));
    let mut open: Vec<IVec3> = at_border.map(|(&brick, _)| brick).collect();
    while let Some(brick) = open.pop() {
        if !found.insert(brick) {
            continue;
        }
        for (step, ..) in FACES {
            let other = brick + step;
            if known.contains_key(&other) || found.contains(&other) {
                continue;
            }
            if !(domain.holds(other) && *uniform.entry(other).or_insert(true)) {
                next.push(other);
            } else if domain.is_at_inner_border(other) {
                open.push(other);
            }
        }
    }
    for brick in next {
        found.remove(brick);
    }
    let mut found: Vec<IVec3> = found.into_iter().collect();
    found.sort_unstable_by_key(|b| (b.z, b.y, b.x));
    found
}

/// The grid over all bricks that were voted on.
fn assemble(mut known: FxHashMap<IVec3, BrickVotes>) -> Grid<Votes> {
    // Faces towards inactive bricks are uniform: one voxel speaks for what follows along x.
    let last = index_in_brick(IVec3::new(7, 0, 0));
    let bricks = Bricks::with_classes(known.keys().copied(), |brick| known[&brick][last].is_inside);
    let values = bricks.active().iter().filter_map(|brick| known.remove(brick)).map(|votes| *votes).collect();
    let say = |inside: bool| Votes { inside: if inside { 13 } else { 0 }, valid: 13, is_inside: inside };
    Grid { bricks: Arc::new(bricks), values, inside: say(true), outside: say(false) }
}
