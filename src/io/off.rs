//! OFF: the object file format of Geomview in its ASCII form, with colours, normals or texture
//! coordinates passed over.

use std::io::Write;

use glam::DVec3;

use super::error::{ReadError, ReadProblem, WriteError};
use super::soup::Soup;
use super::text::{Lines, TextOut, Words, integer, number, quoted, quoted_or_end};
use super::{Format, Loaded};
use crate::mesh::TriMesh;

/// Whether the first word, after comments, is one of the format's keywords.
pub(super) fn has_keyword(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1 << 16)];
    Lines::new(head).next_content().and_then(|(_, line)| Words::new(line).next()).is_some_and(|w| layout(w).is_some())
}

/// What the keyword says of the vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Layout {
    Points,
    OtherDimension,
}

/// `[ST][C][N][4][n]OFF`: in each variant the position comes first, except that `4` and `n` give
/// it another number of coordinates.
fn layout(word: &[u8]) -> Option<Layout> {
    let mut prefix = word.strip_suffix(b"OFF")?;
    for optional in [b"ST".as_slice(), b"C", b"N"] {
        prefix = prefix.strip_prefix(optional).unwrap_or(prefix);
    }
    match prefix {
        b"" => Some(Layout::Points),
        b"4" | b"n" | b"4n" => Some(Layout::OtherDimension),
        _ => None,
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, ReadError> {
    let mut lines = Lines::new(bytes);
    let [vertices, faces] = header(&mut lines)?;
    let mut soup = Soup::new();
    // The shortest vertex line has six bytes, the shortest triangle eight.
    soup.positions.reserve(vertices.min(lines.bytes_left() / 6));
    for i in 0..vertices {
        let (at, line) = next(&mut lines, "vertices", i, vertices)?;
        soup.positions.push(vertex(line).map_err(|problem| ReadError::line(at, problem))?);
    }
    soup.triangles.reserve(faces.min(lines.bytes_left() / 8));
    let mut face = Vec::new();
    for i in 0..faces {
        let (at, line) = next(&mut lines, "faces", i, faces)?;
        corners(line, vertices, &mut face).map_err(|problem| ReadError::line(at, problem))?;
        soup.face(&face);
    }
    if let Some((at, _)) = lines.next_content() {
        soup.warnings.push(format!("the file goes on after its last face; left out from line {at}"));
    }
    soup.finish(Format::Off, None)
}

/// The numbers of vertices and faces. The keyword may be missing, and the counts may stand on its line.
fn header(lines: &mut Lines<'_>) -> Result<[usize; 2], ReadError> {
    let ends = |lines: &Lines<'_>| {
        let problem = ReadProblem::truncated("the numbers of vertices and faces", "the file ends");
        ReadError::line(lines.number(), problem)
    };
    let (mut at, line) = lines.next_content().ok_or_else(|| ends(lines))?;
    let mut words = Words::new(line);
    let mut first = words.next();
    match first.and_then(layout) {
        Some(Layout::Points) => first = words.next(),
        Some(Layout::OtherDimension) => {
            let problem = ReadProblem::Unsupported("OFF with other than three coordinates is not read here".into());
            return Err(ReadError::line(at, problem));
        }
        None => {}
    }
    if first.is_some_and(|word| word.eq_ignore_ascii_case(b"BINARY")) {
        let problem = ReadProblem::Unsupported("binary OFF is not read here; write it as ASCII OFF or PLY".into());
        return Err(ReadError::line(at, problem));
    }
    if first.is_none() {
        let (next, line) = lines.next_content().ok_or_else(|| ends(lines))?;
        at = next;
        words = Words::new(line);
        first = words.next();
    }
    let count = |word: Option<&[u8]>| {
        let value = word.and_then(integer).and_then(|n| u32::try_from(n).ok());
        let fail = || ReadProblem::syntax("the numbers of vertices and faces", quoted_or_end(word));
        value.map(|n| n as usize).ok_or_else(|| ReadError::line(at, fail()))
    };
    Ok([count(first)?, count(words.next())?])
}

fn next<'a>(lines: &mut Lines<'a>, what: &str, have: usize, all: usize) -> Result<(usize, &'a [u8]), ReadError> {
    lines.next_content().ok_or_else(|| {
        let problem = ReadProblem::truncated(format!("{all} {what}"), format!("the file ends after {have}"));
        ReadError::line(lines.number(), problem)
    })
}

fn vertex(line: &[u8]) -> Result<DVec3, ReadProblem> {
    let mut words = Words::new(line);
    let mut p = DVec3::ZERO;
    for k in 0..3 {
        let word = words.next();
        let fail = || ReadProblem::syntax("three coordinates", quoted_or_end(word));
        p[k] = word.and_then(number).ok_or_else(fail)?;
        if !p[k].is_finite() {
            return Err(ReadProblem::NotFinite { found: quoted_or_end(word) });
        }
    }
    Ok(p)
}

/// The corners of a face line; a colour after them is passed over.
fn corners(line: &[u8], vertices: usize, face: &mut Vec<u32>) -> Result<(), ReadProblem> {
    let mut words = Words::new(line);
    let word = words.next().unwrap_or_default();
    let count = integer(word).filter(|n| *n >= 0);
    let count = count.ok_or_else(|| ReadProblem::syntax("a number of corners", quoted(word)))?;
    face.clear();
    for _ in 0..count {
        let word = words.next();
        let fail = || ReadProblem::syntax(format!("{count} vertex numbers"), quoted_or_end(word));
        let index = word.and_then(integer).ok_or_else(fail)?;
        let corner = u32::try_from(index).ok().filter(|&i| (i as usize) < vertices);
        face.push(corner.ok_or(ReadProblem::vertex(index, vertices))?);
    }
    Ok(())
}

/// Writes positions and triangles.
pub(super) fn write(mesh: &TriMesh, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    text.text("OFF\n");
    text.integer(mesh.positions.len() as u64);
    text.text(" ");
    text.integer(mesh.triangles.len() as u64);
    text.text(" 0\n");
    text.rows(mesh)?;
    Ok(text.finish()?)
}
