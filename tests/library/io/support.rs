//! Meshes and checks that several tests share.

use glam::DVec3;
use meshwright::io::{Colours, Format, Paint, WriteOptions, encode, encode_coloured, encode_painted};
use meshwright::mesh::TriMesh;

pub use crate::common::proofs::assert_sound;
use crate::common::textured;

/// A tetrahedron.
pub fn tetrahedron() -> TriMesh {
    TriMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

/// The mesh as a file of `format`.
pub fn encoded(mesh: &TriMesh, options: &WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode(mesh, options, &mut bytes).unwrap_or_else(|error| panic!("{error}"));
    bytes
}

/// The mesh with its colours as a file of `format`.
pub fn encoded_in_colour(mesh: &TriMesh, colours: &Colours, options: &WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_coloured(mesh, Some(colours), options, &mut bytes).unwrap_or_else(|error| panic!("{error}"));
    bytes
}

/// The mesh with textures of its own making as a file of `format`.
pub fn encoded_with_textures(mesh: &TriMesh, options: &WriteOptions) -> Vec<u8> {
    let texture = textured::of_sides(mesh, [textured::png([1, 2, 3]), textured::jpeg()]);
    let paint = Paint { colours: None, texture: Some(&texture), beside: Some("a.obj".as_ref()) };
    let mut bytes = Vec::new();
    encode_painted(mesh, &paint, options, &mut bytes).unwrap_or_else(|error| panic!("{error}"));
    bytes
}

/// The colours of the corners of the triangles, in order.
pub fn corner_colours(mesh: &TriMesh, colours: &Colours) -> Vec<[[u8; 4]; 3]> {
    (0..mesh.triangles.len()).map(|t| colours.corners(mesh, t)).collect()
}

/// Every way to write a mesh.
pub fn every_form() -> Vec<WriteOptions> {
    let plain = Format::ALL.map(WriteOptions::new);
    let ascii = [Format::Stl, Format::Ply].map(|format| WriteOptions { ascii: true, ..WriteOptions::new(format) });
    plain.into_iter().chain(ascii).collect()
}

/// The corners of the triangles, in order.
pub fn corners(mesh: &TriMesh) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect()
}

/// A zip package of stored or deflated files.
pub fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    use std::io::Write;
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in files {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(content).unwrap();
    }
    zip.finish().unwrap().into_inner()
}
