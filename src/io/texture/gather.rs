//! What the readers fill: textures as they come, made one [`TextureMap`] at the end.

use std::ops::Range;

use super::super::text::counted;
use super::{Gallery, Material, TexCoords, TextureMap};

/// The textures of a mesh while it is read.
#[derive(Debug, Default)]
pub(in crate::io) struct Woven {
    coordinates: Vec<Option<TexCoords>>,
    material_of: Vec<Option<u32>>,
    /// The materials so far.
    pub(in crate::io) materials: Vec<Material>,
    /// Images and files.
    images: TextureMap,
    /// Coordinates that are no finite numbers.
    odd: usize,
}

impl Woven {
    /// Sets the coordinates of a triangle. Numbers that are not finite become 0 and are counted.
    #[inline]
    pub(in crate::io) fn put(&mut self, triangle: usize, corners: TexCoords) {
        if self.coordinates.len() <= triangle {
            self.coordinates.resize(triangle + 1, None);
        }
        let odd = corners.iter().flatten().filter(|x| !x.is_finite()).count();
        self.odd += odd;
        let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
        self.coordinates[triangle] = Some(if odd == 0 { corners } else { corners.map(|c| c.map(finite)) });
    }

    /// Whether a triangle has coordinates.
    pub(in crate::io) fn has(&self, triangle: usize) -> bool {
        self.coordinates.get(triangle).is_some_and(Option::is_some)
    }

    /// Gives triangles a material.
    #[inline]
    pub(in crate::io) fn cover(&mut self, triangles: Range<usize>, material: u32) {
        if self.material_of.len() < triangles.end {
            self.material_of.resize(triangles.end, None);
        }
        self.material_of[triangles].fill(Some(material));
    }

    /// Takes over what was found beside the mesh.
    pub(in crate::io) fn hang(&mut self, mut gallery: Gallery<'_>, warnings: &mut Vec<String>) {
        warnings.extend(gallery.sentences());
        (self.images.images, self.images.files) = (gallery.images, gallery.files);
    }

    /// States that the second coordinates count down from the upper edge.
    pub(in crate::io) fn count_down(&mut self) {
        self.images.downward = true;
    }

    /// Whether a triangle has a material.
    pub(in crate::io) fn is_covered(&self) -> bool {
        self.material_of.iter().any(Option::is_some)
    }

    /// Takes materials that are not there away from the triangles that name them.
    pub(in crate::io) fn drop_missing(&mut self) {
        let count = self.materials.len();
        let drop = |material: &mut Option<u32>| *material = material.filter(|n| (*n as usize) < count);
        self.material_of.iter_mut().for_each(drop);
    }

    /// Takes materials away from the triangles that have them.
    pub(in crate::io) fn drop_materials(&mut self, is_none: impl Fn(u32, &str) -> bool) {
        let is_none = |n: &u32| is_none(*n, &self.materials[*n as usize].name);
        let none: Vec<u32> = (0..self.materials.len() as u32).filter(is_none).collect();
        if !none.is_empty() {
            let drop = |material: &mut Option<u32>| *material = material.filter(|n| !none.contains(n));
            self.material_of.iter_mut().for_each(drop);
        }
    }

    /// Forgets the triangles that are not kept.
    pub(in crate::io) fn keep<T>(&mut self, triangles: &[Option<T>]) {
        fn kept<A, T>(list: &mut Vec<A>, triangles: &[Option<T>]) {
            let mut kept = triangles.iter().map(Option::is_some);
            list.retain(|_| kept.next().unwrap_or(false));
        }
        kept(&mut self.coordinates, triangles);
        kept(&mut self.material_of, triangles);
    }

    /// The textures of the finished mesh, `None` when no triangle has any.
    pub(in crate::io) fn finish(mut self, triangles: usize, warnings: &mut Vec<String>) -> Option<TextureMap> {
        if self.odd > 0 {
            warnings.push(format!("{} that is no finite number taken as 0", counted(self.odd, "texture coordinate")));
        }
        self.coordinates.resize(triangles, None);
        self.material_of.resize(triangles, None);
        let used = self.coordinates.iter().any(Option::is_some) || self.material_of.iter().any(Option::is_some);
        used.then_some(TextureMap {
            coordinates: self.coordinates,
            material_of: self.material_of,
            materials: self.materials,
            ..self.images
        })
    }
}
