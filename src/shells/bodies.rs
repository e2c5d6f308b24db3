//! Which shells make a body together: an outer one, and the voids in it.

use rayon::prelude::*;

use super::boxes::Boxes;
use super::winding::around;
use super::{Shell, Shells};
use crate::mesh::TriMesh;
use crate::mesh::predicates::scale_of_mesh;
use crate::progress::{Progress, Stopped};

/// The shells that make each body, by number, the outer one first. A balanced shell that faces inwards is a void of the smallest one
/// that it lies in and that faces outwards; every other shell, open ones too, is a body of its own. Bodies are in the order of
/// their outer shells.
///
/// # Errors
/// Only a stop.
pub fn bodies(mesh: &TriMesh, shells: &Shells, progress: &Progress) -> Result<Vec<Vec<usize>>, Stopped> {
    let list = &shells.list;
    let boxes = Boxes::new(list);
    let scale = scale_of_mesh(mesh);
    let holds = |outer: &Shell, shell: &Shell| {
        let p = mesh.corners(shell.triangles[0] as usize)[0];
        around(mesh, outer, p, scale).is_some_and(|times| times != 0)
    };
    let holder = |n: usize| -> Result<Option<usize>, Stopped> {
        progress.check()?;
        let shell = &list[n];
        if !shell.balanced || shell.volume >= 0.0 {
            return Ok(None);
        }
        let p = mesh.corners(shell.triangles[0] as usize)[0];
        let outer = boxes.around(p).into_iter().filter(|&m| m != n && list[m].balanced && list[m].volume > 0.0);
        Ok(outer
            .filter(|&m| list[m].volume > -shell.volume && holds(&list[m], shell))
            .min_by(|&a, &b| list[a].volume.total_cmp(&list[b].volume)))
    };
    let holders: Vec<Option<usize>> = (0..list.len()).into_par_iter().map(holder).collect::<Result<_, Stopped>>()?;
    let mut of: Vec<Vec<usize>> = (0..list.len()).map(|n| vec![n]).collect();
    for (n, holder) in holders.iter().enumerate() {
        if let Some(holder) = holder {
            of[*holder].push(n);
        }
    }
    Ok(of.into_iter().zip(&holders).filter(|(_, holder)| holder.is_none()).map(|(body, _)| body).collect())
}
