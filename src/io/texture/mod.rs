//! Textures of a mesh: coordinates at the corners of triangles, materials, and images as the bytes of their files.

mod beside;
mod charts;
mod gallery;
mod gather;
mod names;

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use super::colour::{Colours, Rgba, WHITE};
use super::format::Format;
use super::text::counted;
use crate::mesh::TriMesh;

pub(super) use beside::{MOST_BESIDE, file_beside, read_beside};
pub(super) use gallery::Gallery;
pub(super) use gather::Woven;
pub use names::SideFile;
pub(super) use names::library_name;

/// Where the three corners of a triangle lie on an image. Each place is a pair: across the image, then up or down
/// (see [`TextureMap::downward`]); 0 to 1 is the width and the height of the image.
pub type TexCoords = [[f32; 2]; 3];

/// The textures of a mesh: coordinates on images, materials, images. The lists by triangle have one entry for each triangle of the mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TextureMap {
    /// The coordinates of each triangle's corners, where it has some.
    pub coordinates: Vec<Option<TexCoords>>,
    /// The material of each triangle, where it has one.
    pub material_of: Vec<Option<u32>>,
    /// The materials, which `material_of` numbers from 0.
    pub materials: Vec<Material>,
    /// The images, which the materials number from 0.
    pub images: Vec<TextureImage>,
    /// Whether the second coordinate counts from the upper edge of the image down, as glTF has it; else from the lower edge up, as all others
    /// have it.
    pub downward: bool,
    /// Files beside the mesh that were read for it.
    pub files: Vec<PathBuf>,
}

/// How the surface of some triangles looks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Material {
    /// The name of the material in the file; may be empty.
    pub name: String,
    /// The colour that the image is multiplied by, or that the surface has without one; `None` where the file says none.
    pub colour: Option<Rgba>,
    /// The number of the material's image in [`TextureMap::images`].
    pub image: Option<u32>,
}

/// An image as the bytes of its file. Nothing here decodes the pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextureImage {
    /// The name of its file, without a folder.
    pub name: String,
    /// The bytes of the file; none where it could not be read.
    pub bytes: Arc<[u8]>,
}

/// The kind of an image, by its first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageKind {
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
    /// Something else, or nothing.
    Other,
}

impl TextureImage {
    /// The kind of the image, told by its first bytes.
    pub fn kind(&self) -> ImageKind {
        match &*self.bytes {
            [0x89, b'P', b'N', b'G', ..] => ImageKind::Png,
            [0xff, 0xd8, 0xff, ..] => ImageKind::Jpeg,
            _ => ImageKind::Other,
        }
    }

    /// The media type of the image as glTF and 3MF name it; `None` for kinds of images that these formats do not hold.
    pub fn media_type(&self) -> Option<&'static str> {
        match self.kind() {
            ImageKind::Png => Some("image/png"),
            ImageKind::Jpeg => Some("image/jpeg"),
            ImageKind::Other => None,
        }
    }
}

impl TextureMap {
    /// Whether the lists fit `mesh` and one another.
    pub fn fits(&self, mesh: &TriMesh) -> bool {
        let within = |number: Option<u32>, count: usize| number.is_none_or(|n| (n as usize) < count);
        self.coordinates.len() == mesh.triangles.len()
            && self.material_of.len() == mesh.triangles.len()
            && self.material_of.iter().all(|&material| within(material, self.materials.len()))
            && self.materials.iter().all(|material| within(material.image, self.images.len()))
    }

    /// About how many bytes the textures take in memory.
    pub fn bytes(&self) -> u64 {
        let images: usize = self.images.iter().map(|image| image.bytes.len()).sum();
        let each = size_of::<Option<TexCoords>>() + size_of::<Option<u32>>();
        (images + each * self.coordinates.len()) as u64
    }

    /// Whether there is anything to be seen: coordinates, or a material with a colour or an image. Names alone show nothing.
    pub fn shows_anything(&self) -> bool {
        self.has_coordinates() || self.materials.iter().any(|m| m.colour.is_some() || m.image.is_some())
    }

    /// Whether any triangle has coordinates.
    pub fn has_coordinates(&self) -> bool {
        self.coordinates.iter().any(Option::is_some)
    }

