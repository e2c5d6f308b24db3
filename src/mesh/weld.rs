//! Vertices of equal coordinates as one.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::TriMesh;

/// For each vertex the first one with exactly equal coordinates (−0 equals 0).
pub(crate) fn first_of_equal(positions: &[DVec3]) -> Vec<u32> {
    let mut first = FxHashMap::with_capacity_and_hasher(positions.len(), Default::default());
    (0u32..).zip(positions).map(|(v, p)| *first.entry((*p + 0.0).to_array().map(f64::to_bits)).or_insert(v)).collect()
}

/// The triangles of `mesh` with each vertex replaced by the first one with equal coordinates.
pub(crate) fn welded_triangles(mesh: &TriMesh) -> Vec<[u32; 3]> {
    let first = first_of_equal(&mesh.positions);
    mesh.triangles.iter().map(|t| t.map(|v| first[v as usize])).collect()
}

/// Whether a triangle names a vertex twice.
#[inline]
pub(crate) fn has_repeated_index([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// The vertices in increasing order, and whether that is an even permutation.
pub(crate) fn canonical(t: [u32; 3]) -> ([u32; 3], bool) {
    let mut s = t;
    s.sort_unstable();
    let even = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].iter().any(|p| [t[p[0]], t[p[1]], t[p[2]]] == s);
    (s, even)
}
