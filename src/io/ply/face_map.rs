//! Writing a colour and numbers for each face: a map of what faces are.

use std::io::Write;

use super::super::error::WriteError;
use super::super::format::Format;
use super::super::legend::LegendEntry;
use super::super::sound::check;
use super::write::{More, Row, channel_lines, header_with, is_single, write_binary_rows};
use crate::mesh::TriMesh;

/// What [`encode_face_map`] writes beside the mesh. The lists go by triangle; where one is too short, 0 is written.
#[derive(Debug, Clone, Copy)]
pub struct FaceMap<'a> {
    /// Red, green and blue of each triangle.
    pub colours: &'a [[u8; 3]],
    /// Properties of the faces: the name, which must be one word, and a number for each triangle.
    pub numbers: &'a [(&'a str, &'a [u32])],
    /// What the colours mean.
    pub legend: &'a [LegendEntry],
    /// Sentences for the header; line breaks in them become spaces.
    pub comments: &'a [String],
}

/// Writes `mesh` as binary little-endian PLY with `uchar red`, `green`, `blue` and the `int` numbers of each face.
///
/// # Errors
/// See [`WriteProblem`](super::super::WriteProblem). The mesh is checked before the first byte is written.
pub fn encode_face_map(mesh: &TriMesh, map: &FaceMap<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    check(mesh, Format::Ply)?;
    let single = is_single(mesh);
    let comments = map.comments.iter().cloned().chain(map.legend.iter().map(LegendEntry::to_string));
    let numbers: String = map.numbers.iter().map(|(name, _)| format!("property int {name}\n")).collect();
    let more = More {
        comments: comments.map(|text| format!("comment {}\n", text.replace(['\n', '\r'], " "))).collect(),
        of_vertex: String::new(),
        of_face: channel_lines(3) + &numbers,
    };
    out.write_all(header_with(mesh, "binary_little_endian", single, &more).as_bytes())?;
    let extra = |row: Row, bytes: &mut Vec<u8>| {
        if let Row::Face(face) = row {
            bytes.extend_from_slice(&map.colours.get(face).copied().unwrap_or_default());
            for (_, numbers) in map.numbers {
                bytes.extend_from_slice(&numbers.get(face).copied().unwrap_or_default().to_le_bytes());
            }
        }
    };
    write_binary_rows(mesh, single, extra, out)
}
