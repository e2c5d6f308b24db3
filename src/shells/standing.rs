//! Which shells stay as they are, and which way round.

use glam::DVec3;
use rayon::prelude::*;

use super::boxes::Boxes;
use super::winding::{around, solid_angle};
use super::{Contacts, Kind, Shell, Shells};
use crate::ldi::{Expression, Inside};
use crate::mesh::TriMesh;
use crate::mesh::predicates::scale_of_mesh;
use crate::orient::OrientMode;
use crate::progress::{Progress, Stopped};

/// Options of [`standing`].
#[derive(Debug, Clone, Copy)]
pub struct StandingOptions<'a> {
    /// The result in terms of the operands.
    pub expression: &'a Expression,
    /// How many operands there are.
    pub operands: usize,
    /// Whether shells that face the wrong way are turned over.
    pub orient: OrientMode,
    /// Which winding numbers of an operand are inside.
    pub inside: Inside,
}

/// What becomes of a shell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// Nothing is known without rays: the shell goes on to the lattice.
    Open,
    /// The shell is part of the result's surface. `turned`: its triangles face the wrong way in the operand; `reversed`: they do in the
    /// result, whose inside lies on the other side of it (what is taken away leaves a void).
    Bounds {
        /// Whether it was inside out in its operand.
        turned: bool,
        /// Whether the result has it the other way round than the operand, once that is right.
        reversed: bool,
    },
    /// The shell lies inside of the result or outside of it, with both sides: it is left out.
    Inside {
        /// Whether it was inside out in its operand.
        turned: bool,
    },
}

impl Fate {
    /// Whether rays and voxels have to decide.
    pub fn is_open(self) -> bool {
        self == Self::Open
    }
}

/// A winding number of open shells counts as whole when it is within this of one.
pub(super) const WHOLE: f64 = 0.2;

/// The fate of each shell. A shell stays as it is when it is closed and touches nothing, when nothing that is open lies inside of it, and
/// when the winding numbers around it are whole and, by operand, never negative; where they are negative, and nothing open lies
/// around it, all shells that are inside each other take turns: the outermost faces outwards, the next ones inwards, and so on. Where
/// surfaces count whichever way they face ([`Inside::needs_outward`]), negative numbers are as good as others, and no shell is turned over.
///
/// # Errors
/// Only a stop.
pub fn standing(
    mesh: &TriMesh,
    shells: &Shells,
    contacts: &Contacts,
    options: &StandingOptions<'_>,
    progress: &Progress,
) -> Result<Vec<Fate>, Stopped> {
    let count = shells.list.len();
    let touched = contacts.of_shells(count);
    let free = |n: usize| shells.list[n].kind == Kind::Closed && !touched[n] && shells.list[n].volume != 0.0;
    let mut fates = vec![Fate::Open; count];
    let free: Vec<usize> = (0..count).filter(|&n| free(n)).collect();
    if free.is_empty() {
        return Ok(fates);
    }
    let boxes = &Boxes::new(&shells.list);
    let scene = Scene { mesh, shells: &shells.list, free: &free, boxes, scale: scale_of_mesh(mesh), options };
    let mut holders = vec![false; count];
    for holder in scene.holders(progress)? {
        holders[holder] = true;
    }
    let places = scene.places(progress)?;
    let turns = scene.turns(&places, &holders);
    for (k, &n) in free.iter().enumerate() {
        if let Some(fate) = scene.fate(k, &places, &turns).filter(|_| !holders[n]) {
            fates[n] = fate;
        }
    }
    Ok(fates)
}

/// What lies around a free shell.
#[derive(Debug, Clone, Default)]
struct Surroundings {
    /// The free shells that it lies in, by their place in the list of free ones, ascending.
    within: Vec<usize>,
    /// Winding numbers of the other shells, an entry for each operand; `None` where they are not whole.
    others: Option<Vec<i32>>,
}

struct Scene<'a> {
    mesh: &'a TriMesh,
    shells: &'a [Shell],
    free: &'a [usize],
    boxes: &'a Boxes,
    scale: f64,
    options: &'a StandingOptions<'a>,
}

