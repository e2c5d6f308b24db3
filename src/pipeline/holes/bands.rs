//! Rims that face each other, and the bands that join them: what no lid closes each by itself, as where a ring is missing or a wall has lost its end.

use super::Plan;
use super::judge::MOST as CLEAR;
use super::maker::{Made, Maker};
use crate::fill::{Lid, Rim, band};
use crate::mesh::TriMesh;
use crate::pipeline::{LidShape, NotLidded};
use crate::progress::{Progress, Stopped};

/// At most so many rims without lids are compared with each other.
const MOST: usize = 64;

/// So many vertices of a rim are looked at to tell how far another one is from it.
const SAMPLED: usize = 256;

/// The longer of two rims that face each other is at most so many times as long as the other.
const UNLIKE: f64 = 3.0;

/// The gap between them is at most so long as this part of the shorter one; about as wide as what they are the rims of.
const GAP: f64 = 0.35;

/// The rim of an inner side lies at most so much of the gap behind or before that of an outer one, across the plane of the first.
const BEHIND: f64 = 0.5;

/// Two rims that a band joins, and its triangles over the edges of each.
pub(super) struct Band {
    pub rims: [usize; 2],
    pub lids: [Lid; 2],
}

impl Band {
    /// What closes each of the two rims.
    pub(super) fn made(self) -> [(usize, Made); 2] {
        let [first, second] = self.lids.map(|lid| Made { lid, shape: LidShape::Band });
        [(self.rims[0], first), (self.rims[1], second)]
    }
}

/// The bands between rims that have no lids, or doubtful ones: those that are nearest to each other for their length first, each with one other.
pub(super) fn bands(plan: &Plan, maker: &Maker<'_>, progress: &Progress) -> Result<Vec<Band>, Stopped> {
    let rims = &plan.rims;
    let mut pairs = facing(plan, maker.around.mesh());
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut taken = vec![false; rims.len()];
    let mut found = Vec::new();
    for (gap, pair) in pairs {
        progress.check()?;
        let both = pair.map(|n| &rims[n]);
        if pair.iter().any(|&n| taken[n]) {
            continue;
        }
        let Ok(lids) = band(maker.around, both) else { continue };
        let gap = gap * both[0].perimeter.min(both[1].perimeter);
        if maker.judge.band(both, &lids, gap, progress)? > CLEAR {
            pair.iter().for_each(|&n| taken[n] = true);
            found.push(Band { rims: pair, lids });
        }
    }
    Ok(found)
}

/// Pairs of rims without lids, or with doubtful ones, that are near to each other all along, with the gap between them as a part of the shorter one's length.
fn facing(plan: &Plan, mesh: &TriMesh) -> Vec<(f64, [usize; 2])> {
    let Plan { rims, lids, parting, .. } = plan;
    let alone = |n: &usize| match &lids[*n] {
        Ok(_) => parting[*n] <= CLEAR,
        Err(why) => {
            use NotLidded::{Beside, FacesInwards, Meets, NoHole, Sheet};
            matches!(why, NoHole | FacesInwards | Beside | Sheet | Meets)
        }
    };
    // What has no lid for the sake of another part has none to be joined with for its own.
    let for_others = |n: usize| matches!(lids[n], Err(NotLidded::Beside));
    let is_inner = |n: usize| matches!(lids[n], Err(NotLidded::FacesInwards));
    let list: Vec<usize> = (0..rims.len()).filter(alone).take(MOST).collect();
    let mut pairs = Vec::new();
    for (k, &n) in list.iter().enumerate() {
        for &m in &list[k + 1..] {
            let [a, b] = [&rims[n], &rims[m]];
            let (short, long) = (a.perimeter.min(b.perimeter), a.perimeter.max(b.perimeter));
            let apart = a.centre.distance(b.centre) > (a.diameter + b.diameter) / 2.0 + GAP * short;
            if apart || long > UNLIKE * short || (for_others(n) && for_others(m)) {
                continue;
            }
            let gap = between(mesh, a, b).max(between(mesh, b, a));
            // The ends of a wall lie beside each other; holes in both of its sides, which a band would make a bore of, lie behind each other.
            let behind = (b.centre - a.centre).dot(a.plane.normal).abs();
            if gap > GAP * short || (is_inner(n) || is_inner(m)) && behind > BEHIND * gap {
                continue;
            }
            pairs.push((gap / short, [n, m]));
        }
    }
    pairs
}

/// The mean distance from vertices of a rim to the nearest one of another, model units.
fn between(mesh: &TriMesh, from: &Rim, to: &Rim) -> f64 {
    let some = |rim: &Rim| -> Vec<_> {
        let every = rim.vertices.len().div_ceil(SAMPLED);
        rim.vertices.iter().step_by(every).map(|&v| mesh.positions[v as usize]).collect()
    };
    let (from, to) = (some(from), some(to));
    let nearest = |p: &glam::DVec3| to.iter().map(|q| p.distance_squared(*q)).fold(f64::INFINITY, f64::min).sqrt();
    from.iter().map(nearest).sum::<f64>() / from.len() as f64
}
