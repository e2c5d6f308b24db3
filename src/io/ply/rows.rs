//! The rows of the elements, one after another, as numbers.

use super::super::error::{FileError, FileProblem, Location};
use super::super::text::{Lines, Words, number, quoted_or_end};
use super::header::{Element, Encoding, Header, Property, Scalar};

/// A place in the data and the row last read there.
#[derive(Clone)]
pub(super) struct Rows<'a> {
    data: Data<'a>,
    /// Where the row last read begins: a byte, or a line of a text.
    place: u64,
    values: Vec<f64>,
    /// The end of each property in `values`.
    ends: Vec<usize>,
}

#[derive(Clone)]
enum Data<'a> {
    Text(Lines<'a>),
    Binary { bytes: &'a [u8], used: usize, big: bool },
}

impl<'a> Rows<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        let data = match header.encoding {
            Encoding::Ascii => Data::Text(Lines::after(header.lines, &bytes[header.bytes..])),
            encoding => Data::Binary { bytes, used: header.bytes, big: encoding == Encoding::BigEndian },
        };
        Self { data, place: header.bytes as u64, values: Vec::new(), ends: Vec::new() }
    }

    /// The error for a problem in the row last read.
    pub(super) fn fail(&self, problem: FileProblem) -> FileError {
        match self.data {
            Data::Text(_) => FileError::line(self.place as usize, problem),
            Data::Binary { .. } => FileError::at(Location::Byte(self.place), problem),
        }
    }

    /// An error unless the bytes that are left could hold the rows of `element`, each as short as
    /// can be. Only then is it safe to set memory aside for them.
    pub(super) fn can_hold(&self, element: &Element) -> Result<(), FileError> {
        let (shortest, left, place) = match &self.data {
            // A digit and a space or line end for each property, of which the very last may be missing.
            Data::Text(lines) => (2 * element.properties.len(), lines.bytes_left() + 1, Location::Line(lines.number())),
            Data::Binary { bytes, used, .. } => {
                (fixed_size(element), bytes.len() - used, Location::Byte(bytes.len() as u64))
            }
        };
        match element.count.checked_mul(shortest) {
            Some(needed) if needed <= left => Ok(()),
            _ => {
                let expected = format!("{} rows of `{}`", element.count, element.name);
                Err(FileError::at(place, FileProblem::truncated(expected, format!("{left} bytes are left for them"))))
            }
        }
    }

    /// Reads a row of `element`.
    #[inline]
    pub(super) fn next(&mut self, element: &Element) -> Result<(), FileError> {
        self.values.clear();
        self.ends.clear();
        match &mut self.data {
            Data::Text(lines) => {
                let (at, line) = text_row(lines, element)?;
                self.place = at as u64;
                let mut words = Words::new(line);
                for property in &element.properties {
                    text_property(&mut words, property, &mut self.values).map_err(|p| FileError::line(at, p))?;
                    self.ends.push(self.values.len());
                }
            }
            Data::Binary { bytes, used, big } => {
                self.place = *used as u64;
                for property in &element.properties {
                    binary_property(bytes, used, *big, property, &mut self.values)
                        .map_err(|problem| FileError::byte(bytes.len(), problem))?;
                    self.ends.push(self.values.len());
                }
            }
        }
        Ok(())
    }

    /// The value of a property that is no list, in the row last read.
    #[inline]
    pub(super) fn scalar(&self, property: usize) -> f64 {
        self.list(property).first().copied().unwrap_or(f64::NAN)
    }

    /// The values of a list, in the row last read.
    #[inline]
    pub(super) fn list(&self, property: usize) -> &[f64] {
        let start = property.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.values[start..self.ends[property]]
    }

    /// Reads over all rows of `element`.
    pub(super) fn pass_over(&mut self, element: &Element) -> Result<(), FileError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        self.can_hold(element)?;
        match &mut self.data {
            Data::Text(lines) => (0..element.count).try_for_each(|_| text_row(lines, element).map(drop)),
            Data::Binary { used, .. } if element.properties.iter().all(|p| p.list.is_none()) => {
                // `can_hold` has shown that this many bytes are left.
                *used += element.count * fixed_size(element);
                Ok(())
            }
            Data::Binary { .. } => (0..element.count).try_for_each(|_| self.next(element)),
        }
    }
}

/// Bytes of a row whose lists are empty.
fn fixed_size(element: &Element) -> usize {
    element.properties.iter().map(|p| p.list.unwrap_or(p.scalar).size()).sum()
}

/// The next line that is not blank.
fn text_row<'a>(lines: &mut Lines<'a>, element: &Element) -> Result<(usize, &'a [u8]), FileError> {
    lines.find(|(_, line)| !line.trim_ascii().is_empty()).ok_or_else(|| {
        let expected = format!("{} rows of `{}`", element.count, element.name);
        FileError::line(lines.number(), FileProblem::truncated(expected, "the file ends before the last"))
    })
}

fn text_property(words: &mut Words<'_>, property: &Property, values: &mut Vec<f64>) -> Result<(), FileProblem> {
    let mut value = || {
        let word = words.next();
        let fail = || FileProblem::syntax(format!("a number for `{}`", property.name), quoted_or_end(word));
        word.and_then(number).ok_or_else(fail)
    };
    let length = if property.list.is_some() { length(value()?, property)? } else { 1 };
    for _ in 0..length {
        values.push(value()?);
    }
    Ok(())
}

fn length(value: f64, property: &Property) -> Result<usize, FileProblem> {
    if value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0 {
        Ok(value as usize)
    } else {
        Err(FileProblem::syntax(format!("the length of `{}`", property.name), value.to_string()))
    }
}

#[inline]
fn binary_property(
    bytes: &[u8],
    used: &mut usize,
    big: bool,
    property: &Property,
    values: &mut Vec<f64>,
) -> Result<(), FileProblem> {
    let truncated = || FileProblem::truncated(format!("a value of `{}`", property.name), "the file ends within a row");
    let length = match property.list {
        None => 1,
        Some(kind) => {
            let field = bytes.get(*used..*used + kind.size()).ok_or_else(truncated)?;
            *used += kind.size();
            length(decode(field, kind, big), property)?
        }
    };
    let size = property.scalar.size();
    let end = length.checked_mul(size).and_then(|all| all.checked_add(*used));
    let fields = end.and_then(|end| bytes.get(*used..end)).ok_or_else(truncated)?;
    *used += fields.len();
    values.extend(fields.chunks_exact(size).map(|field| decode(field, property.scalar, big)));
    Ok(())
}

/// The number in `field`, which has the size of `kind`.
#[inline]
fn decode(field: &[u8], kind: Scalar, big: bool) -> f64 {
    let mut raw = [0; 8];
    let size = kind.size().min(field.len());
    raw[..size].copy_from_slice(&field[..size]);
    if big {
        raw[..size].reverse();
    }
    let bits = u64::from_le_bytes(raw);
    match kind {
        Scalar::I8 => f64::from(bits as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}