    /// The material of a triangle, where it has one that is there.
    pub fn material(&self, triangle: usize) -> Option<&Material> {
        self.materials.get(self.material_of.get(triangle).copied().flatten()? as usize)
    }

    /// The number of the image that a triangle shows: that of its material, if the triangle has coordinates on it.
    pub fn image(&self, triangle: usize) -> Option<u32> {
        self.coordinates.get(triangle)?.and_then(|_| self.material(triangle)?.image)
    }

    /// The coordinates of a triangle's corners. The second number of each counts down from the upper edge of the image if `downward`, else up
    /// from the lower edge, whichever way the file has it.
    pub fn at(&self, triangle: usize, downward: bool) -> Option<TexCoords> {
        let corners = self.coordinates.get(triangle).copied().flatten()?;
        Some(if downward == self.downward { corners } else { corners.map(|[u, v]| [u, 1.0 - v]) })
    }

    /// The colours that the materials give to the triangles; `None` if all of them are white.
    pub fn material_colours(&self) -> Option<Colours> {
        let colour = |t: usize| self.material(t).and_then(|material| material.colour).unwrap_or(WHITE);
        let colours: Vec<Rgba> = (0..self.material_of.len()).map(colour).collect();
        colours.iter().any(|colour| *colour != WHITE).then_some(Colours::Faces(colours))
    }

    /// Whether `other` has the same coordinates, and materials and images as far as a file of `format` holds them.
    pub fn is_held(&self, other: Option<&Self>, format: Format) -> bool {
        if matches!(format, Format::Stl | Format::Off) || !self.shows_anything() {
            return true;
        }
        // A package has coordinates for images alone.
        let wanted = |t: usize| match format {
            Format::ThreeMf if self.packed_image(t).is_none() => None,
            Format::Glb | Format::Gltf => self.at(t, true),
            _ => self.at(t, false),
        };
        let count = self.coordinates.len();
        let Some(other) = other else { return (0..count).all(|t| wanted(t).is_none()) };
        let embedded = |image: Option<u32>, map: &Self| {
            let image = map.images.get(image? as usize)?;
            image.media_type().map(|_| image.bytes.clone())
        };
        let packs = matches!(format, Format::Glb | Format::Gltf | Format::ThreeMf);
        other.coordinates.len() == count
            && (0..count).all(|t| {
                let found = other.at(t, other.downward);
                wanted(t) == found
                    && (!packs
                        || wanted(t).is_none()
                        || embedded(self.image(t), self) == embedded(other.image(t), other))
            })
    }

    /// The image of a triangle, if a package (glTF, 3MF) holds images of its kind.
    pub(super) fn packed_image(&self, triangle: usize) -> Option<u32> {
        let number = self.image(triangle)?;
        self.images.get(number as usize)?.media_type().map(|_| number)
    }

    /// What of the textures a file of `format` cannot hold, in sentences. `beside` says whether there can be files beside it.
    pub fn lost_in(&self, format: Format, beside: bool) -> Vec<String> {
        if !self.shows_anything() {
            return Vec::new();
        }
        let has_images = self.images.iter().any(|image| !image.bytes.is_empty());
        let foreign = self.images.iter().filter(|i| !i.bytes.is_empty() && i.media_type().is_none()).count();
        let mut lost = Vec::new();
        match format {
            Format::Stl | Format::Off => {
                let what = if self.has_coordinates() { "textures" } else { "materials" };
                let colours = match self.material_colours() {
                    Some(_) if format == Format::Off => ", but for the colours of materials",
                    _ => "",
                };
                lost.push(format!("{format} holds no {what}; they are left out{colours}"));
            }
            Format::Obj | Format::Ply if !beside && (has_images || !self.materials.is_empty()) => {
                lost.push(format!(
                    "{format} has materials and images in files beside it, which a stream has not; left out"
                ));
            }
            Format::Obj | Format::Ply => {}
            Format::Glb | Format::Gltf | Format::ThreeMf if foreign > 0 => {
                let images = counted(foreign, "image");
                lost.push(format!("{format} holds PNG and JPEG alone; {images} of another kind left out"));
            }
            Format::Glb | Format::Gltf | Format::ThreeMf => {}
        }
        if format == Format::ThreeMf && (0..self.coordinates.len()).any(|t| self.has_idle_coordinates(t)) {
            lost.push("3mf has texture coordinates only where there is an image; the others are left out".into());
        }
        lost
    }

