//! Bodies that touch others or have holes, and yet are no part of the result's surface, because they lie inside of it.

use glam::DVec3;
use rayon::prelude::*;

use super::boxes::Boxes;
use super::standing::WHOLE;
use super::winding::{around, solid_angle};
use super::{Contacts, Shells, StandingOptions};
use crate::mesh::TriMesh;
use crate::mesh::edges::Union;
use crate::mesh::predicates::scale_of_mesh;
use crate::progress::{Progress, Stopped};

/// At most so many operands of one group may be inside or not: each doubles the cases.
const MOST_OPEN: usize = 8;

/// For each shell whether it is one of a group of bodies that touch each other, or a body with holes, around which the result is the same
/// whatever the group adds: inside throughout, or outside. The winding numbers of the other shells there have to be whole, and, where surfaces
/// have to face outwards, not negative.
///
/// # Errors
/// Only a stop.
pub fn buried(
    mesh: &TriMesh,
    shells: &Shells,
    contacts: &Contacts,
    options: &StandingOptions<'_>,
    progress: &Progress,
) -> Result<Vec<bool>, Stopped> {
    let list = &shells.list;
    let mut union = Union::new(list.len());
    contacts.pairs.iter().for_each(|&[a, b]| _ = union.join(a, b));
    let group_of: Vec<usize> = (0..list.len() as u32).map(|n| union.root(n) as usize).collect();
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); list.len()];
    group_of.iter().enumerate().for_each(|(n, &group)| groups[group].push(n));
    let scene =
        Scene { mesh, shells, boxes: &Boxes::new(list), scale: scale_of_mesh(mesh), options, group_of: &group_of };
    let is = |(group, members): (usize, &Vec<usize>)| {
        progress.check()?;
        Ok(members.iter().all(|&n| list[n].is_body() && list[n].volume != 0.0) && scene.is_buried(group, members))
    };
    let is: Vec<bool> = groups.par_iter().enumerate().map(is).collect::<Result<_, Stopped>>()?;
    Ok(group_of.iter().map(|&group| is[group]).collect())
}

struct Scene<'a> {
    mesh: &'a TriMesh,
    shells: &'a Shells,
    boxes: &'a Boxes,
    scale: f64,
    options: &'a StandingOptions<'a>,
    group_of: &'a [usize],
}

impl Scene<'_> {
    fn is_buried(&self, group: usize, members: &[usize]) -> bool {
        let Some(&first) = members.first() else { return false };
        let p = self.mesh.corners(self.shells.list[first].triangles[0] as usize)[0];
        let Some(numbers) = self.numbers(group, p) else { return false };
        // How much the group takes away from the number of each operand, and adds to it, at most.
        let mut least = numbers.clone();
        let mut most = numbers;
        for shell in members.iter().map(|&n| &self.shells.list[n]) {
            let side = if shell.volume > 0.0 { &mut most } else { &mut least };
            side[shell.operand] += if shell.volume > 0.0 { 1 } else { -1 };
        }
        if self.options.inside.needs_outward() && least.iter().any(|&number| number < 0) {
            return false;
        }
        let holds = |number: i32| self.options.inside.holds(number);
        let mut inside: Vec<bool> = least.iter().map(|&number| holds(number)).collect();
        let several = |&k: &usize| (least[k]..=most[k]).any(|number| holds(number) != inside[k]);
        let open: Vec<usize> = (0..inside.len()).filter(several).collect();
        if open.len() > MOST_OPEN {
            return false;
        }
        let mut by = |case: usize| {
            open.iter().enumerate().for_each(|(bit, &k)| inside[k] = case >> bit & 1 == 1);
            self.options.expression.evaluate(&inside)
        };
        let first = by(0);
        (1..1usize << open.len()).all(|case| by(case) == first)
    }

    /// The winding number of each operand at `p`, without the group; `None` where one is not whole.
    fn numbers(&self, group: usize, p: DVec3) -> Option<Vec<i32>> {
        let mut whole = vec![0i32; self.options.operands];
        let mut open = vec![0f64; self.options.operands];
        for n in self.boxes.around(p).into_iter().filter(|&n| self.group_of[n] != group) {
            let shell = &self.shells.list[n];
            match shell.balanced {
                true => whole[shell.operand] += around(self.mesh, shell, p, self.scale)?,
                false => open[shell.operand] += solid_angle(self.mesh, shell, p),
            }
        }
        let sure = open.iter().all(|w| (w - w.round()).abs() < WHOLE);
        sure.then(|| whole.iter().zip(&open).map(|(n, w)| n + w.round() as i32).collect())
    }
}
