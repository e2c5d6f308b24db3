//! The numbers of an array: appended or between its tags, as they are, in base64 or as text, compressed or not.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

use super::super::numbers::{self, Cap, Kind};
use super::xml::{Appended, Array, Attributes};
use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

/// How the whole file stores its numbers.
#[derive(Clone, Copy)]
pub(super) struct Storage {
    /// The highest byte first.
    big: bool,
    /// Bytes of the counts before the numbers: 4 or 8.
    word: usize,
    zlib: bool,
    /// What the whole file may take.
    cap: Cap,
}

impl Storage {
    pub(super) fn new(file: &Attributes, cap: Cap) -> Result<Self, FileError> {
        let wrong = |expected: &str, found: &str| {
            Err(FileProblem::syntax(expected, quoted(found.as_bytes())).at_byte(file.byte))
        };
        let big = match file.get("byte_order") {
            Some("LittleEndian") | None => false,
            Some("BigEndian") => true,
            Some(other) => return wrong("LittleEndian or BigEndian as byte_order", other),
        };
        let word = match file.get("header_type") {
            Some("UInt32") | None => 4,
            Some("UInt64") => 8,
            Some(other) => return wrong("UInt32 or UInt64 as header_type", other),
        };
        let zlib = match file.get("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let name = quoted(other.as_bytes());
                let text = format!("the compressor {name} is not read here: save it with ZLib, or without compression");
                return Err(FileProblem::Unsupported(text).at_byte(file.byte));
            }
        };
        Ok(Self { big, word, zlib, cap })
    }

    /// The `count` numbers of `array`.
    pub(super) fn numbers(
        &self,
        array: &Array<'_>,
        count: usize,
        appended: Option<Appended<'_>>,
    ) -> Result<Vec<f32>, FileError> {
        let place = array.attributes.byte;
        let wrong = |expected: &str, found: Option<&str>| {
            let found = found.map_or("none".to_owned(), |found| quoted(found.as_bytes()));
            FileProblem::syntax(expected, found).at_byte(place)
        };
        let name = array.attributes.get("type");
        let kind = name.and_then(kind).ok_or_else(|| wrong("a type of numbers, such as Float32,", name))?;
        let format = array.attributes.get("format");
        let (data, base64, byte) = match format {
            Some("ascii") | None => {
                let values = self.cap.check_values(count, 0).and_then(|()| numbers::from_text(array.text, count));
                return values.map_err(|e| e.at_byte(place));
            }
            Some("binary") => (array.text.trim_ascii(), true, place),
            Some("appended") => {
                let appended = appended.ok_or_else(|| wrong("the element AppendedData", None))?;
                let offset = array.attributes.get("offset");
                let start = offset.and_then(|offset| offset.trim().parse().ok());
                let start: usize = start.ok_or_else(|| wrong("an offset into the appended numbers", offset))?;
                let data = appended.data.get(start..).unwrap_or_default();
                (data, appended.base64, appended.byte.saturating_add(start).min(self.cap.length))
            }
            Some(_) => return Err(wrong("ascii, binary or appended as format", format)),
        };
        let size = count.checked_mul(kind.width()).ok_or_else(|| wrong("fewer numbers", None))?;
        let source = Source { data, base64 };
        let bytes = if self.zlib { self.unzip(source, size, count) } else { self.plain(source, size, count) };
        Ok(kind.decode(&bytes.map_err(|e| e.at_byte(byte))?, self.big))
    }

    /// The length in bytes, then the bytes.
    fn plain(&self, source: Source<'_>, size: usize, count: usize) -> Result<Vec<u8>, FileProblem> {
        let whole = size.checked_add(self.word);
        let whole = whole.ok_or_else(|| FileProblem::truncated(format!("{size} bytes"), "there are fewer"))?;
        self.check_size(self.count(&source.take(0, self.word)?, 0), size)?;
        self.cap.check_values(count, size)?;
        let mut bytes = source.take(0, whole)?;
        bytes.drain(..self.word);
        Ok(bytes)
    }

    /// The number of blocks, the size of a whole one and of the last, the packed size of each, and then the blocks.
    fn unzip(&self, source: Source<'_>, size: usize, count: usize) -> Result<Vec<u8>, FileProblem> {
        let start = source.take(0, 3 * self.word)?;
        let [blocks, whole, last] = [0, 1, 2].map(|n| self.count(&start, n));
        let partial = u64::from(last > 0);
        let total = blocks.checked_sub(partial).and_then(|n| n.checked_mul(whole)).and_then(|n| n.checked_add(last));
        self.check_size(total.unwrap_or(u64::MAX), size)?;
        self.cap.check_values(count, size)?;
        let sizes = usize::try_from(blocks).ok().and_then(|blocks| blocks.checked_add(3)?.checked_mul(self.word));
        let many = || FileProblem::truncated(format!("{blocks} packed blocks"), "there are fewer");
        let header = source.take(0, sizes.ok_or_else(many)?)?;
        let packed = (3..header.len() / self.word)
            .try_fold(0u64, |sum, n| sum.checked_add(self.count(&header, n)))
            .and_then(|sum| usize::try_from(sum).ok());
        let packed = source.take(source.encoded(header.len()), packed.ok_or_else(many)?)?;
        let (mut at, mut left, mut bytes) = (0, size, Vec::new());
        for n in 3..header.len() / self.word {
            let end = at + self.count(&header, n) as usize;
            let wanted = left.min(whole as usize);
            bytes.extend(numbers::unpack(ZlibDecoder::new(&packed[at..end]), wanted)?);
            (at, left) = (end, left - wanted);
        }
        match left {
            0 => Ok(bytes),
            _ => Err(FileProblem::truncated(format!("{size} bytes after unpacking"), format!("{left} are missing"))),
        }
    }

    fn check_size(&self, found: u64, size: usize) -> Result<(), FileProblem> {
        match found == size as u64 {
            true => Ok(()),
            false => Err(FileProblem::syntax(format!("{size} bytes of numbers"), format!("{found}"))),
        }
    }

    /// Word `n` of `bytes`.
    fn count(&self, bytes: &[u8], n: usize) -> u64 {
        let word = bytes[n * self.word..(n + 1) * self.word].iter();
        let shift = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        if self.big { word.fold(0, shift) } else { word.rev().fold(0, shift) }
    }
}

