//! The header: what elements there are and how their rows are laid out.

use super::super::colour_scale::ColourScale;
use super::super::error::{FileError, FileProblem};
use super::super::legend::LegendEntry;
use super::super::text::{Words, integer, quoted, quoted_or_end};

/// How the data after the header is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the value, or of each value of a list.
    pub(super) scalar: Scalar,
    /// For a list, the type of its length.
    pub(super) list: Option<Scalar>,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// Rows, as stated.
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    /// Its line in the header.
    pub(super) line: usize,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// What comments say of the colours.
    pub(super) legend: Vec<LegendEntry>,
    /// What they say of values that colours stand for.
    pub(super) scale: Option<ColourScale>,
    /// Names of image files in comments.
    pub(super) images: Vec<Vec<u8>>,
    /// Lines of the header.
    pub(super) lines: usize,
    /// Bytes of the header.
    pub(super) bytes: usize,
}

impl Header {
    /// The index of the first element called `name`.
    pub(super) fn element(&self, name: &str) -> Option<usize> {
        self.elements.iter().position(|e| e.name == name)
    }

    pub(super) fn read(bytes: &[u8]) -> Result<Self, FileError> {
        // The data may hold any byte right after the header's last line, so lines end as the first does.
        let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let (mut legend, mut images, mut scale) = (Vec::new(), Vec::new(), ColourScale::default());
        let mut used = 0;
        for (i, raw) in bytes.split_inclusive(|&b| b == end).enumerate() {
            used += raw.len();
            let at = i + 1;
            let fail = |expected: &str, found: String| FileError::line(at, FileProblem::syntax(expected, found));
            let mut words = Words::new(raw);
            let word = words.next();
            match word {
                _ if at == 1 => {
                    if word != Some(b"ply") {
                        return Err(fail("`ply`", quoted_or_end(word)));
                    }
                }
                Some(b"format") => encoding = Some(encoding_of(&mut words).map_err(|p| FileError::line(at, p))?),
                Some(b"element") => elements.push(element(&mut words, at).map_err(|p| FileError::line(at, p))?),
                Some(b"property") => {
                    let element = elements.last_mut().ok_or_else(|| fail("`element`", quoted(raw.trim_ascii())))?;
                    element.properties.push(property(&mut words).map_err(|p| FileError::line(at, p))?);
                }
                Some(b"end_header") => {
                    let encoding = encoding.ok_or_else(|| fail("a `format` line in the header", "none".into()))?;
                    return Ok(Self {
                        encoding,
                        elements,
                        legend,
                        scale: scale.whole(),
                        images,
                        lines: at,
                        bytes: used,
                    });
                }
                Some(b"comment") => match words.rest().strip_prefix(b"TextureFile ") {
                    Some(name) => images.push(name.trim_ascii().to_vec()),
                    None => {
                        LegendEntry::gather(words.rest(), &mut legend);
                        ColourScale::gather(words.rest(), &mut scale);
                    }
                },
                None | Some(b"obj_info") => {}
                Some(word) => return Err(fail("a line of the header", quoted(word))),
            }
        }
        Err(FileError::byte(bytes.len(), FileProblem::truncated("`end_header`", "the file ends within the header")))
    }
}

fn encoding_of(words: &mut Words<'_>) -> Result<Encoding, FileProblem> {
    match words.next() {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::LittleEndian),
        Some(b"binary_big_endian") => Ok(Encoding::BigEndian),
        other => {
            Err(FileProblem::syntax("`ascii`, `binary_little_endian` or `binary_big_endian`", quoted_or_end(other)))
        }
    }
}

fn name(word: Option<&[u8]>, expected: &str) -> Result<String, FileProblem> {
    let word = word.ok_or_else(|| FileProblem::syntax(expected, quoted_or_end(None)))?;
    Ok(String::from_utf8_lossy(word).into_owned())
}

fn element(words: &mut Words<'_>, line: usize) -> Result<Element, FileProblem> {
    let name = name(words.next(), "a name of an element")?;
    let word = words.next();
    let count = word.and_then(integer).and_then(|n| usize::try_from(n).ok());
    let count = count.ok_or_else(|| FileProblem::syntax("a number of rows", quoted_or_end(word)))?;
    Ok(Element { name, count, properties: Vec::new(), line })
}

fn property(words: &mut Words<'_>) -> Result<Property, FileProblem> {
    let scalar = |word: Option<&[u8]>| {
        let found = word.and_then(Scalar::of);
        found.ok_or_else(|| FileProblem::syntax("a type such as `float` or `int`", quoted_or_end(word)))
    };
    let first = words.next();
    let (list, scalar) = match first {
        Some(b"list") => (Some(scalar(words.next())?), scalar(words.next())?),
        _ => (None, scalar(first)?),
    };
    Ok(Property { name: name(words.next(), "a name of a property")?, scalar, list })
}
