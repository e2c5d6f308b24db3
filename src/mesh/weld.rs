//! Vertices of equal coordinates as one.

use std::hash::{BuildHasher, Hash};
use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxBuildHasher, FxHashMap};

use super::TriMesh;
use super::parted::{CHUNK, Parted};

/// Items whose keys have the same hash in some bits are looked at together: so many kinds of bits there are.
const SHARDS: usize = 1 << 10;

/// For each of `count` items the first one with an equal key, which all threads look for: items are sorted by some bits of their keys' hash, so that
/// each part has its own small table. The result depends on the keys alone.
pub(crate) fn first_of_equal_keys<K: Copy + Eq + Hash>(count: usize, key: impl Fn(usize) -> K + Sync) -> Vec<u32> {
    if count < CHUNK {
        let mut first = FxHashMap::with_capacity_and_hasher(count, FxBuildHasher);
        return (0..count).map(|n| *first.entry(key(n)).or_insert(n as u32)).collect();
    }
    // The table takes its own bits from either end of the same hash.
    let shard = |n: usize| (FxBuildHasher.hash_one(key(n)) >> 20) as usize % SHARDS;
    let parted = Parted::new(count, SHARDS, |n| Some(shard(n)));
    let first: Vec<AtomicU32> = (0..count).into_par_iter().map(|_| AtomicU32::new(0)).collect();
    (0..SHARDS).into_par_iter().for_each(|s| {
        let mut known = FxHashMap::default();
        for n in parted.of(s) {
            first[n].store(*known.entry(key(n)).or_insert(n as u32), Ordering::Relaxed);
        }
    });
    first.into_iter().map(AtomicU32::into_inner).collect()
}

/// For each vertex the first one with exactly equal coordinates (−0 equals 0).
pub(crate) fn first_of_equal(positions: &[DVec3]) -> Vec<u32> {
    first_of_equal_keys(positions.len(), |v| (positions[v] + 0.0).to_array().map(f64::to_bits))
}

/// The triangles of `mesh` with each vertex replaced by the first one with equal coordinates.
pub(crate) fn welded_triangles(mesh: &TriMesh) -> Vec<[u32; 3]> {
    let first = first_of_equal(&mesh.positions);
    mesh.triangles.par_iter().map(|t| t.map(|v| first[v as usize])).collect()
}

impl TriMesh {
    /// The same surface with vertices of equal coordinates merged (−0 equals 0) and unused ones
    /// dropped; triangles keep their order and number. Vertices are numbered by first use.
    pub fn welded(&self) -> Self {
        const NONE: u32 = u32::MAX;
        let first = first_of_equal(&self.positions);
        let (mut numbers, mut positions) = (vec![NONE; first.len()], Vec::new());
        let mut weld = |v: u32| {
            let number = &mut numbers[first[v as usize] as usize];
            if *number == NONE {
                *number = positions.len() as u32;
                positions.push(self.positions[v as usize]);
            }
            *number
        };
        let triangles = self.triangles.iter().map(|t| t.map(&mut weld)).collect();
        Self { positions, triangles }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_keys_is_found_in_many_as_in_few() {
        // Every seventh and some far ones repeat.
        let key = |n: usize| (n % 7 * 1000 + n / 50, n.is_multiple_of(3));
        for count in [0, 1, 1000, CHUNK - 1, CHUNK, 3 * CHUNK + 5] {
            let mut known = std::collections::BTreeMap::new();
            let expected: Vec<u32> = (0..count).map(|n| *known.entry(key(n)).or_insert(n as u32)).collect();
            assert!(first_of_equal_keys(count, key) == expected, "{count}");
        }
    }
}
