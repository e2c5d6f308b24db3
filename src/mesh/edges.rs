//! The edges of a soup and what hangs together over them.

use rayon::prelude::*;

use super::weld::has_repeated_index;

/// Items sorted by a small key, without a comparison sort: offsets and items.
pub(crate) struct Buckets {
    start: Vec<u32>,
    items: Vec<u64>,
}

impl Buckets {
    /// Sorts `items` (key below `keys`, payload) by key, then payload. Each thread goes through all of them for a range of keys of its own.
    pub(crate) fn new(keys: usize, items: impl Iterator<Item = (u32, u64)> + Clone + Sync) -> Self {
        let parts = if keys < FEW { 1 } else { rayon::current_num_threads().clamp(1, MOST_PARTS) };
        let each = keys.div_ceil(parts).max(1);
        let mut start = vec![0u32; keys + 1];
        start[1..].par_chunks_mut(each).enumerate().for_each(|(part, counts)| {
            let first = part * each;
            for (key, _) in items.clone() {
                if let Some(count) = counts.get_mut((key as usize).wrapping_sub(first)) {
                    *count += 1;
                }
            }
        });
        for k in 0..keys {
            start[k + 1] += start[k];
        }
        let mut sorted = vec![0u64; start[keys] as usize];
        let mut parts: Vec<(usize, Vec<u32>, &mut [u64])> = Vec::new();
        let mut rest = sorted.as_mut_slice();
        for first in (0..keys).step_by(each) {
            let end = (first + each).min(keys);
            let (mine, others) = rest.split_at_mut((start[end] - start[first]) as usize);
            parts.push((first, start[first..end].to_vec(), mine));
            rest = others;
        }
        parts.into_par_iter().for_each(|(first, mut next, mine)| {
            let base = start[first];
            for (key, payload) in items.clone() {
                if let Some(at) = next.get_mut((key as usize).wrapping_sub(first)) {
                    mine[(*at - base) as usize] = payload;
                    *at += 1;
                }
            }
        });
        sort_each(&start, &mut sorted);
        Self { start, items: sorted }
    }

    /// The payloads of `key`, ascending.
    pub(crate) fn get(&self, key: usize) -> &[u64] {
        &self.items[self.start[key] as usize..self.start[key + 1] as usize]
    }

    /// Number of keys.
    pub(crate) fn keys(&self) -> usize {
        self.start.len() - 1
    }
}

/// Fewer keys than this are sorted by one thread.
const FEW: usize = 1 << 14;

/// More threads gain nothing where each goes through all items.
const MOST_PARTS: usize = 16;

/// So many buckets are sorted at once.
const AT_ONCE: usize = 1 << 14;

/// Sorts the items of each bucket, which begin where `start` says, counted from its first entry.
fn sort_each(start: &[u32], items: &mut [u64]) {
    let buckets = start.len() - 1;
    if buckets > AT_ONCE {
        let (low, high) = (&start[..=buckets / 2], &start[buckets / 2..]);
        let (first, second) = items.split_at_mut((high[0] - start[0]) as usize);
        rayon::join(|| sort_each(low, first), || sort_each(high, second));
        return;
    }
    for bucket in start.windows(2) {
        items[(bucket[0] - start[0]) as usize..(bucket[1] - start[0]) as usize].sort_unstable();
    }
}

/// The half-edges of one undirected edge, ascending. Half-edge 3t+k runs from corner k of triangle t to the next.
pub(crate) struct Edge<'a> {
    /// The two vertices, the smaller first.
    pub(crate) ends: [u32; 2],
    entries: &'a [u64],
}

impl Edge<'_> {
    /// The half-edges, ascending.
    pub(crate) fn halves(&self) -> impl Iterator<Item = u32> + Clone + '_ {
        self.entries.iter().map(|&entry| entry as u32)
    }

    /// Number of triangles over the edge.
    pub(crate) fn count(&self) -> usize {
        self.entries.len()
    }
}

/// All undirected edges of the triangles that have three different vertices.
pub(crate) struct Edges<'a> {
    triangles: &'a [[u32; 3]],
    buckets: Buckets,
}

impl<'a> Edges<'a> {
    /// Collects the edges; every index is below `vertices`.
    pub(crate) fn new(triangles: &'a [[u32; 3]], vertices: usize) -> Self {
        let halves = triangles.iter().enumerate().filter(|(_, t)| !has_repeated_index(**t)).flat_map(|(id, t)| {
            (0..3).map(move |k| {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                (a.min(b), (u64::from(a.max(b)) << 32) | (3 * id + k) as u64)
            })
        });
        Self { triangles, buckets: Buckets::new(vertices, halves) }
    }

