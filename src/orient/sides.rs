//! Which side of a patch is outside: the rays of the LDIs vote.

use rayon::prelude::*;

use super::PatchId;
use crate::ldi::{Facing, Hit, Inside, Layers, Operands, facing};
use crate::progress::{Progress, Stopped};

/// At most this many rounds of voting: each turns over the patches that the rays vote against,
/// and the next sees the effect. Two settle every file tried.
const ROUNDS: usize = 4;

/// What a crossing's vote counts; one that says less counts 1. Through the holes of an open body pass few of its rays, but many of those that meet
/// a piece of a cracked body meet another piece, too.
const VOICE: u64 = 4;

/// Votes of the rays on one patch.
#[derive(Debug, Clone, Copy, Default)]
struct Ballot {
    keep: u64,
    flip: u64,
}

/// Decides for each patch whether it has to be turned over, and turns the crossings of the turned
/// patches in `layers`. `patch_of` maps triangles of the common soup to patches.
///
/// Each ray looks at each operand's crossings by themselves. Where they balance as they are, every
/// crossing votes to keep its patch: overlapping bodies and voids in hollow ones are fine. Where
/// they do not, but are even in number, enter, leave, enter, leave… is expected, and each crossing
/// votes for what that says of it. An odd number of crossings has no say.
///
/// Where surfaces count whichever way they face ([`Inside::needs_outward`]), crossings that only say that all of it faces inwards vote to keep
/// their patches, but with a quarter of a voice: a closed surface stays as it is, also when some rays pass through holes of it, and a patch
/// is turned over where more rays see that the surface that it is a part of faces the other way.
pub fn orient_sides(
    layers: &mut [Layers],
    patch_of: &[PatchId],
    patch_count: usize,
    operands: &Operands,
    progress: &Progress,
) -> Result<Vec<bool>, Stopped> {
    let mut turned = vec![false; patch_count];
    for _ in 0..ROUNDS {
        let ballots = layers
            .par_iter()
            .map(|layers| progress.check().map(|()| poll(layers, patch_of, patch_count, operands)))
            .try_reduce(|| vec![Ballot::default(); patch_count], |a, b| Ok(add(a, b)))?;
        let flip: Vec<bool> = ballots.iter().map(|ballot| ballot.flip > ballot.keep).collect();
        if !flip.contains(&true) {
            break;
        }
        turned.iter_mut().zip(&flip).for_each(|(turned, &flip)| *turned ^= flip);
        layers.par_iter_mut().for_each(|layers| {
            for hit in &mut layers.hits {
                if flip[patch_of[hit.triangle() as usize].index()] {
                    *hit = hit.turned();
                }
            }
        });
    }
    Ok(turned)
}

fn add(mut a: Vec<Ballot>, b: Vec<Ballot>) -> Vec<Ballot> {
    for (a, b) in a.iter_mut().zip(b) {
        a.keep += b.keep;
        a.flip += b.flip;
    }
    a
}

fn poll(layers: &Layers, patch_of: &[PatchId], patch_count: usize, operands: &Operands) -> Vec<Ballot> {
    let mut ballots = vec![Ballot::default(); patch_count];
    let mut own = Vec::new();
    for hits in layers.offsets.windows(2).map(|w| &layers.hits[w[0] as usize..w[1] as usize]) {
        if hits.is_empty() {
            continue;
        }
        if operands.count() == 1 {
            vote(hits, operands.inside, patch_of, &mut ballots);
            continue;
        }
        for operand in 0..operands.count() {
            own.clear();
            own.extend(hits.iter().filter(|hit| operands.of(hit.triangle()) == operand));
            vote(&own, operands.inside, patch_of, &mut ballots);
        }
    }
    ballots
}

/// Adds the votes of one operand's crossings on one ray.
fn vote(hits: &[Hit], inside: Inside, patch_of: &[PatchId], ballots: &mut [Ballot]) {
    if hits.len() % 2 == 1 {
        return;
    }
    let facing = facing(hits);
    let all_inwards = facing == Facing::Inwards && !inside.needs_outward();
    let voice = if all_inwards { 1 } else { VOICE };
    for (n, hit) in hits.iter().enumerate() {
        let ballot = &mut ballots[patch_of[hit.triangle() as usize].index()];
        if all_inwards || facing == Facing::Right || hit.entering() == (n % 2 == 0) {
            ballot.keep += voice;
        } else {
            ballot.flip += voice;
        }
    }
}
