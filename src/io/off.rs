//! OFF: the object file format of Geomview in its ASCII form; normals and texture coordinates are passed over.

use std::io::Write;
use std::ops::Range;

use glam::DVec3;

use super::colour::{Colours, LEVELS_OF_WHITE, Levels, Tails};
use super::error::{FileError, FileProblem, WriteError};
use super::soup::Soup;
use super::text::{Lines, TextOut, Words, integer, number, quoted};
use super::{Format, Loaded};
use crate::mesh::TriMesh;

/// Whether the first word, after comments, is one of the format's keywords.
pub(super) fn has_keyword(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1 << 16)];
    let first = Lines::new(head).next_content().and_then(|(_, line)| Words::new(line).next());
    first.is_some_and(|word| layout(split_keyword(word).0).is_some())
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

/// A keyword and the number that some programs write right behind it: `OFF8`.
fn split_keyword(word: &[u8]) -> (&[u8], &[u8]) {
    let digits = word.iter().rev().take_while(|byte| byte.is_ascii_digit()).count();
    let (keyword, number) = word.split_at(word.len() - digits);
    if keyword.ends_with(b"OFF") { (keyword, number) } else { (word, b"") }
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

/// Words across lines; comments are passed over.
#[derive(Clone)]
struct Stream<'a> {
    lines: Lines<'a>,
    /// What is left of the line.
    words: Words<'a>,
}

