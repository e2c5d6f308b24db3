//! Texture coordinates of vertices or of the corners of faces, and the images that comments name.

use std::path::Path;

use super::super::soup::Soup;
use super::super::texture::Gallery;
use super::header::Element;
use super::rows::Rows;
use crate::io::Material;

/// Names that programs give the two coordinates of a vertex.
const NAMES: [[&str; 2]; 4] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Image files of one mesh; a header may name any number.
const MOST_IMAGES: usize = 4096;

/// The coordinates of vertices.
#[derive(Default)]
pub(super) struct OfVertices {
    properties: Option<[usize; 2]>,
    coordinates: Vec<[f32; 2]>,
}

impl OfVertices {
    /// Finds out whether the rows of vertices have coordinates.
    pub(super) fn begin(&mut self, element: &Element) {
        let named = |name: &str| element.properties.iter().position(|p| p.name == name && p.list.is_none());
        self.properties = NAMES.into_iter().find_map(|[u, v]| Some([named(u)?, named(v)?]));
    }

    /// The coordinates of the vertex in the row last read.
    #[inline]
    pub(super) fn take(&mut self, rows: &Rows<'_>) {
        if let Some(properties) = self.properties {
            self.coordinates.push(properties.map(|property| rows.scalar(property) as f32));
        }
    }

    /// Gives them to the corners of the triangles that have none of their own.
    pub(super) fn spread(self, soup: &mut Soup) {
        if self.coordinates.is_empty() {
            return;
        }
        for triangle in 0..soup.triangles.len() {
            if !soup.texture.has(triangle) {
                let corners = soup.triangles[triangle].map(|v| self.coordinates[v as usize]);
                soup.texture.put(triangle, corners);
            }
        }
    }
}

/// The coordinates of the corners of faces.
pub(super) struct OfFaces {
    /// `texcoord`: two numbers for each corner.
    coordinates: Option<usize>,
    /// `texnumber`: the image.
    image: Option<usize>,
    cut: Vec<[u32; 3]>,
}

impl OfFaces {
    pub(super) fn of(element: &Element) -> Self {
        let named =
            |name: &str, list: bool| element.properties.iter().position(|p| p.name == name && p.list.is_some() == list);
        Self { coordinates: named("texcoord", true), image: named("texnumber", false), cut: Vec::new() }
    }

    /// Adds the face in the row last read.
    #[inline]
    pub(super) fn face(&mut self, corners: &[u32], rows: &Rows<'_>, soup: &mut Soup) {
        let first = soup.triangles.len();
        let coordinates = self.coordinates.map_or(&[][..], |list| rows.list(list));
        if corners.len() >= 3 && coordinates.len() == 2 * corners.len() {
            soup.face_of_corners(corners, &mut self.cut);
            for (triangle, own) in (first..).zip(&self.cut) {
                let corner = |k: u32| [coordinates[2 * k as usize] as f32, coordinates[2 * k as usize + 1] as f32];
                soup.texture.put(triangle, own.map(corner));
            }
        } else {
            soup.face(corners);
        }
        if let Some(property) = self.image {
            let number = rows.scalar(property);
            if number >= 0.0 && number < MOST_IMAGES as f64 && number.fract() == 0.0 && first < soup.triangles.len() {
                soup.texture.cover(first..soup.triangles.len(), number as u32);
            }
        }
    }
}

/// Makes a material of each image that the header names. Triangles with coordinates that name no image have the first, unless others name one.
pub(super) fn hang(names: &[Vec<u8>], path: Option<&Path>, soup: &mut Soup) {
    let mut gallery = Gallery::beside(path);
    let textured = (0..soup.triangles.len()).any(|t| soup.texture.has(t));
    if textured {
        for name in &names[..names.len().min(MOST_IMAGES)] {
            let name = String::from_utf8_lossy(name);
            let image = gallery.image(&name);
            let file = Path::new(name.as_ref()).file_stem().map(|stem| stem.to_string_lossy().into_owned());
            let material = Material { name: file.unwrap_or_default(), colour: None, image: Some(image) };
            soup.texture.materials.push(material);
        }
        if !names.is_empty() && !soup.texture.is_covered() {
            for triangle in 0..soup.triangles.len() {
                if soup.texture.has(triangle) {
                    soup.texture.cover(triangle..triangle + 1, 0);
                }
            }
        }
    }
    soup.texture.drop_missing();
    soup.texture.hang(gallery, &mut soup.warnings);
}