/// Bytes, perhaps behind base64.
#[derive(Clone, Copy)]
struct Source<'a> {
    data: &'a [u8],
    base64: bool,
}

impl Source<'_> {
    /// The characters of the file that `bytes` bytes take.
    fn encoded(&self, bytes: usize) -> usize {
        if self.base64 { bytes.div_ceil(3).saturating_mul(4) } else { bytes }
    }

    /// `size` bytes from character `start` on.
    fn take(&self, start: usize, size: usize) -> Result<Vec<u8>, FileProblem> {
        let there = self.data.get(start..).unwrap_or_default();
        let piece = there.get(..self.encoded(size));
        if !self.base64 {
            let short = || FileProblem::truncated(format!("{size} bytes"), format!("{} are there", there.len()));
            return piece.map(<[u8]>::to_vec).ok_or_else(short);
        }
        let short = || {
            FileProblem::truncated(format!("{size} bytes in base64"), format!("{} characters are there", there.len()))
        };
        let decoded = STANDARD.decode(piece.ok_or_else(short)?);
        let mut decoded = decoded.map_err(|e| FileProblem::syntax("base64", e.to_string()))?;
        if decoded.len() < size {
            return Err(short());
        }
        decoded.truncate(size);
        Ok(decoded)
    }
}

fn kind(name: &str) -> Option<Kind> {
    Some(match name {
        "Int8" => Kind::I8,
        "UInt8" => Kind::U8,
        "Int16" => Kind::I16,
        "UInt16" => Kind::U16,
        "Int32" => Kind::I32,
        "UInt32" => Kind::U32,
        "Int64" => Kind::I64,
        "UInt64" => Kind::U64,
        "Float32" => Kind::F32,
        "Float64" => Kind::F64,
        _ => return None,
    })
}
