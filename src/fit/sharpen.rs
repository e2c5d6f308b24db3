//! Creases and corners put back, as far as the surface then does not meet itself.

use rustc_hash::FxHashSet;

use super::cut::Cut;
use super::fitting::{Fitting, Haste};
use super::surface::{Surface, shape};
use super::{Facets, FitOptions, FitReport, cut, mend, safeguard};
use crate::progress::{Progress, Stopped};

/// Rounds of undoing after which the surface stays as it was. Real meshes take up to 10, cycloidal more than 24.
const MOST_ROUNDS: usize = 64;

/// Rounds after which all that was done at a bad place is taken back at once, and after which what is around it is taken back, too: in a
/// row of slivers the next one is wrong each time, and walking along it must not cost all the others their creases.
const PATIENT_ROUNDS: usize = 6;
const NARROW_ROUNDS: usize = 12;
const RINGS: u32 = 3;

/// How much is taken back in a round.
fn haste(round: usize) -> Haste {
    match round {
        0..PATIENT_ROUNDS => Haste::StepByStep,
        PATIENT_ROUNDS..NARROW_ROUNDS => Haste::AtOnce,
        _ => Haste::Around(RINGS),
    }
}

/// A surface with its creases.
pub(super) struct Sharp {
    pub surface: Surface,
    /// For each triangle the one it was part of.
    pub origin: Vec<u32>,
    pub report: FitReport,
}

/// Moves vertices onto creases, cuts the triangles that reach over them, and takes back what makes a
/// triangle turn over or meet another. `initial` must be valid, and so is the result.
pub(super) fn sharpen(
    initial: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<Sharp, Stopped> {
    // Triangles that mending made and that were judged to be right: it makes most of them again each time.
    let mut fine: FxHashSet<[u64; 9]> = FxHashSet::default();
    let mut fitting = Fitting::new(initial, facets, h, options);
    for round in 0..MOST_ROUNDS {
        progress.check()?;
        let mut cut = cut::cut(&fitting.surface, facets, h, &fitting.points, &fitting.spared, |c| options.wants(c, h));
        let away = fitting.changed(&cut.origin);
        let mended = mend::mend(&mut cut, facets, h, &away);
        let is_new = |t: &u32| fitting.is_dirty(cut.origin[*t as usize]) || !fine.contains(&corners(&cut, *t));
        let mended: Vec<u32> = mended.into_iter().filter(is_new).collect();
        let other = merged(
            fitting.changed(&cut.origin).into_iter().filter(|&t| fitting.is_dirty(cut.origin[t as usize])),
            &mended,
        );
        // A triangle that is back where it was at first is right by itself, but what is near it may not be.
        let back = (0..cut.origin.len() as u32).filter(|&t| fitting.was_dirtied(cut.origin[t as usize]));
        let near = merged(back, &other);
        let before = |t: u32| shape(initial.mesh.corners(cut.origin[t as usize] as usize)).0;
        let mut bad = safeguard::misshapen(&cut.surface, facets, h, &other, before);
        bad.extend(safeguard::coincident(&cut.surface.mesh, &near));
        bad.extend(safeguard::meeting(&cut.surface.mesh, h, &near, progress)?);
        if bad.is_empty() {
            return Ok(Sharp { surface: cut.surface, origin: cut.origin, report: fitting.report() });
        }
        bad.sort_unstable();
        bad.dedup();
        let origin = |t: u32| cut.origin[t as usize];
        let apart = |a, b| fitting.are_apart(origin(a), origin(b));
        let touching = safeguard::touching(&cut.surface.mesh, &bad, apart, progress)?;
        let touching = merged(touching.into_iter().map(origin), &[]);
        fine.extend(mended.iter().filter(|t| bad.binary_search(t).is_err()).map(|&t| corners(&cut, t)));
        let bad = merged(bad.into_iter().map(|t| cut.origin[t as usize]), &[]);
        fitting.undo(&bad, &touching, &cut.centred, haste(round));
    }
    let report = FitReport { given_up: initial.mesh.triangles.len(), ..FitReport::default() };
    Ok(Sharp { surface: initial.clone(), origin: (0..initial.mesh.triangles.len() as u32).collect(), report })
}

/// The places of a triangle's corners, bit by bit, the first one first in some order of places.
fn corners(cut: &Cut, t: u32) -> [u64; 9] {
    let corners = cut.surface.mesh.corners(t as usize).map(|p| p.to_array().map(f64::to_bits));
    let first = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
    std::array::from_fn(|n| corners[(first + n / 3) % 3][n % 3])
}

/// All numbers of both lists, ascending, each once.
fn merged(list: impl Iterator<Item = u32>, more: &[u32]) -> Vec<u32> {
    let mut all: Vec<u32> = list.chain(more.iter().copied()).collect();
    all.sort_unstable();
    all.dedup();
    all
}