impl Scene<'_> {
    fn point(&self, shell: usize) -> DVec3 {
        self.mesh.corners(self.shells[shell].triangles[0] as usize)[0]
    }

    fn sign(shell: &Shell) -> i32 {
        if shell.volume > 0.0 { 1 } else { -1 }
    }

    fn is_free(&self, shell: usize) -> bool {
        self.free.binary_search(&shell).is_ok()
    }

    /// The free shells that some other shell lies in which is not free.
    fn holders(&self, progress: &Progress) -> Result<Vec<usize>, Stopped> {
        let others: Vec<usize> = (0..self.shells.len()).filter(|&n| !self.is_free(n)).collect();
        let holders_of = |&other: &usize| {
            progress.check()?;
            let p = self.point(other);
            let holds = |&n: &usize| self.is_free(n) && around(self.mesh, &self.shells[n], p, self.scale) != Some(0);
            Ok(self.boxes.around(p).into_iter().filter(holds).collect::<Vec<_>>())
        };
        Ok(others.par_iter().map(holders_of).collect::<Result<Vec<_>, Stopped>>()?.concat())
    }

    fn places(&self, progress: &Progress) -> Result<Vec<Surroundings>, Stopped> {
        let of = |&n: &usize| {
            progress.check()?;
            Ok(self.surroundings(n, self.point(n)))
        };
        self.free.par_iter().map(of).collect()
    }

    fn surroundings(&self, own: usize, p: DVec3) -> Surroundings {
        let mut within = Vec::new();
        let mut whole = vec![0i32; self.options.operands];
        let mut open = vec![0f64; self.options.operands];
        for n in self.boxes.around(p).into_iter().filter(|&n| n != own) {
            let shell = &self.shells[n];
            if !shell.balanced {
                open[shell.operand] += solid_angle(self.mesh, shell, p);
                continue;
            }
            match (around(self.mesh, shell, p, self.scale), self.free.binary_search(&n)) {
                (Some(0), _) => {}
                (Some(_), Ok(k)) => within.push(k),
                (Some(times), Err(_)) => whole[shell.operand] += times,
                (None, _) => return Surroundings::default(),
            }
        }
        let sure = open.iter().all(|w| (w - w.round()).abs() < WHOLE);
        let sum = whole.iter().zip(&open).map(|(n, w)| n + w.round() as i32).collect();
        Surroundings { within, others: sure.then_some(sum) }
    }

    /// For each free shell whether it is to be turned over; `None` where that is not known.
    fn turns(&self, places: &[Surroundings], holders: &[bool]) -> Vec<Option<bool>> {
        let shell = |k: usize| &self.shells[self.free[k]];
        let same = |k: usize| {
            let own = shell(k).operand;
            places[k].within.iter().copied().filter(move |&other| shell(other).operand == own)
        };
        // What lies around a shell by the others of its operand, and on both sides of it.
        let others = |k: usize| places[k].others.as_ref().map(|sum| sum[shell(k).operand]);
        let is_right = |k: usize| {
            others(k).map(|others| {
                let out = others + same(k).map(|other| Self::sign(shell(other))).sum::<i32>();
                !self.options.inside.needs_outward() || out.min(out + Self::sign(shell(k))) >= 0
            })
        };
        let root = |k: usize| same(k).min_by_key(|&other| places[other].within.len()).unwrap_or(k);
        let roots: Vec<usize> = (0..places.len()).map(root).collect();
        let mut trees = vec![Tree::default(); places.len()];
        for k in 0..places.len() {
            let tree = &mut trees[roots[k]];
            tree.wrong |= is_right(k) != Some(true);
            tree.unknown |= others(k) != Some(0) || holders[self.free[k]];
        }
        let turn = |k: usize| match trees[roots[k]] {
            Tree { wrong: false, .. } => Some(false),
            Tree { unknown: false, .. } if self.options.orient == OrientMode::Auto => {
                let outward = same(k).count().is_multiple_of(2);
                Some((Self::sign(shell(k)) > 0) != outward)
            }
            _ => None,
        };
        (0..places.len()).map(turn).collect()
    }

    fn fate(&self, k: usize, places: &[Surroundings], turns: &[Option<bool>]) -> Option<Fate> {
        let turned = turns[k]?;
        let sign =
            |k: usize| turns[k].map(|turned| Self::sign(&self.shells[self.free[k]]) * if turned { -1 } else { 1 });
        let mut winding = places[k].others.clone()?;
        for &other in &places[k].within {
            winding[self.shells[self.free[other]].operand] += sign(other)?;
        }
        let is_inside = |winding: &[i32]| {
            let inside: Vec<bool> = winding.iter().map(|&w| self.options.inside.holds(w)).collect();
            self.options.expression.evaluate(&inside)
        };
        let outer = is_inside(&winding);
        let sign = sign(k)?;
        winding[self.shells[self.free[k]].operand] += sign;
        let inner = is_inside(&winding);
        if outer == inner {
            return Some(Fate::Inside { turned });
        }
        // Outward is right where the inner side is the solid's.
        Some(Fate::Bounds { turned, reversed: inner != (sign > 0) })
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Tree {
    /// Some winding number in it is not known, or negative where it must not be.
    wrong: bool,
    /// Something open lies around it or in it.
    unknown: bool,
}
