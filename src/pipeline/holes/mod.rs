//! What becomes of the holes of one operand: a lid over each rim, made from the rim alone and judged by winding numbers, or voxels.

mod bands;
mod judge;
mod maker;
mod open;
mod patches;
mod refuse;
mod sheets;

use std::borrow::Cow;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

pub(super) use self::maker::WIDE;
pub use self::open::{NotOpened, Opened};

use self::bands::{Band, bands};
use self::judge::{ENOUGH, Judge};
use self::maker::{Made, Maker, WAYS};
use self::patches::Patches;
use self::sheets::left_out;
use super::{BooleanError, HoleClosing, HoleReport, NotLidded, Options, Warning};
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
    /// Over which part of its area the lid over each rim parts inside and outside, as far as that was asked; 1 for bands.
    parting: Vec<f64>,
    /// Pairs of rims that are joined by bands.
    joined: Vec<[usize; 2]>,
    /// For each triangle whether it is of a sheet that is left out; empty where none is.
    left_out: Vec<bool>,
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

/// Finds the rims of a soup, and a lid for each that has one: which meets nothing, and over which winding numbers see a hole. Rims that have none and face each other
/// are joined by bands; then the others are judged anew.
pub(super) fn planned(soup: &Soup, options: &Options, progress: &Progress) -> Result<Plan, Stopped> {
    let rims = rims(&soup.mesh);
    if options.vote != VoteRule::Winding {
        return Ok(Plan::none(rims, NotLidded::Rays));
    }
    if rims.is_empty() || rims.len() > MOST_RIMS {
        return Ok(Plan::none(rims, NotLidded::TooMany));
    }
    let around = Surroundings::new(&soup.mesh);
    let patches = Patches::of(soup);
    let judge = Judge::new(&around, soup, (&patches, &rims), options.orient, progress)?;
    let maker = Maker { around: &around, patches: &patches, judge: &judge, style: options.fill };
    let plan = Plan::lidded(rims, Vec::new(), &maker, progress)?;
    let bands = bands(&plan, &maker, progress)?;
    if bands.is_empty() {
        return Ok(plan);
    }
    let Plan { rims, .. } = plan;
    let patches = patches.joined(bands.iter().map(|band| band.rims.map(|n| &rims[n])));
    let judge = Judge::new(&around, soup, (&patches, &rims), options.orient, progress)?;
    let maker = Maker { around: &around, patches: &patches, judge: &judge, style: options.fill };
    Plan::lidded(rims, bands, &maker, progress)
}

impl Plan {
    /// No rim has a lid, all for one reason.
    fn none(rims: Vec<Rim>, why: NotLidded) -> Self {
        Self { lids: rims.iter().map(|_| Err(why)).collect(), rims, ..Self::default() }
    }

    /// Bands between rims, and lids over the others.
    fn lidded(rims: Vec<Rim>, bands: Vec<Band>, maker: &Maker<'_>, progress: &Progress) -> Result<Self, Stopped> {
        let (judge, patches, mesh) = (maker.judge, maker.patches, maker.around.mesh());
        let joined: Vec<[usize; 2]> = bands.iter().map(|band| band.rims).collect();
        let mut made: FxHashMap<usize, Made> = bands.into_iter().flat_map(Band::made).collect();
        let has_band = |n: usize| joined.iter().flatten().any(|&m| m == n);
        let first = rims.par_iter().enumerate().map(|(n, rim)| match has_band(n) {
            // Its part of the band comes after.
            true => Ok(Err(NotLidded::NoHole)),
            false => maker.lid(rim, 0, progress),
        });
        let mut lids: Vec<Result<Made, NotLidded>> = first.collect::<Result<_, _>>()?;
        made.drain().for_each(|(n, made)| lids[n] = Ok(made));
        let each: Vec<_> = rims.iter().zip(&lids).collect();
        let refused = refuse::refused(patches, mesh, &each, judge.sign);
        for (n, rim) in rims.iter().enumerate() {
            if let Some(why) = refused[patches.beside(rim)] {
                lids[n] = Err(why);
            }
        }
        let judged = rims.par_iter().zip(&lids).enumerate().map(|(n, (rim, lid))| match lid.is_err() || has_band(n) {
            true => Ok(1.0),
            false => judge.hole(rim, progress),
        });
        let parting: Vec<f64> = judged.collect::<Result<_, Stopped>>()?;
        for (lid, _) in lids.iter_mut().zip(&parting).filter(|(_, parting)| **parting <= ENOUGH) {
            *lid = Err(NotLidded::NoHole);
        }
        let mut plan = Self { rims, lids, parting, joined, left_out: Vec::new() };
        plan.without_meetings(mesh, maker, progress)?;
        if plan.lids.iter().any(|lid| matches!(lid, Err(NotLidded::Sheet))) {
            plan.left_out = left_out(&plan, (patches, judge), mesh, progress)?;
            if plan.left_out.is_empty() {
                refuse::beside(&mut plan.lids);
            }
        }
        plan.joined.retain(|pair| pair.iter().all(|&n| plan.lids[n].is_ok()));
        Ok(plan)
    }

