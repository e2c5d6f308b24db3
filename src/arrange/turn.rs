//! Which shells of a closed input face the wrong way.

use super::cells::{Cells, Owner, steps};
use super::refine::Refined;
use crate::ldi::Operands;
use crate::mesh::TriMesh;
use crate::mesh::edges::{Edges, Union};

/// The triangles of several operands, and which of their shells are taken the other way round.
#[derive(Debug)]
pub(super) struct Turned<'a> {
    operands: &'a Operands,
    /// The shell of each triangle: what is joined through edges.
    shell: Vec<u32>,
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

    /// How many shells are turned over.
    pub(super) fn count(&self) -> usize {
        self.turned.iter().filter(|&&turned| turned).count()
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
        owner.shell = shells(mesh, operands);
        let shells = owner.shell.iter().max().map_or(0, |&last| last as usize + 1);
        owner.turned = vec![false; shells];
        let volumes = volumes(mesh, &owner.shell, shells);
        let operand_of = |shell: &[u32]| {
            let mut of = vec![0usize; shells];
            shell.iter().enumerate().for_each(|(t, &s)| of[s as usize] = operands.of(t as u32));
            of
        };
        let operand_of = operand_of(&owner.shell);
        // A file that is inside out as a whole.
        for operand in 0..count {
            let own = || winding.iter().skip(operand).step_by(count);
            if own().any(|&w| w < 0) && own().all(|&w| w <= 0) {
                (0..shells).filter(|&s| operand_of[s] == operand).for_each(|s| owner.turned[s] = true);
            }
        }
        let mut found = cells.winding(refined, count, &owner).unwrap_or(winding);
        for _ in 0..ROUNDS {
            if found.iter().all(|&w| w >= 0) {
                break;
            }
            let wrong = owner.beside_negative(refined, cells, &found);
            let turn: Vec<usize> = (0..shells).filter(|&s| wrong[s] && (volumes[s] < 0.0) != owner.turned[s]).collect();
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

/// The shell of each triangle, numbered by their first triangles.
fn shells(mesh: &TriMesh, operands: &Operands) -> Vec<u32> {
    let welded = mesh.welded();
    let edges = Edges::new(&welded.triangles, welded.positions.len());
    let mut union = Union::new(mesh.triangles.len());
    edges.each(|edge| {
        let mut first: Vec<(usize, u32)> = Vec::new();
        for t in edge.halves().map(|half| half / 3) {
            match first.iter().find(|entry| entry.0 == operands.of(t)) {
                Some(&(_, other)) => _ = union.join(other, t),
                None => first.push((operands.of(t), t)),
            }
        }
    });
    let mut number = vec![u32::MAX; mesh.triangles.len()];
    let mut count = 0;
    (0..mesh.triangles.len() as u32)
        .map(|t| {
            let root = union.root(t) as usize;
            if number[root] == u32::MAX {
                number[root] = count;
                count += 1;
            }
            number[root]
        })
        .collect()
}

/// The signed volume of each shell, as it is.
fn volumes(mesh: &TriMesh, shell: &[u32], shells: usize) -> Vec<f64> {
    let mut volumes = vec![0.0; shells];
    let centre = mesh.bounds().map_or(glam::DVec3::ZERO, |bounds| (bounds.min + bounds.max) / 2.0);
    for (t, &s) in shell.iter().enumerate() {
        let [a, b, c] = mesh.corners(t).map(|p| p - centre);
        volumes[s as usize] += a.dot(b.cross(c)) / 6.0;
    }
    volumes
}
