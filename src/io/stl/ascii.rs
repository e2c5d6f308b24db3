//! ASCII STL: any number of solids, keywords in any case, line breaks anywhere.

use std::io::Write;

use glam::DVec3;

use super::super::error::{FileError, FileProblem, WriteError};
use super::super::soup::{Soup, Welder};
use super::super::text::{Lines, TextOut, Words, counted, number, quoted};
use super::normal;
use crate::mesh::TriMesh;

/// Words across lines.
struct Stream<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
    /// Whether the last word handed out is the first of its line.
    first: bool,
    /// Words that follow a statement on its line and mean nothing.
    trailing: usize,
}

/// The words that mean something.
const KEYWORDS: [&str; 9] = ["facet", "normal", "outer", "loop", "vertex", "endloop", "endfacet", "solid", "endsolid"];

impl<'a> Stream<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        self.first = false;
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            self.words = Words::new(self.lines.next()?.1);
            self.first = true;
        }
    }

    /// The next word that begins a line or means something.
    fn next_statement(&mut self) -> Option<&'a [u8]> {
        loop {
            let word = self.next()?;
            if self.first || KEYWORDS.iter().any(|keyword| is(word, keyword)) {
                return Some(word);
            }
            self.trailing += 1;
        }
    }

    fn rest_of_line(&mut self) -> &'a [u8] {
        std::mem::replace(&mut self.words, Words::new(b"")).rest()
    }

    fn fail(&self, problem: FileProblem) -> FileError {
        FileError::line(self.lines.number(), problem)
    }

    /// The next statement; the end of the file is an error that says what was `expected`.
    fn word(&mut self, expected: &str) -> Result<&'a [u8], FileError> {
        let word = self.next_statement();
        word.ok_or_else(|| self.fail(FileProblem::truncated(expected, "the file ends within a facet")))
    }

    /// The next word, whatever it means.
    fn any_word(&mut self, expected: &str) -> Result<&'a [u8], FileError> {
        let word = self.next();
        word.ok_or_else(|| self.fail(FileProblem::truncated(expected, "the file ends within a facet")))
    }

    fn keyword(&mut self, keyword: &str) -> Result<(), FileError> {
        let expected = format!("`{keyword}`");
        let word = self.word(&expected)?;
        if is(word, keyword) { Ok(()) } else { Err(self.fail(FileProblem::syntax(expected, quoted(word)))) }
    }

    fn point(&mut self) -> Result<DVec3, FileError> {
        let mut p = DVec3::ZERO;
        for k in 0..3 {
            let word = self.any_word("a coordinate")?;
            p[k] = number(word).ok_or_else(|| self.fail(FileProblem::syntax("a coordinate", quoted(word))))?;
        }
        Ok(p)
    }

    /// What follows the word `facet`: the normal is passed over, whatever it is written as.
    fn facet(&mut self, corners: &mut Vec<DVec3>) -> Result<(), FileError> {
        corners.clear();
        // `normal`, three numbers, and what may trail.
        const MOST: usize = 20;
        for _ in 0..MOST {
            let word = self.any_word("`outer loop`")?;
            if is(word, "outer") {
                break;
            }
            if is(word, "vertex") || is(word, "endfacet") {
                return Err(self.fail(FileProblem::syntax("`outer loop`", quoted(word))));
            }
        }
        self.keyword("loop")?;
        loop {
            let word = self.word("`vertex` or `endloop`")?;
            if is(word, "endloop") {
                break;
            }
            if !is(word, "vertex") {
                return Err(self.fail(FileProblem::syntax("`vertex` or `endloop`", quoted(word))));
            }
            corners.push(self.point()?);
        }
        if corners.len() < 3 {
            return Err(self.fail(FileProblem::syntax("three vertices in a loop", corners.len().to_string())));
        }
        self.keyword("endfacet")
    }
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

pub(super) fn read(bytes: &[u8]) -> Result<Soup, FileError> {
    let mut stream = Stream { lines: Lines::new(bytes), words: Words::new(b""), first: false, trailing: 0 };
    let mut soup = Soup::new();
    // About 250 bytes a facet in files as they are.
    let mut welder = Welder::for_triangles(bytes.len() / 250);
    let (mut corners, mut face) = (Vec::new(), Vec::new());
    let mut open = false;
    while let Some(word) = stream.next_statement() {
        if is(word, "facet") {
            stream.facet(&mut corners)?;
            face.clear();
            for &p in &corners {
                face.push(welder.vertex(p, &mut soup.positions)?);
            }
            soup.face(&face);
        } else if is(word, "solid") {
            soup.begin_part(stream.rest_of_line());
            open = true;
        } else if is(word, "endsolid") {
            stream.rest_of_line();
            open = false;
        } else {
            return Err(stream.fail(FileProblem::syntax("`facet`, `solid` or `endsolid`", quoted(word))));
        }
    }
    if stream.trailing > 0 {
        soup.warnings.push(format!("{} after the end of a statement left out", counted(stream.trailing, "word")));
    }
    if open {
        soup.warnings.push("no `endsolid` at the end: facets may be missing".into());
    }
    Ok(soup)
}

/// Writes one solid.
pub(in crate::io) fn write(mesh: &TriMesh, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    text.text("solid meshwright\n");
    text.each(mesh.triangles.len(), |triangle, text| {
        text.text("facet normal");
        // Nothing is computed from a normal, so it is written as short as an `f32` can be.
        for x in normal(mesh, triangle).as_vec3().to_array() {
            text.text(" ");
            text.short_number(x);
        }
        text.text("\nouter loop\n");
        for corner in mesh.corners(triangle) {
            text.text("vertex");
            for x in corner.as_vec3().to_array() {
                text.text(" ");
                text.number(f64::from(x));
            }
            text.text("\n");
        }
        text.text("endloop\nendfacet\n");
    })?;
    text.text("endsolid meshwright\n");
    Ok(text.finish()?)
}
