//! What goes into a file: vertices that each have one colour and one place on an image, and triangles in pieces of one material.

use std::borrow::Cow;
use std::io::Write;

use rustc_hash::FxHashMap;

use super::super::colour::{Colours, Rgba, WHITE, by_vertex, linear_from_srgb};
use super::super::error::WriteProblem;
use crate::io::{Format, Material, Paint, TextureImage, TextureMap};
use crate::mesh::TriMesh;

/// What goes into the file.
pub(super) struct Content<'a> {
    pub(super) mesh: Cow<'a, TriMesh>,
    /// One for each vertex.
    pub(super) colours: Option<Cow<'a, [Rgba]>>,
    /// One for each vertex, counted down from the upper edge.
    pub(super) coordinates: Option<Vec<[f32; 2]>>,
    pub(super) texture: Option<&'a TextureMap>,
    /// The images that the format holds.
    pub(super) images: Vec<&'a TextureImage>,
    pub(super) pieces: Vec<Piece>,
}

/// Triangles that follow one another and have one material.
pub(super) struct Piece {
    pub(super) first: usize,
    pub(super) count: usize,
    pub(super) material: Option<u32>,
    /// Whether they have texture coordinates.
    pub(super) textured: bool,
}

impl<'a> Content<'a> {
    /// `mesh` with its vertices repeated where colours or coordinates meet.
    pub(super) fn new(mesh: &'a TriMesh, paint: &Paint<'a>, format: Format) -> Result<Self, WriteProblem> {
        let too_large = WriteProblem::TooLarge { format };
        let texture = paint.texture;
        let whole = || vec![Piece { first: 0, count: mesh.triangles.len(), material: None, textured: false }];
        let pieces = texture.map_or_else(whole, pieces);
        let content = Self {
            mesh: Cow::Borrowed(mesh),
            colours: None,
            coordinates: None,
            texture,
            images: images(texture),
            pieces,
        };
        Ok(match (paint.colours, texture.filter(|texture| texture.has_coordinates())) {
            (None, None) => content,
            (Some(colours), None) => {
                let (mesh, colours) = by_vertex(mesh, colours).ok_or(too_large)?;
                Self { mesh, colours: Some(colours), ..content }
            }
            (colours, Some(texture)) => {
                let Split { mesh, colours: own, coordinates } = split(mesh, colours, texture).ok_or(too_large)?;
                let colours = colours.map(|_| Cow::Owned(own));
                Self { mesh: Cow::Owned(mesh), colours, coordinates: Some(coordinates), ..content }
            }
        })
    }

    /// Whether materials have their colours: not where vertices have some that are the colours of the surface already.
    pub(super) fn has_factors(&self) -> bool {
        self.colours.is_none()
    }

    /// The number of a piece's material in the file; for colours alone that after the last.
    pub(super) fn material_of(&self, piece: &Piece) -> Option<usize> {
        let own = piece.material.map(|material| material as usize);
        let plain = self.colours.as_ref().map(|_| self.texture.map_or(0, |texture| texture.materials.len()));
        own.or(plain)
    }

    /// The number of a material's image in the file.
    pub(super) fn image_number(&self, material: &Material) -> Option<usize> {
        let image = self.texture?.images.get(material.image? as usize)?;
        self.images.iter().position(|own| std::ptr::eq(*own, image))
    }

    /// Bytes of the buffer.
    pub(super) fn bytes(&self) -> usize {
        let images: usize = self.images.iter().map(|image| image.bytes.len().next_multiple_of(4)).sum();
        self.geometry_bytes() + images
    }

    /// Bytes of the buffer up to its images.
    pub(super) fn geometry_bytes(&self) -> usize {
        let vertices = self.mesh.positions.len();
        let each = 12 + self.colours.as_ref().map_or(0, |_| 8) + self.coordinates.as_ref().map_or(0, |_| 8);
        each * vertices + 12 * self.mesh.triangles.len()
    }

    pub(super) fn write_buffer(&self, out: &mut dyn Write) -> std::io::Result<()> {
        self.write_geometry(out)?;
        for image in &self.images {
            out.write_all(&image.bytes)?;
            out.write_all(&[0; 3][..image.bytes.len().next_multiple_of(4) - image.bytes.len()])?;
        }
        Ok(())
    }

