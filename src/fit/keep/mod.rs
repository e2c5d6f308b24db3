//! Source triangles that bound the solid as they are stay as they are.
//!
//! A repair should change what is broken and nothing else. Where the rays say that a patch of source
//! triangles bounds the solid and no triangle meets it, the surface is that patch, and the contour is only needed
//! in between: over holes, where triangles meet, and where rays say nothing.
//! The contour is cut along the border of the patches, the part over them is thrown away, and the two are
//! joined at the vertices that both then have. Where the two do not fit, triangles near that place
//! are let go and it is tried again, at worst until none is kept.

mod border;
mod choose;
mod rings;
mod stitch;

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::cut::Cut;
use super::facets::Facets;
use super::surface::{Surface, shape};
use super::{mend, safeguard};
use crate::mesh::{HalfEdges, Shape};
use crate::progress::{Progress, Stopped};
use border::Border;
pub use choose::{Kept, Seams};
use stitch::{Joined, Misfit, joined};

/// Times that triangles are let go. Real meshes take up to 20.
const MOST_ROUNDS: usize = 48;

/// How far from a place that does not fit triangles are let go, h, at first, and how much more each time that there was
/// trouble within [`SAME_PLACE`] before; after [`PATIENCE`] times, or rounds, it is twice as far each time. More everywhere would make new borders,
/// and with them new trouble. Never is more of a patch let go than what is near: a few triangles that meet say nothing of the rest.
const REACH: f64 = 1.0;
const REACH_GROWS: f64 = 0.5;
const SAME_PLACE: f64 = 3.0;
const PATIENCE: (usize, usize) = (6, 36);

/// Triangles nearer than this, h, to a place where others meet are let go at once: the crease there wants room. In the
/// union of fandisk with itself, turned, 97.5 % of the edges come out without, 99 % with.
const CLEARANCE: f64 = 1.5;

/// The surface with source triangles in place of the contour wherever that can be, and the number of them. `initial`
/// must be valid; `kept` are those that bound the solid by the word of the rays.
pub(super) fn keep(
    initial: &Surface,
    facets: &Facets<'_>,
    kept: &Kept,
    h: f64,
    progress: &Progress,
) -> Result<(Surface, usize), Stopped> {
    let mut kept = kept.clone();
    near(&kept, &meeting_places(initial, &kept), CLEARANCE * h).into_iter().for_each(|t| kept.is[t as usize] = false);
    let mut trouble = Trouble::default();
    for _ in 0..MOST_ROUNDS {
        progress.check()?;
        kept.tidy();
        if !kept.is.contains(&true) {
            break;
        }
        let border = Border::new(&kept);
        if border.segments.iter().any(|s| facets.is_beyond(kept.mesh.positions[s.from as usize])) {
            // The contour has nothing to put there.
            break;
        }
        let misfit = match joined(initial, facets, &kept, &border, h) {
            Ok(joined) => match mended(joined, facets, h, progress)? {
                Ok(surface) => return Ok((surface, kept.facets().len())),
                Err(points) => Misfit { points, ..Misfit::default() },
            },
            Err(misfit) => misfit,
        };
        let mut gone = misfit.unseen;
        let near = trouble.near(&kept, &misfit.points, h);
        gone.sort_unstable();
        near.iter().for_each(|&t| kept.is[t as usize] = false);
        for t in 0..kept.is.len() {
            kept.is[t] &= gone.binary_search(&border.component[t]).is_err();
        }
        if gone.is_empty() && near.is_empty() {
            // Nothing would be different the next time.
            break;
        }
    }
    Ok((initial.clone(), 0))
}

/// Where the contour goes over from one to another of triangles that meet.
fn meeting_places(initial: &Surface, kept: &Kept) -> Vec<DVec3> {
    let meets = |v: u32| {
        let facets = initial.sides[v as usize].iter().map(|s| s.facet().index());
        facets.filter(|&t| kept.meets.get(t) == Some(&true)).collect::<Vec<_>>()
    };
    let apart = |a: usize, b: usize| {
        let (a, b) = (kept.mesh.triangles[a], kept.mesh.triangles[b]);
        a.iter().all(|v| !b.contains(v))
    };
    let crossing = initial.edges().filter(|&[a, b]| {
        let (a, b) = (meets(a), meets(b));
        !a.is_empty() && a.iter().all(|&p| b.iter().any(|&q| apart(p, q)))
    });
    crossing.map(|[a, b]| (initial.at(a) + initial.at(b)) / 2.0).collect()
}

