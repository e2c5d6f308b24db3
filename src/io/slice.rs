//! A part of a mesh as a mesh of its own.

use std::ops::Range;

use super::colour::Colours;
use super::loaded::{Loaded, Part};
use super::texture::TextureMap;
use crate::mesh::TriMesh;

/// No number yet.
const NONE: u32 = u32::MAX;

/// Takes parts out of a mesh, one after the other.
pub(super) struct Slicer<'a> {
    loaded: &'a Loaded,
    /// For each vertex its number in the slice that is being made.
    numbers: Vec<u32>,
}

impl<'a> Slicer<'a> {
    pub(super) fn new(loaded: &'a Loaded) -> Self {
        Self { loaded, numbers: vec![NONE; loaded.mesh.positions.len()] }
    }

    /// The triangles of a range with their own vertices, in the same order, and with what they look like. Colours that are all white are none.
    pub(super) fn slice(&mut self, range: Range<usize>) -> (TriMesh, Option<Colours>, Option<TextureMap>) {
        self.pick(&range.collect::<Vec<_>>())
    }

    /// The same for any triangles.
    pub(super) fn pick(&mut self, triangles: &[usize]) -> (TriMesh, Option<Colours>, Option<TextureMap>) {
        let whole = &self.loaded.mesh;
        let mut own: Vec<u32> = triangles.iter().flat_map(|&t| whole.triangles[t]).collect();
        own.sort_unstable();
        own.dedup();
        for (n, &vertex) in own.iter().enumerate() {
            self.numbers[vertex as usize] = n as u32;
        }
        let mesh = TriMesh {
            positions: own.iter().map(|&v| whole.positions[v as usize]).collect(),
            triangles: triangles.iter().map(|&t| whole.triangles[t].map(|v| self.numbers[v as usize])).collect(),
        };
        own.iter().for_each(|&vertex| self.numbers[vertex as usize] = NONE);
        let colours = self.loaded.colours.as_ref().map(|colours| match colours {
            Colours::Faces(list) => Colours::Faces(triangles.iter().map(|&t| list[t]).collect()),
            Colours::Corners(list) => Colours::Corners(triangles.iter().map(|&t| list[t]).collect()),
            Colours::Vertices(list) => Colours::Vertices(own.iter().map(|&v| list[v as usize]).collect()),
        });
        let numbers: Vec<u32> = triangles.iter().map(|&t| t as u32).collect();
        let texture = self.loaded.texture.as_ref().map(|texture| pruned(texture, &numbers));
        let is_there = |texture: &TextureMap| texture.has_coordinates() || !texture.materials.is_empty();
        (mesh, colours.filter(|colours| !colours.is_white()), texture.filter(is_there))
    }
}

impl Loaded {
    /// Leaves out the parts whose numbers `keep` does not want, with the vertices that no other has. What is to be taken away stays.
    pub fn keep_parts(&mut self, keep: impl Fn(usize) -> bool) {
        let mut parts = Vec::new();
        let mut triangles: Vec<usize> = Vec::new();
        for (_, part) in self.parts.iter().enumerate().filter(|(n, _)| keep(*n)) {
            let first = triangles.len();
            triangles.extend(part.triangles.clone());
            parts.push(Part { name: part.name.clone(), triangles: first..triangles.len() });
        }
        if triangles.is_empty() || triangles.len() == self.mesh.triangles.len() {
            return;
        }
        (self.mesh, self.colours, self.texture) = Slicer::new(self).pick(&triangles);
        self.parts = parts;
    }
}

/// The textures of some triangles, with the materials and images of these alone.
fn pruned(texture: &TextureMap, triangles: &[u32]) -> TextureMap {
    let (mut materials, mut images) = (Vec::new(), Vec::new());
    let mut number_of = vec![None; texture.materials.len()];
    let mut image_of = vec![None; texture.images.len()];
    let material_of = triangles.iter().map(|&t| {
        let old = texture.material_of[t as usize]? as usize;
        let material = texture.materials.get(old)?;
        Some(*number_of[old].get_or_insert_with(|| {
            let image = material.image.and_then(|image| {
                let own = texture.images.get(image as usize)?;
                Some(*image_of[image as usize].get_or_insert_with(|| {
                    images.push(own.clone());
                    images.len() as u32 - 1
                }))
            });
            materials.push(crate::io::Material { image, ..material.clone() });
            materials.len() as u32 - 1
        }))
    });
    let material_of = material_of.collect();
    let coordinates = triangles.iter().map(|&t| texture.coordinates[t as usize]).collect();
    TextureMap { coordinates, material_of, materials, images, downward: texture.downward, files: texture.files.clone() }
}
