//! The widest way through a part: how wide, how long, and where it is narrowest.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::fill::FilledPart;
use super::topology::Changes;
use super::{Canal, CanalKind};
use crate::lattice::Lattice;
use crate::mesh::edges::Union;
use crate::sdf::exact::ExactDistance;

/// The way may pass voxels that are by this much, h, nearer to the solid than its narrowest place: voxels lie up to
/// 0.87 h beside the middle of a canal.
const BESIDE: f64 = 0.75;

/// Mouths that look the same way (cosine of the angle) and are no farther apart than the part is wide are one.
const SAME_WAY: f64 = 0.3;

/// The middle of a canal is looked for as far as this from the way, h, and found to this part of h.
const ASIDE: f64 = 1.5;
const FINEST: f64 = 1.0 / 64.0;

/// Places whose widths differ by less than twice this, h, are as narrow.
const ALIKE: f64 = 0.05;

/// Pits are at least as deep, h: of less the lattice shows no shape.
const LEAST_DEPTH: f64 = 2.0;

/// Pits are deeper than their widest ball by this factor. What a closing rounds where three sides meet at right angles is 0.87
/// times as deep as wide, up to 1.1 times in voxels.
const DEEP: f64 = 1.5;

/// Rounds of averaging that take the steps of the lattice out of a way.
const ROUNDS: usize = 8;

/// The part as a canal; `None` when it is only the rounding of an inner edge.
pub(super) fn measure(
    part: &FilledPart,
    changes: &Changes,
    distance: &ExactDistance,
    lattice: &Lattice,
) -> Option<Canal> {
    let mouths = mouths(part);
    let depth = shortest(part, |n| part.mouth[n as usize], |_| true);
    let farthest = depth.far.iter().copied().filter(|far| far.is_finite()).fold(0.0, f64::max);
    let kind = match changes {
        Changes { spaces: 0, .. } => CanalKind::Cavity,
        Changes { handles: 1.., .. } => CanalKind::Tunnel,
        Changes { spaces: 2.., .. } => CanalKind::Neck,
        Changes { bodies: 2.., .. } => CanalKind::Gap,
        _ => CanalKind::Pit,
    };
    let several = mouths.iter().flatten().any(|&mouth| mouth > 0);
    let way = match kind {
        CanalKind::Cavity => inner(part),
        CanalKind::Tunnel | CanalKind::Neck | CanalKind::Gap if several => through(part, &mouths),
        _ => passage(part, |n| part.mouth[n as usize], |n| depth.far[n as usize] >= farthest / 2.0),
    }?;
    let points = smooth(way.iter().map(|&n| part.voxels[n as usize].as_dvec3()).collect());
    let (position, clearance) = narrowest(&points, kind, distance, lattice);
    let length = match several || kind == CanalKind::Cavity {
        true => points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>() + 1.0,
        false => farthest + 1.0,
    };
    let widest = part.clearance.iter().copied().fold(0.0, f64::max);
    (kind != CanalKind::Pit || farthest > (DEEP * 2.0 * widest).max(LEAST_DEPTH)).then(|| Canal {
        number: 0,
        kind,
        diameter: 2.0 * clearance,
        length: length * lattice.h,
        position: position.to_array(),
        volume: part.voxels.len() as f64 * lattice.h.powi(3),
        handles: changes.handles,
    })
}

/// For each member that borders on the open the number of its mouth. Mouths that lie side by side and look the same way
/// are one: the surface of a ball, cut into voxels, may fall apart.
fn mouths(part: &FilledPart) -> Vec<Option<u32>> {
    let count = part.voxels.len();
    let mut sets = Union::new(count);
    let members: Vec<u32> = (0..count as u32).filter(|&n| part.mouth[n as usize]).collect();
    for &n in &members {
        part.beside(n).filter(|&m| part.mouth[m as usize]).for_each(|m| {
            sets.join(n, m);
        });
    }
    let mut patches: Vec<Patch> = Vec::new();
    let mut patch_of = vec![None; count];
    for &n in &members {
        let root = sets.root(n);
        let number = *patch_of[root as usize].get_or_insert_with(|| {
            patches.push(Patch::default());
            patches.len() as u32 - 1
        });
        patch_of[n as usize] = Some(number);
        patches[number as usize].add(part, n);
    }
    let mut one = Union::new(patches.len());
    for (a, first) in (0u32..).zip(&patches) {
        for (b, second) in (0u32..).zip(&patches[..a as usize]) {
            if first.is_beside(second) {
                one.join(a, b);
            }
        }
    }
    let mut last = 0;
    let numbers: Vec<u32> = (0..patches.len() as u32)
        .map(|n| {
            let fresh = one.root(n) == n;
            last += u32::from(fresh);
            last - 1
        })
        .collect();
    patch_of.iter().map(|patch| patch.map(|n| numbers[one.root(n) as usize])).collect()
}

