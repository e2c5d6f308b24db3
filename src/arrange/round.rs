//! From an exact surface to one whose vertices have numbers that a file can hold, and of which no triangle crosses another.
//!
//! Rounding makes triangles cross that only came near each other. What crosses is united with itself again: the surface as it is
//! now, exactly, and rounded again. So that this ends, points that are made near a vertex become that vertex, needles among what crosses are collapsed,
//! longer ones from round to round, and what keeps crossing is moved onto a grid.

use glam::DVec3;

use super::cells::{Cells, Owner, gaps};
use super::draft::{Draft, Kind, Rounding};
use super::extract::{Face, extract};
use super::facets::Facets;
use super::fine::Fine;
use super::merge::merge;
use super::near::Near;
use super::options::ArrangeOptions;
use super::refine::{Refined, refine};
use crate::mesh::edges::Edges;
use crate::mesh::{TriMesh, flat_triangles, intersections_with, self_intersections};
use crate::progress::{Progress, Stopped};

/// How often a surface is united with itself before another way is tried.
const ROUNDS: u32 = 8;

/// A surface that grows by more than this factor does not get better.
const GROWTH: usize = 2;

/// Neither does one with more than this many times the fewest triangles that crossed before, and some to spare.
const WORSE: usize = 4;

/// One way of going on where triangles cross once rounded. Lengths are in the coarsest numbers that coordinates along each axis may have.
///
/// Measured on the closed files of the real data in single and double precision: no way ends well on all of them, and one of these ends well on each. Grids that grow from round to round, and cutting needles instead of collapsing them, end well on half of the hard ones.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// Rounds before anything is moved onto the grid.
    patience: u32,
    /// The grid.
    grid: f64,
    /// How far away a vertex is found by a point that is made.
    reach: f64,
    /// How short an edge is collapsed in the first round; doubled in each further one.
    needle: f64,
}

const WAYS: [Way; 7] = [
    Way { patience: 2, grid: 8.0, reach: 2.0, needle: 16.0 },
    Way { patience: 0, grid: 8.0, reach: 2.0, needle: 16.0 },
    Way { patience: 1, grid: 32.0, reach: 8.0, needle: 16.0 },
    Way { patience: 4, grid: 8.0, reach: 8.0, needle: 4.0 },
    Way { patience: 2, grid: 64.0, reach: 16.0, needle: 64.0 },
    Way { patience: 4, grid: 64.0, reach: 16.0, needle: 64.0 },
    Way { patience: 1, grid: 64.0, reach: 1.0, needle: 4.0 },
];

/// A surface that is done.
#[derive(Debug)]
pub(crate) struct Rounded {
    pub(crate) mesh: TriMesh,
    pub(crate) sources: Vec<u32>,
    /// How often the surface was united with itself.
    pub(crate) rounds: u32,
    /// Vertices that were made to move apart what touches.
    pub(crate) separated: usize,
    /// By which part the volume has changed.
    pub(crate) volume_error: f64,
}

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

/// The surface of a solid to be rounded.
pub(crate) struct Surface<'a> {
    pub(crate) refined: &'a Refined,
    pub(crate) faces: &'a [Face],
    /// What each vertex of the arrangement is.
    pub(crate) kinds: &'a [Kind],
    pub(crate) fine: &'a Fine,
    /// The positions of the input's vertices as the result may have them, model units.
    pub(crate) input: &'a [DVec3],
    pub(crate) options: &'a ArrangeOptions<'a>,
}

/// A volume that is off by less than this part is not worth another way.
const CLOSE: f64 = 1e-6;

/// Rounds a surface; `None` if triangles cross whichever way is gone. Of several ways the one that changes the volume least is taken, once the
/// first changes it by much.
pub(crate) fn round(surface: &Surface<'_>, progress: &Progress) -> Result<Option<Rounded>, Stopped> {
    let volume = surface.volume();
    let mut best: Option<Rounded> = None;
    for way in &WAYS {
        let Some(mut rounded) = way.go(surface, progress)? else { continue };
        let corners = (0..rounded.mesh.triangles.len()).map(|t| rounded.mesh.corners(t));
        rounded.volume_error = (self::volume(corners) / volume - 1.0).abs();
        // Where nothing crossed, all ways are one.
        let is_close = rounded.volume_error <= CLOSE || rounded.rounds == 0;
        if best.as_ref().is_none_or(|best| rounded.volume_error < best.volume_error) {
            best = Some(rounded);
        }
        if is_close {
            break;
        }
    }
    Ok(best)
}

impl Way {
    /// Rounds a surface and unites it with itself until nothing crosses.
    fn go(&self, surface: &Surface<'_>, progress: &Progress) -> Result<Option<Rounded>, Stopped> {
        let rounding = Rounding { fine: surface.fine, kinds: surface.kinds, near: None, exact: true };
        let mut draft = Draft::new(surface.refined, surface.faces, &rounding, |t| t);
        let most = GROWTH * draft.triangles.len() + 1000;
        let mut fewest = usize::MAX;
        for number in 0..ROUNDS {
            progress.check()?;
            let mut mesh = draft.mesh(surface.fine, surface.input);
            let mut offenders = surface.offenders(&draft, &mesh, progress)?;
            if offenders.is_empty() {
                let separated = draft.separate(surface.fine, f64::from(1 << number));
                if separated.vertices > 0 {
                    mesh = draft.mesh(surface.fine, surface.input);
                    offenders = surface.offenders(&draft, &mesh, progress)?;
                }
                if offenders.is_empty() && separated.is_manifold {
                    let (sources, separated) = (draft.sources, separated.vertices);
                    return Ok(Some(Rounded { mesh, sources, rounds: number, separated, volume_error: 0.0 }));
                }
            }
            fewest = fewest.min(offenders.len());
            if draft.triangles.len() > most || offenders.len() > WORSE * fewest + 100 {
                break;
            }
            let grid = if number < self.patience { 0.0 } else { self.grid };
            draft.move_offenders(&offenders, surface.fine, grid, number);
            draft.mend_needles(&offenders, surface.fine, self.needle * f64::from(1 << number));
            match united(&draft, self.reach, surface, progress)? {
                Some(next) => draft = next,
                None => break,
            }
        }
        Ok(None)
    }
}

