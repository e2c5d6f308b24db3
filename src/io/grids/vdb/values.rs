//! The values of a node: those of active entries, and what makes up the others.

use flate2::read::ZlibDecoder;

use super::super::numbers::{self, Kind};
use super::cursor::{Cursor, Mask};
use super::{COMPRESS_ACTIVE_MASK, COMPRESS_BLOSC, COMPRESS_ZIP, blosc};
use crate::io::error::{FileError, FileProblem};

/// How the values of inactive entries are said, from the byte before the values of a node.
mod inactive {
    /// All are the background.
    pub(in super::super) const BACKGROUND: u8 = 0;
    /// All are its negative.
    pub(in super::super) const MINUS_BACKGROUND: u8 = 1;
    /// All are the value that follows.
    pub(super) const ONE: u8 = 2;
    /// A mask that follows chooses the background, else its negative.
    pub(in super::super) const MASK: u8 = 3;
    /// It chooses the background, else the value that follows.
    pub(super) const MASK_AND_ONE: u8 = 4;
    /// It chooses the second value that follows, else the first.
    pub(super) const MASK_AND_TWO: u8 = 5;
    /// They are stored like those of active entries.
    pub(super) const STORED: u8 = 6;
}
pub(super) use inactive::{BACKGROUND, MASK, MINUS_BACKGROUND};

/// What all nodes of a tree share.
#[derive(Clone, Copy)]
pub(super) struct Format {
    pub(super) number: Kind,
    pub(super) stored: Kind,
    pub(super) compression: u32,
    pub(super) background: f32,
}

impl Format {
    /// A number outside the buffers.
    pub(super) fn number(&self, cursor: &mut Cursor<'_>, what: &str) -> Result<f32, FileError> {
        match self.number {
            Kind::F64 => cursor.f64(what).map(|value| value as f32),
            _ => cursor.f32(what),
        }
    }

    /// The values of a node of `count` entries.
    pub(super) fn values(
        &self,
        cursor: &mut Cursor<'_>,
        active: &Mask,
        count: usize,
        what: &str,
    ) -> Result<Vec<f32>, FileError> {
        use inactive::{MASK_AND_ONE, MASK_AND_TWO, ONE, STORED};
        let how = cursor.u8(what)?;
        if how > STORED {
            return Err(cursor.wrong("0 to 6 for how inactive values are stored", how.to_string()));
        }
        let mut choices = [if how == BACKGROUND { self.background } else { -self.background }, self.background];
        if matches!(how, ONE | MASK_AND_ONE | MASK_AND_TWO) {
            choices[0] = self.number(cursor, what)?;
        }
        if how == MASK_AND_TWO {
            choices[1] = self.number(cursor, what)?;
        }
        let chosen = match how {
            MASK | MASK_AND_ONE | MASK_AND_TWO => Some(cursor.mask(count, what)?),
            _ => None,
        };
        if self.compression & COMPRESS_ACTIVE_MASK == 0 || how == STORED {
            return self.data(cursor, count, what);
        }
        let mut stored = self.data(cursor, active.count(), what)?.into_iter();
        let chosen = |n: usize| choices[usize::from(chosen.as_ref().is_some_and(|mask| mask.has(n)))];
        let value = |n: usize| if active.has(n) { stored.next() } else { Some(chosen(n)) };
        Ok((0..count).map(value).map(Option::unwrap_or_default).collect())
    }

    /// `count` numbers, perhaps compressed.
    fn data(&self, cursor: &mut Cursor<'_>, count: usize, what: &str) -> Result<Vec<f32>, FileError> {
        let size = count * self.stored.width();
        // Numbers of 16 bits are not even announced where there are none.
        if self.stored == Kind::F16 && count == 0 {
            return Ok(Vec::new());
        }
        if self.compression & (COMPRESS_ZIP | COMPRESS_BLOSC) == 0 {
            return Ok(self.stored.decode(cursor.take(size, what)?, false));
        }
        let start = cursor.at();
        let packed = cursor.i64(what)?;
        // What did not shrink is stored as it is, and its size as a negative number.
        let length = usize::try_from(packed.unsigned_abs()).unwrap_or(usize::MAX);
        let data = cursor.take(length, what)?;
        if packed <= 0 {
            return match data.len() == size {
                true => Ok(self.stored.decode(data, false)),
                false => Err(cursor.wrong(format!("{size} bytes of values"), data.len().to_string())),
            };
        }
        let unpacked = match self.compression & COMPRESS_BLOSC {
            0 => unzip(data, size),
            _ => blosc::unpack(data, size),
        };
        Ok(self.stored.decode(&unpacked.map_err(|problem| problem.at_byte(start))?, false))
    }
}

fn unzip(data: &[u8], size: usize) -> Result<Vec<u8>, FileProblem> {
    numbers::unpack(ZlibDecoder::new(data), size)
}
