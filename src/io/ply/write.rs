//! Writing: positions as `float` when every coordinate is one, else as `double`; triangles.

use std::io::Write;

use super::super::colour::{Colours, Tails};
use super::super::error::WriteError;
use super::super::pieces::in_pieces;
use super::super::text::TextOut;
use super::super::{Paint, TextureMap, shown_colours};
use crate::mesh::TriMesh;

/// What the rows of a mesh with colours and textures hold.
struct Rest<'a> {
    tails: Tails<'a>,
    texture: Option<&'a TextureMap>,
    /// Names of the image files; none on a stream.
    images: Vec<String>,
    /// Whether faces say which image they have.
    numbered: bool,
}

impl<'a> Rest<'a> {
    fn of(colours: Option<&'a Colours>, paint: &Paint<'a>) -> Self {
        let texture = paint.texture.filter(|texture| texture.has_coordinates());
        let named = texture.zip(paint.beside).map(|(texture, path)| texture.image_names(path));
        let images = named.unwrap_or_default();
        let has_image = |t: usize, texture: &TextureMap| texture.image(t).is_some();
        let every = |texture: &TextureMap| {
            (0..texture.coordinates.len()).all(|t| has_image(t, texture) == texture.coordinates[t].is_some())
        };
        let numbered = images.len() > 1 || !images.is_empty() && !texture.is_some_and(every);
        Self { tails: Tails::of(colours), texture, images, numbered }
    }

    fn header(&self, mesh: &TriMesh, format: &str, single: bool) -> String {
        let more = More {
            comments: self.images.iter().map(|name| format!("comment TextureFile {name}\n")).collect(),
            of_vertex: channel_lines(self.tails.vertex_channels()),
            of_face: channel_lines(self.tails.face_channels())
                + self.texture.map_or("", |_| "property list uchar float texcoord\n")
                + if self.numbered { "property int texnumber\n" } else { "" },
        };
        header_with(mesh, format, single, &more)
    }

    /// The coordinates of a face's corners; none for a face without.
    fn coordinates(&self, face: usize) -> Option<[[f32; 2]; 3]> {
        self.texture?.at(face, false)
    }

    /// The image of a face, −1 for none.
    fn image(&self, face: usize) -> i32 {
        let number = self.texture.and_then(|texture| texture.image(face));
        number.and_then(|number| i32::try_from(number).ok()).unwrap_or(-1)
    }

    fn face_bytes(&self, face: usize, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(self.tails.face(face));
        if self.texture.is_some() {
            let coordinates = self.coordinates(face);
            bytes.push(if coordinates.is_some() { 6 } else { 0 });
            coordinates.iter().flatten().flatten().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
        }
        if self.numbered {
            bytes.extend_from_slice(&self.image(face).to_le_bytes());
        }
    }

    fn face_text(&self, face: usize, text: &mut TextOut<'_>) {
        if self.texture.is_some() {
            let coordinates = self.coordinates(face);
            text.text(if coordinates.is_some() { " 6" } else { " 0" });
            for x in coordinates.iter().flatten().flatten() {
                text.text(" ");
                text.short_number(*x);
            }
        }
        if self.numbered {
            text.text(&format!(" {}", self.image(face)));
        }
    }
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
pub(in crate::io) fn write_binary(mesh: &TriMesh, paint: &Paint<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let colours = shown_colours(paint.colours, paint.texture);
    let (single, rest) = (is_single(mesh), Rest::of(colours.as_deref(), paint));
    out.write_all(rest.header(mesh, "binary_little_endian", single).as_bytes())?;
    let extra = |row: Row, bytes: &mut Vec<u8>| match row {
        Row::Vertex(vertex) => bytes.extend_from_slice(rest.tails.vertex(vertex)),
        Row::Face(face) => rest.face_bytes(face, bytes),
    };
    write_binary_rows(mesh, single, extra, out)
}

/// Writes what follows the header of binary little-endian PLY; `extra` appends the further
/// properties of a row to it.
pub(super) fn write_binary_rows(
    mesh: &TriMesh,
    single: bool,
    extra: impl Fn(Row, &mut Vec<u8>) + Sync,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    in_pieces(mesh.positions.len(), out, |rows, bytes| {
        for vertex in rows {
            for x in mesh.positions[vertex].to_array() {
                if single {
                    bytes.extend_from_slice(&(x as f32).to_le_bytes());
                } else {
                    bytes.extend_from_slice(&x.to_le_bytes());
                }
            }
            extra(Row::Vertex(vertex), bytes);
        }
    })?;
    Ok(in_pieces(mesh.triangles.len(), out, |rows, bytes| {
        for face in rows {
            bytes.push(3);
            mesh.triangles[face].iter().for_each(|v| bytes.extend_from_slice(&v.to_le_bytes()));
            extra(Row::Face(face), bytes);
        }
    })?)
}

/// Writes ASCII PLY. The numbers are those of the mesh in full, so a reader that takes them as
/// `double` loses nothing either.
pub(in crate::io) fn write_ascii(mesh: &TriMesh, paint: &Paint<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let colours = shown_colours(paint.colours, paint.texture);
    let mut text = TextOut::new(out);
    let rest = Rest::of(colours.as_deref(), paint);
    text.text(&rest.header(mesh, "ascii", is_single(mesh)));
    text.rows(mesh, &rest.tails, |face, text| rest.face_text(face, text))?;
    Ok(text.finish()?)
}
