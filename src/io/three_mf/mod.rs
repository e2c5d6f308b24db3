//! 3MF: a zip package of XML models. Objects hold a mesh or components (other objects under a
//! transform); the build places objects.

mod apart;
mod builder;
mod extensions;
mod fresh;
mod model;
mod models;
mod object;
mod package;
mod palette;
mod patch;
mod pictures;
mod roles;
mod splice;
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
use super::scene::Unplaced;
use super::unit::Unit;

pub(super) use fresh::write_fresh;
pub(super) use patch::write_patched;
pub(super) use write::write;

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, FileError> {
    let (builder, unit) = built(bytes, |builder| builder)?;
    let (soup, negative) = builder.finish();
    let negative = negative.finish_negative();
    let loaded = soup.finish(Format::ThreeMf, Some(unit))?;
    Ok(Loaded { negative, ..loaded })
}

/// Reads the objects of a package, each once, and where they are placed.
pub(super) fn read_apart(bytes: &[u8]) -> Result<Unplaced, FileError> {
    let (builder, unit) = built(bytes, Builder::apart)?;
    let (mut soup, apart) = builder.finish_apart();
    if soup.triangles.is_empty() {
        soup.warnings.clone_from(&apart.lost_elsewhere);
    }
    let loaded = soup.finish(Format::ThreeMf, Some(unit))?;
    Ok(apart.unplaced(loaded))
}

/// A builder that has placed everything, and the unit.
fn built<'a>(bytes: &'a [u8], kind: fn(Builder<'a>) -> Builder<'a>) -> Result<(Builder<'a>, Unit), FileError> {
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
    let mut builder = kind(Builder::new(models, root, roles, warnings));
    for item in &items {
        builder.place(item)?;
    }
    Ok((builder, unit))
}
