//! Which triangles are the outer surface.

use super::{Sight, Sights};
use crate::mesh::TriMesh;
use crate::mesh::neighbours::Neighbours;
use crate::orient::PatchId;

/// What a triangle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// It is the outer surface: on one side of it is the outside.
    Outer,
    /// It bounds chambers alone, or nothing that a ball comes near.
    Inner,
    /// The outside is on both sides of it.
    Sheet,
}

/// What the triangles of a soup are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Parts {
    /// Of each triangle.
    pub of: Vec<Part>,
    /// For each triangle whether its outside is on its back.
    pub turned: Vec<bool>,
}

/// Decides, patch by patch, what triangles are. The triangles of a patch agree about their sides; its outside is on the side that more of its area shows to the outside.
///
/// A triangle that shows that side to the outside is the outer surface, and one that shows it to a chamber is not. What shows it to neither, the bottom of a groove or the
/// wall of a pinhole, is what is beside: outer surface where nothing inner is; where it leads from one to the other it is a passage that the ball does not pass, and goes. A patch that nowhere shows itself to
/// the outside goes.
pub fn judge(mesh: &TriMesh, patch_of: &[PatchId], patches: usize, sights: &[Sights]) -> Parts {
    let mut shown = vec![[0.0; 2]; patches];
    let mut is_seen = vec![false; patches];
    for (t, sight) in sights.iter().enumerate() {
        let [a, b, c] = mesh.corners(t);
        let area = (b - a).cross(c - a).length();
        let sides = [sight.front, sight.back].map(|sight| sight == Sight::Outside);
        let patch = patch_of[t].index();
        is_seen[patch] |= sides[0] || sides[1];
        if sides[0] != sides[1] {
            shown[patch][usize::from(sides[1])] += area;
        }
    }
    let mut turned: Vec<bool> =
        patch_of.iter().map(|patch| shown[patch.index()]).map(|[front, back]| back > front).collect();
    let mut part = |(t, sight): (usize, &Sights)| {
        let patch = patch_of[t].index();
        if !is_seen[patch] {
            return Some(Part::Inner);
        }
        let Sights { front, back } = *sight;
        let (front, back) = if turned[t] { (back, front) } else { (front, back) };
        match (front, back) {
            // The patch does not agree about its sides, but here there is no doubt.
            (Sight::Chamber, Sight::Outside) => {
                turned[t] = !turned[t];
                Some(Part::Outer)
            }
            (_, Sight::Outside) => Some(Part::Sheet),
            (Sight::Outside, _) => Some(Part::Outer),
            (Sight::Chamber, _) => Some(Part::Inner),
            (Sight::Nowhere, _) => None,
        }
    };
    let mut of: Vec<Option<Part>> = sights.iter().enumerate().map(&mut part).collect();
    settle(&mut of, mesh, patch_of);
    Parts { of: of.into_iter().map(|part| part.unwrap_or(Part::Inner)).collect(), turned }
}

/// Decides about what hangs together undecided, by what is beside it in its patch.
fn settle(of: &mut [Option<Part>], mesh: &TriMesh, patch_of: &[PatchId]) {
    let neighbours = Neighbours::new(&mesh.triangles, mesh.positions.len());
    let mut seen: Vec<bool> = of.iter().map(|part| part.is_some()).collect();
    for first in 0..of.len() {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        let (mut members, mut next) = (vec![first as u32], 0);
        let [mut outer, mut inner, mut sheet] = [false; 3];
        while let Some(&t) = members.get(next) {
            next += 1;
            let beside = (0..3).filter_map(|k| neighbours.across(t, k));
            for other in beside.map(|across| across.triangle).filter(|&n| patch_of[n as usize] == patch_of[t as usize])
            {
                match of[other as usize] {
                    Some(Part::Outer) => outer = true,
                    Some(Part::Inner) => inner = true,
                    Some(Part::Sheet) => sheet = true,
                    None if !seen[other as usize] => {
                        seen[other as usize] = true;
                        members.push(other);
                    }
                    None => {}
                }
            }
        }
        let part = match (inner, outer, sheet) {
            (true, ..) => Part::Inner,
            (false, true, _) => Part::Outer,
            (false, false, true) => Part::Sheet,
            _ => Part::Inner,
        };
        members.iter().for_each(|&t| of[t as usize] = Some(part));
    }
}
