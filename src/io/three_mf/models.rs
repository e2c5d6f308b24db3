//! The models of a package, and what their objects inherit from one another.

use std::collections::BTreeMap;

use super::super::colour::Rgba;
use super::super::error::FileError;
use super::super::texture::TexCoords;
use super::model::{self, Model, Property};
use super::package::Package;

/// The models of a package, read when first asked for.
pub(super) struct Models<'a> {
    pub(super) package: Package<'a>,
    /// Those that were read, in the order of reading.
    pub(super) loaded: Vec<Model>,
    known: BTreeMap<String, usize>,
}

impl<'a> Models<'a> {
    pub(super) fn new(package: Package<'a>) -> Self {
        Self { package, loaded: Vec::new(), known: BTreeMap::new() }
    }

    /// The number of the model called `name`.
    pub(super) fn load(&mut self, name: &str) -> Result<usize, FileError> {
        if let Some(&known) = self.known.get(name) {
            return Ok(known);
        }
        let model = self.package.read_xml(name, |xml| model::parse(xml, name))?;
        model.extensions.check().map_err(|problem| FileError::item(name, problem))?;
        self.loaded.push(model);
        self.known.insert(name.to_owned(), self.loaded.len() - 1);
        Ok(self.loaded.len() - 1)
    }

    /// The colours of a property, if it is colours.
    pub(super) fn colours(&self, property: Inherited) -> Option<[Rgba; 3]> {
        let Inherited { model, property } = property;
        let entries = self.loaded[model].groups.get(&property.group)?;
        let colour = |entry: u32| entries.get(entry as usize).copied();
        let [a, b, c] = property.entries.map(colour);
        Some([a?, b?, c?])
    }

    /// The image of a property (the model that names it, and its number there) and the places on it, if it is a place on an image.
    pub(super) fn places(&self, property: Inherited) -> Option<((usize, u32), TexCoords)> {
        let Inherited { model, property } = property;
        let (image, entries) = self.loaded[model].places.get(&property.group)?;
        self.loaded[model].textures.get(image)?;
        let place = |entry: u32| entries.get(entry as usize).copied();
        let [a, b, c] = property.entries.map(place);
        Some(((model, *image), [a?, b?, c?]))
    }
}

/// A property and the model that has its group.
#[derive(Clone, Copy)]
pub(super) struct Inherited {
    pub(super) model: usize,
    pub(super) property: Property,
}
