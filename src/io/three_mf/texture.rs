//! Textures: the places on images that triangles have as properties, and the images in the package.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::super::soup::Soup;
use super::super::texture::Gallery;
use super::models::{Inherited, Models};

use crate::io::Material;

/// The images that triangles have, each a material of its own.
#[derive(Default)]
pub(super) struct Textures {
    /// Numbers of materials, by the model that names the image and its number there.
    numbers: BTreeMap<(usize, u32), u32>,
}

impl Textures {
    /// Gives the last triangles, which have these numbers in their object, their images and places, where they have some.
    pub(super) fn hang(
        &mut self,
        soup: &mut Soup,
        models: &Models<'_>,
        numbers: &[usize],
        property: impl Fn(usize) -> Option<Inherited>,
        mirrored: bool,
    ) {
        let first = soup.triangles.len() - numbers.len();
        for (triangle, &number) in (first..).zip(numbers) {
            let Some((image, [a, b, c])) = property(number).and_then(|property| models.places(property)) else {
                continue;
            };
            let next = self.numbers.len() as u32;
            let material = *self.numbers.entry(image).or_insert(next);
            soup.texture.cover(triangle..triangle + 1, material);
            soup.texture.put(triangle, if mirrored { [a, c, b] } else { [a, b, c] });
        }
    }

    /// Takes the images out of the package.
    pub(super) fn finish(&self, models: &mut Models<'_>, soup: &mut Soup) {
        let mut gallery = Gallery::beside(None);
        let mut in_order: Vec<((usize, u32), u32)> = self.numbers.iter().map(|(&key, &number)| (key, number)).collect();
        in_order.sort_by_key(|(_, number)| *number);
        for ((model, image), _) in in_order {
            let path = models.loaded[model].textures.get(&image).cloned().unwrap_or_default();
            let fetch = |_: &mut Gallery<'_>| models.package.read_bytes(&path).map(Arc::from);
            let number = gallery.own(path.to_ascii_lowercase(), fetch, &path);
            let stem = Path::new(&path).file_stem().map(|stem| stem.to_string_lossy().into_owned());
            soup.texture.materials.push(Material { name: stem.unwrap_or_default(), colour: None, image: Some(number) });
        }
        soup.texture.hang(gallery, &mut soup.warnings);
    }
}
