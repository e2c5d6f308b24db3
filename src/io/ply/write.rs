//! Writing: positions as `float` when every coordinate is one, else as `double`; triangles.

use std::io::Write;

use super::super::error::WriteError;
use super::super::text::TextOut;
use crate::mesh::TriMesh;

fn header(mesh: &TriMesh, format: &str, single: bool) -> String {
    header_with(mesh, format, single, "", "")
}

/// A header with more comments and more properties of vertices, each line ended by `\n`.
pub(super) fn header_with(mesh: &TriMesh, format: &str, single: bool, comments: &str, properties: &str) -> String {
    let coordinate = if single { "float" } else { "double" };
    let index = if mesh.positions.len() <= i32::MAX as usize { "int" } else { "uint" };
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    format!(
        "ply\nformat {format} 1.0\ncomment written by meshwright\n{comments}\
         element vertex {vertices}\nproperty {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\n{properties}\
         element face {faces}\nproperty list uchar {index} vertex_indices\nend_header\n"
    )
}

pub(super) fn is_single(mesh: &TriMesh) -> bool {
    mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p)
}

/// Writes binary little-endian PLY.
pub(in crate::io) fn write_binary(mesh: &TriMesh, out: &mut dyn Write) -> Result<(), WriteError> {
    let single = is_single(mesh);
    out.write_all(header(mesh, "binary_little_endian", single).as_bytes())?;
    write_binary_rows(mesh, single, |_, _| (), out)
}

/// Writes what follows the header of binary little-endian PLY; `extra` appends the further
/// properties of a vertex, given by its number, to its row.
pub(super) fn write_binary_rows(
    mesh: &TriMesh,
    single: bool,
    extra: impl Fn(usize, &mut Vec<u8>),
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
        extra(vertex, &mut chunk);
        if chunk.len() >= CHUNK {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    for t in &mesh.triangles {
        chunk.push(3);
        t.iter().for_each(|v| chunk.extend_from_slice(&v.to_le_bytes()));
        if chunk.len() >= CHUNK {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    Ok(out.write_all(&chunk)?)
}

/// Writes ASCII PLY. The numbers are those of the mesh in full, so a reader that takes them as
/// `double` loses nothing either.
pub(in crate::io) fn write_ascii(mesh: &TriMesh, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    text.text(&header(mesh, "ascii", is_single(mesh)));
    text.rows(mesh)?;
    Ok(text.finish()?)
}
