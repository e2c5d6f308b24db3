//! What becomes of the holes of one operand: a lid over each rim, made from the rim alone and judged by winding numbers, or voxels.

mod judge;
mod maker;
mod open;
mod patches;
mod refuse;

use std::borrow::Cow;

use rayon::prelude::*;

pub(super) use self::maker::WIDE;
pub use self::open::{NotOpened, Opened};

use self::judge::Judge;
use self::maker::{Made, Maker, WAYS};
use self::patches::Patches;
use super::{BooleanError, HoleReport, NotLidded, Options};
use crate::fill::{Rim, Surroundings, rims};
use crate::mesh::{TriMesh, intersections_with};
use crate::progress::{Progress, Stopped};
use crate::survey::Soup;
use crate::vote::VoteRule;

/// At most so many rims are closed by lids.
const MOST_RIMS: usize = 5000;

/// The rims of a mesh, the longest first, and for each a lid, or why it has none.
#[derive(Default)]
pub(super) struct Plan {
    rims: Vec<Rim>,
    lids: Vec<Result<Made, NotLidded>>,
}

/// The holes of a mesh, the longest rim first, and what [`repair`](super::repair) would do over each if the mesh is to be made whole.
///
/// # Errors
/// [`BooleanError`]: the mesh has no triangle, or one whose vertices are none; interrupted.
pub fn holes(mesh: &TriMesh, options: &Options, progress: &Progress) -> Result<Vec<HoleReport>, BooleanError> {
    BooleanError::check(0, mesh)?;
    let soup = Soup::of(&[mesh], options.orient, progress)?;
    Ok(planned(&soup, options, progress)?.reports())
}

/// Finds the rims of a soup, and a lid for each that has one: which meets nothing, and over which winding numbers see a hole.
pub(super) fn planned(soup: &Soup, options: &Options, progress: &Progress) -> Result<Plan, Stopped> {
    let rims = rims(&soup.mesh);
    let none = |why: NotLidded, rims: Vec<Rim>| Ok(Plan { lids: rims.iter().map(|_| Err(why)).collect(), rims });
    if options.vote != VoteRule::Winding {
        return none(NotLidded::Rays, rims);
    }
    if rims.is_empty() || rims.len() > MOST_RIMS {
        return none(NotLidded::TooMany, rims);
    }
    let around = Surroundings::new(&soup.mesh);
    let patches = Patches::of(soup);
    let judge = Judge::new(&around, soup, (&patches, &rims), options.orient, progress)?;
    let maker = Maker { around: &around, patches: &patches, judge: &judge, style: options.fill };
    let first = rims.par_iter().map(|rim| maker.lid(rim, 0, progress));
    let mut plan = Plan { lids: first.collect::<Result<_, _>>()?, rims };
    let each: Vec<_> = plan.rims.iter().zip(&plan.lids).collect();
    let refused = refuse::refused(&patches, &soup.mesh, &each, judge.sign);
    for (rim, lid) in plan.rims.iter().zip(&mut plan.lids) {
        if let Some(why) = refused[patches.beside(rim)] {
            *lid = Err(why);
        }
    }
    let judged = plan.rims.par_iter().zip(&plan.lids).map(|(rim, lid)| match lid {
        Ok(_) => judge.is_hole(rim, progress),
        Err(_) => Ok(true),
    });
    let judged: Vec<bool> = judged.collect::<Result<_, _>>()?;
    for (lid, is_hole) in plan.lids.iter_mut().zip(judged) {
        if !is_hole {
            *lid = Err(NotLidded::NoHole);
        }
    }
    plan.without_meetings(&soup.mesh, &maker, progress)?;
    Ok(plan)
}

impl Plan {
    /// Whether all rims have lids.
    pub fn is_whole(&self) -> bool {
        self.lids.iter().all(Result::is_ok)
    }

    /// Whether no rim has one.
    pub fn is_empty(&self) -> bool {
        self.lids.iter().all(Result::is_err)
    }

    /// What there is to say of each rim.
    pub fn reports(&self) -> Vec<HoleReport> {
        let list = self.rims.iter().zip(&self.lids).zip(1..);
        let report = |((rim, lid), number): ((&Rim, &Result<Made, NotLidded>), usize)| {
            let lid = lid.as_ref().map(|made| (&made.lid, made.shape)).map_err(|why| *why);
            HoleReport::of(number, rim, lid)
        };
        list.map(report).collect()
    }

    /// The soup with the lids, whose triangles come after those of the operand.
    pub fn over<'a>(&self, soup: &'a Soup) -> Cow<'a, Soup> {
        if self.is_empty() {
            return Cow::Borrowed(soup);
        }
        let (lids, of) = self.lids_of(&soup.mesh);
        let of: Vec<(u32, u32)> = of.iter().map(|&n| (n as u32 + 1, self.rims[n].vertices[0])).collect();
        Cow::Owned(soup.with_lids(&lids, &of))
    }

    /// All lids, in numbers that follow those of the mesh's vertices, and for each triangle its rim.
    fn lids_of(&self, mesh: &TriMesh) -> (TriMesh, Vec<usize>) {
        let known = mesh.positions.len();
        let (mut lids, mut of) = (TriMesh::default(), Vec::new());
        for (n, lid) in self.lids.iter().enumerate() {
            let Ok(Made { lid, .. }) = lid else { continue };
            lids.triangles.extend(lid.triangles_after(known, lids.positions.len()));
            lids.positions.extend_from_slice(&lid.positions);
            of.extend(std::iter::repeat_n(n, lid.triangles.len()));
        }
        (lids, of)
    }

    /// Lids that meet something get another shape, or none.
    fn without_meetings(&mut self, mesh: &TriMesh, maker: &Maker<'_>, progress: &Progress) -> Result<(), Stopped> {
        for way in 1..WAYS {
            let meeting = self.meeting(mesh, progress)?;
            if meeting.is_empty() {
                return Ok(());
            }
            let other = |&n: &usize| Ok((n, maker.lid(&self.rims[n], way, progress)?));
            let others: Vec<(usize, Result<Made, NotLidded>)> =
                meeting.par_iter().map(other).collect::<Result<_, Stopped>>()?;
            others.into_iter().for_each(|(n, lid)| self.lids[n] = lid.map_err(|_| NotLidded::Meets));
        }
        // Of two lids that meet each other neither is the better one; without both there may be others that met them only.
        for n in self.meeting(mesh, progress)? {
            self.lids[n] = Err(NotLidded::Meets);
        }
        Ok(())
    }

    /// The rims whose lids meet each other, themselves, or the mesh.
    fn meeting(&self, mesh: &TriMesh, progress: &Progress) -> Result<Vec<usize>, Stopped> {
        let (lids, of) = self.lids_of(mesh);
        let own = mesh.triangles.len();
        let mut closed = mesh.clone();
        closed.positions.extend_from_slice(&lids.positions);
        closed.triangles.extend_from_slice(&lids.triangles);
        let is_lid: Vec<bool> = (0..closed.triangles.len()).map(|t| t >= own).collect();
        let found = intersections_with(&closed, &is_lid, progress)?;
        let mut meeting: Vec<usize> =
            found.iter().flatten().filter_map(|&t| (t as usize).checked_sub(own)).map(|t| of[t]).collect();
        meeting.sort_unstable();
        meeting.dedup();
        Ok(meeting)
    }
}
