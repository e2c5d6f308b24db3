//! Numbers as files have them: integers and floats of any width and byte order, as text, and compressed.

use std::io::{self, Read};

use crate::io::error::FileProblem;
use crate::io::text::quoted;

/// Bytes of memory that the values of any file may take.
const ALWAYS_ALLOWED: usize = 256 << 20;
/// Beyond that, bytes of memory for each byte of the file.
const LARGEST_RATIO: usize = 50;

/// What a file may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cap {
    /// Bytes of the file.
    pub(super) length: usize,
    /// Bytes of memory for the file and its values, if there is a limit.
    pub(super) allowed: Option<u64>,
}

impl Cap {
    /// Refuses values of so many `bytes`, by what the file's length justifies; and by what is allowed those, the file, and
    /// the bytes `besides` that are held while it is read.
    pub(super) fn check(self, bytes: usize, besides: usize) -> Result<(), FileProblem> {
        let limit = ALWAYS_ALLOWED.max(self.length.saturating_mul(LARGEST_RATIO));
        let needed = self.length.saturating_add(bytes).saturating_add(besides) as u64;
        match self.allowed {
            Some(allowed) if needed > allowed => Err(FileProblem::Memory { needed, allowed }),
            _ if bytes > limit => Err(FileProblem::TooLarge { what: "the bytes of its values", limit: limit as u64 }),
            _ => Ok(()),
        }
    }

    /// The same for `count` values.
    pub(super) fn check_values(self, count: usize, besides: usize) -> Result<(), FileProblem> {
        self.check(count.saturating_mul(size_of::<f32>()), besides)
    }
}

/// A kind of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Kind {
    /// Bytes of one.
    pub(super) fn width(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// All numbers in `bytes`, the lowest byte first unless `big`.
    pub(super) fn decode(self, bytes: &[u8], big: bool) -> Vec<f32> {
        match self {
            Self::I8 => words(bytes, big, |w| i8::from_le_bytes(w).into()),
            Self::U8 => words(bytes, big, |w| u8::from_le_bytes(w).into()),
            Self::I16 => words(bytes, big, |w| i16::from_le_bytes(w).into()),
            Self::U16 => words(bytes, big, |w| u16::from_le_bytes(w).into()),
            Self::I32 => words(bytes, big, |w| i32::from_le_bytes(w) as f32),
            Self::U32 => words(bytes, big, |w| u32::from_le_bytes(w) as f32),
            Self::I64 => words(bytes, big, |w| i64::from_le_bytes(w) as f32),
            Self::U64 => words(bytes, big, |w| u64::from_le_bytes(w) as f32),
            Self::F16 => words(bytes, big, |w| half(u16::from_le_bytes(w))),
            Self::F32 => words(bytes, big, f32::from_le_bytes),
            Self::F64 => words(bytes, big, |w| f64::from_le_bytes(w) as f32),
        }
    }
}

fn words<const N: usize>(bytes: &[u8], big: bool, value: impl Fn([u8; N]) -> f32) -> Vec<f32> {
    let turned = |word: &[u8; N]| {
        let mut word = *word;
        if big {
            word.reverse();
        }
        value(word)
    };
    bytes.as_chunks::<N>().0.iter().map(turned).collect()
}

/// A number of 16 bits (IEEE 754 binary16).
fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023));
    match exponent {
        0 => sign * fraction * 2f32.powi(-24),
        31 if fraction == 0.0 => sign * f32::INFINITY,
        31 => f32::NAN,
        _ => sign * (1024.0 + fraction) * 2f32.powi(exponent - 25),
    }
}

/// Numbers of a lattice: `dims` multiplied, if the memory could hold so many.
pub(super) fn count(dims: [usize; 3]) -> Option<usize> {
    let count = dims.iter().try_fold(1usize, |product, &n| product.checked_mul(n))?;
    (count.checked_mul(8)? <= isize::MAX as usize).then_some(count)
}

/// `count` numbers written as text, separated by blanks.
pub(super) fn from_text(text: &[u8], count: usize) -> Result<Vec<f32>, FileProblem> {
    // A number takes at least a digit and a blank.
    if count > text.len().div_ceil(2) {
        return Err(FileProblem::truncated(format!("{count} numbers"), format!("{} characters are there", text.len())));
    }
    let mut values = Vec::with_capacity(count);
    for word in text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
        let number = number.ok_or_else(|| FileProblem::syntax("a number", quoted(word)))?;
        if values.len() == count {
            return Err(FileProblem::syntax(format!("{count} numbers"), "more"));
        }
        values.push(number as f32);
    }
    match values.len() == count {
        true => Ok(values),
        false => Err(FileProblem::truncated(format!("{count} numbers"), format!("there are {}", values.len()))),
    }
}