    /// Calls `visit` with every edge, by vertices.
    pub(crate) fn each(&self, mut visit: impl FnMut(Edge<'_>)) {
        for low in 0..self.buckets.keys() {
            for entries in self.buckets.get(low).chunk_by(|a, b| a >> 32 == b >> 32) {
                visit(Edge { ends: [low as u32, (entries[0] >> 32) as u32], entries });
            }
        }
    }

    /// Whether half-edge `half` runs from its edge's smaller vertex to the larger.
    pub(crate) fn runs_up(&self, half: u32) -> bool {
        let [from, to] = self.corners_of(half).map(|c| self.triangles[c as usize / 3][c as usize % 3]);
        from < to
    }

    /// The corners (3t+k) at the start and the end of a half-edge.
    fn corners_of(&self, half: u32) -> [u32; 2] {
        [half, if half % 3 == 2 { half - 2 } else { half + 1 }]
    }

    /// The corners of a half-edge at the smaller and the larger vertex of its edge.
    fn corners_low_high(&self, half: u32) -> [u32; 2] {
        let [from, to] = self.corners_of(half);
        if self.runs_up(half) { [from, to] } else { [to, from] }
    }

    /// What hangs together over edges: for each vertex the number of fans of triangles around it, and
    /// the number of shells.
    pub(crate) fn connectivity(&self) -> Connectivity {
        let mut fans = vec![0u32; self.buckets.keys()];
        let mut shells = 0;
        for t in self.triangles.iter().filter(|t| !has_repeated_index(**t)) {
            t.iter().for_each(|&v| fans[v as usize] += 1);
            shells += 1;
        }
        let mut corners = Union::new(3 * self.triangles.len());
        let mut faces = Union::new(self.triangles.len());
        self.each(|edge| {
            for pair in edge.entries.windows(2) {
                let [left, right] = [pair[0] as u32, pair[1] as u32];
                let (ends, others) = (self.corners_low_high(left), self.corners_low_high(right));
                for k in 0..2 {
                    fans[edge.ends[k] as usize] -= u32::from(corners.join(ends[k], others[k]));
                }
                shells -= usize::from(faces.join(left / 3, right / 3));
            }
        });
        Connectivity { fans, shells }
    }
}

/// See [`Edges::connectivity`].
pub(crate) struct Connectivity {
    /// Edge-connected fans of triangles around each vertex: 0 at unused, 1 at manifold ones.
    pub(crate) fans: Vec<u32>,
    /// Edge-connected shells.
    pub(crate) shells: usize,
}

/// Disjoint sets, joined by the smaller root.
pub(crate) struct Union {
    parent: Vec<u32>,
}

impl Union {
    /// Sets of one: 0 to `size` - 1.
    pub(crate) fn new(size: usize) -> Self {
        Self { parent: (0..size as u32).collect() }
    }

    /// Vertices, joined where triangles connect them.
    pub(crate) fn of_triangles(vertices: usize, triangles: impl IntoIterator<Item = [u32; 3]>) -> Self {
        let mut union = Self::new(vertices);
        for [a, b, c] in triangles {
            union.join(a, b);
            union.join(b, c);
        }
        union
    }

    /// The smallest member of the set of `of`.
    pub(crate) fn root(&mut self, mut of: u32) -> u32 {
        while self.parent[of as usize] != of {
            let above = self.parent[self.parent[of as usize] as usize];
            self.parent[of as usize] = above;
            of = above;
        }
        of
    }

    /// Joins the sets of `a` and `b`; false if they were one already.
    pub(crate) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }
}

/// For each triangle that repeats an earlier one (the same three vertices in any order): its id and the first one's.
/// Ascending. Triangles with a repeated index take no part.
pub(crate) fn copies(triangles: &[[u32; 3]], vertices: usize) -> Vec<[u32; 2]> {
    let sorted = |id: u64| {
        let mut t = triangles[id as usize];
        t.sort_unstable();
        t
    };
    let items = triangles.iter().enumerate().filter(|(_, t)| !has_repeated_index(**t));
    let buckets = Buckets::new(vertices, items.map(|(id, t)| (t[0].min(t[1]).min(t[2]), id as u64)));
    let of_key = |key: usize| {
        let ids = buckets.get(key);
        let mut group: Vec<([u32; 3], u32)> = Vec::new();
        if ids.len() > 1 {
            group.extend(ids.iter().map(|&id| (sorted(id), id as u32)));
            group.sort_unstable();
        }
        let same = group.chunk_by(|a, b| a.0 == b.0);
        same.flat_map(|same| same[1..].iter().map(|copy| [copy.1, same[0].1])).collect::<Vec<_>>()
    };
    let mut found: Vec<[u32; 2]> =
        (0..buckets.keys()).into_par_iter().with_min_len(1 << 10).flat_map_iter(of_key).collect();
    found.sort_unstable();
    found
}
