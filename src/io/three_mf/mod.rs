//! 3MF: a zip package of XML models. Objects hold a mesh or components (other objects under a
//! transform); the build places objects.

mod builder;
mod extensions;
mod model;
mod models;
mod package;
mod pictures;
mod roles;
mod texture;
mod write;
mod xml;

use self::builder::Builder;
use self::models::Models;
use self::package::Package;
use self::roles::Roles;
use super::error::FileError;
use super::format::Format;
use super::loaded::Loaded;

pub(super) use write::write;

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, FileError> {
    let mut package = Package::open(bytes)?;
    let root = package.root_model()?;
    let roles = Roles::read(&mut package);
    let mut models = Models::new(package);
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
