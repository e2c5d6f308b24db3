//! Textures of the base colour: coordinates, materials, images.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use gltf::{Accessor, Document, Material, Semantic};

use super::super::error::FileProblem;
use super::super::soup::{Expansion, Soup};
use super::super::text::counted;
use super::super::texture::Gallery;
use super::accessor;
use super::buffers::{Buffers, decoded_data, percent_decoded};
use super::checked::{self, ImageSource, Primitive};
use super::material::Tint;
use crate::io;

/// What is read of textures, once for each material, accessor and image.
pub(super) struct Looks<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    gallery: Gallery<'a>,
    /// Whether the document has textures or coordinates at all; else its materials are colours.
    pub(super) is_textured: bool,
    /// Whether the colours of materials stay theirs: not where vertices have colours that they are multiplied by.
    pub(super) keeps_colours: bool,
    /// Whether materials go by their numbers in the document, which keeps them as they are.
    is_numbered: bool,
    /// Our numbers of materials, by those of the document.
    numbers: BTreeMap<usize, u32>,
    coordinates: BTreeMap<usize, Option<Vec<[f32; 2]>>>,
    /// Textures of something else than the colour.
    others: usize,
    /// Sentences on what could not be read.
    warnings: Vec<String>,
}

impl<'a> Looks<'a> {
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'a>, path: Option<&'a Path>) -> Self {
        let primitives = || document.meshes().flat_map(|mesh| checked::primitives(document, &mesh));
        let has = |semantic: Semantic| primitives().any(|primitive| primitive.has(semantic.clone()));
        let is_textured = document.materials().any(|material| checked::base_texture(document, &material).is_some())
            || has(Semantic::TexCoords(0));
        Self {
            document,
            buffers,
            gallery: Gallery::beside(path),
            is_textured,
            keeps_colours: is_textured && !has(Semantic::Colors(0)),
            is_numbered: false,
            numbers: BTreeMap::new(),
            coordinates: BTreeMap::new(),
            others: 0,
            warnings: Vec::new(),
        }
    }

    /// The same for a document whose materials stay what they are: each goes by its number, and its colour is not multiplied into those of the
    /// vertices.
    pub(super) fn numbered(document: &'a Document, buffers: &'a Buffers<'a>, path: Option<&'a Path>) -> Self {
        Self { is_textured: true, keeps_colours: true, is_numbered: true, ..Self::new(document, buffers, path) }
    }

    /// Gives the triangles from number `start` on, whose vertices are counted from `first`, their material and coordinates.
    pub(super) fn hang(
        &mut self,
        primitive: &Primitive<'a>,
        (start, first): (usize, u32),
        soup: &mut Soup,
        allowance: &mut Expansion,
    ) {
        let material = primitive.material().ok().flatten();
        if let Some(material) = &material
            && start < soup.triangles.len()
            && let Some(number) = self.material(material, soup)
        {
            soup.texture.cover(start..soup.triangles.len(), number);
        }
        let image = material.and_then(|material| checked::base_texture(self.document, &material));
        let set = image.map_or(0, |(_, set)| set);
        let (document, buffers, warnings) = (self.document, self.buffers, &mut self.warnings);
        let accessor = match primitive.attribute(Semantic::TexCoords(set)) {
            Ok(Some(accessor)) => accessor,
            Ok(None) => return,
            Err(problem) => return self.absent(&problem),
        };
        let read = self.coordinates.entry(accessor.index()).or_insert_with(|| {
            let read = accessor::coordinates(document, buffers, &accessor, allowance);
            read.map_err(|error| warnings.push(left_out(&accessor, &error.problem.to_string()))).ok()
        });
        let Some(coordinates) = read else { return };
        let most = soup.triangles[start..].iter().flatten().map(|v| (v - first) as usize).max();
        if most.is_some_and(|most| most >= coordinates.len()) {
            let there = counted(coordinates.len(), "value");
            // Said once, however often it is placed.
            self.coordinates.insert(accessor.index(), None);
            self.warnings.push(left_out(&accessor, &format!("there are {there} for more vertices")));
            return;
        }
        for triangle in start..soup.triangles.len() {
            let corners = soup.triangles[triangle].map(|v| coordinates[(v - first) as usize]);
            soup.texture.put(triangle, corners);
        }
    }

    /// Says, once, that the accessor of coordinates is not there.
    fn absent(&mut self, problem: &FileProblem) {
        if let FileProblem::IndexOutOfRange { index, .. } = problem
            && self.coordinates.insert(*index as usize, None).is_none()
        {
            self.warnings.push(format!("the texture coordinates of accessors[{index}] left out: {problem}"));
        }
    }

    /// Our number of a material of the document; `None` for the one that stands for no material.
    fn material(&mut self, material: &Material<'a>, soup: &mut Soup) -> Option<u32> {
        let number = material.index()?;
        if let Some(&known) = self.numbers.get(&number) {
            return Some(known);
        }
        self.others += checked::other_textures(self.document, material);
        let tint = Tint::of(self.document, material);
        let image = checked::base_texture(self.document, material).and_then(|(texture, _)| self.image(texture));
        let colour = (self.keeps_colours && !tint.is_plain()).then(|| tint.applied_to([1.0; 4], &mut 0));
        let own = soup.texture.materials.len() as u32;
        let name = match self.is_numbered {
            true => number.to_string(),
            false => material.name().unwrap_or_default().to_owned(),
        };
        soup.texture.materials.push(io::Material { name, colour, image });
        self.numbers.insert(number, own);
        Some(own)
    }

    /// Our number of the image of a texture of the document.
    fn image(&mut self, texture: usize) -> Option<u32> {
        let (document, buffers) = (self.document, self.buffers);
        let Some(image) = checked::image(document, texture) else {
            self.warnings.push(format!("the image of textures[{texture}] is not there; left out"));
            return None;
        };
        let source = checked::source(document, &image);
        if let Some(ImageSource::Uri(uri)) = &source
            && !uri.starts_with("data:")
        {
            // Names of files have percent signs in addresses.
            let name = String::from_utf8_lossy(&percent_decoded(uri)).into_owned();
            return Some(self.gallery.image(&name));
        }
        let fetch = |_: &mut Gallery<'_>| match source {
            Some(ImageSource::Uri(uri)) => {
                decoded_data(uri.trim_start_matches("data:")).map_err(|problem| problem.to_string()).map(Arc::from)
            }
            Some(ImageSource::View(view)) => {
                buffers.view(document, view).map(|(bytes, _)| Arc::from(bytes)).map_err(|e| e.problem.to_string())
            }
            None => Err("it has neither bytes nor a file".into()),
        };
        let number = image.index();
        let name =
            image.name().filter(|name| !name.is_empty()).map_or_else(|| format!("image_{number}"), str::to_owned);
        // No file has this name.
        Some(self.gallery.own(format!("\0{number}"), fetch, &name))
    }

    /// Hands over what was found, with sentences on what was not.
    pub(super) fn finish(mut self, soup: &mut Soup) {
        if !self.is_textured {
            return;
        }
        if self.document.extensions_used().any(|name| name == "KHR_texture_transform") {
            self.warnings.push("textures that KHR_texture_transform shifts or scales taken as they are".into());
        }
        if self.others > 0 {
            let textures = counted(self.others, "further texture");
            self.warnings.push(format!(
                "{textures} of materials (gloss, bumps and the like) left out; that of the colour is kept"
            ));
        }
        soup.texture.count_down();
        soup.warnings.append(&mut self.warnings);
        soup.texture.hang(self.gallery, &mut soup.warnings);
    }
}

fn left_out(accessor: &Accessor<'_>, reason: &str) -> String {
    format!("the texture coordinates of accessors[{}] left out: {reason}", accessor.index())
}
