//! What goes into a pipeline: meshes, and what they look like.

use super::colours::classes;
use super::textures::classes_of;
use crate::io::{Colours, Loaded, TextureMap};
use crate::mesh::{Solid, TriMesh};

/// A mesh, which may be broken, and what it looks like. Made from a `&TriMesh`, a `&Solid` or a `&Loaded` by `into`; the pipelines
/// take any of them.
#[derive(Debug, Clone, Copy)]
pub struct Operand<'a> {
    /// The mesh, model units.
    pub mesh: &'a TriMesh,
    /// Its colours.
    pub colours: Option<&'a Colours>,
    /// Its texture coordinates, materials and images.
    pub texture: Option<&'a TextureMap>,
}

impl Operand<'_> {
    /// A number for each triangle, different where colours, materials or pieces of images differ: simplification keeps apart what has
    /// different numbers. Empty where there is nothing to keep apart.
    pub(super) fn classes(&self) -> Vec<u32> {
        match self.texture {
            Some(_) => classes_of(self.mesh, self.colours, self.texture),
            None => classes(self.colours),
        }
    }
}

impl<'a> From<&'a TriMesh> for Operand<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self { mesh, colours: None, texture: None }
    }
}

impl<'a> From<&'a Solid> for Operand<'a> {
    fn from(solid: &'a Solid) -> Self {
        solid.mesh().into()
    }
}

impl<'a> From<&'a Loaded> for Operand<'a> {
    fn from(loaded: &'a Loaded) -> Self {
        Self { mesh: &loaded.mesh, colours: loaded.colours.as_ref(), texture: loaded.texture.as_ref() }
    }
}