    /// The rims, the longest first.
    pub fn rims(&self) -> &[Rim] {
        &self.rims
    }

    /// Whether all rims have lids, but for those of sheets that are left out.
    pub fn is_whole(&self) -> bool {
        self.lids.iter().all(|lid| lid.is_ok() || self.is_out(lid))
    }

    /// Whether a rim is that of a sheet that is left out.
    fn is_out(&self, lid: &Result<Made, NotLidded>) -> bool {
        !self.left_out.is_empty() && matches!(lid, Err(NotLidded::Sheet))
    }

    /// The rims that have no lid, where all others have one and where that is for their shape alone: nothing is doubtful but what is near them. Nothing else.
    pub fn bare(&self) -> Vec<&Rim> {
        let of_shape = |why: &NotLidded| {
            matches!(why, NotLidded::NoHole | NotLidded::Meets | NotLidded::Folded | NotLidded::NoArea)
        };
        if !self.left_out.is_empty() || !self.lids.iter().all(|lid| lid.as_ref().err().is_none_or(of_shape)) {
            return Vec::new();
        }
        self.rims.iter().zip(&self.lids).filter(|(_, lid)| lid.is_err()).map(|(rim, _)| rim).collect()
    }

    /// A note on the sheets that are left out.
    pub fn warning(&self) -> Option<Warning> {
        let triangles = self.left_out.iter().filter(|out| **out).count();
        (triangles > 0).then_some(Warning::SheetsLeftOut { triangles })
    }

    /// Whether the soup stays as it is: no rim has a lid, and no sheet is left out.
    pub fn is_empty(&self) -> bool {
        self.lids.iter().all(Result::is_err) && self.left_out.is_empty()
    }

    /// What there is to say of each rim.
    pub fn reports(&self) -> Vec<HoleReport> {
        let list = self.rims.iter().zip(&self.lids).zip(1..);
        let report = |((rim, lid), number): ((&Rim, &Result<Made, NotLidded>), usize)| {
            let lid = lid.as_ref().map(|made| (&made.lid, made.shape)).map_err(|why| *why);
            HoleReport::of(number, rim, lid)
        };
        let mut reports: Vec<HoleReport> = list.map(report).collect();
        for (report, _) in reports.iter_mut().zip(&self.lids).filter(|(_, lid)| self.is_out(lid)) {
            report.closed_by = HoleClosing::LeftOut;
        }
        for &[n, m] in &self.joined {
            (reports[n].joined_with, reports[m].joined_with) = (Some(m + 1), Some(n + 1));
        }
        reports
    }

    /// The soup with the lids, whose triangles come after those of the operand, and without the sheets that are left out.
    pub fn over<'a>(&self, soup: &'a Soup) -> Cow<'a, Soup> {
        if self.is_empty() {
            return Cow::Borrowed(soup);
        }
        let (lids, of) = self.lids_of(&soup.mesh);
        let of: Vec<(u32, u32)> = of.iter().map(|&n| (n as u32 + 1, self.rims[n].vertices[0])).collect();
        Cow::Owned(match self.left_out.is_empty() {
            true => soup.with_lids(&lids, &of),
            false => soup.only(|t| !self.left_out[t]).with_lids(&lids, &of),
        })
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
            let (joined, meeting): (Vec<usize>, Vec<usize>) =
                meeting.into_iter().partition(|n| self.partner(*n).is_some());
            joined.iter().for_each(|&n| self.refuse(n, NotLidded::Meets));
            let other = |&n: &usize| Ok((n, maker.lid(&self.rims[n], way, progress)?));
            let others: Vec<(usize, Result<Made, NotLidded>)> =
                meeting.par_iter().map(other).collect::<Result<_, Stopped>>()?;
            others.into_iter().for_each(|(n, lid)| self.lids[n] = lid.map_err(|_| NotLidded::Meets));
        }
        // Of two lids that meet each other neither is the better one; without both there may be others that met them only.
        for n in self.meeting(mesh, progress)? {
            self.refuse(n, NotLidded::Meets);
        }
        Ok(())
    }

    /// The rim that a band joins with another one.
    fn partner(&self, rim: usize) -> Option<usize> {
        self.joined.iter().find_map(|&[n, m]| (n == rim).then_some(m).or((m == rim).then_some(n)))
    }

    /// Takes away what closes a rim, and with a band what closes its partner.
    fn refuse(&mut self, rim: usize, why: NotLidded) {
        for n in [Some(rim), self.partner(rim)].into_iter().flatten() {
            self.lids[n] = Err(why);
        }
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