/// The first `wanted` bytes that `packed` unpacks into. Memory grows with what is really there.
pub(super) fn unpack(packed: impl Read, wanted: usize) -> Result<Vec<u8>, FileProblem> {
    let mut bytes = Vec::new();
    let read = packed.take(wanted as u64).read_to_end(&mut bytes);
    read.map_err(|error| FileProblem::syntax("compressed numbers", error.to_string()))?;
    match bytes.len() == wanted {
        true => Ok(bytes),
        false => {
            let found = format!("there are {}", bytes.len());
            Err(FileProblem::truncated(format!("{wanted} bytes after unpacking"), found))
        }
    }
}

/// The `count` numbers after the first `skipped` bytes that `packed` unpacks into, piece by piece.
pub(super) fn unpack_numbers(
    mut packed: impl Read,
    skipped: u64,
    count: usize,
    decode: impl Fn(&[u8]) -> Vec<f32>,
    width: usize,
) -> Result<Vec<f32>, FileProblem> {
    const PIECE: usize = 1 << 13;
    let broken = |error: io::Error| FileProblem::syntax("compressed numbers", error.to_string());
    let missing =
        |found: usize| FileProblem::truncated(format!("{count} numbers after unpacking"), format!("there are {found}"));
    let passed = io::copy(&mut packed.by_ref().take(skipped), &mut io::sink()).map_err(broken)?;
    if passed < skipped {
        return Err(missing(0));
    }
    let (mut values, mut piece) = (Vec::new(), Vec::new());
    while values.len() < count {
        let wanted = PIECE.min(count - values.len()) * width;
        piece.clear();
        packed.by_ref().take(wanted as u64).read_to_end(&mut piece).map_err(broken)?;
        if piece.len() < wanted {
            return Err(missing(values.len() + piece.len() / width));
        }
        if values.is_empty() && count > PIECE {
            // All at once only when the first piece is there, and never twice the room that is needed.
            values.reserve_exact(count);
        }
        values.extend(decode(&piece));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_exact() {
        for (bits, value) in [
            (0x0000, 0.0),
            (0x8001, -(2f32.powi(-24))),
            (0x03ff, 1023.0 * 2f32.powi(-24)),
            (0x0400, 2f32.powi(-14)),
            (0x3555, 0.333_251_95),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0xfc00, f32::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan());
    }

    #[test]
    fn numbers_of_every_kind_and_order() {
        for (kind, bytes, value) in [
            (Kind::I8, vec![0xfe], -2.0),
            (Kind::U8, vec![0xfe], 254.0),
            (Kind::I16, vec![0xfe, 0xff], -2.0),
            (Kind::U16, vec![1, 2], 513.0),
            (Kind::I32, vec![0xfe, 0xff, 0xff, 0xff], -2.0),
            (Kind::U32, vec![0, 0, 0, 0x80], 2_147_483_648.0),
            (Kind::I64, vec![0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff], -2.0),
            (Kind::U64, vec![0, 1, 0, 0, 0, 0, 0, 0], 256.0),
            (Kind::F16, vec![0, 0xc0], -2.0),
            (Kind::F32, vec![0, 0, 0x20, 0xc0], -2.5),
            (Kind::F64, vec![0, 0, 0, 0, 0, 0, 4, 0x40], 2.5),
        ] {
            assert_eq!((kind.width(), kind.decode(&bytes, false)), (bytes.len(), vec![value]), "{kind:?}");
            let turned: Vec<u8> = bytes.iter().rev().copied().collect();
            assert_eq!(kind.decode(&turned, true), [value], "{kind:?}");
        }
    }

    #[test]
    fn text_must_hold_as_many_numbers_as_it_should() {
        assert_eq!(from_text(b" 1 -2.5\n1e2", 3).ok(), Some(vec![1.0, -2.5, 100.0]));
        for (text, count) in [("1 2", 3), ("1 2 3 4", 3), ("1 x 3", 3), ("", 1), ("1", usize::MAX)] {
            assert!(from_text(text.as_bytes(), count).is_err(), "{text}");
        }
    }
}
