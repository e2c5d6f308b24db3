//! Closed surfaces too small to be meant: crumbs that the lattice made, and what the user wants no smaller.

use rustc_hash::FxHashMap;

use super::{BooleanError, Draft, Dropped, NothingEnclosed, Operand, Outcome, Report, Topology, TriangleSource};
use crate::ldi::Operands;
use crate::mesh::TriMesh;
use crate::progress::Progress;
use crate::shells::{Shell, Shells, shells};
use crate::survey::Soup;

/// A surface that voxels made and no operand asked for is a crumb when it encloses less than this, h³: two voxels each way. Of the
/// crumbs of the data set, 17 in lion and beetle, the largest has 4.7 h³.
const CRUMB: f64 = 8.0;

/// Pieces that have more than this part of the volume together are no crumbs but what a lattice has left of a body, however small each is: they stay, and are told
/// as pieces that came off.
const FRAGMENTS: f64 = 1e-3;

/// What was made of a soup with voxels of `h`, without crumbs. The largest piece of every closed shell of the soup, and of one with
/// small holes, is none; nor is the largest piece of all. Where crumbs are much of the volume, all stay.
pub(super) fn without_crumbs(made: &mut Draft, soup: &Soup, h: f64) {
    let found = shells_of(&made.mesh);
    if found.list.iter().all(|shell| is_large(shell, h)) {
        return;
    }
    let asked = shells(&soup.mesh, &soup.operands);
    let mut largest: FxHashMap<u32, u32> = FxHashMap::default();
    for (source, &piece) in made.sources.iter().zip(&found.of) {
        let TriangleSource::Operand { operand, triangle } = *source else { continue };
        let range = soup.operands.range(operand as usize);
        let given = range.start..range.end.min(soup.source.len());
        let Ok(n) = soup.source[given].binary_search(&triangle) else { continue };
        let shell = asked.of[range.start + n];
        if asked.list[shell as usize].is_body() {
            let best = largest.entry(shell).or_insert(piece);
            if found.list[piece as usize].volume.abs() > found.list[*best as usize].volume.abs() {
                *best = piece;
            }
        }
    }
    let mut stays: Vec<bool> = found.list.iter().map(|shell| is_large(shell, h)).collect();
    largest.values().for_each(|&piece| stays[piece as usize] = true);
    let volume = |of: bool| -> f64 {
        let chosen = found.list.iter().zip(&stays).filter(|(_, stays)| **stays == of);
        chosen.map(|(shell, _)| shell.volume.abs()).sum()
    };
    if volume(false) > FRAGMENTS * volume(true) {
        return;
    }
    made.report.crumbs = sweep(made, &found, stays);
}

/// What morphology made with voxels of `h`, without crumbs; what has triangles of the solid is none.
pub(super) fn without_made_crumbs(mesh: &mut TriMesh, own: &mut Vec<Option<u32>>, h: f64) -> Dropped {
    let found = shells_of(mesh);
    let mut stays: Vec<bool> = found.list.iter().map(|shell| is_large(shell, h)).collect();
    own.iter().zip(&found.of).filter(|(own, _)| own.is_some()).for_each(|(_, &shell)| stays[shell as usize] = true);
    take(mesh, own, &found, stays)
}

/// The outcome without closed surfaces that enclose less than `least`, cubic model units: bodies are gone, voids are filled. Besides,
/// the numbers that its triangles had. `operands`: those that its sources name.
///
/// # Errors
/// [`NothingEnclosed::AllSmaller`] when all enclose less.
pub fn drop_smaller<'a>(
    outcome: Outcome,
    operands: impl IntoIterator<Item: Into<Operand<'a>>>,
    least: f64,
    progress: &Progress,
) -> Result<(Outcome, Vec<usize>), BooleanError> {
    let operands: Vec<Operand<'_>> = operands.into_iter().map(Into::into).collect();
    let meshes: Vec<&TriMesh> = operands.iter().map(|operand| operand.mesh).collect();
    let mut draft = outcome.into_draft();
    let found = shells_of(&draft.mesh);
    let stays: Vec<bool> = found.list.iter().map(|shell| shell.volume.abs() >= least).collect();
    if !stays.contains(&true) {
        let largest = found.list.iter().map(|shell| shell.volume.abs()).fold(0.0, f64::max);
        return Err(NothingEnclosed::AllSmaller { surfaces: found.list.len(), least, largest }.into());
    }
    let left = (0..found.of.len()).filter(|&t| stays[found.of[t] as usize]).collect();
    draft.report.smaller = sweep(&mut draft, &found, stays);
    Ok((draft.counted(&meshes).judged(&operands, progress)?, left))
}

fn shells_of(mesh: &TriMesh) -> Shells {
    shells(mesh, &Operands::new([mesh.triangles.len()]))
}

fn is_large(shell: &Shell, h: f64) -> bool {
    shell.volume.abs() >= CRUMB * h.powi(3)
}

fn sweep(outcome: &mut Draft, found: &Shells, stays: Vec<bool>) -> Dropped {
    let gone = found.list.iter().zip(&stays).filter(|(_, stays)| !**stays).map(|(shell, _)| shell);
    count_out(&mut outcome.report, gone);
    let dropped = take(&mut outcome.mesh, &mut outcome.sources, found, stays);
    outcome.report.closed_triangles = outcome.sources.iter().filter(|source| source.is_made_up()).count();
    dropped
}

/// Takes what goes out of the numbers of bodies, voids and tunnels.
fn count_out<'a>(report: &mut Report, gone: impl Iterator<Item = &'a Shell>) {
    let Some(topology) = &mut report.topology else { return };
    let Topology { bodies, voids, tunnels } = &mut topology.after;
    for shell in gone {
        let count = if shell.volume > 0.0 { &mut *bodies } else { &mut *voids };
        *count = count.saturating_sub(1);
        *tunnels -= shell.genus.unwrap_or(0);
    }
}

/// Takes the triangles of shells that do not stay out of `mesh`, and their entries out of `of_triangles`; the largest shell stays
/// in any case.
fn take<T: Copy>(mesh: &mut TriMesh, of_triangles: &mut Vec<T>, found: &Shells, mut stays: Vec<bool>) -> Dropped {
    let volume = |n: &usize| found.list[*n].volume.abs();
    if let Some(largest) = (0..stays.len()).max_by(|a, b| volume(a).total_cmp(&volume(b))) {
        stays[largest] = true;
    }
    let mut dropped = Dropped::default();
    for (shell, _) in found.list.iter().zip(&stays).filter(|(_, stays)| !**stays) {
        let one = Dropped { surfaces: 1, triangles: shell.triangles.len(), volume: shell.volume.abs() };
        dropped = dropped.and(one);
    }
    if dropped.surfaces == 0 {
        return dropped;
    }
    let triangles = 0..mesh.triangles.len() as u32;
    let kept: Vec<u32> = triangles.filter(|&t| stays[found.of[t as usize] as usize]).collect();
    *of_triangles = kept.iter().map(|&t| of_triangles[t as usize]).collect();
    *mesh = mesh.submesh(&kept).mesh;
    dropped
}
