//! Writing a number and a colour for each vertex, as viewers of measurements expect them.

use std::io::Write;

use super::super::error::WriteError;
use super::super::format::Format;
use super::super::sound::check;
use super::write::{More, Row, channel_lines, header_with, is_single, write_binary_rows};
use crate::mesh::TriMesh;

/// What [`encode_vertex_map`] writes beside the mesh. The lists go by vertex; where one is too short, 0 is written.
#[derive(Debug, Clone, Copy)]
pub struct VertexMap<'a> {
    /// A number for each vertex.
    pub quality: &'a [f32],
    /// Red, green and blue of each vertex.
    pub colours: &'a [[u8; 3]],
    /// Sentences for the header; line breaks in them become spaces.
    pub comments: &'a [String],
}

/// Writes `mesh` as binary little-endian PLY with `float quality` and `uchar red`, `green`, `blue` for each vertex.
///
/// # Errors
/// See [`WriteProblem`](super::super::WriteProblem). The mesh is checked before the first byte is written.
pub fn encode_vertex_map(mesh: &TriMesh, map: &VertexMap<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    check(mesh, Format::Ply)?;
    let single = is_single(mesh);
    let more = More {
        comments: map.comments.iter().map(|text| format!("comment {}\n", text.replace(['\n', '\r'], " "))).collect(),
        of_vertex: format!("property float quality\n{}", channel_lines(3)),
        of_face: String::new(),
    };
    out.write_all(header_with(mesh, "binary_little_endian", single, &more).as_bytes())?;
    let extra = |row: Row, bytes: &mut Vec<u8>| {
        if let Row::Vertex(vertex) = row {
            bytes.extend_from_slice(&map.quality.get(vertex).copied().unwrap_or(0.0).to_le_bytes());
            bytes.extend_from_slice(&map.colours.get(vertex).copied().unwrap_or_default());
        }
    };
    write_binary_rows(mesh, single, extra, out)
}
