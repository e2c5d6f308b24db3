//! What an extracted surface has of each sheet, triangulated with no more points than it needs.
//!
//! Much of what was cut borders on nothing any more once the pieces inside of the solid are gone. A point in the middle of a flat region,
//! or of a straight crease, says nothing; but each such point would be rounded, and with many points close to each other rounding goes wrong.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::extract::Face;
use super::facets::Cover;
use super::layout::Layout;
use super::planar::Planar;
use super::plane::Plane;
use super::refine::Refined;
use crate::mesh::edges::{Edges, Union};
use crate::progress::{Progress, Stopped};

/// What makes faces one region: a facet that stands for the cut ones around it in its plane, the side that the solid lies on, and a number that
/// keeps apart what looks different.
type Region = (u32, bool, u32);

/// A border of a region from a needed point to the next, with the region on its left as seen from outside.
type Border = (Region, [u32; 2], Cover);

/// The same surface with no more points than it needs. `class`: triangles of the input with different numbers are not merged.
pub(crate) fn merge(
    refined: &Refined,
    faces: Vec<Face>,
    class: &(impl Fn(u32) -> u32 + Sync),
    progress: &Progress,
) -> Result<Vec<Face>, Stopped> {
    let corners: Vec<[u32; 3]> = faces.iter().map(|face| face.corners).collect();
    let planes = Planes::of(refined, &faces, &corners);
    let region: Vec<Region> =
        faces.iter().map(|face| (planes.first(face), planes.over(refined, face), class(face.cover.triangle))).collect();
    let creases = creases(refined, &corners, &region);
    let is_whole = |face: &Face| refined.is_whole(face.facet);
    // The border half-edges of cut sheets, by where they start. A region that lies on both sides of an edge has two of them at each point.
    let mut next: FxHashMap<(Region, u32), [u32; 2]> = FxHashMap::default();
    let mut starts: Vec<(Region, [u32; 2], Cover)> = Vec::new();
    for (n, face) in faces.iter().enumerate().filter(|(_, face)| !is_whole(face)) {
        for k in 0..3 {
            let [u, v] = [face.corners[k], face.corners[(k + 1) % 3]];
            if !creases.edges.contains(&[u.min(v), u.max(v)]) {
                continue;
            }
            match creases.straight.contains(&u) {
                true => next.entry((region[n], u)).or_insert([v; 2])[1] = v,
                false => starts.push((region[n], [u, v], face.cover)),
            }
        }
    }
    let mut borders: Vec<Border> = starts
        .into_iter()
        .map(|(region, [u, mut v], cover)| {
            let mut from = u;
            while let Some(&on) = next.get(&(region, v)).and_then(|ends| ends.iter().find(|&&end| end != from)) {
                (from, v) = (v, on);
            }
            (region, [u, v], cover)
        })
        .collect();
    borders.par_sort_unstable();
    let sheets: Vec<&[Border]> = borders.chunk_by(|a, b| a.0.0 == b.0.0).collect();
    let contacts = contacts(&faces, &region, &creases, &is_whole);
    let merged: Vec<Vec<Face>> = sheets
        .par_iter()
        .map(|borders| progress.check().map(|()| triangulated(refined, &planes, borders, &contacts)))
        .collect::<Result<_, _>>()?;
    // In the order of the facets: what stands for several is where the first of them is.
    let mut of_sheet: FxHashMap<u32, usize> =
        sheets.iter().enumerate().map(|(n, borders)| (borders[0].0.0, n)).collect();
    let mut result = Vec::new();
    for same in faces.chunk_by(|a, b| a.facet == b.facet) {
        match is_whole(&same[0]) {
            true => result.extend_from_slice(same),
            false => {
                let sheet = of_sheet.remove(&planes.first(&same[0]));
                sheet.into_iter().for_each(|n| result.extend_from_slice(&merged[n]));
            }
        }
    }
    Ok(result)
}

/// Which cut facets lie in one plane with neighbours, so that the edges between them say nothing either.
struct Planes {
    /// For each facet the one that stands for it: itself where it is alone.
    first: Vec<u32>,
    /// Whether it stands for others besides itself.
    several: Vec<bool>,
}

