//! 3MF: a zip package of XML models. Objects hold a mesh or components (other objects under a
//! transform); the build places objects.

mod builder;
mod extensions;
mod model;
mod package;
mod pictures;
mod roles;
mod texture;
mod write;

use std::collections::BTreeMap;

use self::builder::Builder;
use self::model::{Model, Property};
use self::package::Package;
use self::roles::Roles;
use super::colour::Rgba;
use super::error::FileError;
use super::{Format, Loaded, TexCoords};

pub(super) use write::write;

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, FileError> {
    let mut package = Package::open(bytes)?;
    let root = package.root_model()?;
    let roles = Roles::read(&mut package);
    let mut models = Models { package, loaded: Vec::new(), known: BTreeMap::new() };
    let root = models.load(&root)?;
    let unit = models.loaded[root].unit;
    // A copy, because placing objects may load further models.
    let mut items = models.loaded[root].items.clone();
    let mut warnings = Vec::new();
    if items.is_empty() {
        items = models.loaded[root].free_objects();
        if !items.is_empty() {
            warnings.push("the build is empty; every object that is no component of another is read".into());
        }
    }
    let mut builder = Builder::new(models, root, roles, warnings);
    for item in &items {
        builder.place(item)?;
    }
    let (soup, negative) = builder.finish();
    let negative = negative.finish_negative();
    let loaded = soup.finish(Format::ThreeMf, Some(unit))?;
    Ok(Loaded { negative, ..loaded })
}

/// The models of a package, read when first asked for.
struct Models<'a> {
    package: Package<'a>,
    loaded: Vec<Model>,
    known: BTreeMap<String, usize>,
}

impl Models<'_> {
    fn load(&mut self, name: &str) -> Result<usize, FileError> {
        if let Some(&known) = self.known.get(name) {
            return Ok(known);
        }
        let model = self.package.read_model(name)?;
        model.extensions.check().map_err(|problem| FileError::item(name, problem))?;
        self.loaded.push(model);
        self.known.insert(name.to_owned(), self.loaded.len() - 1);
        Ok(self.loaded.len() - 1)
    }

    /// The colours of a property, if it is colours.
    fn colours(&self, property: Inherited) -> Option<[Rgba; 3]> {
        let Inherited { model, property } = property;
        let entries = self.loaded[model].groups.get(&property.group)?;
        let colour = |entry: u32| entries.get(entry as usize).copied();
        let [a, b, c] = property.entries.map(colour);
        Some([a?, b?, c?])
    }

    /// The image of a property (the model that names it, and its number there) and the places on it, if it is a place on an image.
    fn places(&self, property: Inherited) -> Option<((usize, u32), TexCoords)> {
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
struct Inherited {
    model: usize,
    property: Property,
}
