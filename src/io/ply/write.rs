//! Writing: positions as `float` when every coordinate is one, else as `double`; triangles.

use std::io::Write;

use super::super::colour::{Colours, Tails};
use super::super::error::WriteError;
use super::super::text::TextOut;
use crate::mesh::TriMesh;

fn header(mesh: &TriMesh, format: &str, single: bool, tails: &Tails<'_>) -> String {
    let more = More {
        comments: String::new(),
        of_vertex: channel_lines(tails.vertex_channels()),
        of_face: channel_lines(tails.face_channels()),
    };
    header_with(mesh, format, single, &more)
}

/// Lines of a header beyond those of positions and triangles, each ended by `\n`.
#[derive(Default)]
pub(super) struct More {
    pub(super) comments: String,
    /// Properties of vertices.
    pub(super) of_vertex: String,
    /// Properties of faces.
    pub(super) of_face: String,
}

/// The properties of the first `channels` of red, green, blue and alpha.
pub(super) fn channel_lines(channels: usize) -> String {
    ["red", "green", "blue", "alpha"].iter().take(channels).map(|name| format!("property uchar {name}\n")).collect()
}

/// A row of the file.
pub(super) enum Row {
    /// Of the vertex with this number.
    Vertex(usize),
    /// Of the face with this number.
    Face(usize),
}

pub(super) fn header_with(mesh: &TriMesh, format: &str, single: bool, more: &More) -> String {
    let More { comments, of_vertex, of_face } = more;
    let coordinate = if single { "float" } else { "double" };
    let index = if mesh.positions.len() <= i32::MAX as usize { "int" } else { "uint" };
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    format!(
        "ply\nformat {format} 1.0\ncomment written by meshwright\n{comments}\
         element vertex {vertices}\nproperty {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\n{of_vertex}\
         element face {faces}\nproperty list uchar {index} vertex_indices\n{of_face}end_header\n"
    )
}

pub(super) fn is_single(mesh: &TriMesh) -> bool {
    mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p)
}

/// Writes binary little-endian PLY.
pub(in crate::io) fn write_binary(
    mesh: &TriMesh,
    colours: Option<&Colours>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let (single, tails) = (is_single(mesh), Tails::of(colours));
    out.write_all(header(mesh, "binary_little_endian", single, &tails).as_bytes())?;
    let extra = |row: Row, bytes: &mut Vec<u8>| match row {
        Row::Vertex(vertex) => bytes.extend_from_slice(tails.vertex(vertex)),
        Row::Face(face) => bytes.extend_from_slice(tails.face(face)),
    };
    write_binary_rows(mesh, single, extra, out)
}

/// Writes what follows the header of binary little-endian PLY; `extra` appends the further
/// properties of a row to it.
pub(super) fn write_binary_rows(
    mesh: &TriMesh,
    single: bool,
    extra: impl Fn(Row, &mut Vec<u8>),
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    const CHUNK: usize = 1 << 16;
    let mut chunk = Vec::with_capacity(CHUNK + 64);
    for (vertex, p) in mesh.positions.iter().enumerate() {
        for x in p.to_array() {
            if single {
                chunk.extend_from_slice(&(x as f32).to_le_bytes());
            } else {
                chunk.extend_from_slice(&x.to_le_bytes());
            }
        }
        extra(Row::Vertex(vertex), &mut chunk);
        if chunk.len() >= CHUNK {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    for (face, t) in mesh.triangles.iter().enumerate() {
        chunk.push(3);
        t.iter().for_each(|v| chunk.extend_from_slice(&v.to_le_bytes()));
        extra(Row::Face(face), &mut chunk);
        if chunk.len() >= CHUNK {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    Ok(out.write_all(&chunk)?)
}

/// Writes ASCII PLY. The numbers are those of the mesh in full, so a reader that takes them as
/// `double` loses nothing either.
pub(in crate::io) fn write_ascii(
    mesh: &TriMesh,
    colours: Option<&Colours>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    let tails = Tails::of(colours);
    text.text(&header(mesh, "ascii", is_single(mesh), &tails));
    text.rows(mesh, &tails)?;
    Ok(text.finish()?)
}