/// Some voxels of a mouth.
#[derive(Default)]
struct Patch {
    sum: DVec3,
    count: f64,
    /// Towards the open, from the part's own voxels around.
    outwards: DVec3,
    width: f64,
}

impl Patch {
    fn add(&mut self, part: &FilledPart, n: u32) {
        let p = part.voxels[n as usize].as_dvec3();
        self.sum += p;
        self.count += 1.0;
        self.outwards += part.beside(n).map(|m| p - part.voxels[m as usize].as_dvec3()).sum::<DVec3>();
        self.width = self.width.max(2.0 * part.clearance[n as usize]);
    }

    fn is_beside(&self, other: &Self) -> bool {
        let apart = (self.sum / self.count).distance(other.sum / other.count);
        let ways = [self, other].map(|patch| patch.outwards.normalize_or_zero());
        apart < 2.0 * self.width.max(other.width).max(1.0) && ways[0].dot(ways[1]) > SAME_WAY
    }
}

/// The widest way between two mouths.
fn through(part: &FilledPart, mouths: &[Option<u32>]) -> Option<Vec<u32>> {
    // The members from the widest on, until two mouths hang together.
    let mut order: Vec<u32> = (0..part.voxels.len() as u32).collect();
    order.sort_by(|&a, &b| part.clearance[b as usize].total_cmp(&part.clearance[a as usize]));
    let mut sets = Union::new(order.len());
    let mut mouth = mouths.to_vec();
    let mut there = vec![false; order.len()];
    for n in order {
        there[n as usize] = true;
        for m in part.beside(n).filter(|&m| there[m as usize]) {
            let of = [n, m].map(|k| mouth[sets.root(k) as usize]);
            if let [Some(a), Some(b)] = of
                && a != b
            {
                let is = |of: u32| move |k: u32| mouths[k as usize] == Some(of);
                return passage(part, is(a), is(b));
            }
            sets.join(n, m);
            mouth[sets.root(n) as usize] = of[0].or(of[1]);
        }
    }
    None
}

/// The widest way from a member that `from` holds of to one that `to` holds of, wherever it can be wide kept to the middle.
fn passage(part: &FilledPart, from: impl Fn(u32) -> bool, to: impl Fn(u32) -> bool) -> Option<Vec<u32>> {
    let level = bottleneck(part, &from, &to)?;
    let found = shortest(part, from, |n| part.clearance[n as usize] >= level - BESIDE);
    let reached = |n: &u32| to(*n) && found.cost[*n as usize].is_finite();
    let cost = |n: &u32| found.cost[*n as usize];
    let end = (0..part.voxels.len() as u32).filter(reached).min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    Some(found.back_from(end))
}

/// The largest clearance that all members of some way have.
fn bottleneck(part: &FilledPart, from: impl Fn(u32) -> bool, to: impl Fn(u32) -> bool) -> Option<f64> {
    let clearance = |n: u32| part.clearance[n as usize];
    let mut best = vec![f64::NEG_INFINITY; part.voxels.len()];
    // Clearances are positive, so that their bits are in their order.
    let mut heap: BinaryHeap<(u64, Reverse<u32>)> = BinaryHeap::new();
    for n in (0..part.voxels.len() as u32).filter(|&n| from(n)) {
        best[n as usize] = clearance(n);
        heap.push((clearance(n).to_bits(), Reverse(n)));
    }
    while let Some((bits, Reverse(n))) = heap.pop() {
        let level = f64::from_bits(bits);
        if to(n) {
            return Some(level);
        }
        if level < best[n as usize] {
            continue;
        }
        for m in part.beside(n) {
            let next = level.min(clearance(m));
            if next > best[m as usize] {
                best[m as usize] = next;
                heap.push((next.to_bits(), Reverse(m)));
            }
        }
    }
    None
}

/// Ways from a set of members to all others.
struct Ways {
    /// Their cost: their length, where narrow places count more.
    cost: Vec<f64>,
    /// Their length, h.
    far: Vec<f64>,
    /// The member before each; itself at the beginning of a way.
    before: Vec<u32>,
}

impl Ways {
    /// The members from `end` back to where its way begins.
    fn back_from(&self, end: u32) -> Vec<u32> {
        let before = |&at: &u32| Some(self.before[at as usize]).filter(|&before| before != at);
        std::iter::successors(Some(end), before).collect()
    }
}