    fn has_idle_coordinates(&self, triangle: usize) -> bool {
        self.coordinates[triangle].is_some() && self.packed_image(triangle).is_none()
    }

    /// An order of the triangles in which those of one material follow one another, as glTF holds them in one piece; within a material the
    /// order stays. `None` when the triangles are in such an order already.
    pub fn by_material(&self) -> Option<Vec<u32>> {
        let key = |t: &u32| (self.material_of[*t as usize], self.coordinates[*t as usize].is_some());
        let mut order: Vec<u32> = (0..self.material_of.len() as u32).collect();
        let mut met = std::collections::BTreeSet::new();
        let pieces = order.chunk_by(|a, b| key(a) == key(b));
        if pieces.into_iter().all(|piece| met.insert(key(&piece[0]))) {
            return None;
        }
        order.sort_by_key(key);
        Some(order)
    }

    /// The same textures for triangles in another order, or for some of them.
    pub fn picked(&self, triangles: &[u32]) -> Self {
        Self {
            coordinates: triangles.iter().map(|&t| self.coordinates[t as usize]).collect(),
            material_of: triangles.iter().map(|&t| self.material_of[t as usize]).collect(),
            ..self.clone()
        }
    }
}

/// The colours that a surface shows where there is no place for materials: its own, else those of its materials.
pub fn shown_colours<'a>(colours: Option<&'a Colours>, texture: Option<&TextureMap>) -> Option<Cow<'a, Colours>> {
    match colours {
        Some(colours) => Some(Cow::Borrowed(colours)),
        None => texture.and_then(TextureMap::material_colours).map(Cow::Owned),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> TextureMap {
        let material = |name: &str, colour, image| Material { name: name.into(), colour, image };
        TextureMap {
            coordinates: vec![Some([[0.0, 0.25], [1.0, 0.5], [0.0, 1.0]]), None, Some([[0.5; 2]; 3]), None],
            material_of: vec![Some(1), Some(0), Some(1), None],
            materials: vec![material("red", Some([255, 0, 0, 255]), None), material("wood", None, Some(0))],
            images: vec![TextureImage { name: "a.png".into(), bytes: Arc::from(*b"\x89PNG") }],
            ..TextureMap::default()
        }
    }

    #[test]
    fn coordinates_are_turned_and_triangles_sorted_by_material() {
        let map = map();
        assert_eq!(map.at(0, true), Some([[0.0, 0.75], [1.0, 0.5], [0.0, 0.0]]));
        assert_eq!((map.at(0, false), map.at(1, false), map.at(9, false)), (map.coordinates[0], None, None));
        let order = map.by_material().expect("they are not together");
        assert_eq!(order, [3, 1, 0, 2]);
        let sorted = map.picked(&order);
        assert_eq!(
            (sorted.by_material(), sorted.material_of[3], sorted.coordinates[3]),
            (None, Some(1), map.coordinates[2])
        );
    }

    #[test]
    fn what_formats_hold_is_known_beforehand() {
        let map = map();
        let red = Colours::Faces(vec![WHITE, [255, 0, 0, 255], WHITE, WHITE]);
        assert_eq!(map.material_colours(), Some(red));
        assert_eq!(map.lost_in(Format::Stl, true).len(), 1);
        assert!(
            [Format::Obj, Format::Ply, Format::Glb, Format::ThreeMf].iter().all(|f| map.lost_in(*f, true).is_empty())
        );
        assert_eq!(map.lost_in(Format::Obj, false).len(), 1);
        let mut foreign = map.clone();
        foreign.images[0].bytes = Arc::from(*b"BM....");
        assert_eq!(foreign.lost_in(Format::Glb, true).len(), 1);
        assert_eq!(foreign.lost_in(Format::ThreeMf, true).len(), 2);
        assert!(map.is_held(Some(&map), Format::Obj) && !map.is_held(None, Format::Obj));
        let mut other = map.clone();
        other.coordinates[0] = None;
        assert!(!map.is_held(Some(&other), Format::Obj) && map.is_held(Some(&other), Format::Stl));
        other = map.clone();
        other.images[0].bytes = Arc::from(*b"\x89PNG other");
        assert!(map.is_held(Some(&other), Format::Ply) && !map.is_held(Some(&other), Format::ThreeMf));
    }
}
