//! Lines, words and numbers of text formats, both ways.

use std::io::{self, Write};

use super::colour::Tails;
use super::pieces::in_pieces;
use crate::mesh::TriMesh;

/// The lines of a text with their numbers, from 1. Ends of lines may be LF, CR LF or, in a text
/// without any LF, CR.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    separator: u8,
}

impl<'a> Lines<'a> {
    /// The lines of `text`; a byte order mark before the first is dropped.
    pub(super) fn new(text: &'a [u8]) -> Self {
        let rest = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        Self { rest, number: 0, separator: if rest.contains(&b'\n') { b'\n' } else { b'\r' } }
    }

    /// The lines of `text`, which follow the line `number` of the file.
    pub(super) fn after(number: usize, text: &'a [u8]) -> Self {
        Self { number, ..Self::new(text) }
    }

    /// The number of the last line handed out.
    pub(super) fn number(&self) -> usize {
        self.number
    }

    /// Bytes not yet handed out.
    pub(super) fn bytes_left(&self) -> usize {
        self.rest.len()
    }

    /// The next line that is neither blank nor a comment (`#` first); what follows a `#` is cut off.
    pub(super) fn next_content(&mut self) -> Option<(usize, &'a [u8])> {
        self.find_map(|(number, line)| {
            let end = line.iter().position(|&b| b == b'#').unwrap_or(line.len());
            let line = line[..end].trim_ascii();
            (!line.is_empty()).then_some((number, line))
        })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&b| b == self.separator);
        let (line, rest) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &self.rest[self.rest.len()..]),
        };
        self.rest = rest;
        self.number += 1;
        Some((self.number, line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// The words of a line, between white space.
#[derive(Clone)]
pub(super) struct Words<'a>(&'a [u8]);

impl<'a> Words<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        Self(line)
    }

    /// What has not been handed out.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.0.trim_ascii()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.0.iter().position(|b| !b.is_ascii_whitespace())?;
        let tail = &self.0[start..];
        let end = tail.iter().position(u8::is_ascii_whitespace).unwrap_or(tail.len());
        self.0 = &tail[end..];
        Some(&tail[..end])
    }
}

/// A decimal number; infinities and NaN are numbers here, the caller tells them apart.
#[inline]
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A decimal number in single precision; what is no number, or not finite there, is NaN.
#[inline]
pub(super) fn single(word: &[u8]) -> f32 {
    std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()).unwrap_or(f32::NAN)
}

/// A whole number.
#[inline]
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    // Indices are short runs of digits; anything else takes the slow way.
    if (1..=9).contains(&word.len()) && word.iter().all(u8::is_ascii_digit) {
        return Some(word.iter().fold(0, |value, digit| value * 10 + i64::from(digit - b'0')));
    }
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// `bytes` for a message: quoted, short, without control characters.
pub(super) fn quoted(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text: String = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)])
        .chars()
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .take(LONGEST)
        .collect();
    let more = if bytes.len() > text.len() { "…" } else { "" };
    format!("`{text}{more}`")
}

/// `found` for a word that may be absent.
pub(super) fn quoted_or_end(word: Option<&[u8]>) -> String {
    word.map_or_else(|| "the end of the line".to_owned(), quoted)
}

/// `1 face`, `2 faces`, `3 meshes`, `4 vertices`.
pub(super) fn counted(count: usize, what: &str) -> String {
    match (count, what.strip_suffix("ex")) {
        (1, _) => format!("1 {what}"),
        (_, Some(stem)) => format!("{count} {stem}ices"),
        _ if what.ends_with("sh") => format!("{count} {what}es"),
        _ => format!("{count} {what}s"),
    }
}

/// Text output: numbers in their shortest form that reads back as the same `f64`, gathered into large writes.
pub(super) struct TextOut<'a> {
    out: &'a mut dyn Write,
    buffer: Vec<u8>,
}

const CHUNK: usize = 1 << 16;

impl<'a> TextOut<'a> {
    pub(super) fn new(out: &'a mut dyn Write) -> Self {
        Self { out, buffer: Vec::with_capacity(CHUNK + 1024) }
    }

    #[inline]
    pub(super) fn text(&mut self, text: &str) {
        self.buffer.extend_from_slice(text.as_bytes());
    }

