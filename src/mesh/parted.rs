//! Items sorted by the part they belong to, on all threads: what follows is near in memory then, and each part is for one thread.

use std::ops::Range;

use rayon::prelude::*;

/// So many items are sorted at once.
pub(super) const CHUNK: usize = 1 << 18;

/// Items by part; within one by number.
pub(super) struct Parted {
    chunks: Vec<Chunk>,
}

/// Some of the items.
struct Chunk {
    /// Where the items of each part begin, and one more.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Parted {
    /// Items 0 to `count` - 1 by `part`, below `parts`; those that have none are left out.
    pub(super) fn new(count: usize, parts: usize, part: impl Fn(usize) -> Option<usize> + Sync) -> Self {
        let chunks = (0..count.div_ceil(CHUNK)).into_par_iter();
        let range = |chunk: usize| CHUNK * chunk..(CHUNK * (chunk + 1)).min(count);
        Self { chunks: chunks.map(|chunk| Chunk::of(range(chunk), parts, &part)).collect() }
    }

    /// The items of a part, ascending.
    pub(super) fn of(&self, part: usize) -> impl Iterator<Item = usize> {
        self.chunks.iter().flat_map(move |chunk| &chunk.items[chunk.range(part)]).map(|&n| n as usize)
    }

    /// How many items a part has.
    pub(super) fn size(&self, part: usize) -> usize {
        self.chunks.iter().map(|chunk| chunk.range(part).len()).sum()
    }
}

impl Chunk {
    fn of(range: Range<usize>, parts: usize, part: impl Fn(usize) -> Option<usize>) -> Self {
        let of: Vec<u16> = range.clone().map(|n| part(n).map_or(parts, |part| part) as u16).collect();
        // Those without a part come last.
        let mut starts = vec![0u32; parts + 2];
        of.iter().for_each(|&part| starts[part as usize + 1] += 1);
        (0..=parts).for_each(|part| starts[part + 1] += starts[part]);
        let (mut at, mut items) = (starts.clone(), vec![0; range.len()]);
        for (n, &part) in range.zip(&of) {
            let place = &mut at[part as usize];
            items[*place as usize] = n as u32;
            *place += 1;
        }
        Self { starts, items }
    }

    fn range(&self, part: usize) -> Range<usize> {
        self.starts[part] as usize..self.starts[part + 1] as usize
    }
}
