//! Meshes with textures, made here.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use meshwright::io::{self, Loaded, Material, Paint, TextureImage, TextureMap, WriteOptions};
use meshwright::mesh::TriMesh;

/// An image of a single pixel.
pub fn png(colour: [u8; 3]) -> Arc<[u8]> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&colour)).expect("memory takes it");
    bytes.into()
}

/// What begins as a JPEG; nobody looks further.
pub fn jpeg() -> Arc<[u8]> {
    Arc::from(*b"\xff\xd8\xff\xe0 not really a picture")
}

/// Where a place on a side that faces along `axis` (0 to 5: −x, +x, −y, +y, −z, +z) lies on its image: the sides are pieces of their own.
pub fn place(p: DVec3, axis: usize) -> [f32; 2] {
    let flat = [[p.y, p.z], [p.x, p.z], [p.x, p.y]][axis / 2];
    flat.map(|x| (x / 64.0 + 0.125 * axis as f64 + 0.0625) as f32)
}

/// The side that a triangle faces, 0 to 5.
pub fn axis([a, b, c]: [DVec3; 3]) -> usize {
    let n = (b - a).cross(c - a);
    let size = n.abs();
    let k = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
    2 * k + usize::from(n[k] > 0.0)
}

/// Textures for a mesh of flat sides along the axes: an image for top and bottom, another for the others.
pub fn of_sides(mesh: &TriMesh, images: [Arc<[u8]>; 2]) -> TextureMap {
    let axes: Vec<usize> = (0..mesh.triangles.len()).map(|t| axis(mesh.corners(t))).collect();
    let material = |n: u32| Material { name: format!("side_{n}"), colour: None, image: Some(n) };
    let image = |(n, bytes): (usize, Arc<[u8]>)| {
        let ending = if bytes.starts_with(b"\xff\xd8") { "jpg" } else { "png" };
        TextureImage { name: format!("picture {n}.{ending}"), bytes }
    };
    TextureMap {
        coordinates: (axes.iter().enumerate()).map(|(t, &a)| Some(mesh.corners(t).map(|p| place(p, a)))).collect(),
        material_of: axes.iter().map(|&a| Some(u32::from(a < 4))).collect(),
        materials: (0..2).map(material).collect(),
        images: images.into_iter().enumerate().map(image).collect(),
        ..TextureMap::default()
    }
}

/// Writes a mesh and what belongs beside it.
pub fn save(path: &Path, mesh: &TriMesh, texture: &TextureMap, options: &WriteOptions) {
    let paint = Paint { colours: None, texture: Some(texture), beside: Some(path) };
    let mut bytes = Vec::new();
    io::encode_painted(mesh, &paint, options, &mut bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    std::fs::write(path, bytes).expect("written");
    for file in texture.side_files(options.format, path) {
        std::fs::write(path.with_file_name(&file.name), &file.bytes[..]).expect("written");
    }
}

/// Reads a mesh, about which there is nothing to say.
#[track_caller]
pub fn load(path: &Path) -> Loaded {
    let loaded = io::read(path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.warnings, Vec::<String>::new(), "{}", path.display());
    loaded
}

/// The bytes of a triangle's image.
pub fn image(texture: &TextureMap, triangle: usize) -> Option<Arc<[u8]>> {
    texture.image(triangle).map(|n| texture.images[n as usize].bytes.clone())
}