impl Surface<'_> {
    /// The triangles that cross others or have no area, ascending. Where it is known which triangles of the input touched nothing, those that are still what they
    /// were are not looked at against each other again.
    fn offenders(&self, draft: &Draft, mesh: &TriMesh, progress: &Progress) -> Result<Vec<u32>, Stopped> {
        let suspects = self.options.suspects;
        let pairs = if suspects.is_empty() {
            self_intersections(mesh, progress)?
        } else {
            let own = |v: &u32| matches!(draft.kinds[*v as usize], Kind::Own(_));
            let marked = |(t, source): (&[u32; 3], &u32)| suspects[*source as usize] || !t.iter().all(own);
            let marked: Vec<bool> = draft.triangles.iter().zip(&draft.sources).map(marked).collect();
            intersections_with(mesh, &marked, progress)?
        };
        let mut found: Vec<u32> = pairs.into_iter().flatten().collect();
        found.extend(flat_triangles(mesh));
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }
}

/// From this round on vertices of the input are moved onto the grid like others.
const LAST_RESORT: u32 = 6;

impl Draft {
    /// Puts the corners of triangles that cross on the lattice, and on a grid, if that is not zero; corners of the input only in the last
    /// rounds.
    fn move_offenders(&mut self, offenders: &[u32], fine: &Fine, grid: f64, number: u32) {
        let mut corners: Vec<u32> = offenders.iter().flat_map(|&t| self.triangles[t as usize]).collect();
        corners.sort_unstable();
        corners.dedup();
        for v in corners.into_iter().map(|v| v as usize) {
            let spared = matches!(self.kinds[v], Kind::Own(_)) || self.kinds[v] == Kind::Placed;
            if spared && number < LAST_RESORT {
                self.kinds[v] = Kind::Placed;
                continue;
            }
            self.kinds[v] = Kind::Moved;
            if grid > 0.0 {
                let grid = grid * fine.coarsest;
                let place = DVec3::from_array(self.places[v].map(f64::from));
                self.places[v] = fine.settled((place / grid).round() * grid);
            }
        }
    }
}

/// The union of a draft with itself.
fn united(draft: &Draft, reach: f64, surface: &Surface<'_>, progress: &Progress) -> Result<Option<Draft>, Stopped> {
    let (facets, numbers) = Facets::new(&draft.places, &draft.triangles);
    let mut kinds = vec![Kind::Moved; facets.vertices.len()];
    for (&n, &kind) in numbers.iter().zip(&draft.kinds) {
        if kind != Kind::Moved && !matches!(kinds[n as usize], Kind::Own(_)) {
            kinds[n as usize] = kind;
        }
    }
    let pairs = touching(&facets, |_| true, progress)?;
    let mut touched: Vec<u32> = pairs.iter().flatten().copied().collect();
    touched.sort_unstable();
    touched.dedup();
    let near = Near::new(&facets, &touched, surface.fine, reach);
    let refined = refine(facets, &pairs, progress)?;
    let corners = refined.corners();
    let edges = Edges::new(&corners, refined.points.len());
    if !gaps(&refined, &edges, &One).is_empty() {
        return Ok(None);
    }
    let cells = Cells::of(&refined, &edges, progress)?;
    let Some(winding) = cells.winding(&refined, 1, &One) else { return Ok(None) };
    let inside: Vec<bool> = winding.iter().map(|&winding| winding >= 1).collect();
    let class = |t: u32| surface.options.classes.get(draft.sources[t as usize] as usize).copied().unwrap_or(0);
    let faces = merge(&refined, extract(&refined, &cells, &inside), &class, progress)?;
    let rounding = Rounding { fine: surface.fine, kinds: &kinds, near: Some(&near), exact: false };
    Ok(Some(Draft::new(&refined, &faces, &rounding, |t| draft.sources[t as usize])))
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

impl Surface<'_> {
    /// The volume before rounding, cubic model units, to about 1e-12 of it.
    pub(super) fn volume(&self) -> f64 {
        let corner = |p: u32| match self.kinds.get(p as usize) {
            Some(&Kind::Own(v)) => self.input[v as usize],
            _ => self.refined.points.approximate(p) * self.fine.step,
        };
        volume(self.faces.iter().map(|face: &Face| face.corners.map(corner)))
    }
}

/// The signed volume that triangles enclose.
pub(super) fn volume(triangles: impl Iterator<Item = [DVec3; 3]> + Clone) -> f64 {
    let Some([origin, ..]) = triangles.clone().next() else { return 0.0 };
    triangles.map(|corners| corners.map(|p| p - origin)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
