//! Consistent orientation within edge-connected patches.

use super::OrientMode;
use super::edges::sorted_half_edges;

/// The patches of a soup.
#[derive(Debug, Clone, Default)]
pub struct Patches {
    /// The patch of each triangle; patches are numbered by their first triangle.
    pub of: Vec<u32>,
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
    let neighbours = neighbours(triangles);
    let mut patches = Patches { of: vec![u32::MAX; triangles.len()], ..Patches::default() };
    let mut flip = vec![false; triangles.len()];
    let mut members = Vec::new();
    for seed in 0..triangles.len() {
        if patches.of[seed] != u32::MAX {
            continue;
        }
        members.clear();
        members.push(seed as u32);
        patches.of[seed] = patches.count as u32;
        let mut next = 0;
        while next < members.len() {
            let t = members[next] as usize;
            next += 1;
            for &(other, same_way) in &neighbours[t] {
                if other != u32::MAX && patches.of[other as usize] == u32::MAX {
                    patches.of[other as usize] = patches.count as u32;
                    flip[other as usize] = flip[t] != same_way;
                    members.push(other);
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
    if mode == OrientMode::Keep {
        return patches;
    }
    for (t, _) in triangles.iter_mut().zip(&flip).filter(|(_, flip)| **flip) {
        t.swap(1, 2);
    }
    patches.flipped = flip.iter().filter(|&&f| f).count();
    patches
}

/// For each triangle and side: the triangle across (`u32::MAX`: not exactly one), and whether it
/// runs along the edge the same way.
fn neighbours(triangles: &[[u32; 3]]) -> Vec<[(u32, bool); 3]> {
    let mut neighbours = vec![[(u32::MAX, false); 3]; triangles.len()];
    let half_edges = sorted_half_edges(triangles);
    for edge in half_edges.chunk_by(|a, b| a.ends == b.ends) {
        if let [a, b] = edge {
            let same_way = a.forward == b.forward;
            for (from, to) in [(a, b), (b, a)] {
                let free = neighbours[from.triangle as usize].iter_mut().find(|n| n.0 == u32::MAX);
                if let Some(free) = free {
                    *free = (to.triangle, same_way);
                }
            }
        }
    }
    neighbours
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(orient_patches(&mut triangles, &[false; 2], OrientMode::Auto).of, [0, 1]);
    }
}