    /// Writes positions, indices, colours and coordinates.
    pub(super) fn write_geometry(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let mut chunk = Vec::with_capacity(1 << 16);
        for points in self.mesh.positions.chunks(4096) {
            chunk.clear();
            points.iter().flat_map(|p| p.as_vec3().to_array()).for_each(|x| chunk.extend_from_slice(&x.to_le_bytes()));
            out.write_all(&chunk)?;
        }
        for triangles in self.mesh.triangles.chunks(4096) {
            chunk.clear();
            triangles.iter().flatten().for_each(|v| chunk.extend_from_slice(&v.to_le_bytes()));
            out.write_all(&chunk)?;
        }
        // In 16 bits of linear light every one of the 256 levels has its own number; in 8 bits the dark ones would not.
        let stored: Vec<u16> = (0..=255).map(|level| (linear_from_srgb(level) * 65535.0).round() as u16).collect();
        for colours in self.colours.iter().flat_map(|colours| colours.chunks(4096)) {
            chunk.clear();
            for &[red, green, blue, alpha] in colours {
                let light = [red, green, blue].map(|level| stored[usize::from(level)]);
                light.iter().chain([&(u16::from(alpha) * 257)]).for_each(|x| chunk.extend_from_slice(&x.to_le_bytes()));
            }
            out.write_all(&chunk)?;
        }
        for coordinates in self.coordinates.iter().flat_map(|coordinates| coordinates.chunks(4096)) {
            chunk.clear();
            coordinates.iter().flatten().for_each(|x| chunk.extend_from_slice(&x.to_le_bytes()));
            out.write_all(&chunk)?;
        }
        Ok(())
    }
}

/// The images that a material has and that the format holds.
fn images(texture: Option<&TextureMap>) -> Vec<&TextureImage> {
    let Some(texture) = texture else { return Vec::new() };
    let named = |n: u32| texture.materials.iter().any(|material| material.image == Some(n));
    let all = (0..).zip(&texture.images);
    all.filter(|(n, image)| named(*n) && image.media_type().is_some()).map(|(_, image)| image).collect()
}

fn pieces(texture: &TextureMap) -> Vec<Piece> {
    let key = |t: usize| (texture.material_of[t], texture.coordinates[t].is_some());
    let mut pieces: Vec<Piece> = Vec::new();
    for triangle in 0..texture.material_of.len() {
        let (material, textured) = key(triangle);
        match pieces.last_mut() {
            Some(last) if (last.material, last.textured) == (material, textured) => last.count += 1,
            _ => pieces.push(Piece { first: triangle, count: 1, material, textured }),
        }
    }
    pieces
}

/// A mesh whose vertices have one colour and one place on an image each.
struct Split {
    mesh: TriMesh,
    colours: Vec<Rgba>,
    coordinates: Vec<[f32; 2]>,
}

/// The same triangles, with as many vertices at a place as colours and coordinates meet there: the first keeps its number, the others follow
/// after the last. `None` when that is more than 32 bits can number.
fn split(mesh: &TriMesh, colours: Option<&Colours>, texture: &TextureMap) -> Option<Split> {
    type Key = (Rgba, Option<[u32; 2]>);
    let mut keys: Vec<Option<Key>> = vec![None; mesh.positions.len()];
    let mut further: FxHashMap<(u32, Key), u32> = FxHashMap::default();
    let mut split = mesh.clone();
    for (triangle, t) in split.triangles.iter_mut().enumerate() {
        let colour = colours.map_or([WHITE; 3], |colours| colours.corners(mesh, triangle));
        let places = texture.at(triangle, true);
        for k in 0..3 {
            let key = (colour[k], places.map(|places| places[k].map(f32::to_bits)));
            let v = t[k];
            if *keys[v as usize].get_or_insert(key) == key {
                continue;
            }
            let next = u32::try_from(split.positions.len()).ok()?;
            let own = *further.entry((v, key)).or_insert(next);
            if own == next {
                split.positions.push(mesh.positions[v as usize]);
                keys.push(Some(key));
            }
            t[k] = own;
        }
    }
    let of = |key: &Option<Key>| key.unwrap_or((WHITE, None));
    let colours = keys.iter().map(|key| of(key).0).collect();
    let coordinates = keys.iter().map(|key| of(key).1.unwrap_or_default().map(f32::from_bits)).collect();
    Some(Split { mesh: split, colours, coordinates })
}