    /// A finite number.
    #[inline]
    pub(super) fn number(&mut self, value: f64) {
        self.digits(zmij::Buffer::new().format(value));
    }

    /// A level of light or opacity, from 0 to 1.
    #[inline]
    pub(super) fn level(&mut self, level: u8) {
        // Four digits tell 256 levels apart.
        self.number((f64::from(level) / 255.0 * 1e4).round() / 1e4);
    }

    /// A finite number in the shortest form that reads back as the same `f32`; as `f64` it may not.
    #[inline]
    pub(super) fn short_number(&mut self, value: f32) {
        self.digits(zmij::Buffer::new().format(value));
    }

    #[inline]
    fn digits(&mut self, text: &str) {
        self.text(text.strip_suffix(".0").unwrap_or(text));
    }

    #[inline]
    pub(super) fn integer(&mut self, value: u64) {
        self.text(itoa::Buffer::new().format(value));
    }

    /// Each value after a space.
    pub(super) fn channels(&mut self, values: &[u8]) {
        for &value in values {
            self.text(" ");
            self.integer(u64::from(value));
        }
    }

    /// Writes `count` rows, each by itself on any thread, in their order.
    pub(super) fn each(&mut self, count: usize, row: impl Fn(usize, &mut TextOut<'_>) + Sync) -> io::Result<()> {
        self.flush()?;
        in_pieces(count, self.out, |rows, bytes| {
            let mut nowhere = io::sink();
            let mut text = TextOut { out: &mut nowhere, buffer: std::mem::take(bytes) };
            rows.for_each(|n| row(n, &mut text));
            *bytes = text.buffer;
        })
    }

    /// A line for each position, then a line for each triangle: 3 and its vertices, from 0. Each ends in its tail; `more` follows that of a
    /// triangle.
    pub(super) fn rows(
        &mut self,
        mesh: &TriMesh,
        tails: &Tails<'_>,
        more: impl Fn(usize, &mut TextOut<'_>) + Sync,
    ) -> io::Result<()> {
        self.each(mesh.positions.len(), |vertex, text| {
            for (k, x) in mesh.positions[vertex].to_array().into_iter().enumerate() {
                text.text(if k == 0 { "" } else { " " });
                text.number(x);
            }
            text.channels(tails.vertex(vertex));
            text.text("\n");
        })?;
        self.each(mesh.triangles.len(), |face, text| {
            text.text("3");
            for v in mesh.triangles[face] {
                text.text(" ");
                text.integer(u64::from(v));
            }
            text.channels(tails.face(face));
            more(face, text);
            text.text("\n");
        })
    }

    /// Passes the text on when there is enough of it. To be called now and then, and by
    /// [`TextOut::finish`].
    #[inline]
    pub(super) fn pass_on(&mut self) -> io::Result<()> {
        if self.buffer.len() >= CHUNK { self.flush() } else { Ok(()) }
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_end_in_three_ways() {
        let lines = |text: &'static str| Lines::new(text.as_bytes()).map(|(_, l)| l).collect::<Vec<_>>();
        let three: Vec<&[u8]> = vec![b"a", b"", b"b"];
        assert_eq!(lines("a\n\nb\n"), three);
        assert_eq!(lines("a\r\n\r\nb"), three);
        assert_eq!(lines("a\r\rb\r"), three);
        assert_eq!(lines("\u{feff}a\n\nb"), three);
    }

    proptest! {
        #[test]
        fn written_numbers_read_back(value in prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
                                     small in any::<f32>().prop_filter("finite", |v| v.is_finite()),
                                     whole in any::<u32>()) {
            let mut bytes = Vec::new();
            let mut out = TextOut::new(&mut bytes);
            out.number(value);
            out.text(" ");
            out.number(f64::from(small));
            out.text(" ");
            out.integer(u64::from(whole));
            out.finish().unwrap();
            let words: Vec<_> = Words::new(&bytes).collect();
            prop_assert_eq!(number(words[0]).unwrap().to_bits(), value.to_bits());
            prop_assert_eq!(number(words[1]).unwrap().to_bits(), f64::from(small).to_bits());
            prop_assert_eq!(integer(words[2]), Some(i64::from(whole)));
        }
    }
}
