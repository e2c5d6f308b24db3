//! The closed surfaces of a mesh, measured one by one.

use crate::mesh::edges::Union;
use crate::mesh::{TriMesh, ValidateOptions, Validity, validate};
use crate::progress::{Progress, Stopped};

/// A surface of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMeasures {
    /// Its measures, without a search for intersections.
    pub validity: Validity,
}

/// The surfaces of a mesh, those of the largest box first, at most `most` of them; and how many there are.
pub fn bodies_of(mesh: &TriMesh, most: usize, progress: &Progress) -> Result<(Vec<BodyMeasures>, usize), Stopped> {
    let mut sets = Union::of_triangles(mesh.positions.len(), mesh.triangles.iter().copied());
    let mut lists: Vec<Vec<u32>> = Vec::new();
    let mut number = vec![u32::MAX; mesh.positions.len()];
    for (t, corners) in (0u32..).zip(&mesh.triangles) {
        let number = &mut number[sets.root(corners[0]) as usize];
        if *number == u32::MAX {
            *number = lists.len() as u32;
            lists.push(Vec::new());
        }
        lists[*number as usize].push(t);
    }
    let all = lists.len();
    // A stable order: by triangles, then as they come.
    lists.sort_by_key(|list| std::cmp::Reverse(list.len()));
    lists.truncate(most);
    let measured = |list: &Vec<u32>| {
        let options = ValidateOptions { self_intersections: false, weld: false };
        Ok(BodyMeasures { validity: validate(&mesh.submesh(list).mesh, &options, progress)? })
    };
    let mut bodies: Vec<BodyMeasures> = lists.iter().map(measured).collect::<Result<_, Stopped>>()?;
    bodies.sort_by(|a, b| b.validity.volume.abs().total_cmp(&a.validity.volume.abs()));
    Ok((bodies, all))
}
