//! What goes into a pipeline: meshes, and what they look like.

use super::colours::classes;
use super::textures::classes_of;
use crate::io::{Colours, Loaded, TextureMap};
use crate::ldi::Expression;
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
    /// What is to be taken away from the mesh wherever it stands in an expression: the negative parts of a 3MF file. Triangles of the result
    /// that come from there have an operand number after those of all operands given.
    pub negative: Option<&'a TriMesh>,
}

impl<'a> Operand<'a> {
    /// The operands, and after them their negative parts; and the expression that takes these away.
    pub(super) fn with_negatives(
        operands: impl IntoIterator<Item: Into<Self>>,
        expression: &Expression,
    ) -> (Vec<Self>, Expression) {
        let mut all: Vec<Self> = operands.into_iter().map(Into::into).collect();
        let mut negative_of = vec![None; all.len()];
        for n in 0..all.len() {
            if let Some(negative) = all[n].negative.take() {
                negative_of[n] = Some(all.len());
                all.push(negative.into());
            }
        }
        (all, expression.less(&negative_of))
    }

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
        Self { mesh, colours: None, texture: None, negative: None }
    }
}

impl<'a> From<&'a Solid> for Operand<'a> {
    fn from(solid: &'a Solid) -> Self {
        solid.mesh().into()
    }
}

impl<'a> From<&'a Loaded> for Operand<'a> {
    fn from(loaded: &'a Loaded) -> Self {
        Self {
            mesh: &loaded.mesh,
            colours: loaded.colours.as_ref(),
            texture: loaded.texture.as_ref(),
            negative: loaded.negative.as_ref().map(|negative| &negative.mesh),
        }
    }
}