/// Mends the triangles that end on the border. Returns the surface, or points near which it meets itself, is misshapen,
/// or is no manifold.
fn mended(
    joined: Joined,
    facets: &Facets<'_>,
    h: f64,
    progress: &Progress,
) -> Result<Result<Surface, Vec<DVec3>>, Stopped> {
    let Joined { surface, first, seam } = joined;
    if let Err(wrong) = HalfEdges::new(&surface.mesh.triangles, surface.mesh.positions.len()) {
        return Ok(Err(wrong.edge.iter().map(|&v| surface.at(v)).collect()));
    }
    let mut cut = Cut::of(&surface);
    let changed: Vec<u32> = seam.iter().map(|s| s.0).collect();
    let touched = mend::mend(&mut cut, facets, h, &changed);
    let is_changed = |t: &u32| {
        let origin = cut.origin[*t as usize];
        origin >= first && (seam.binary_search_by_key(&origin, |s| s.0).is_ok() || touched.binary_search(t).is_ok())
    };
    let before = |t: u32| {
        let origin = cut.origin[t as usize];
        let known = seam.binary_search_by_key(&origin, |s| s.0).map(|k| seam[k].1);
        known.unwrap_or_else(|_| shape(surface.mesh.corners(origin as usize)).0)
    };
    let others: Vec<u32> = (0..cut.origin.len() as u32).filter(|&t| cut.origin[t as usize] >= first).collect();
    let changed: Vec<u32> = others.iter().copied().filter(is_changed).collect();
    let mut bad = safeguard::misshapen(&cut.surface, facets, h, &changed, before);
    bad.extend(safeguard::coincident(&cut.surface.mesh, &others));
    bad.extend(safeguard::meeting(&cut.surface.mesh, h, &others, progress)?);
    let corners = |t: u32| cut.surface.mesh.corners(t as usize);
    match bad.is_empty() {
        true => Ok(Ok(cut.surface)),
        false => Ok(Err(bad.into_iter().flat_map(corners).collect())),
    }
}

/// Where the two did not fit so far.
#[derive(Default)]
struct Trouble {
    /// The points of each round.
    rounds: Vec<Vec<DVec3>>,
}

impl Trouble {
    /// The kept triangles to be let go because of trouble at `points`: the farther from there, the more often there was
    /// trouble before.
    fn near(&mut self, kept: &Kept, points: &[DVec3], h: f64) -> Vec<u32> {
        let close = |p: &DVec3, others: &Vec<DVec3>| others.iter().any(|o| o.distance(*p) < SAME_PLACE * h);
        let before = |p: &DVec3| self.rounds.iter().filter(|others| close(p, others)).count();
        let mut by_count: Vec<(usize, DVec3)> = points.par_iter().map(|p| (before(p), *p)).collect();
        by_count.sort_by_key(|entry| entry.0);
        let mut all = Vec::new();
        for group in by_count.chunk_by(|a, b| a.0 == b.0) {
            let points: Vec<DVec3> = group.iter().map(|entry| entry.1).collect();
            all.extend(near(kept, &points, h * self.reach(group[0].0)));
        }
        self.rounds.push(points.to_vec());
        all
    }

    /// How far to let go, h, around a place where there was trouble so many times before.
    fn reach(&self, times: usize) -> f64 {
        let (slow, fast) = (times.min(PATIENCE.0), times.saturating_sub(PATIENCE.0));
        let late = self.rounds.len().saturating_sub(PATIENCE.1);
        (REACH + REACH_GROWS * slow as f64) * 2f64.powi(fast.max(late).min(40) as i32)
    }
}

/// Cells a triangle's box may reach over before all points are looked at instead.
const MOST_CELLS: i64 = 512;

/// The kept triangles within `reach` of any of the points.
fn near(kept: &Kept, points: &[DVec3], reach: f64) -> Vec<u32> {
    let cell = |p: DVec3| (p / reach).floor().as_ivec3();
    let mut cells: FxHashMap<IVec3, Vec<DVec3>> = FxHashMap::default();
    points.iter().for_each(|&p| cells.entry(cell(p)).or_default().push(p));
    let is_near = |&t: &u32| {
        let corners = kept.mesh.corners(t as usize);
        let close = |p: &DVec3| corners.nearest(*p).0.distance(*p) <= reach;
        let bounds = corners.bounds();
        let (low, high) = (cell(bounds.min - reach), cell(bounds.max + reach));
        let steps = (high - low + 1).as_i64vec3();
        if steps.x * steps.y * steps.z > MOST_CELLS.max(points.len() as i64) {
            return points.iter().any(close);
        }
        (low.z..=high.z).any(|z| {
            (low.y..=high.y).any(|y| {
                (low.x..=high.x).any(|x| cells.get(&IVec3::new(x, y, z)).is_some_and(|list| list.iter().any(close)))
            })
        })
    };
    if points.is_empty() { Vec::new() } else { kept.facets().into_par_iter().filter(is_near).collect() }
}