/// The cheapest ways over members that `allowed` holds of.
fn shortest(part: &FilledPart, from: impl Fn(u32) -> bool, allowed: impl Fn(u32) -> bool) -> Ways {
    let count = part.voxels.len();
    let widest = part.clearance.iter().copied().fold(0.0, f64::max);
    let mut ways =
        Ways { cost: vec![f64::INFINITY; count], far: vec![f64::INFINITY; count], before: (0..count as u32).collect() };
    let mut heap: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
    for n in (0..count as u32).filter(|&n| from(n) && allowed(n)) {
        (ways.cost[n as usize], ways.far[n as usize]) = (0.0, 0.0);
        heap.push(Reverse((0, n)));
    }
    while let Some(Reverse((bits, n))) = heap.pop() {
        if f64::from_bits(bits) > ways.cost[n as usize] {
            continue;
        }
        for m in part.beside(n).filter(|&m| allowed(m)) {
            let step = part.voxels[n as usize].as_dvec3().distance(part.voxels[m as usize].as_dvec3());
            let cost = ways.cost[n as usize] + step * (widest / part.clearance[m as usize]).powi(2);
            if cost < ways.cost[m as usize] {
                ways.cost[m as usize] = cost;
                ways.far[m as usize] = ways.far[n as usize] + step;
                ways.before[m as usize] = n;
                heap.push(Reverse((cost.to_bits(), m)));
            }
        }
    }
    ways
}

/// The longest of the way from the widest member to all others.
fn inner(part: &FilledPart) -> Option<Vec<u32>> {
    let count = part.voxels.len() as u32;
    let widest = (0..count).max_by(|&a, &b| part.clearance[a as usize].total_cmp(&part.clearance[b as usize]))?;
    let ways = shortest(part, |n| n == widest, |_| true);
    let end = (0..count).max_by(|&a, &b| ways.far[a as usize].total_cmp(&ways.far[b as usize]))?;
    Some(ways.back_from(end))
}

fn smooth(mut points: Vec<DVec3>) -> Vec<DVec3> {
    for _ in 0..ROUNDS {
        let before = points.clone();
        for (k, around) in before.windows(3).enumerate() {
            points[k + 1] = (around[0] + 2.0 * around[1] + around[2]) / 4.0;
        }
    }
    points
}

/// The point (model units) where the way (lattice coordinates) is narrowest, and its distance from the solid; of a cavity,
/// where it is widest.
fn narrowest(points: &[DVec3], kind: CanalKind, distance: &ExactDistance, lattice: &Lattice) -> (DVec3, f64) {
    let middle = |k: usize| {
        let along = (points[(k + 2).min(points.len() - 1)] - points[k.saturating_sub(2)]).normalize_or_zero();
        centred(lattice.to_model(points[k]), along, distance, lattice.h)
    };
    let all: Vec<(DVec3, f64)> = (0..points.len()).map(middle).collect();
    let extreme = all.iter().map(|at| at.1).fold(None, |best: Option<f64>, clearance| match (best, kind) {
        (None, _) => Some(clearance),
        (Some(best), CanalKind::Cavity) => Some(best.max(clearance)),
        (Some(best), _) => Some(best.min(clearance)),
    });
    let Some(extreme) = extreme else { return (DVec3::ZERO, 0.0) };
    // Of a canal as wide everywhere, the middle.
    let alike = |&k: &usize| (all[k].1 - extreme).abs() < ALIKE * lattice.h;
    let middle = (0..all.len()).filter(alike).min_by_key(|&k| (2 * k + 1).abs_diff(all.len()));
    (middle.map_or(DVec3::ZERO, |k| all[k].0), extreme)
}

/// From `start` across the way to where the solid is farthest; both in model units.
fn centred(start: DVec3, along: DVec3, distance: &ExactDistance, h: f64) -> (DVec3, f64) {
    let clearance = |p: DVec3| distance.at(p).map_or(0.0, |nearest| nearest.signed);
    let (u, v) = match along == DVec3::ZERO {
        true => (DVec3::X, DVec3::Y),
        false => along.any_orthonormal_pair(),
    };
    let ways = [u, -u, v, -v, u + v, u - v, v - u, -u - v];
    let mut best = (start, clearance(start));
    let mut step = h / 2.0;
    while step > FINEST * h {
        let tries = ways.map(|way| best.0 + way * step);
        let near = tries.into_iter().filter(|p| p.distance(start) <= ASIDE * h);
        let next = near.map(|p| (p, clearance(p))).max_by(|a, b| a.1.total_cmp(&b.1));
        match next.filter(|next| next.1 > best.1) {
            Some(next) => best = next,
            None => step /= 2.0,
        }
    }
    best
}
