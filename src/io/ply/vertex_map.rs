//! Writing a number and a colour for each vertex, as viewers of measurements expect them.

use std::io::Write;

use super::super::error::WriteError;
use super::super::{Format, check};
use super::write::{header_with, is_single, write_binary_rows};
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
    let comments: String =
        map.comments.iter().map(|text| format!("comment {}\n", text.replace(['\n', '\r'], " "))).collect();
    let properties = "property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n";
    out.write_all(header_with(mesh, "binary_little_endian", single, &comments, properties).as_bytes())?;
    let extra = |vertex: usize, row: &mut Vec<u8>| {
        row.extend_from_slice(&map.quality.get(vertex).copied().unwrap_or(0.0).to_le_bytes());
        row.extend_from_slice(&map.colours.get(vertex).copied().unwrap_or_default());
    };
    write_binary_rows(mesh, single, extra, out)
}
