//! Wavefront OBJ: vertices with or without colours, faces with texture coordinates, objects and groups, materials; everything else is
//! passed over.

mod apart;
mod materials;
mod write;

use std::borrow::Cow;
use std::path::Path;

use glam::DVec3;

use self::apart::Section;
use self::materials::Looks;
use super::colour::LEVELS_OF_WHITE;
use super::error::{FileError, FileProblem};
use super::soup::{LONGEST_NAME, Soup, too_many_vertices};
use super::text::{Lines, Words, counted, integer, number, quoted, quoted_or_end};
use super::{Format, Loaded};

pub(super) use apart::read_apart;
pub(super) use write::write;

/// Reads the file at `path`, beside which its materials and images lie.
pub(super) fn read(bytes: &[u8], path: Option<&Path>) -> Result<Loaded, FileError> {
    let mut reader = Reader::default();
    read_all(bytes, &mut reader)?;
    reader.finish(path)
}

fn read_all(bytes: &[u8], reader: &mut Reader) -> Result<(), FileError> {
    let mut lines = Lines::new(bytes);
    while let Some((first, line)) = lines.next() {
        let line = continued(line, &mut lines);
        reader.statement(&line, first)?;
    }
    Ok(())
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
    looks: Looks,
    face: Vec<u32>,
    /// The largest index so far and its line: a face may refer to vertices that come later, so
    /// the check waits for the end.
    largest: Option<(u32, usize)>,
    /// Lines and free-form statements passed over.
    passed_over: usize,
    /// Statements of points passed over.
    points: usize,
    /// Where objects are wanted: what each part is; the parts go by their numbers.
    sections: Option<Vec<Section>>,
}

impl Default for Reader {
    fn default() -> Self {
        Self {
            soup: Soup::new(),
            looks: Looks::default(),
            face: Vec::new(),
            largest: None,
            passed_over: 0,
            points: 0,
            sections: None,
        }
    }
}

impl Reader {
    fn statement(&mut self, line: &[u8], at: usize) -> Result<(), FileError> {
        let mut words = Words::new(line);
        match words.next() {
            Some(b"v") => self.vertex(words, at),
            Some(b"f" | b"fo") => self.face(words, at),
            Some(kind @ (b"o" | b"g")) => {
                self.part(kind == b"o", words.rest());
                Ok(())
            }
            Some(b"vt") => {
                self.looks.coordinate(words);
                Ok(())
            }
            Some(b"usemtl") => {
                self.looks.material(words.rest(), &mut self.soup.texture);
                Ok(())
            }
            Some(b"mtllib") => {
                self.looks.library(words.rest());
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

    fn part(&mut self, is_object: bool, name: &[u8]) {
        let Some(sections) = &mut self.sections else { return self.soup.begin_part(name) };
        let name = String::from_utf8_lossy(&name[..name.len().min(LONGEST_NAME)]).trim().to_owned();
        let next = sections.last().cloned().unwrap_or_default().next(is_object, name);
        self.soup.begin_part(sections.len().to_string().as_bytes());
        sections.push(next);
    }

    /// Three coordinates, and a colour if exactly three numbers follow; anything else after them is passed over.
    fn vertex(&mut self, mut words: Words<'_>, at: usize) -> Result<(), FileError> {
        let mut p = DVec3::ZERO;
        for k in 0..3 {
            let word = words.next();
            let fail = || FileProblem::syntax("three coordinates after `v`", quoted_or_end(word));
            p[k] = word.and_then(number).ok_or_else(|| FileError::line(at, fail()))?;
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

    fn face(&mut self, words: Words<'_>, at: usize) -> Result<(), FileError> {
        self.face.clear();
        self.looks.begin_face();
        let first = self.soup.triangles.len();
        let count = self.soup.positions.len();
        let mut largest = 0;
        for word in words {
            if word.starts_with(b"#") {
                break;
            }
            let corner = corner(word, count).map_err(|problem| FileError::line(at, problem))?;
            largest = largest.max(corner);
            self.face.push(corner);
            self.looks.corner(word);
        }
        if self.largest.is_none_or(|(known, _)| largest > known) {
            self.largest = Some((largest, at));
        }
        // The shape of a polygon ahead of its vertices is not known: a fan.
        let ahead = largest as usize >= count && self.face.len() > 3;
        if self.face.len() >= 3 && self.looks.is_textured(self.face.len()) {
            self.looks.add(&self.face, ahead, &mut self.soup);
        } else if ahead {
            super::polygon::fan(&self.face, &mut self.soup.triangles);
        } else {
            self.soup.face(&self.face);
        }
        self.looks.cover(first, &mut self.soup);
        Ok(())
    }

    fn finish(mut self, path: Option<&Path>) -> Result<Loaded, FileError> {
        let count = self.soup.positions.len();
        if let Some((largest, line)) = self.largest
            && largest as usize >= count
            && !self.soup.triangles.is_empty()
        {
            return Err(FileError::line(line, FileProblem::vertex(i64::from(largest) + 1, count)));
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
        self.looks.finish(&mut self.soup, path);
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
fn corner(word: &[u8], count: usize) -> Result<u32, FileProblem> {
    let end = word.iter().position(|&b| b == b'/').unwrap_or(word.len());
    let index = integer(&word[..end]).ok_or_else(|| FileProblem::syntax("a vertex number", quoted(word)))?;
    let from_zero = if index < 0 { index.checked_add(count as i64) } else { index.checked_sub(1) };
    from_zero
        .and_then(|i| u32::try_from(i).ok())
        .filter(|&i| i < u32::MAX)
        .ok_or_else(|| FileProblem::vertex(index, count))
}
