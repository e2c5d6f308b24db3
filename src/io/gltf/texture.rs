//! Textures of the base colour: coordinates, materials, images.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use gltf_json::material::Material;
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

use super::super::soup::{Expansion, Soup};
use super::super::text::counted;
use super::super::texture::Gallery;
use super::accessor;
use super::buffers::{Buffers, decoded_data, percent_decoded};
use super::material::Tint;
use crate::io;

/// What is read of textures, once for each material, accessor and image.
pub(super) struct Looks<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    gallery: Gallery<'a>,
    /// Whether the document has textures or coordinates at all; else its materials are colours.
    pub(super) is_textured: bool,
    /// Whether the colours of materials stay theirs: not where vertices have colours that they are multiplied by.
    pub(super) keeps_colours: bool,
    /// Our numbers of materials, by those of the document.
    numbers: BTreeMap<usize, u32>,
    coordinates: BTreeMap<usize, Option<Vec<[f32; 2]>>>,
    /// Textures of something else than the colour.
    others: usize,
    /// Sentences on what could not be read.
    warnings: Vec<String>,
}

impl<'a> Looks<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>, path: Option<&'a Path>) -> Self {
        let with_image = |m: &Material| m.pbr_metallic_roughness.base_color_texture.is_some();
        let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
        let has = |semantic: Semantic| {
            let semantic = Checked::Valid(semantic);
            primitives().any(|primitive| primitive.attributes.contains_key(&semantic))
        };
        let is_textured = root.materials.iter().any(with_image) || has(Semantic::TexCoords(0));
        Self {
            root,
            buffers,
            gallery: Gallery::beside(path),
            is_textured,
            keeps_colours: is_textured && !has(Semantic::Colors(0)),
            numbers: BTreeMap::new(),
            coordinates: BTreeMap::new(),
            others: 0,
            warnings: Vec::new(),
        }
    }

    /// Gives the triangles from number `start` on, whose vertices are counted from `first`, their material and coordinates.
    pub(super) fn hang(
        &mut self,
        primitive: &Primitive,
        (start, first): (usize, u32),
        soup: &mut Soup,
        allowance: &mut Expansion,
    ) {
        let material = primitive.material.and_then(|index| Some((index.value(), self.root.get(index)?)));
        if let Some((number, material)) = material
            && start < soup.triangles.len()
        {
            let number = self.material(number, material, soup);
            soup.texture.cover(start..soup.triangles.len(), number);
        }
        let image = material.and_then(|(_, m)| m.pbr_metallic_roughness.base_color_texture.as_ref());
        let set = image.map_or(0, |image| image.tex_coord);
        let Some(&index) = primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(set))) else { return };
        let (root, buffers, warnings) = (self.root, self.buffers, &mut self.warnings);
        let read = self.coordinates.entry(index.value()).or_insert_with(|| {
            let read = accessor::coordinates(root, buffers, index, allowance);
            read.map_err(|error| warnings.push(left_out(index, &error.problem.to_string()))).ok()
        });
        let Some(coordinates) = read else { return };
        let most = soup.triangles[start..].iter().flatten().map(|v| (v - first) as usize).max();
        if most.is_some_and(|most| most >= coordinates.len()) {
            let there = counted(coordinates.len(), "value");
            // Said once, however often it is placed.
            self.coordinates.insert(index.value(), None);
            self.warnings.push(left_out(index, &format!("there are {there} for more vertices")));
            return;
        }
        for triangle in start..soup.triangles.len() {
            let corners = soup.triangles[triangle].map(|v| coordinates[(v - first) as usize]);
            soup.texture.put(triangle, corners);
        }
    }

    /// Our number of a material of the document.
    fn material(&mut self, number: usize, material: &Material, soup: &mut Soup) -> u32 {
        if let Some(&known) = self.numbers.get(&number) {
            return known;
        }
        let pbr = &material.pbr_metallic_roughness;
        let tint = Tint::of_material(material);
        let others = [
            pbr.metallic_roughness_texture.is_some(),
            material.normal_texture.is_some(),
            material.occlusion_texture.is_some(),
            material.emissive_texture.is_some(),
        ];
        self.others += others.into_iter().filter(|there| *there).count();
        let image = pbr.base_color_texture.as_ref().and_then(|texture| self.image(texture.index));
        let colour = (self.keeps_colours && !tint.is_plain()).then(|| tint.applied_to([1.0; 4], &mut 0));
        let own = soup.texture.materials.len() as u32;
        let name = material.name.clone().unwrap_or_default();
        soup.texture.materials.push(io::Material { name, colour, image });
        self.numbers.insert(number, own);
        own
    }

    /// Our number of the image of a texture of the document.
    fn image(&mut self, texture: Index<gltf_json::Texture>) -> Option<u32> {
        let (root, buffers) = (self.root, self.buffers);
        let found = root.get(texture).and_then(|texture| Some((texture.source.value(), root.get(texture.source)?)));
        let Some((number, image)) = found else {
            self.warnings.push(format!("the image of textures[{}] is not there; left out", texture.value()));
            return None;
        };
        if let Some(uri) = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")) {
            // Names of files have percent signs in addresses.
            let name = String::from_utf8_lossy(&percent_decoded(uri)).into_owned();
            return Some(self.gallery.image(&name));
        }
        let fetch = |_: &mut Gallery<'_>| match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                decoded_data(uri.trim_start_matches("data:")).map_err(|problem| problem.to_string()).map(Arc::from)
            }
            (None, Some(view)) => {
                buffers.view(root, view).map(|(bytes, _)| Arc::from(bytes)).map_err(|e| e.problem.to_string())
            }
            (None, None) => Err("it has neither bytes nor a file".into()),
        };
        let name = image.name.clone().filter(|name| !name.is_empty()).unwrap_or_else(|| format!("image_{number}"));
        // No file has this name.
        Some(self.gallery.own(format!("\0{number}"), fetch, &name))
    }

    /// Hands over what was found, with sentences on what was not.
    pub(super) fn finish(mut self, soup: &mut Soup) {
        if !self.is_textured {
            return;
        }
        if self.root.extensions_used.iter().any(|name| name == "KHR_texture_transform") {
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

fn left_out(index: Index<gltf_json::Accessor>, reason: &str) -> String {
    format!("the texture coordinates of accessors[{}] left out: {reason}", index.value())
}
