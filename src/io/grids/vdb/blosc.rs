//! Unpacking Blosc 1 with LZ4 inside, which most programs write.

use crate::io::error::FileProblem;

/// Bytes before the table of blocks.
const HEADER: usize = 16;
/// Flags: bytes are shuffled; nothing is packed; bits are shuffled; blocks are not split.
const SHUFFLED: u8 = 0x01;
const COPIED: u8 = 0x02;
const BITS_SHUFFLED: u8 = 0x04;
const NOT_SPLIT: u8 = 0x10;
/// The three highest bits of the flags name the packer.
const LZ4: u8 = 1;
/// A block is split by the bytes of its numbers where these are few and the pieces not too small.
const MOST_SPLITS: usize = 16;
const LEAST_PIECE: usize = 128;

/// The `size` bytes that `packed` holds.
pub(super) fn unpack(packed: &[u8], size: usize) -> Result<Vec<u8>, FileProblem> {
    let header: &[u8; HEADER] = packed.first_chunk().ok_or_else(cut)?;
    let (flags, width) = (header[2], usize::from(header[3]).max(1));
    let [bytes, block] = [4, 8].map(|at| word(packed, at).unwrap_or(0));
    if bytes != size {
        return Err(FileProblem::syntax(format!("{size} bytes packed by Blosc"), bytes.to_string()));
    }
    if flags & COPIED != 0 {
        return packed.get(HEADER..HEADER + size).map(<[u8]>::to_vec).ok_or_else(cut);
    }
    if flags >> 5 != LZ4 || flags & BITS_SHUFFLED != 0 {
        let text = "of Blosc only LZ4 with shuffled bytes is read here: save it with zip compression, or without";
        return Err(FileProblem::unsupported(text));
    }
    if block == 0 {
        return Err(FileProblem::syntax("blocks packed by Blosc", "blocks of 0 bytes"));
    }
    let mut out = Vec::with_capacity(size);
    for n in 0..size.div_ceil(block) {
        let length = block.min(size - n * block);
        let start = word(packed, HEADER + 4 * n).ok_or_else(cut)?;
        let whole = length == block;
        let split = flags & NOT_SPLIT == 0 && width <= MOST_SPLITS && block / width >= LEAST_PIECE && whole;
        let bytes = unpack_block(packed, start, length, if split { width } else { 1 })?;
        match flags & SHUFFLED {
            0 => out.extend(bytes),
            _ => unshuffle(&bytes, width, &mut out),
        }
    }
    Ok(out)
}

fn unpack_block(packed: &[u8], mut at: usize, length: usize, pieces: usize) -> Result<Vec<u8>, FileProblem> {
    let mut out = vec![0; length];
    for piece in out.chunks_exact_mut(length / pieces) {
        let size = word(packed, at).ok_or_else(cut)?;
        let data = at.checked_add(4).and_then(|start| packed.get(start..start.checked_add(size)?)).ok_or_else(cut)?;
        at += 4 + size;
        if size == piece.len() {
            piece.copy_from_slice(data);
            continue;
        }
        let written = lz4_flex::block::decompress_into(data, piece);
        if written.map_err(|error| FileProblem::syntax("bytes packed by LZ4", error.to_string()))? != piece.len() {
            return Err(cut());
        }
    }
    Ok(out)
}

/// The first bytes of all numbers come first, then the second ones; what makes no whole number is at the end.
fn unshuffle(bytes: &[u8], width: usize, out: &mut Vec<u8>) {
    let count = bytes.len() / width;
    out.extend((0..count).flat_map(|n| (0..width).map(move |k| bytes[k * count + n])));
    out.extend(&bytes[count * width..]);
}

/// The number of 32 bits at `at`.
fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]) as usize)
}

fn cut() -> FileProblem {
    FileProblem::truncated("values packed by Blosc", "they end early")
}