impl Planes {
    fn of(refined: &Refined, faces: &[Face], corners: &[[u32; 3]]) -> Self {
        let facets = &refined.facets;
        let mut union = Union::new(facets.len());
        let is_one = |a: &Face, b: &Face| {
            let (p, q) = (facets.plane(a.facet), facets.plane(b.facet));
            let on_one_side = (a.over == b.over) == p.faces_as(&q);
            on_one_side && facets.places(b.facet).iter().all(|&at| p.value(at) == 0)
        };
        Edges::new(corners, refined.points.len()).each(|edge| {
            let mut beside = edge.halves().map(|half| &faces[half as usize / 3]);
            let (Some(a), Some(b), None) = (beside.next(), beside.next(), beside.next()) else { return };
            let cut = |face: &Face| !refined.is_whole(face.facet);
            if a.facet != b.facet && cut(a) && cut(b) && is_one(a, b) {
                union.join(a.facet, b.facet);
            }
        });
        let first: Vec<u32> = (0..facets.len() as u32).map(|f| union.root(f)).collect();
        let mut several = vec![false; first.len()];
        (0..).zip(&first).filter(|&(f, &first)| f != first).for_each(|(_, &first)| several[first as usize] = true);
        Self { first, several }
    }

    /// The facet that stands for that of a face.
    fn first(&self, face: &Face) -> u32 {
        self.first[face.facet as usize]
    }

    /// Whether the solid lies in front of the facet that stands for that of a face.
    fn over(&self, refined: &Refined, face: &Face) -> bool {
        let first = self.first(face);
        let plane = |facet: u32| refined.facets.plane(facet);
        face.over == (first == face.facet || plane(first).faces_as(&plane(face.facet)))
    }
}

