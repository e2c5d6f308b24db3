//! Consistent orientation within edge-connected patches.

use super::OrientMode;
use crate::mesh::neighbours::{Across, Neighbours};

/// A triangle that no patch has reached yet.
const UNSEEN: u32 = u32::MAX;

/// The number of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PatchId(u32);

impl PatchId {
    /// The first patch.
    pub const FIRST: Self = Self(0);

    /// The place of the patch among all patches.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The number that the patch has when `count` others come before it.
    pub fn after(self, count: usize) -> Self {
        Self(self.0 + count as u32)
    }
}

/// The patches of a soup: triangles that are connected through edges which exactly two of them share.
#[derive(Debug, Clone, Default)]
pub struct Patches {
    /// The patch of each triangle; patches are numbered by their first triangle.
    pub of: Vec<PatchId>,
    /// Number of patches.
    pub count: usize,
    /// Triangles that were turned over.
    pub flipped: usize,
}

/// Finds the patches (triangles connected through edges that exactly two triangles share) and turns
/// triangles over so that the two triangles of such an edge run along it in opposite ways. Of the
/// two orientations of a patch the one that turns over fewer triangles is taken; `unoriented`
/// triangles have no say. A patch that cannot be oriented (a Möbius strip) keeps a seam.
/// With [`OrientMode::Keep`] the patches are found but nothing is turned over.
pub fn orient_patches(triangles: &mut [[u32; 3]], unoriented: &[bool], mode: OrientMode) -> Patches {
    let vertices = triangles.iter().flatten().max().map_or(0, |&v| v as usize + 1);
    let neighbours = Neighbours::new(triangles, vertices);
    let mut patches = Patches::default();
    let mut of = vec![UNSEEN; triangles.len()];
    let mut flip = vec![false; triangles.len()];
    let mut members = Vec::new();
    for seed in 0..triangles.len() {
        if of[seed] != UNSEEN {
            continue;
        }
        members.clear();
        members.push(seed as u32);
        of[seed] = patches.count as u32;
        let mut next = 0;
        while next < members.len() {
            let t = members[next] as usize;
            next += 1;
            for Across { triangle, turned } in beside(triangles, &neighbours, t) {
                let other = triangle as usize;
                if of[other] == UNSEEN {
                    of[other] = patches.count as u32;
                    flip[other] = flip[t] != turned;
                    members.push(triangle);
                }
            }
        }
        let voters = members.iter().filter(|&&t| !unoriented[t as usize]);
        let against = voters.clone().filter(|&&t| flip[t as usize]).count();
        if 2 * against > voters.count() {
            members.iter().for_each(|&t| flip[t as usize] = !flip[t as usize]);
        }
        patches.count += 1;
    }
    patches.of = of.into_iter().map(PatchId).collect();
    if mode == OrientMode::Keep {
        return patches;
    }
    for (t, _) in triangles.iter_mut().zip(&flip).filter(|(_, flip)| **flip) {
        t.swap(1, 2);
    }
    patches.flipped = flip.iter().filter(|&&f| f).count();
    patches
}

/// The neighbours of a triangle, in the order of the edges between them.
fn beside(triangles: &[[u32; 3]], neighbours: &Neighbours, t: usize) -> impl Iterator<Item = Across> {
    let mut edges = [0, 1, 2];
    edges.sort_unstable_by_key(|&k| {
        let (a, b) = (triangles[t][k], triangles[t][(k + 1) % 3]);
        (a.min(b), a.max(b))
    });
    edges.into_iter().filter_map(move |k| neighbours.across(t as u32, k))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::edges::Edges;

    #[test]
    fn a_flipped_triangle_of_a_tetrahedron_is_turned_back() {
        let mut triangles = vec![[0, 2, 1], [0, 1, 3], [3, 2, 1], [0, 3, 2]];
        let patches = orient_patches(&mut triangles, &[false; 4], OrientMode::Auto);
        assert_eq!((patches.count, patches.flipped), (1, 1));
        assert_eq!(triangles, [[0, 2, 1], [0, 1, 3], [3, 1, 2], [0, 3, 2]]);
    }

    #[test]
    fn triangles_that_share_only_a_vertex_are_two_patches() {
        let mut triangles = vec![[0, 1, 2], [2, 3, 4]];
        assert_eq!(orient_patches(&mut triangles, &[false; 2], OrientMode::Auto).of, [0, 1].map(PatchId));
    }

    #[test]
    fn patches_that_meet_only_in_an_edge_of_four_triangles_stay_apart() {
        // Two tetrahedra on the edge 0-1, the second one inside out.
        let mut triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        triangles.extend([[0, 1, 4], [0, 5, 1], [1, 5, 4], [0, 4, 5]]);
        let before = triangles.clone();
        let patches = orient_patches(&mut triangles, &[false; 8], OrientMode::Auto);
        assert_eq!(patches.of, [0, 0, 0, 0, 1, 1, 1, 1].map(PatchId));
        assert_eq!((patches.count, patches.flipped), (2, 0));
        assert_eq!(triangles, before);
    }

    #[test]
    fn a_moebius_strip_is_one_patch_and_keeps_one_seam() {
        // Vertices 2i below and 2i + 1 above; the last quad joins on upside down.
        let n = 8;
        let at = |i: u32, side: u32| if i < n { 2 * i + side } else { 1 - side };
        let quad = |i: u32| [[at(i, 0), at(i + 1, 0), at(i + 1, 1)], [at(i, 0), at(i + 1, 1), at(i, 1)]];
        let mut triangles: Vec<[u32; 3]> = (0..n).flat_map(quad).collect();
        triangles[5].swap(1, 2);
        let patches = orient_patches(&mut triangles, &[false; 16], OrientMode::Auto);
        assert_eq!(patches.count, 1);
        let edges = Edges::new(&triangles, 2 * n as usize);
        let mut seams = 0;
        edges.each(|edge| {
            let up = edge.halves().filter(|&half| edges.runs_up(half)).count();
            seams += usize::from(edge.count() == 2 && up != 1);
        });
        assert_eq!(seams, 1);
    }

    #[test]
    fn unoriented_triangles_have_no_say_and_keep_turns_nothing() {
        let wrong = [[0, 1, 2], [0, 3, 1], [3, 2, 1], [0, 3, 2]];
        let mut triangles = wrong.to_vec();
        // Three of four are turned, but only the fourth counts.
        let patches = orient_patches(&mut triangles, &[true, true, true, false], OrientMode::Auto);
        assert_eq!(patches.flipped, 3);
        assert_eq!(triangles[3], [0, 3, 2]);
        let mut kept = wrong.to_vec();
        assert_eq!(orient_patches(&mut kept, &[false; 4], OrientMode::Keep).flipped, 0);
        assert_eq!(kept, wrong);
    }
}
