//! Exact cleaning: degenerate triangles, repetitions, and triangles present in both orientations.

use glam::DVec3;
use rayon::prelude::*;

use super::edges::{UNIQUE_EDGE_LIMIT, sorted_half_edges};
use crate::mesh::TriMesh;

/// The soup after cleaning.
#[derive(Debug, Clone, Default)]
pub struct Cleaned {
    /// The triangles that are left, over vertices merged where their coordinates are equal.
    pub mesh: TriMesh,
    /// For each of them, its number in the input.
    pub source: Vec<u32>,
    /// For each of them, whether the input has it equally often in both orientations.
    pub unoriented: Vec<bool>,
    /// Triangles without area or with a repeated vertex, dropped.
    pub degenerate: usize,
    /// Repetitions dropped.
    pub duplicates: usize,
    /// Triangles that were there in both orientations.
    pub both_sided: usize,
}

/// Merges vertices of equal coordinates, drops triangles without area, and keeps one of each set
/// of triangles over the same three vertices, in the orientation that most of the set have.
/// Both-sided triangles that only separate two bodies that are closed without them (a membrane
/// between boxes that share a face) are dropped altogether.
pub fn clean(input: &TriMesh) -> Cleaned {
    let welded = input.welded();
    let mut keyed: Vec<([u32; 3], u32)> = (0..welded.triangles.len() as u32)
        .into_par_iter()
        .filter(|&t| has_area(&welded, t))
        .map(|t| (canonical(welded.triangles[t as usize]).0, t))
        .collect();
    let degenerate = welded.triangles.len() - keyed.len();
    keyed.par_sort_unstable();
    let with_area = keyed.len();
    let mut kept: Vec<(u32, bool, bool)> = Vec::with_capacity(with_area);
    for same in keyed.chunk_by(|a, b| a.0 == b.0) {
        let even = |&&(_, t): &&([u32; 3], u32)| canonical(welded.triangles[t as usize]).1;
        let forward = same.iter().filter(even).count();
        let wanted = 2 * forward >= same.len();
        let first = same.iter().find(|entry| even(entry) == wanted).unwrap_or(&same[0]).1;
        kept.push((first, 2 * forward == same.len(), forward != 0 && forward != same.len()));
    }
    kept.sort_unstable();
    let mut cleaned = Cleaned {
        degenerate,
        duplicates: with_area - kept.len(),
        both_sided: kept.iter().filter(|k| k.2).count(),
        ..Cleaned::default()
    };
    cleaned.mesh.positions = welded.positions;
    cleaned.mesh.triangles = kept.iter().map(|k| welded.triangles[k.0 as usize]).collect();
    cleaned.source = kept.iter().map(|k| k.0).collect();
    cleaned.unoriented = kept.iter().map(|k| k.1).collect();
    drop_membranes(&mut cleaned);
    cleaned
}

/// Whether triangle `t` has three different vertices that are not on one line.
fn has_area(mesh: &TriMesh, t: u32) -> bool {
    let [a, b, c] = mesh.corners(t as usize);
    let n = (b - a).cross(c - a);
    n != DVec3::ZERO && n.is_finite()
}

/// The vertices in increasing order, and whether that is an even permutation.
fn canonical(t: [u32; 3]) -> ([u32; 3], bool) {
    let mut s = t;
    s.sort_unstable();
    let even = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].iter().any(|p| [t[p[0]], t[p[1]], t[p[2]]] == s);
    (s, even)
}

/// Drops groups of both-sided triangles whose rims are closed without them.
fn drop_membranes(cleaned: &mut Cleaned) {
    if !cleaned.unoriented.contains(&true) {
        return;
    }
    let half_edges = sorted_half_edges(&cleaned.mesh.triangles);
    let mut group: Vec<u32> = (0..cleaned.mesh.triangles.len() as u32).collect();
    for edge in half_edges.chunk_by(|a, b| a.ends == b.ends) {
        let mut sided = edge.iter().filter(|h| cleaned.unoriented[h.triangle as usize]).map(|h| h.triangle);
        if let Some(first) = sided.next() {
            sided.for_each(|t| join(&mut group, first, t));
        }
    }
    // A rim edge with an even number of other triangles speaks for dropping the group.
    let mut balance = vec![0i64; group.len()];
    for edge in half_edges.chunk_by(|a, b| a.ends == b.ends).filter(|edge| edge.len() <= UNIQUE_EDGE_LIMIT) {
        let others = edge.iter().filter(|h| !cleaned.unoriented[h.triangle as usize]).count();
        for h in edge.iter().filter(|h| cleaned.unoriented[h.triangle as usize]) {
            if others > 0 {
                balance[root(&mut group, h.triangle) as usize] += if others % 2 == 0 { 1 } else { -1 };
            }
        }
    }
    let drop: Vec<bool> =
        (0..group.len()).map(|t| cleaned.unoriented[t] && balance[root(&mut group, t as u32) as usize] > 0).collect();
    let keep = |t: &usize| !drop[*t];
    let all = 0..drop.len();
    cleaned.mesh.triangles = all.clone().filter(keep).map(|t| cleaned.mesh.triangles[t]).collect();
    cleaned.source = all.clone().filter(keep).map(|t| cleaned.source[t]).collect();
    cleaned.unoriented = all.filter(keep).map(|t| cleaned.unoriented[t]).collect();
}

/// Root of `t` in a union-find forest, with path halving.
pub(super) fn root(forest: &mut [u32], mut t: u32) -> u32 {
    while forest[t as usize] != t {
        let up = forest[forest[t as usize] as usize];
        forest[t as usize] = up;
        t = up;
    }
    t
}

/// Joins the sets of `a` and `b`; the smaller root stays.
pub(super) fn join(forest: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(forest, a), root(forest, b));
    forest[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> TriMesh {
        TriMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        }
    }

    #[test]
    fn repetitions_and_flat_triangles_go_and_a_reversed_copy_marks_its_triangle() {
        let mut mesh = tetrahedron();
        mesh.triangles.extend([[1, 0, 2], [3, 1, 2], [1, 1, 2], [0, 3, 2], [2, 3, 0]]);
        let cleaned = clean(&mesh);
        assert_eq!(cleaned.mesh.triangles.len(), 4);
        assert_eq!((cleaned.degenerate, cleaned.duplicates, cleaned.both_sided), (1, 4, 1));
        // [0,3,2] was there twice, its reverse [2,3,0] once: the majority decides.
        assert!(!cleaned.unoriented.contains(&true));
    }

    #[test]
    fn a_membrane_between_two_closed_bodies_goes() {
        let mut mesh = tetrahedron();
        // A second tetrahedron on the other side of face [1,2,3], which both have.
        mesh.positions.push(DVec3::ONE);
        mesh.triangles.extend([[1, 3, 2], [4, 3, 1], [4, 1, 2], [4, 2, 3]]);
        let cleaned = clean(&mesh);
        assert_eq!(cleaned.mesh.triangles.len(), 6);
        assert_eq!(cleaned.both_sided, 1);
    }
}
