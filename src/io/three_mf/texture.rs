//! Textures: the places on images that triangles have as properties, and the images in the package.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::super::colour::{Rgba, WHITE};
use super::super::scene::MaterialOrigin;
use super::super::soup::Soup;
use super::super::texture::Gallery;
use super::model::Object;
use super::models::{Inherited, Models};

use crate::io::Material;

/// What makes a material of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// An image: the model that names it, and its number there.
    Picture(usize, u32),
    /// An entry of a group of a model, and whether triangles have it as their own.
    Entry { model: usize, group: u32, entry: u32, own: bool },
    /// Colours that differ from corner to corner.
    Blend,
}

/// The images that triangles have, each a material of its own.
#[derive(Default)]
pub(super) struct Textures {
    /// Numbers of materials.
    numbers: BTreeMap<Kind, u32>,
    /// Whether every property is a material of its own, and goes by its number.
    of_all: bool,
}

impl Textures {
    /// The same for all properties: each is a material that goes by its number.
    pub(super) fn of_all() -> Self {
        Self { of_all: true, ..Self::default() }
    }

    fn number(&mut self, kind: Kind) -> u32 {
        let next = self.numbers.len() as u32;
        *self.numbers.entry(kind).or_insert(next)
    }

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
            let Some(((model, image), [a, b, c])) = property(number).and_then(|property| models.places(property))
            else {
                continue;
            };
            let material = self.number(Kind::Picture(model, image));
            soup.texture.cover(triangle..triangle + 1, material);
            soup.texture.put(triangle, if mirrored { [a, c, b] } else { [a, b, c] });
        }
    }

    /// Gives the last triangles, which have these numbers in their object, materials by their properties. Returns the colours that are in
    /// no material.
    pub(super) fn cover(
        &mut self,
        soup: &mut Soup,
        models: &Models<'_>,
        (object, model): (&Object, usize),
        numbers: &[usize],
        default: Option<Inherited>,
    ) -> Vec<[Rgba; 3]> {
        let first = soup.triangles.len() - numbers.len();
        let mut corners = vec![[WHITE; 3]; numbers.len()];
        for (n, &number) in numbers.iter().enumerate() {
            let own = object.properties.get(number).copied().flatten().map(|property| Inherited { model, property });
            let Some(found) = own.or(default) else { continue };
            let [a, b, c] = found.property.entries;
            let kind = if let Some(((model, image), places)) = models.places(found) {
                soup.texture.put(first + n, places);
                Kind::Picture(model, image)
            } else if a == b && b == c {
                Kind::Entry { model: found.model, group: found.property.group, entry: a, own: own.is_some() }
            } else {
                let Some(colours) = models.colours(found) else { continue };
                corners[n] = colours;
                Kind::Blend
            };
            let material = self.number(kind);
            soup.texture.cover(first + n..first + n + 1, material);
        }
        corners
    }

    /// Takes the images out of the package. Returns the true name and the origin of each material that goes by its number.
    pub(super) fn finish(
        &self,
        models: &mut Models<'_>,
        soup: &mut Soup,
    ) -> BTreeMap<String, (String, MaterialOrigin)> {
        let mut gallery = Gallery::beside(None);
        let mut in_order: Vec<(Kind, u32)> = self.numbers.iter().map(|(&kind, &number)| (kind, number)).collect();
        in_order.sort_by_key(|(_, number)| *number);
        let mut names = BTreeMap::new();
        for (kind, number) in in_order {
            let (material, origin) = match kind {
                Kind::Picture(model, image) => {
                    (picture(models, &mut gallery, model, image), MaterialOrigin::Picture(image))
                }
                Kind::Entry { model, group, entry, own } => {
                    let model = &models.loaded[model];
                    let colour = model.groups.get(&group).and_then(|group| group.get(entry as usize)).copied();
                    let name = model.names.get(&group).and_then(|names| names.get(entry as usize)).cloned();
                    let origin = if own { MaterialOrigin::Entry { group, entry } } else { MaterialOrigin::Plain };
                    (Material { name: name.unwrap_or_default(), colour, image: None }, origin)
                }
                Kind::Blend => (Material { name: String::new(), colour: None, image: None }, MaterialOrigin::Blend),
            };
            let name = if self.of_all { number.to_string() } else { material.name.clone() };
            soup.texture.materials.push(Material { name: name.clone(), ..material });
            if self.of_all {
                names.insert(name, (material.name, origin));
            }
        }
        soup.texture.hang(gallery, &mut soup.warnings);
        names
    }
}

/// The material of an image.
fn picture(models: &mut Models<'_>, gallery: &mut Gallery<'_>, model: usize, image: u32) -> Material {
    let path = models.loaded[model].textures.get(&image).cloned().unwrap_or_default();
    let fetch = |_: &mut Gallery<'_>| models.package.read_bytes(&path).map(Arc::from);
    let number = gallery.own(path.to_ascii_lowercase(), fetch, &path);
    let stem = Path::new(&path).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Material { name: stem.unwrap_or_default(), colour: None, image: Some(number) }
}
