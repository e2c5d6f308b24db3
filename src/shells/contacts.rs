//! Which triangles and which shells touch others.

use rustc_hash::FxHashSet;

use super::Shells;
use crate::mesh::weld::first_of_equal;
use crate::mesh::{TriMesh, flat_triangles, intersecting_groups};
use crate::progress::{Progress, Stopped};

/// Which triangles and shells of a soup touch others.
#[derive(Debug, Clone, Default)]
pub struct Contacts {
    /// For each triangle, whether it meets another one, has no area, or has a corner where another vertex is, too.
    pub touched: Vec<bool>,
    /// Pairs of shells of which triangles touch, the smaller number first; a shell that touches itself is a pair with itself.
    /// Sorted.
    pub pairs: Vec<[u32; 2]>,
}

impl Contacts {
    /// For each of `count` shells, whether it touches anything.
    pub fn of_shells(&self, count: usize) -> Vec<bool> {
        let mut touched = vec![false; count];
        self.pairs.iter().flatten().for_each(|&shell| touched[shell as usize] = true);
        touched
    }
}

/// Finds all contacts, exactly. `mesh` may have coordinates that differ from those of which the shells were made (rounded ones): what
/// rounding lets touch is found, too.
pub fn contacts(mesh: &TriMesh, shells: &Shells, progress: &Progress) -> Result<Contacts, Stopped> {
    let met = intersecting_groups(mesh, &shells.of, progress)?;
    let mut touched = vec![false; mesh.triangles.len()];
    met.triangles.iter().for_each(|&t| touched[t as usize] = true);
    let mut pairs: FxHashSet<[u32; 2]> = met.pairs.into_iter().collect();
    for t in flat_triangles(mesh) {
        touched[t as usize] = true;
        pairs.insert([shells.of[t as usize]; 2]);
    }
    at_one_place(mesh, shells, &mut touched, &mut pairs);
    let mut pairs: Vec<[u32; 2]> = pairs.into_iter().collect();
    pairs.sort_unstable();
    Ok(Contacts { touched, pairs })
}

/// Vertices that have a number each and one place: formats without numbers make one of them.
fn at_one_place(mesh: &TriMesh, shells: &Shells, touched: &mut [bool], pairs: &mut FxHashSet<[u32; 2]>) {
    let first = first_of_equal(&mesh.positions);
    // The vertex and the shell that came first at each place.
    let mut owner: Vec<Option<(u32, u32)>> = vec![None; mesh.positions.len()];
    let mut shared = vec![false; mesh.positions.len()];
    for (corners, &shell) in mesh.triangles.iter().zip(&shells.of) {
        for &v in corners {
            let place = first[v as usize] as usize;
            let (vertex, other) = *owner[place].get_or_insert((v, shell));
            if vertex != v {
                shared[place] = true;
                pairs.insert([shell.min(other), shell.max(other)]);
            }
        }
    }
    for (corners, touched) in mesh.triangles.iter().zip(touched) {
        *touched |= corners.iter().any(|&v| shared[first[v as usize] as usize]);
    }
}
