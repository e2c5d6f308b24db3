//! Wavefront OBJ: vertices with or without colours, faces, objects and groups; everything else is passed over.

use std::borrow::Cow;
use std::io::Write;

use glam::DVec3;

use super::colour::{Colours, LEVELS_OF_WHITE, vertex_means};
use super::error::{ReadError, ReadProblem, WriteError};
use super::soup::{Soup, counted, too_many_vertices};
use super::text::{Lines, TextOut, Words, integer, number, quoted, quoted_or_end};
use super::{Format, Loaded};
use crate::mesh::TriMesh;

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, ReadError> {
    let mut reader = Reader::default();
    let mut lines = Lines::new(bytes);
    while let Some((first, line)) = lines.next() {
        let line = continued(line, &mut lines);
        reader.statement(&line, first)?;
    }
    reader.finish()
}

/// `line` joined with the ones after it while it ends in a backslash.
fn continued<'a>(line: &'a [u8], lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let Some(mut part) = line.strip_suffix(b"\\") else {
        return Cow::Borrowed(line);
    };
    let mut joined = Vec::new();
    loop {
        joined.extend_from_slice(part);
        joined.push(b' ');
        match lines.next() {
            None => return Cow::Owned(joined),
            Some((_, next)) => match next.strip_suffix(b"\\") {
                Some(stem) => part = stem,
                None => {
                    joined.extend_from_slice(next);
                    return Cow::Owned(joined);
                }
            },
        }
    }
}

struct Reader {
    soup: Soup,
    face: Vec<u32>,
    /// The largest index so far and its line: a face may refer to vertices that come later, so
    /// the check waits for the end.
    largest: Option<(u32, usize)>,
    /// Lines and free-form statements passed over.
    passed_over: usize,
    /// Statements of points passed over.
    points: usize,
}

impl Default for Reader {
    fn default() -> Self {
        Self { soup: Soup::new(), face: Vec::new(), largest: None, passed_over: 0, points: 0 }
    }
}

impl Reader {
    fn statement(&mut self, line: &[u8], at: usize) -> Result<(), ReadError> {
        let mut words = Words::new(line);
        match words.next() {
            Some(b"v") => self.vertex(words, at),
            Some(b"f" | b"fo") => self.face(words, at),
            Some(b"o" | b"g") => {
                self.soup.begin_part(words.rest());
                Ok(())
            }
            Some(b"l" | b"curv" | b"curv2" | b"surf") => {
                self.passed_over += 1;
                Ok(())
            }
            Some(b"p") => {
                self.points += 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Three coordinates, and a colour if exactly three numbers follow; anything else after them is passed over.
    fn vertex(&mut self, mut words: Words<'_>, at: usize) -> Result<(), ReadError> {
        let mut p = DVec3::ZERO;
        for k in 0..3 {
            let word = words.next();
            let fail = || ReadProblem::syntax("three coordinates after `v`", quoted_or_end(word));
            p[k] = word.and_then(number).ok_or_else(|| ReadError::line(at, fail()))?;
        }
        if self.soup.positions.len() >= u32::MAX as usize {
            return Err(too_many_vertices());
        }
        let vertex = self.soup.positions.len();
        self.soup.positions.push(p);
        if let Some(levels) = colour(words) {
            self.soup.colours.vertices.put(vertex..vertex + 1, levels);
        }
        Ok(())
    }

    fn face(&mut self, words: Words<'_>, at: usize) -> Result<(), ReadError> {
        self.face.clear();
        let count = self.soup.positions.len();
        let mut largest = 0;
        for word in words {
            if word.starts_with(b"#") {
                break;
            }
            let corner = corner(word, count).map_err(|problem| ReadError::line(at, problem))?;
            largest = largest.max(corner);
            self.face.push(corner);
        }
        if self.largest.is_none_or(|(known, _)| largest > known) {
            self.largest = Some((largest, at));
        }
        if largest as usize >= count && self.face.len() > 3 {
            // The shape of a polygon ahead of its vertices is not known: a fan.
            super::polygon::fan(&self.face, &mut self.soup.triangles);
        } else {
            self.soup.face(&self.face);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Loaded, ReadError> {
        let count = self.soup.positions.len();
        if let Some((largest, line)) = self.largest
            && largest as usize >= count
            && !self.soup.triangles.is_empty()
        {
            return Err(ReadError::line(line, ReadProblem::vertex(i64::from(largest) + 1, count)));
        }
        // A file of points alone is named as such.
        let passed_over = match self.soup.triangles.is_empty() {
            true => self.passed_over,
            false => self.passed_over + self.points,
        };
        if passed_over > 0 {
            let what = counted(passed_over, "line, point or free-form statement");
            self.soup.warnings.push(format!("{what} left out"));
        }
        self.soup.finish(Format::Obj, None)
    }
}

/// Red, green and blue, if `words` are that and no more than a comment follows.
#[inline]
fn colour(words: Words<'_>) -> Option<[f32; 4]> {
    let mut levels = LEVELS_OF_WHITE;
    let mut count = 0;
    for word in words.take_while(|word| !word.starts_with(b"#")) {
        *levels[..3].get_mut(count)? = number(word)? as f32;
        count += 1;
    }
    (count == 3).then_some(levels)
}

/// The vertex of a face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, from 0: files count from 1, or
/// backwards from the last vertex so far.
#[inline]
fn corner(word: &[u8], count: usize) -> Result<u32, ReadProblem> {
    let end = word.iter().position(|&b| b == b'/').unwrap_or(word.len());
    let index = integer(&word[..end]).ok_or_else(|| ReadProblem::syntax("a vertex number", quoted(word)))?;
    let from_zero = if index < 0 { index.checked_add(count as i64) } else { index.checked_sub(1) };
    from_zero
        .and_then(|i| u32::try_from(i).ok())
        .filter(|&i| i < u32::MAX)
        .ok_or_else(|| ReadProblem::vertex(index, count))
}

/// Writes positions, with a colour after each if there are colours, and triangles.
pub(super) fn write(mesh: &TriMesh, colours: Option<&Colours>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    let colours = colours.map(|colours| vertex_means(mesh, colours));
    for (vertex, p) in mesh.positions.iter().enumerate() {
        text.text("v");
        for x in p.to_array() {
            text.text(" ");
            text.number(x);
        }
        if let Some(colour) = colours.as_ref().and_then(|colours| colours.get(vertex)) {
            for level in &colour[..3] {
                // Four digits tell 256 levels apart.
                text.text(" ");
                text.number((f64::from(*level) / 255.0 * 1e4).round() / 1e4);
            }
        }
        text.text("\n");
        text.pass_on()?;
    }
    for t in &mesh.triangles {
        text.text("f");
        for v in t {
            text.text(" ");
            text.integer(u64::from(*v) + 1);
        }
        text.text("\n");
        text.pass_on()?;
    }
    Ok(text.finish()?)
}