/// The points within regions at which others touch them, each with its facet, ascending.
fn contacts(
    faces: &[Face],
    region: &[Region],
    creases: &Creases,
    is_whole: &impl Fn(&Face) -> bool,
) -> Vec<(u32, u32)> {
    // Points by the regions that have them; whether the region may be cut anew, and whether its border passes the point.
    let mut uses: Vec<(u32, Region, bool, bool)> = Vec::new();
    for (face, &region) in faces.iter().zip(region) {
        let [a, b, c] = face.corners;
        let is_border = |a: u32, b: u32| creases.edges.contains(&[a.min(b), a.max(b)]);
        let borders = [[a, b], [b, c], [c, a]].map(|[a, b]| is_border(a, b));
        let whole = is_whole(face);
        uses.extend((0..3).map(|k| (face.corners[k], region, !whole, borders[k] || borders[(k + 2) % 3])));
    }
    uses.par_sort_unstable();
    let mut found = Vec::new();
    for same in uses.chunk_by(|a, b| a.0 == b.0).filter(|same| same[0].1 != same[same.len() - 1].1) {
        let regions = same.chunk_by(|a, b| a.1 == b.1);
        let within = regions.filter(|uses| uses.iter().all(|&(_, _, anew, border)| anew && !border));
        found.extend(within.map(|uses| (uses[0].1.0, uses[0].0)));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// The edges between regions, and the points in the middle of straight ones.
struct Creases {
    edges: FxHashSet<[u32; 2]>,
    straight: FxHashSet<u32>,
}

fn creases(refined: &Refined, corners: &[[u32; 3]], region: &[Region]) -> Creases {
    let edges = Edges::new(corners, refined.points.len());
    let mut found = Creases { edges: FxHashSet::default(), straight: FxHashSet::default() };
    // For each point the edges that end at it, with the regions beside them.
    let mut at: Vec<(u32, u32, u32)> = Vec::new();
    let mut beside: Vec<Vec<(Region, bool)>> = Vec::new();
    edges.each(|edge| {
        let mut sides: Vec<(Region, bool)> =
            edge.halves().map(|half| (region[half as usize / 3], edges.runs_up(half))).collect();
        if sides.len() == 2 && sides[0].0 == sides[1].0 {
            return;
        }
        // Uncut facets have no points to spare.
        if edge.halves().all(|half| refined.is_whole(region[half as usize / 3].0)) {
            return;
        }
        found.edges.insert(edge.ends);
        sides.sort_unstable();
        let number = beside.len() as u32;
        beside.push(sides);
        at.extend([(edge.ends[0], edge.ends[1], number), (edge.ends[1], edge.ends[0], number)]);
    });
    at.par_sort_unstable();
    for same in at.chunk_by(|a, b| a.0 == b.0) {
        let &[(p, a, first), (_, b, second)] = same else { continue };
        // Up along one edge and down along the other, or the other way round: an edge runs up if its other end has the higher number.
        let turned = (a > p) == (b > p);
        let (one, two) = (&beside[first as usize], &beside[second as usize]);
        let alike = one.len() == two.len() && two.iter().all(|&(r, up)| one.contains(&(r, up != turned)));
        if alike && refined.points.are_in_line(a, p, b) {
            found.straight.insert(p);
        }
    }
    found
}

/// The regions of one sheet between their borders, and with the points at which others touch them.
fn triangulated(refined: &Refined, planes: &Planes, borders: &[Border], contacts: &[(u32, u32)]) -> Vec<Face> {
    let facet = borders[0].0.0;
    let plane: Plane = refined.facets.plane(facet);
    let touched = contacts.partition_point(|contact| contact.0 < facet);
    let touched = contacts[touched..].iter().take_while(|contact| contact.0 == facet).map(|contact| contact.1);
    let numbers = borders.iter().flat_map(|border| border.1).chain(touched).collect();
    let is_alone = refined.is_single(facet) && !planes.several[facet as usize];
    let alone = is_alone.then(|| refined.facets.corners[facet as usize]);
    let layout = Layout::new(&refined.points, numbers, &plane, alone);
    let mut planar = layout.planar();
    // What lies left of an edge, as the facet is seen: regions over it run the other way round.
    let mut left: FxHashMap<[u32; 2], (Region, Cover)> = FxHashMap::default();
    for &(region, [u, v], cover) in borders {
        left.insert(layout.local_edge(if region.1 { [v, u] } else { [u, v] }), (region, cover));
    }
    let mut edges: Vec<[u32; 2]> = left.keys().map(|&[u, v]| [u.min(v), u.max(v)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges.iter().zip(0..).for_each(|(&[u, v], n)| planar.fix(u, v, n));
    planar.relax();
    let inside = regions(&planar, &left);
    let face = |(corners, found): (&[u32; 3], &Option<(Region, Cover)>)| {
        let ((_, over, _), cover) = (*found)?;
        let [a, b, c] = layout.named(*corners);
        Some(Face { corners: if over { [a, c, b] } else { [a, b, c] }, facet, over, cover })
    };
    planar.triangles.iter().zip(&inside).filter_map(face).collect()
}

/// The region that each triangle lies in.
fn regions(planar: &Planar<'_>, left: &FxHashMap<[u32; 2], (Region, Cover)>) -> Vec<Option<(Region, Cover)>> {
    let mut found: Vec<Option<(Region, Cover)>> = vec![None; planar.triangles.len()];
    let mut seen = vec![false; planar.triangles.len()];
    for start in 0..planar.triangles.len() as u32 {
        if seen[start as usize] {
            continue;
        }
        // All triangles between the same fixed edges.
        let mut members = vec![start];
        seen[start as usize] = true;
        let mut region = None;
        let mut at = 0;
        while let Some(&t) = members.get(at) {
            at += 1;
            let corners = planar.triangles[t as usize];
            for k in 0..3 {
                match (planar.fixed(t, k), planar.across(t, k)) {
                    (Some(_), _) => region = region.or(left.get(&[corners[k], corners[(k + 1) % 3]]).copied()),
                    (None, Some(other)) if !std::mem::replace(&mut seen[other as usize], true) => members.push(other),
                    _ => {}
                }
            }
        }
        members.iter().for_each(|&t| found[t as usize] = region);
    }
    found
}
