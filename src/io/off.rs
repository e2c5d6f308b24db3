//! OFF: the object file format of Geomview in its ASCII form; normals and texture coordinates are passed over.

use std::io::Write;
use std::ops::Range;

use glam::DVec3;

use super::colour::{Colours, LEVELS_OF_WHITE, Levels, Tails};
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
    /// What stands after the three coordinates, in this order.
    Points {
        normals: bool,
        colours: bool,
        texture: bool,
    },
    OtherDimension,
}

/// `[ST][C][N][4][n]OFF`: in each variant the position comes first, except that `4` and `n` give
/// it another number of coordinates.
fn layout(word: &[u8]) -> Option<Layout> {
    let mut prefix = word.strip_suffix(b"OFF")?;
    let [texture, colours, normals] = [b"ST".as_slice(), b"C", b"N"].map(|optional| {
        let rest = prefix.strip_prefix(optional);
        prefix = rest.unwrap_or(prefix);
        rest.is_some()
    });
    match prefix {
        b"" => Some(Layout::Points { normals, colours, texture }),
        b"4" | b"n" | b"4n" => Some(Layout::OtherDimension),
        _ => None,
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, ReadError> {
    let mut lines = Lines::new(bytes);
    let ([vertices, faces], extras) = header(&mut lines)?;
    let [mut of_vertices, mut of_faces] = [Tints::default(), Tints::default()];
    let mut soup = Soup::new();
    // The shortest vertex line has six bytes, the shortest triangle eight.
    soup.positions.reserve(vertices.min(lines.bytes_left() / 6));
    for i in 0..vertices {
        let (at, line) = next(&mut lines, "vertices", i, vertices)?;
        let mut words = Words::new(line);
        soup.positions.push(vertex(&mut words).map_err(|problem| ReadError::line(at, problem))?);
        if let Some(extras) = extras {
            of_vertices.add(words.rest(), extras, i..i + 1);
        }
    }
    soup.triangles.reserve(faces.min(lines.bytes_left() / 8));
    let mut face = Vec::new();
    for i in 0..faces {
        let (at, line) = next(&mut lines, "faces", i, faces)?;
        let mut words = Words::new(line);
        corners(&mut words, vertices, &mut face).map_err(|problem| ReadError::line(at, problem))?;
        let first = soup.triangles.len();
        soup.face(&face);
        of_faces.add(words.rest(), Extras::default(), first..soup.triangles.len());
    }
    if let Some((at, _)) = lines.next_content() {
        soup.warnings.push(format!("the file goes on after its last face; left out from line {at}"));
    }
    soup.colours.vertices = of_vertices.levels();
    soup.colours.faces = of_faces.levels();
    soup.finish(Format::Off, None)
}

/// The numbers of vertices and faces, and what surrounds the colours of vertices if the keyword says that they have some.
/// The keyword may be missing, and the counts may stand on its line.
fn header(lines: &mut Lines<'_>) -> Result<([usize; 2], Option<Extras>), ReadError> {
    let ends = |lines: &Lines<'_>| {
        let problem = ReadProblem::truncated("the numbers of vertices and faces", "the file ends");
        ReadError::line(lines.number(), problem)
    };
    let (mut at, line) = lines.next_content().ok_or_else(|| ends(lines))?;
    let mut words = Words::new(line);
    let mut first = words.next();
    let mut extras = None;
    match first.and_then(layout) {
        Some(Layout::Points { normals, colours, texture }) => {
            extras = colours.then_some(Extras { before: 3 * usize::from(normals), after: 2 * usize::from(texture) });
            first = words.next();
        }
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
    Ok(([count(first)?, count(words.next())?], extras))
}

fn next<'a>(lines: &mut Lines<'a>, what: &str, have: usize, all: usize) -> Result<(usize, &'a [u8]), ReadError> {
    lines.next_content().ok_or_else(|| {
        let problem = ReadProblem::truncated(format!("{all} {what}"), format!("the file ends after {have}"));
        ReadError::line(lines.number(), problem)
    })
}

fn vertex(words: &mut Words<'_>) -> Result<DVec3, ReadProblem> {
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

/// The corners of a face line.
fn corners(words: &mut Words<'_>, vertices: usize, face: &mut Vec<u32>) -> Result<(), ReadProblem> {
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

/// Numbers of a line that stand around a colour.
#[derive(Debug, Clone, Copy, Default)]
struct Extras {
    before: usize,
    after: usize,
}

/// The colours of vertices or of faces as they come.
#[derive(Default)]
struct Tints {
    levels: Levels,
    /// Whether a number was written as a fraction. The format tells colours that count to 1 from those that count to 255
    /// by that.
    fractions: bool,
}

impl Tints {
    /// Takes the colour from the end of a line: three or four numbers. Anything else is passed over, as it always was: one
    /// number is an entry in a colour map that the file does not hold.
    fn add(&mut self, text: &[u8], extras: Extras, which: Range<usize>) {
        if text.is_empty() {
            return;
        }
        const MOST: usize = 3 + 4 + 2;
        let mut numbers = [0.0; MOST];
        let mut count = 0;
        let mut fractions = false;
        for word in Words::new(text) {
            let (Some(slot), Some(value)) = (numbers.get_mut(count), number(word)) else { return };
            *slot = value as f32;
            // Only the colour's own way of writing counts, and it may be followed by texture coordinates.
            fractions |= (extras.before..extras.before + 3).contains(&count) && integer(word).is_none();
            count += 1;
        }
        let mut levels = LEVELS_OF_WHITE;
        if let Some(channels @ (3 | 4)) = count.checked_sub(extras.before + extras.after) {
            levels[..channels].copy_from_slice(&numbers[extras.before..extras.before + channels]);
            self.levels.put(which, levels);
            self.fractions |= fractions;
        }
    }

    fn levels(mut self) -> Levels {
        if !self.fractions {
            self.levels.count_to(255.0);
        }
        self.levels
    }
}

/// Writes positions and triangles, with colours in whole numbers after those that have some. The format asks for alpha
/// with the colour of a vertex; faces get it too.
pub(super) fn write(mesh: &TriMesh, colours: Option<&Colours>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    let tails = Tails::of(colours).with_alpha();
    text.text(if tails.vertex_channels() > 0 { "COFF\n" } else { "OFF\n" });
    text.integer(mesh.positions.len() as u64);
    text.text(" ");
    text.integer(mesh.triangles.len() as u64);
    text.text(" 0\n");
    text.rows(mesh, &tails)?;
    Ok(text.finish()?)
}
