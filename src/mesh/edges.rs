//! The edges of a soup and what hangs together over them.

use rayon::prelude::*;

use super::parted::Parted;
use super::weld::has_repeated_index;

/// Items sorted by a small key, without a comparison sort: offsets and items.
pub(crate) struct Buckets {
    start: Vec<u32>,
    items: Vec<u64>,
}

impl Buckets {
    /// Sorts items 0 to `count` - 1, those that `item` gives (key below `keys`, payload), by key, then payload.
    pub(crate) fn new(keys: usize, count: usize, item: impl Fn(usize) -> Option<(u32, u64)> + Sync) -> Self {
        if count < FEW {
            return Self::on_one_thread(keys, count, item);
        }
        let part = |n: usize| item(n).map(|(key, _)| key as usize * PARTS / keys);
        let end_of = |part: usize| (part * keys).div_ceil(PARTS);
        let parted = Parted::new(count, PARTS, part);
        let mut start = vec![0u32; keys + 1];
        let mut items = vec![0u64; (0..PARTS).map(|part| parted.size(part)).sum()];
        let (mut starts, mut rest, mut before) = (&mut start[..keys], items.as_mut_slice(), 0);
        let mut parts = Vec::with_capacity(PARTS);
        for part in 0..PARTS {
            let (own, others) = starts.split_at_mut(end_of(part + 1) - end_of(part));
            let (mine, left) = rest.split_at_mut(parted.size(part));
            let first = before;
            before += mine.len() as u32;
            parts.push((part, own, mine, first));
            (starts, rest) = (others, left);
        }
        parts.into_par_iter().for_each(|(part, starts, items, first)| {
            let given = || parted.of(part).filter_map(&item);
            let at = |key: u32| key as usize - end_of(part);
            given().for_each(|(key, _)| starts[at(key)] += 1);
            let mut sum = 0;
            for start in starts.iter_mut() {
                sum += std::mem::replace(start, sum);
            }
            // The starts move to the ends while filling.
            for (key, payload) in given() {
                let place = &mut starts[at(key)];
                items[*place as usize] = payload;
                *place += 1;
            }
            let mut begin = 0;
            for start in starts.iter_mut() {
                let end = std::mem::replace(start, first + begin);
                items[begin as usize..end as usize].sort_unstable();
                begin = end;
            }
        });
        start[keys] = items.len() as u32;
        Self { start, items }
    }

    /// The same made by the calling thread alone.
    pub(crate) fn on_one_thread(keys: usize, count: usize, item: impl Fn(usize) -> Option<(u32, u64)>) -> Self {
        let mut given: Vec<(u32, u64)> = (0..count).filter_map(item).collect();
        given.sort_unstable();
        let mut start = vec![0u32; keys + 1];
        given.iter().for_each(|&(key, _)| start[key as usize + 1] += 1);
        (0..keys).for_each(|k| start[k + 1] += start[k]);
        Self { start, items: given.into_iter().map(|(_, payload)| payload).collect() }
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

/// Fewer items than this are sorted as they are.
const FEW: usize = 1 << 12;

/// So many parts the keys are divided in.
const PARTS: usize = 256;

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
        let half = |n: usize| {
            let (t, k) = (triangles[n / 3], n % 3);
            let (a, b) = (t[k], t[(k + 1) % 3]);
            (!has_repeated_index(t)).then(|| (a.min(b), (u64::from(a.max(b)) << 32) | n as u64))
        };
        Self { triangles, buckets: Buckets::new(vertices, 3 * triangles.len(), half) }
    }

    /// What `make` makes of every edge, by vertices, on all threads.
    pub(crate) fn map<T: Send>(&self, make: impl Fn(Edge<'_>) -> T + Sync) -> Vec<T> {
        let of = |low: usize| {
            let edges = self.buckets.get(low).chunk_by(|a, b| a >> 32 == b >> 32);
            edges
                .map(|entries| make(Edge { ends: [low as u32, (entries[0] >> 32) as u32], entries }))
                .collect::<Vec<T>>()
        };
        (0..self.buckets.keys()).into_par_iter().with_min_len(1 << 10).flat_map_iter(of).collect()
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
    let item = |id: usize| {
        let [a, b, c] = triangles[id];
        (!has_repeated_index([a, b, c])).then(|| (a.min(b).min(c), id as u64))
    };
    let buckets = Buckets::new(vertices, triangles.len(), item);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::parted::CHUNK;

    #[test]
    fn buckets_hold_the_payloads_of_their_keys_in_order() {
        // Some items have no key, and most keys no item where there are more of them.
        let item = |n: usize| (!n.is_multiple_of(5)).then(|| ((n * 7919 % 100_003) as u32, (n * 31 % 1009) as u64));
        for (count, limit) in
            [(0, 3), (50, 100_003), (FEW - 1, 100_003), (FEW, 100_003), (3 * CHUNK + 7, 100_003), (FEW, 2)]
        {
            let of = |n: usize| item(n).map(|(key, payload)| (key % limit, payload));
            let mut expected = vec![Vec::new(); limit as usize];
            (0..count).filter_map(of).for_each(|(key, payload)| expected[key as usize].push(payload));
            expected.iter_mut().for_each(|list| list.sort_unstable());
            let buckets = Buckets::new(limit as usize, count, of);
            assert_eq!(buckets.keys(), limit as usize);
            assert!((0..limit as usize).all(|key| buckets.get(key) == expected[key]), "{count} items, {limit} keys");
        }
    }
}
