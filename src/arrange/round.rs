//! From an exact surface to one whose vertices have numbers that a file can hold, and of which no triangle crosses another.
//!
//! Rounding makes triangles cross that only came near each other. What crosses is united with itself again: the surface as it is
//! now, exactly, and rounded again. So that this ends, points that are made near a vertex become that vertex, needles among what crosses are collapsed,
//! longer ones from round to round, and what keeps crossing is moved onto a grid.

use glam::DVec3;

use super::again::united;
use super::draft::{Draft, Kind, Rounding};
use super::fine::Fine;
use super::surface::{Surface, volume};
use crate::mesh::{TriMesh, flat_triangles, intersections_with, self_intersections};
use crate::progress::{Progress, Stopped};

/// How often a surface is united with itself before another way is tried.
const ROUNDS: u32 = 12;

/// A surface that grows by more than this factor does not get better.
const GROWTH: usize = 2;

/// Neither does one with more than this many times the fewest triangles that crossed before, and some to spare.
const WORSE: usize = 8;

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

const WAYS: [Way; 9] = [
    Way { patience: 2, grid: 8.0, reach: 2.0, needle: 16.0 },
    Way { patience: 0, grid: 8.0, reach: 2.0, needle: 16.0 },
    Way { patience: 1, grid: 32.0, reach: 8.0, needle: 16.0 },
    Way { patience: 4, grid: 8.0, reach: 8.0, needle: 4.0 },
    Way { patience: 2, grid: 64.0, reach: 16.0, needle: 64.0 },
    Way { patience: 4, grid: 64.0, reach: 16.0, needle: 64.0 },
    Way { patience: 1, grid: 64.0, reach: 1.0, needle: 4.0 },
    Way { patience: 1, grid: 64.0, reach: 1.0, needle: 16.0 },
    Way { patience: 1, grid: 64.0, reach: 4.0, needle: 16.0 },
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

/// A volume that is off by less than this part is not worth another way.
const CLOSE: f64 = 1e-6;

/// Rounds a surface; `None` if triangles cross whichever way is gone. Of several ways the one that changes the volume least is taken, once the
/// first changes it by much.
pub(crate) fn round(surface: &Surface<'_>, progress: &Progress) -> Result<Option<Rounded>, Stopped> {
    let exact = surface.volume();
    let rounding = Rounding { fine: surface.fine, kinds: surface.kinds, input: surface.input, near: None, exact: true };
    let mut draft = Draft::new(surface.refined, surface.faces, &rounding, |t| t);
    surface.mark(&mut draft);
    let first = surface.look(draft, progress)?;
    let mut best: Option<Rounded> = None;
    for way in &WAYS {
        let Some(mut rounded) = way.go(surface, first.clone(), progress)? else { continue };
        let corners = (0..rounded.mesh.triangles.len()).map(|t| rounded.mesh.corners(t));
        rounded.volume_error = (volume(corners) / exact - 1.0).abs();
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

/// A draft with the numbers of the result, and which of its triangles cross others or have no area, ascending.
#[derive(Clone)]
struct Seen {
    draft: Draft,
    mesh: TriMesh,
    offenders: Vec<u32>,
}

impl Way {
    /// Unites a surface with itself until nothing crosses.
    fn go(&self, surface: &Surface<'_>, mut seen: Seen, progress: &Progress) -> Result<Option<Rounded>, Stopped> {
        let most = GROWTH * seen.draft.triangles.len() + 1000;
        let mut fewest = usize::MAX;
        for number in 0..ROUNDS {
            progress.check()?;
            if seen.offenders.is_empty() {
                seen.draft.fresh.fill(false);
                let separated = seen.draft.separate(surface.fine, f64::from(1 << number.min(7)));
                if separated.vertices > 0 {
                    seen = surface.look(seen.draft, progress)?;
                }
                if seen.offenders.is_empty() && separated.is_manifold {
                    let (Seen { draft, mesh, .. }, separated) = (seen, separated.vertices);
                    let sources = draft.sources;
                    return Ok(Some(Rounded { mesh, sources, rounds: number, separated, volume_error: 0.0 }));
                }
            }
            let Seen { mut draft, offenders, .. } = seen;
            fewest = fewest.min(offenders.len());
            if draft.triangles.len() > most || offenders.len() > WORSE * fewest + 100 {
                break;
            }
            self.mend(&mut draft, &offenders, surface.fine, number);
            match united(&draft, self.reach, surface, progress)? {
                Some(next) => seen = surface.look(next, progress)?,
                None => break,
            }
        }
        Ok(None)
    }

    /// Moves vertices of triangles that cross; all triangles at these vertices, and at others that moved, are fresh afterwards.
    fn mend(&self, draft: &mut Draft, offenders: &[u32], fine: &Fine, number: u32) {
        let before = draft.clone();
        let grid = if number < self.patience { 0.0 } else { self.grid };
        draft.move_offenders(offenders, fine, grid, number);
        draft.mend_needles(offenders, fine, self.needle * f64::from(1 << number.min(7)));
        let moved = |v: usize| draft.places[v] != before.places[v] || draft.kinds[v] != before.kinds[v];
        let mut at: Vec<bool> = (0..draft.places.len()).map(moved).collect();
        offenders.iter().flat_map(|&t| before.triangles[t as usize]).for_each(|v| at[v as usize] = true);
        draft.fresh = draft.triangles.iter().map(|corners| corners.iter().any(|&v| at[v as usize])).collect();
    }
}

impl Surface<'_> {
    /// Looks at what crosses among the fresh triangles of a draft, and between those and others.
    fn look(&self, draft: Draft, progress: &Progress) -> Result<Seen, Stopped> {
        let mesh = draft.mesh(self.fine, self.input);
        let pairs = match draft.fresh.contains(&false) {
            true => intersections_with(&mesh, &draft.fresh, progress)?,
            false => self_intersections(&mesh, progress)?,
        };
        let mut offenders: Vec<u32> = pairs.into_iter().flatten().collect();
        offenders.extend(flat_triangles(&mesh));
        offenders.sort_unstable();
        offenders.dedup();
        Ok(Seen { draft, mesh, offenders })
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
