//! A surface of which some triangles cross, united with itself.
//!
//! Few triangles cross after rounding, and all others stay what they are. So only those that may cross, those that they touch, and a ring of
//! their neighbours are arranged again: the ring says which side is outside.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::cells::{Cells, Owner, Ring, gaps};
use super::draft::{Draft, Kind, Rounding};
use super::extract::extract;
use super::facets::Facets;
use super::merge::merge;
use super::near::Near;
use super::refine::refine;
use super::surface::Surface;
use crate::mesh::edges::Edges;
use crate::mesh::{TriMesh, intersections_with, self_intersections};
use crate::progress::{Progress, Stopped};

/// All triangles are of one operand, as they are.
struct One;

impl Owner for One {
    fn operand(&self, _: u32) -> u32 {
        0
    }

    fn is_turned(&self, _: u32) -> bool {
        false
    }
}

/// The union of a draft with itself, of which only fresh triangles cross others; `None` where it has none.
pub(super) fn united(
    draft: &Draft,
    reach: f64,
    surface: &Surface<'_>,
    progress: &Progress,
) -> Result<Option<Draft>, Stopped> {
    if draft.fresh.contains(&false) {
        let part = Part::of(draft, progress)?;
        if let Some(mended) = arranged(&part.draft, &part.ring, reach, surface, progress)? {
            return Ok(Some(part.joined(draft, mended)));
        }
    }
    let whole = arranged(draft, &[], reach, surface, progress)?;
    Ok(whole.map(|(mut whole, parents)| {
        whole.sources = parents.iter().map(|&t| draft.sources[t as usize]).collect();
        surface.mark(&mut whole);
        whole
    }))
}

/// A part of a draft with all that its fresh triangles touch.
struct Part {
    draft: Draft,
    /// For each of its triangles the number in the whole.
    numbers: Vec<u32>,
    /// For each of its triangles whether it is of the ring around.
    ring: Vec<bool>,
    /// For each triangle of the whole whether the part takes its place; those among them that have no area vanish.
    replaced: Vec<bool>,
}