impl<'a> Stream<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            self.words = Words::new(self.lines.next_content()?.1);
        }
    }

    /// What is left of the line, which is done with.
    fn rest_of_line(&mut self) -> &'a [u8] {
        std::mem::replace(&mut self.words, Words::new(b"")).rest()
    }

    /// The colour after what was begun on line `first`. Nothing may follow on another line: there a number was missing.
    fn colour(&mut self, first: usize, expected: &str) -> Result<&'a [u8], FileError> {
        let rest = self.rest_of_line();
        match rest.is_empty() || self.lines.number() == first {
            true => Ok(rest),
            false => Err(self.fail(FileProblem::syntax(format!("{expected} and then a new line"), quoted(rest)))),
        }
    }

    /// Whether at least `count` lines with content follow the one being read.
    fn has_lines(&self, count: usize) -> bool {
        let mut lines = self.lines.clone();
        (0..count).all(|_| lines.next_content().is_some())
    }

    fn fail(&self, problem: FileProblem) -> FileError {
        FileError::line(self.lines.number(), problem)
    }

    /// The error for a file that ends after `have` of `all` vertices or faces.
    fn ends(&self, what: &str, have: usize, all: usize) -> FileError {
        self.fail(FileProblem::truncated(format!("{all} {what}"), format!("the file ends after {have}")))
    }

    fn count(&self, word: Option<&[u8]>) -> Result<usize, FileError> {
        const WANTED: &str = "the numbers of vertices and faces";
        let word = word.ok_or_else(|| self.fail(FileProblem::truncated(WANTED, "the file ends")))?;
        let value = integer(word).and_then(|n| u32::try_from(n).ok());
        value.map(|n| n as usize).ok_or_else(|| self.fail(FileProblem::syntax(WANTED, quoted(word))))
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, FileError> {
    let mut stream = Stream { lines: Lines::new(bytes), words: Words::new(b"") };
    let ([vertices, faces], extras) = header(&mut stream)?;
    let [mut of_vertices, mut of_faces] = [Tints::default(), Tints::default()];
    let mut soup = Soup::new();
    // The shortest vertex has six bytes, the shortest triangle eight.
    soup.positions.reserve(vertices.min(stream.lines.bytes_left() / 6));
    // Each vertex and each face begins a line, and may have a colour at its end; or there are not lines enough for that.
    let by_line = stream.has_lines(vertices);
    for i in 0..vertices {
        let (p, line) = vertex(&mut stream, [i, vertices])?;
        soup.positions.push(p);
        if by_line {
            let rest = stream.colour(line, "three coordinates")?;
            extras.iter().for_each(|extras| of_vertices.add(rest, *extras, i..i + 1));
        }
    }
    soup.triangles.reserve(faces.min(stream.lines.bytes_left() / 8));
    let by_line = stream.has_lines(faces);
    let mut face = Vec::new();
    for i in 0..faces {
        let line = corners(&mut stream, vertices, &mut face, [i, faces])?;
        let first = soup.triangles.len();
        soup.face(&face);
        if by_line {
            let rest = stream.colour(line, "as many vertex numbers as the face has")?;
            of_faces.add(rest, Extras::default(), first..soup.triangles.len());
        }
    }
    if stream.next().is_some() {
        let line = stream.lines.number();
        soup.warnings.push(format!("the file goes on after its last face; left out from line {line}"));
    }
    soup.colours.vertices = of_vertices.levels();
    soup.colours.faces = of_faces.levels();
    soup.finish(Format::Off, None)
}

/// The numbers of vertices and faces, and what surrounds the colours of vertices if the keyword says that they have some.
/// The keyword may be missing, and the counts may stand on its line, or right behind it. A number of edges may follow.
fn header(stream: &mut Stream<'_>) -> Result<([usize; 2], Option<Extras>), FileError> {
    let mut first = stream.next();
    let mut extras = None;
    let (keyword, number) = split_keyword(first.unwrap_or_default());
    match layout(keyword) {
        Some(Layout::Points { normals, colours, texture }) => {
            extras = colours.then_some(Extras { before: 3 * usize::from(normals), after: 2 * usize::from(texture) });
            first = if number.is_empty() { stream.next() } else { Some(number) };
        }
        Some(Layout::OtherDimension) => {
            let problem = FileProblem::Unsupported("OFF with other than three coordinates is not read here".into());
            return Err(stream.fail(problem));
        }
        None => {}
    }
    if first.is_some_and(|word| word.eq_ignore_ascii_case(b"BINARY")) {
        let problem = FileProblem::Unsupported("binary OFF is not read here; write it as ASCII OFF or PLY".into());
        return Err(stream.fail(problem));
    }
    let vertices = stream.count(first)?;
    let faces = stream.next();
    let faces = stream.count(faces)?;
    // The number of edges follows, as the format asks, or the first vertex does.
    let next_line = || stream.lines.clone().next_content().map_or(b"".as_slice(), |(_, line)| line);
    match stream.words.rest() {
        b"" if Words::new(next_line()).nth(2).is_some() => {}
        b"" => drop(stream.next()),
        _ if stream.has_lines(vertices) => drop(stream.rest_of_line()),
        _ => drop(stream.next()),
    }
    Ok(([vertices, faces], extras))
}

/// The next vertex, of which there should be so many, and the line where it begins.
fn vertex(stream: &mut Stream<'_>, [have, all]: [usize; 2]) -> Result<(DVec3, usize), FileError> {
    let (mut p, mut line) = (DVec3::ZERO, 0);
    for k in 0..3 {
        let word = stream.next().ok_or_else(|| stream.ends("vertices", have, all))?;
        p[k] = number(word).ok_or_else(|| stream.fail(FileProblem::syntax("three coordinates", quoted(word))))?;
        line = if k == 0 { stream.lines.number() } else { line };
    }
    Ok((p, line))
}

/// Reads the corners of the next face, of which there should be so many. Returns the line where it begins.
fn corners(
    stream: &mut Stream<'_>,
    vertices: usize,
    face: &mut Vec<u32>,
    [have, all]: [usize; 2],
) -> Result<usize, FileError> {
    let word = stream.next().ok_or_else(|| stream.ends("faces", have, all))?;
    let line = stream.lines.number();
    let count = integer(word).filter(|n| *n >= 0);
    let count = count.ok_or_else(|| stream.fail(FileProblem::syntax("a number of corners", quoted(word))))?;
    face.clear();
    for _ in 0..count {
        let word = stream.next().ok_or_else(|| stream.ends("faces", have, all))?;
        let fail = || stream.fail(FileProblem::syntax(format!("{count} vertex numbers"), quoted(word)));
        let index = integer(word).ok_or_else(fail)?;
        let corner = u32::try_from(index).ok().filter(|&i| (i as usize) < vertices);
        face.push(corner.ok_or_else(|| stream.fail(FileProblem::vertex(index, vertices)))?);
    }
    Ok(line)
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
    text.rows(mesh, &tails, |_, _| {})?;
    Ok(text.finish()?)
}
