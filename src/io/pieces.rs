//! Rows of a file, made by all threads and written in their order.

use std::io::{self, Write};
use std::ops::Range;

use rayon::prelude::*;

/// Rows of a piece: some 100 KB.
const ROWS: usize = 1 << 12;

/// Pieces that are made at a time, for each thread.
const AHEAD: usize = 4;

/// Lets `make` append the bytes of rows to a list, piece by piece on all threads, and writes them in the order of the `count` rows.
pub(super) fn in_pieces(
    count: usize,
    out: &mut dyn Write,
    make: impl Fn(Range<usize>, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let together = (AHEAD * rayon::current_num_threads()).min(count.div_ceil(ROWS));
    let mut pieces = vec![Vec::new(); together];
    let mut first = 0;
    while first < count {
        let rows = |k: usize| (first + k * ROWS).min(count)..(first + (k + 1) * ROWS).min(count);
        pieces.par_iter_mut().enumerate().for_each(|(k, bytes)| {
            bytes.clear();
            make(rows(k), bytes);
        });
        pieces.iter().try_for_each(|bytes| out.write_all(bytes))?;
        first += together * ROWS;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_in_their_order_for_any_number_of_threads() {
        for (count, threads) in [(0, 1), (1, 3), (ROWS, 2), (ROWS + 1, 2), (50 * ROWS + 17, 3)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let mut out = Vec::new();
            let row = |n: usize, bytes: &mut Vec<u8>| bytes.extend_from_slice(&(n as u32).to_le_bytes());
            let made = pool.install(|| in_pieces(count, &mut out, |rows, bytes| rows.for_each(|n| row(n, bytes))));
            made.expect("memory takes it");
            let expected: Vec<u8> = (0..count as u32).flat_map(u32::to_le_bytes).collect();
            assert!(out == expected, "{count} {threads}");
        }
    }
}
