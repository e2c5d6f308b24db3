//! What can be wrong after vertices have been merged, seen from one vertex or one triangle.

use glam::DVec3;

use super::merging::Merging;

/// Most triangles around a vertex; a merged voxel that would have more is split.
const MOST: usize = 48;

/// Cosine of the angle between the normals of neighbours from which they count as folded (154°).
const FOLDED: f64 = -0.9;

/// Sine of the smallest angle that a triangle may get if it had a larger one before (1.1°).
const THIN: f64 = 0.02;

/// Something is wrong.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fault {
    /// The group that should be split.
    pub group: u32,
}

/// What is wrong around `vertex`, which stands for itself: its triangles must be one fan around
/// different vertices, at least three, and no two neighbours folded. As all vertices are looked at,
/// the mesh is a closed manifold when none is at fault.
pub(super) fn star_fault(merging: &Merging<'_>, vertex: &u32) -> Option<Fault> {
    let mut arcs = [(0, 0); MOST];
    let mut count = 0;
    let mut any_merged = merging.merged_group(*vertex).is_some();
    for arc in merging.star(vertex) {
        if count == MOST {
            return blame(merging, *vertex, arcs.iter().map(|a| a.0));
        }
        any_merged |= merging.merged_group(arc.0).is_some();
        arcs[count] = arc;
        count += 1;
    }
    if !any_merged {
        return None;
    }
    let arcs = &mut arcs[..count];
    // bring the arcs into the order of the fan
    for k in 1..count {
        match arcs[k..].iter().position(|a| a.0 == arcs[k - 1].1) {
            Some(next) => arcs.swap(k, k + next),
            None => return blame(merging, *vertex, arcs.iter().map(|a| a.0)),
        }
    }
    let repeated = |k: usize| arcs[..k].iter().any(|a| a.0 == arcs[k].0);
    if count < 3 || arcs[count - 1].1 != arcs[0].0 {
        return blame(merging, *vertex, arcs.iter().map(|a| a.0));
    }
    if (1..count).any(repeated) {
        // the vertex at the other end of a doubled edge sees it too: both blame the same group
        let doubled = (1..count).filter(|&k| repeated(k)).map(|k| arcs[k].0);
        let group = doubled.chain([*vertex]).filter_map(|v| merging.merged_group(v)).max();
        return group.map(|group| Fault { group });
    }
    let at = |v: u32| merging.at[v as usize];
    let centre = at(*vertex);
    let normal = |k: usize| (at(arcs[k].0) - centre).cross(at(arcs[k].1) - centre);
    let mut before = normal(count - 1);
    for k in 0..count {
        let after = normal(k);
        let cosine = before.dot(after);
        if cosine < 0.0 && cosine * cosine > FOLDED * FOLDED * before.length_squared() * after.length_squared() {
            let others = [arcs[k].0, arcs[k].1, arcs[(k + count - 1) % count].0];
            if let Some(fault) = blame(merging, *vertex, others.into_iter()) {
                return Some(fault);
            }
        }
        before = after;
    }
    None
}

/// Blames the group of `vertex`, or else the last of the groups of its neighbours.
fn blame(merging: &Merging<'_>, vertex: u32, neighbours: impl Iterator<Item = u32>) -> Option<Fault> {
    let own = merging.merged_group(vertex);
    own.or_else(|| neighbours.filter_map(|v| merging.merged_group(v)).max()).map(|group| Fault { group })
}

/// What is wrong with raw triangle `id`, whose corners are `now`: it must not be degenerate or thin
/// when it was not before, and must not have turned by 90°.
pub(super) fn triangle_fault(merging: &Merging<'_>, id: u32, now: [u32; 3]) -> Option<Fault> {
    let group = now.iter().filter_map(|&v| merging.merged_group(v)).max()?;
    let (before, then) = shape(merging.raw_corners(id));
    let (after, thin) = shape(now.map(|v| merging.at[v as usize]));
    let bad = after.dot(before) <= 0.0 || thin < THIN.min(then);
    bad.then_some(Fault { group })
}

/// Twice the area as a vector, and the sine of the smallest angle.
fn shape([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let mut sides = [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()];
    sides.sort_by(f64::total_cmp);
    (normal, normal.length() / (sides[1] * sides[2]).sqrt())
}
