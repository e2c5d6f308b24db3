//! Which shells of a closed input face the wrong way.

use super::cells::{Cells, Owner, steps};
use super::refine::Refined;
use crate::ldi::Operands;
use crate::mesh::TriMesh;
use crate::shells::{Shells, shells};

/// The triangles of several operands, and which of their shells are taken the other way round.
#[derive(Debug)]
pub(super) struct Turned<'a> {
    operands: &'a Operands,
    /// The shell of each triangle: what is joined through edges.
    shell: Vec<u32>,
    /// For each shell whether it is turned over.
    turned: Vec<bool>,
}

impl Owner for Turned<'_> {
    fn operand(&self, triangle: u32) -> u32 {
        self.operands.of(triangle) as u32
    }

    fn is_turned(&self, triangle: u32) -> bool {
        self.turned[self.shell[triangle as usize] as usize]
    }
}

/// At most so many times shells are turned over and looked at again.
const ROUNDS: usize = 4;

impl<'a> Turned<'a> {
    /// All triangles as they are.
    pub(super) fn none(operands: &'a Operands, triangles: usize) -> Self {
        Self { operands, shell: vec![0; triangles], turned: vec![false] }
    }

    /// For each operand how many of its shells are turned over, and how many triangles these have.
    pub(super) fn counts(&self) -> (Vec<usize>, Vec<usize>) {
        let (mut shells, mut triangles) = (vec![0; self.operands.count()], vec![0; self.operands.count()]);
        let mut counted = vec![false; self.turned.len()];
        for (t, &shell) in (0..).zip(&self.shell).filter(|&(_, &shell)| self.turned[shell as usize]) {
            let operand = self.operands.of(t);
            triangles[operand] += 1;
            shells[operand] += usize::from(!std::mem::replace(&mut counted[shell as usize], true));
        }
        (shells, triangles)
    }

    /// Turns over what makes winding numbers negative, so that none is, if that can be: of operands that have such numbers, all shells, or those that
    /// enclose a negative volume and border on them. Returns the winding numbers.
    pub(super) fn outward(
        mesh: &TriMesh,
        operands: &'a Operands,
        (refined, cells): (&Refined, &Cells),
        winding: Vec<i32>,
    ) -> (Self, Vec<i32>) {
        let count = operands.count();
        let mut owner = Self::none(operands, mesh.triangles.len());
        if winding.iter().all(|&w| w >= 0) {
            return (owner, winding);
        }
        let Shells { of, list } = shells_of(mesh, operands);
        (owner.shell, owner.turned) = (of, vec![false; list.len()]);
        // A file that is inside out as a whole.
        for operand in 0..count {
            let own = || winding.iter().skip(operand).step_by(count);
            if own().any(|&w| w < 0) && own().all(|&w| w <= 0) {
                (0..list.len()).filter(|&s| list[s].operand == operand).for_each(|s| owner.turned[s] = true);
            }
        }
        let mut found = cells.winding(refined, count, &owner).unwrap_or(winding);
        for _ in 0..ROUNDS {
            if found.iter().all(|&w| w >= 0) {
                break;
            }
            let wrong = owner.beside_negative(refined, cells, &found);
            let turn: Vec<usize> =
                (0..list.len()).filter(|&s| wrong[s] && (list[s].volume < 0.0) != owner.turned[s]).collect();
            if turn.is_empty() {
                break;
            }
            turn.into_iter().for_each(|s| owner.turned[s] ^= true);
            match cells.winding(refined, count, &owner) {
                Some(winding) => found = winding,
                None => break,
            }
        }
        (owner, found)
    }

    /// For each shell whether a piece of it borders on a cell that its operand winds around a negative number of times.
    fn beside_negative(&self, refined: &Refined, cells: &Cells, winding: &[i32]) -> Vec<bool> {
        let count = self.operands.count();
        let mut wrong = vec![false; self.turned.len()];
        for (piece, sides) in (0..).zip(&cells.beside) {
            let negative =
                |operand: u32| sides.iter().any(|&cell| winding[cell as usize * count + operand as usize] < 0);
            let mut any = false;
            steps(refined, piece, self, |operand, _| any |= negative(operand));
            if any {
                for cover in refined.covers(&refined.pieces[piece as usize]) {
                    wrong[self.shell[cover.triangle as usize] as usize] |= negative(self.operand(cover.triangle));
                }
            }
        }
        wrong
    }
}

/// The shells of operands, whose vertices are merged within each.
fn shells_of(mesh: &TriMesh, operands: &Operands) -> Shells {
    let mut merged = TriMesh::default();
    for operand in 0..operands.count() {
        let triangles = mesh.triangles[operands.range(operand)].to_vec();
        merged.append(&TriMesh { positions: mesh.positions.clone(), triangles }.welded());
    }
    shells(&merged, operands)
}
