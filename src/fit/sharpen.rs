//! Creases and corners put back, as far as the surface then does not meet itself.

use super::fitting::Fitting;
use super::surface::{Surface, shape};
use super::{Facets, FitOptions, FitReport, cut, mend, safeguard};
use crate::progress::{Progress, Stopped};

/// Rounds of undoing after which the surface stays as it was. Real meshes take up to 10.
const MOST_ROUNDS: usize = 24;

/// Rounds after which all that was done at a bad place is taken back at once.
const PATIENT_ROUNDS: usize = 6;

/// Moves vertices onto creases, cuts the triangles that reach over them, and takes back what makes a
/// triangle turn over or meet another. `home` must be valid, and so is the result.
pub(super) fn sharpen(
    home: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<(Surface, FitReport), Stopped> {
    let mut fitting = Fitting::new(home, facets, h, options);
    for round in 0..MOST_ROUNDS {
        progress.check()?;
        let mut cut = cut::cut(&fitting.surface, facets, h, &fitting.points, &fitting.spared, |c| options.wants(c, h));
        let away = fitting.changed(&cut.origin);
        let mended = mend::mend(&mut cut, facets, h, &away);
        let other = merged(
            fitting.changed(&cut.origin).into_iter().filter(|&t| fitting.is_dirty(cut.origin[t as usize])),
            &mended,
        );
        // A triangle that is back at home is right by itself, but what is near it may not be.
        let back = (0..cut.origin.len() as u32).filter(|&t| fitting.was_dirtied(cut.origin[t as usize]));
        let near = merged(back, &other);
        let before = |t: u32| shape(home.mesh.corners(cut.origin[t as usize] as usize)).0;
        let mut bad = safeguard::misshapen(&cut.surface, facets, h, &other, before);
        bad.extend(safeguard::coincident(&cut.surface.mesh, &near));
        bad.extend(safeguard::meeting(&cut.surface.mesh, h, &near, progress)?);
        if bad.is_empty() {
            return Ok((cut.surface, fitting.report()));
        }
        let bad = merged(bad.into_iter().map(|t| cut.origin[t as usize]), &[]);
        fitting.undo(&bad, &cut.centred, round >= PATIENT_ROUNDS);
    }
    Ok((home.clone(), FitReport { given_up: home.mesh.triangles.len(), ..FitReport::default() }))
}

/// All numbers of both lists, ascending, each once.
fn merged(list: impl Iterator<Item = u32>, more: &[u32]) -> Vec<u32> {
    let mut all: Vec<u32> = list.chain(more.iter().copied()).collect();
    all.sort_unstable();
    all.dedup();
    all
}