impl Part {
    fn of(whole: &Draft, progress: &Progress) -> Result<Self, Stopped> {
        let (facets, numbers) = Facets::new(&whole.places, &whole.triangles);
        let fresh = with_flat(whole, &facets, &numbers);
        let is_fresh = |f: u32| facets.covers(f).iter().any(|cover| fresh[cover.triangle as usize]);
        let mut core: Vec<bool> = (0..facets.len() as u32).map(is_fresh).collect();
        for pair in intersections_with(&lattice_mesh(&facets), &core, progress)? {
            pair.iter().for_each(|&f| core[f as usize] = true);
        }
        let edges = |f: usize| {
            let [a, b, c] = facets.corners[f];
            [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
        };
        let border: FxHashSet<[u32; 2]> = (0..facets.len()).filter(|&f| core[f]).flat_map(edges).collect();
        let mut part = Self { draft: Draft::default(), numbers: Vec::new(), ring: Vec::new(), replaced: fresh };
        let mut taken: Vec<(u32, bool)> = Vec::new();
        for (f, &is_core) in core.iter().enumerate() {
            if is_core || edges(f).iter().any(|edge| border.contains(edge)) {
                taken.extend(facets.covers(f as u32).iter().map(|cover| (cover.triangle, !is_core)));
            }
        }
        taken.sort_unstable();
        let mut vertices: FxHashMap<u32, u32> = FxHashMap::default();
        for (t, ring) in taken {
            let corners = whole.triangles[t as usize].map(|v| {
                let new = || part.draft.add(whole.places[v as usize], whole.kinds[v as usize]);
                *vertices.entry(v).or_insert_with(new)
            });
            part.draft.push(corners, whole.sources[t as usize], false);
            part.numbers.push(t);
            part.ring.push(ring);
            part.replaced[t as usize] = true;
        }
        Ok(part)
    }

    /// The whole with this part mended: each of its triangles with one of the part that it lies on.
    fn joined(&self, whole: &Draft, (mended, parents): (Draft, Vec<u32>)) -> Draft {
        let corners =
            |draft: &Draft, t: usize| draft.triangles[t].map(|v| (draft.places[v as usize], draft.kinds[v as usize]));
        // Each triangle with the one of the whole that it lies on, so that order is kept.
        let rest = (0..whole.triangles.len()).filter(|&t| !self.replaced[t]);
        let mut list: Vec<_> = rest.map(|t| (t as u32, false, corners(whole, t))).collect();
        list.extend(
            parents
                .iter()
                .enumerate()
                .map(|(t, &parent)| (self.numbers[parent as usize], !self.ring[parent as usize], corners(&mended, t))),
        );
        list.sort_by_key(|&(t, ..)| t);
        let mut joined = Draft::default();
        let mut at: FxHashMap<[i32; 3], u32> = FxHashMap::default();
        for (t, fresh, corners) in list {
            let corners = corners.map(|(place, kind)| *at.entry(place).or_insert_with(|| joined.add(place, kind)));
            joined.push(corners, whole.sources[t as usize], fresh);
        }
        joined
    }
}

/// Which triangles are fresh, with those around others that have no area on the lattice, though they have one where the result has their vertices.
fn with_flat(draft: &Draft, facets: &Facets, numbers: &[u32]) -> Vec<bool> {
    let mut fresh = draft.fresh.clone();
    let mut is_flat = vec![true; draft.triangles.len()];
    let covers = (0..facets.len() as u32).flat_map(|f| facets.covers(f));
    covers.for_each(|cover| is_flat[cover.triangle as usize] = false);
    let flat = (0..fresh.len()).filter(|&t| is_flat[t] && !draft.fresh[t]);
    let at: FxHashSet<u32> = flat.flat_map(|t| draft.triangles[t].map(|v| numbers[v as usize])).collect();
    if !at.is_empty() {
        let beside = |corners: &[u32; 3]| corners.iter().any(|&v| at.contains(&numbers[v as usize]));
        fresh.iter_mut().zip(&draft.triangles).for_each(|(fresh, corners)| *fresh |= beside(corners));
    }
    fresh
}

/// A draft united with itself, and for each triangle the one of the draft that it lies on. `ring`: what is known of its triangles, or nothing.
fn arranged(
    draft: &Draft,
    ring: &[bool],
    reach: f64,
    surface: &Surface<'_>,
    progress: &Progress,
) -> Result<Option<(Draft, Vec<u32>)>, Stopped> {
    let (facets, numbers) = Facets::new(&draft.places, &draft.triangles);
    let mut kinds = vec![Kind::Moved; facets.vertices.len()];
    for (&n, &kind) in numbers.iter().zip(&draft.kinds) {
        if kind != Kind::Moved && !matches!(kinds[n as usize], Kind::Own(_)) {
            kinds[n as usize] = kind;
        }
    }
    let mut pairs = touching(&facets, |_| true, progress)?;
    if !ring.is_empty() {
        let is_ring = |&f: &u32| ring[facets.covers(f)[0].triangle as usize];
        pairs.retain(|pair| !pair.iter().any(is_ring));
    }
    let mut touched: Vec<u32> = pairs.iter().flatten().copied().collect();
    touched.sort_unstable();
    touched.dedup();
    let near = Near::new(&facets, &touched, surface.fine, reach);
    let refined = refine(facets, &pairs, progress)?;
    let corners = refined.corners();
    let edges = Edges::new(&corners, refined.points.len());
    let ring = Ring { triangles: ring };
    if !gaps(&refined, &edges, &One, &ring).is_empty() {
        return Ok(None);
    }
    let cells = Cells::of(&refined, &edges, &ring, progress)?;
    let Some(winding) = cells.winding(&refined, 1, &One) else { return Ok(None) };
    let inside: Vec<bool> = winding.iter().map(|&winding| winding >= 1).collect();
    let class = |t: u32| surface.options.classes.get(draft.sources[t as usize] as usize).copied().unwrap_or(0);
    let faces = merge(&refined, extract(&refined, &cells, &inside), &class, progress)?;
    let rounding =
        Rounding { fine: surface.fine, kinds: &kinds, input: surface.input, near: Some(&near), exact: false };
    let mut next = Draft::new(&refined, &faces, &rounding, |t| t);
    let parents = std::mem::take(&mut next.sources);
    Ok(Some((next, parents)))
}

/// Facets as a mesh on the lattice.
fn lattice_mesh(facets: &Facets) -> TriMesh {
    let positions = facets.vertices.iter().map(|v| DVec3::from_array(v.map(f64::from))).collect();
    TriMesh { positions, triangles: facets.corners.clone() }
}

/// The pairs of facets that touch elsewhere than at what they share, among those that may.
pub(crate) fn touching(
    facets: &Facets,
    may_touch: impl Fn(u32) -> bool,
    progress: &Progress,
) -> Result<Vec<[u32; 2]>, Stopped> {
    let list: Vec<u32> = (0..facets.len() as u32).filter(|&f| may_touch(f)).collect();
    let positions = facets.vertices.iter().map(|v| DVec3::from_array(v.map(f64::from))).collect();
    let triangles = list.iter().map(|&f| facets.corners[f as usize]).collect();
    let pairs = self_intersections(&TriMesh { positions, triangles }, progress)?;
    Ok(pairs.into_iter().map(|pair| pair.map(|n| list[n as usize])).collect())
}
