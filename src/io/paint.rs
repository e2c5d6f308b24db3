//! Colours and textures of a mesh that is to be written.

use std::path::Path;

use super::colour::{Carried, Colours};
use super::format::Format;
use super::texture::TextureMap;
use crate::mesh::TriMesh;

/// What the surface of a mesh looks like.
#[derive(Debug, Clone, Copy, Default)]
pub struct Paint<'a> {
    /// Colours of triangles, vertices or corners.
    pub colours: Option<&'a Colours>,
    /// Textures: coordinates, materials, images.
    pub texture: Option<&'a TextureMap>,
    /// Where the file will lie, which names the files beside it ([`TextureMap::side_files`]); `None` for a stream, which has
    /// none. [`write_painted`](crate::io::write_painted) fills it in.
    pub beside: Option<&'a Path>,
}

impl<'a> From<Option<&'a Colours>> for Paint<'a> {
    fn from(colours: Option<&'a Colours>) -> Self {
        Self { colours, ..Self::default() }
    }
}

impl<'a> From<&'a Colours> for Paint<'a> {
    fn from(colours: &'a Colours) -> Self {
        Some(colours).into()
    }
}

impl Paint<'_> {
    /// What of the colours and textures of `mesh` a file of `format` cannot hold, in sentences: what is averaged, and what is left out.
    /// `files_beside` says whether there can be files beside it, as there cannot with a stream.
    pub fn lost_in(&self, format: Format, mesh: &TriMesh, files_beside: bool) -> Vec<String> {
        let colours = self.colours.map_or(Carried::Wholly, |colours| colours.carried_by(format, mesh));
        let colours = match colours {
            Carried::Wholly => None,
            Carried::Roughly => Some(format!("{format} has no place for colours of this kind; they were averaged")),
            Carried::Not => Some(format!("{format} holds no colours; they are left out")),
        };
        let mut lost: Vec<String> = colours.into_iter().collect();
        if let Some(texture) = self.texture {
            lost.extend(texture.lost_in(format, files_beside));
            if self.colours.is_some() && self.texture_covers_colours(format) {
                lost.push(
                    "3mf has either a colour or a texture for a triangle; colours of textured ones are left out".into(),
                );
            }
        }
        lost
    }

    /// Whether textures take the place of colours in a file of this format.
    pub fn texture_covers_colours(&self, format: Format) -> bool {
        let covers = |texture: &TextureMap| (0..texture.coordinates.len()).any(|t| texture.image(t).is_some());
        format == Format::ThreeMf && self.texture.is_some_and(covers)
    }
}
