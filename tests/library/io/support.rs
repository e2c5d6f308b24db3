//! Meshes and checks that several tests share.

use glam::DVec3;
use meshwright::io::{Colours, Format, Loaded, Paint, WriteOptions, encode, encode_coloured, encode_painted};
use meshwright::mesh::TriMesh;

use crate::common::textured;

/// What every reader promises.
pub fn assert_sound(loaded: &Loaded) {
    let mesh = &loaded.mesh;
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
    assert_eq!(loaded.parts.first().map(|p| p.triangles.start), Some(0));
    assert_eq!(loaded.parts.last().map(|p| p.triangles.end), Some(mesh.triangles.len()));
    assert!(loaded.parts.windows(2).all(|pair| pair[0].triangles.end == pair[1].triangles.start));
    assert!(loaded.parts.iter().all(|p| !p.triangles.is_empty()));
    if let Some(negative) = &loaded.negative {
        let mesh = &negative.mesh;
        assert!(!mesh.triangles.is_empty() && mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
        let counted: usize = negative.parts.iter().map(|part| part.triangles.len()).sum();
        assert_eq!(counted, mesh.triangles.len());
    }
    assert!(loaded.texture.as_ref().is_none_or(|texture| texture.fits(mesh)));
    assert!(loaded.texture.iter().flat_map(|t| &t.coordinates).flatten().flatten().flatten().all(|x| x.is_finite()));
    match &loaded.colours {
        None => {}
        Some(Colours::Faces(colours)) => assert_eq!(colours.len(), mesh.triangles.len()),
        Some(Colours::Vertices(colours)) => assert_eq!(colours.len(), mesh.positions.len()),
        Some(Colours::Corners(colours)) => assert_eq!(colours.len(), mesh.triangles.len()),
    }
}

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
