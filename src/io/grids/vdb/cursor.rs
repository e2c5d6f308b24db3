//! Reading forward through bytes, with the place of what is missing.

use glam::{DVec3, IVec3};

use crate::io::error::{FileError, FileProblem};

/// Bytes and how far they have been read.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The same bytes from `place` on.
    pub(super) fn moved(&self, place: i64, what: &str) -> Result<Self, FileError> {
        let at = usize::try_from(place).ok().filter(|&at| at <= self.bytes.len());
        let at = at.ok_or_else(|| self.wrong(format!("the place of {what} in the file"), place.to_string()))?;
        Ok(Self { bytes: self.bytes, at })
    }

    /// The next `size` bytes.
    pub(super) fn take(&mut self, size: usize, what: &str) -> Result<&'a [u8], FileError> {
        let rest = &self.bytes[self.at..];
        let Some(taken) = rest.get(..size) else {
            let problem = FileProblem::truncated(what, format!("{} bytes are left", rest.len()));
            return Err(problem.at_byte(self.bytes.len()));
        };
        self.at += size;
        Ok(taken)
    }

    fn word<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FileError> {
        let bytes = self.take(N, what)?;
        Ok(std::array::from_fn(|n| bytes[n]))
    }

    pub(super) fn u8(&mut self, what: &str) -> Result<u8, FileError> {
        self.word(what).map(|[byte]| byte)
    }

    pub(super) fn u32(&mut self, what: &str) -> Result<u32, FileError> {
        self.word(what).map(u32::from_le_bytes)
    }

    pub(super) fn i64(&mut self, what: &str) -> Result<i64, FileError> {
        self.word(what).map(i64::from_le_bytes)
    }

    pub(super) fn f32(&mut self, what: &str) -> Result<f32, FileError> {
        self.word(what).map(f32::from_le_bytes)
    }

    pub(super) fn f64(&mut self, what: &str) -> Result<f64, FileError> {
        self.word(what).map(f64::from_le_bytes)
    }

    pub(super) fn vector(&mut self, what: &str) -> Result<DVec3, FileError> {
        Ok(DVec3::new(self.f64(what)?, self.f64(what)?, self.f64(what)?))
    }

    pub(super) fn voxel(&mut self, what: &str) -> Result<IVec3, FileError> {
        let mut next = || self.word(what).map(i32::from_le_bytes);
        Ok(IVec3::new(next()?, next()?, next()?))
    }

    /// A length of 32 bits and as many bytes of text.
    pub(super) fn text(&mut self, what: &str) -> Result<String, FileError> {
        let length = self.u32(what)? as usize;
        Ok(String::from_utf8_lossy(self.take(length, what)?).into_owned())
    }

    /// Bits, the lowest first.
    pub(super) fn mask(&mut self, bits: usize, what: &str) -> Result<Mask, FileError> {
        let words = self.take(bits / 8, what)?.as_chunks::<8>().0;
        Ok(Mask(words.iter().map(|word| u64::from_le_bytes(*word)).collect()))
    }

    pub(super) fn wrong(&self, expected: impl Into<String>, found: impl Into<String>) -> FileError {
        FileProblem::syntax(expected, found).at_byte(self.at)
    }
}

/// One bit for each entry of a node.
pub(super) struct Mask(Vec<u64>);

impl Mask {
    pub(super) fn has(&self, n: usize) -> bool {
        self.0[n / 64] >> (n % 64) & 1 == 1
    }

    pub(super) fn count(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The entries whose bit is set, in order.
    pub(super) fn ones(&self) -> impl Iterator<Item = usize> + '_ {
        let of_word = |(n, &word): (usize, &u64)| (0..64).filter(move |k| word >> k & 1 == 1).map(move |k| 64 * n + k);
        self.0.iter().enumerate().flat_map(of_word)
    }
}
