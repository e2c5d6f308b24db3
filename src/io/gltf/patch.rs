//! Writing a scene of glTF: the document as it is, with other triangles in the meshes that were replaced.

use std::io::{self, Write};
use std::path::Path;

use serde_json::{Value, json};

use super::super::error::WriteError;
use super::super::scene::{MaterialOrigin, Origin, Scene, SceneObject};
use super::super::texture::{file_beside, read_beside};
use super::apart::is_surface;
use super::buffers::percent_decoded;
use super::compact;
use super::content::{Content, Piece};
use super::write::index_accessor;
use super::{Opened, pack};
use crate::io::{Format, TextureImage};
use crate::mesh::Bounds;

const FLOAT: u32 = gltf::json::accessor::FLOAT;
const UNSIGNED_SHORT: u32 = gltf::json::accessor::UNSIGNED_SHORT;

/// Images beside the document are taken into it up to this size.
const LARGEST_IMAGE: u64 = 1 << 30;

/// Sets a member of a value that is an object; a file may have something else in its place.
pub(super) fn set(value: &mut Value, name: &str, member: Value) {
    if let Some(members) = value.as_object_mut() {
        members.insert(name.to_owned(), member);
    }
}

/// A document with one buffer, being changed.
pub(super) struct Patch {
    pub(super) document: Value,
    pub(super) buffer: Vec<u8>,
}

impl Patch {
    /// The list of this name; nothing where there is none.
    pub(super) fn list(&mut self, name: &str) -> &mut [Value] {
        self.document.get_mut(name).and_then(Value::as_array_mut).map_or(&mut [], Vec::as_mut_slice)
    }

    /// Adds an entry to a list and returns its number.
    pub(super) fn add(&mut self, name: &str, entry: Value) -> usize {
        if !self.document[name].is_array() {
            set(&mut self.document, name, json!([]));
        }
        let Some(list) = self.document.get_mut(name).and_then(Value::as_array_mut) else { return 0 };
        list.push(entry);
        list.len() - 1
    }

    /// Adds a view of bytes that follow.
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.buffer.extend_from_slice(bytes);
        self.add("bufferViews", view)
    }

    /// Adds an image that lies within the file.
    pub(super) fn image(&mut self, image: &TextureImage) -> usize {
        let view = self.view(&image.bytes, None);
        self.add("images", json!({ "bufferView": view, "mimeType": image.media_type(), "name": image.name }))
    }

    /// Adds the triangles of an object and returns its primitives. `material` gives the number of a piece's material and of its set of
    /// coordinates.
    pub(super) fn primitives(
        &mut self,
        content: &Content<'_>,
        material: impl Fn(&Piece) -> (Option<usize>, u32),
    ) -> io::Result<Vec<Value>> {
        let mut bytes = Vec::with_capacity(content.geometry_bytes());
        content.write_geometry(&mut bytes)?;
        let mesh = &content.mesh;
        let (vertices, mut at) = (mesh.positions.len(), 0);
        let mut take = |size: usize| (at, at += size).0..at;
        let single = mesh.positions.iter().map(|p| p.as_vec3().as_dvec3());
        let (min, max) = Bounds::of(single).map_or_else(Default::default, |b| (b.min.to_array(), b.max.to_array()));
        let (array, elements) = (gltf::json::buffer::ARRAY_BUFFER, gltf::json::buffer::ELEMENT_ARRAY_BUFFER);
        let view = self.view(&bytes[take(12 * vertices)], Some(array));
        let positions = self.add("accessors", json!({
            "bufferView": view, "componentType": FLOAT, "count": vertices, "type": "VEC3", "min": min, "max": max
        }));
        let view = self.view(&bytes[take(12 * mesh.triangles.len())], Some(elements));
        let indices: Vec<usize> =
            content.pieces.iter().map(|piece| self.add("accessors", index_accessor(view, piece))).collect();
        let colours = content.colours.as_ref().map(|_| {
            let view = self.view(&bytes[take(8 * vertices)], Some(array));
            self.add("accessors", json!({
                "bufferView": view, "componentType": UNSIGNED_SHORT, "normalized": true, "count": vertices, "type": "VEC4"
            }))
        });
        let coordinates = content.coordinates.as_ref().map(|_| {
            let view = self.view(&bytes[take(8 * vertices)], Some(array));
            self.add("accessors", json!({ "bufferView": view, "componentType": FLOAT, "count": vertices, "type": "VEC2" }))
        });
        let primitive = |(piece, indices): (&Piece, usize)| {
            let (material, set) = material(piece);
            let mut primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
            if let Some(colours) = colours {
                primitive["attributes"]["COLOR_0"] = json!(colours);
            }
            if let Some(coordinates) = coordinates.filter(|_| piece.textured) {
                primitive["attributes"][format!("TEXCOORD_{set}")] = json!(coordinates);
            }
            if let Some(material) = material {
                primitive["material"] = json!(material);
            }
            primitive
        };
        Ok(content.pieces.iter().zip(indices).map(primitive).collect())
    }
}

/// Writes the file of a scene with the objects that were replaced.
pub(in crate::io) fn write_patched(scene: &Scene, format: Format, out: &mut dyn Write) -> Result<(), WriteError> {
    let path = scene.path.as_deref();
    let opened = Opened::new(&scene.bytes, scene.format, path).map_err(io::Error::other)?;
    let document: Value = serde_json::from_slice(opened.text).map_err(io::Error::from)?;
    if !document.is_object() {
        return Err(io::Error::other("the document is no JSON object").into());
    }
    let mut patch = Patch { document, buffer: Vec::new() };
    patch.take_in(&opened);
    patch.take_in_images(path);
    let is_known = |primitive: &Value| is_surface(mode(primitive), primitive["attributes"]["POSITION"].is_u64());
    for object in scene.objects.iter().filter(|object| object.is_replaced) {
        let Origin::Mesh(number) = object.origin else { continue };
        let content = Content::new(&object.mesh, &object.paint(), format)?;
        let mut primitives = patch.primitives(&content, |piece| numbered(scene, object, piece))?;
        let Some(mesh) = patch.list("meshes").get_mut(number) else { continue };
        let old = mesh.get_mut("primitives").and_then(Value::as_array_mut).map(std::mem::take).unwrap_or_default();
        primitives.extend(old.into_iter().filter(|primitive| !is_known(primitive)));
        set(mesh, "primitives", Value::Array(primitives));
    }
    compact::compact(&mut patch);
    pack::write(patch.document, &patch.buffer, format, out)
}

/// What the vertices of a primitive make.
fn mode(primitive: &Value) -> Option<gltf::mesh::Mode> {
    use gltf::mesh::Mode;
    match primitive.get("mode").map_or(Some(4), Value::as_u64)? {
        4 => Some(Mode::Triangles),
        5 => Some(Mode::TriangleStrip),
        6 => Some(Mode::TriangleFan),
        _ => None,
    }
}

/// The number of a piece's material in the document, and of its set of coordinates.
fn numbered(scene: &Scene, object: &SceneObject, piece: &Piece) -> (Option<usize>, u32) {
    let own = object.texture.as_ref().zip(piece.material).and_then(|(texture, n)| texture.materials.get(n as usize));
    match own.and_then(|own| scene.material_called(&own.name)).map(|(_, material)| material.origin) {
        Some(MaterialOrigin::Numbered { number, set }) => (Some(number), set),
        _ => (None, 0),
    }
}

impl Patch {
    /// Makes one buffer of all buffers.
    fn take_in(&mut self, opened: &Opened<'_>) {
        let mut starts = Vec::new();
        for bytes in opened.buffers.all() {
            self.buffer.resize(self.buffer.len().next_multiple_of(8), 0);
            starts.push(self.buffer.len());
            self.buffer.extend_from_slice(bytes);
        }
        for view in self.list("bufferViews") {
            let Some(&start) = view["buffer"].as_u64().and_then(|n| starts.get(n as usize)) else { continue };
            let offset = view["byteOffset"].as_u64().unwrap_or(0);
            set(view, "buffer", json!(0));
            set(view, "byteOffset", json!(offset.saturating_add(start as u64)));
        }
    }

    /// Takes images from beside the document into it; those that are not there keep their addresses.
    fn take_in_images(&mut self, path: Option<&Path>) {
        for number in 0..self.list("images").len() {
            let image = &self.document["images"][number];
            let Some(uri) = image["uri"].as_str().filter(|uri| !uri.starts_with("data:")) else { continue };
            let name = String::from_utf8_lossy(&percent_decoded(uri)).into_owned();
            let file = path.and_then(|base| Some((file_beside(&name, base)?, base)));
            let found = file.and_then(|(file, base)| read_beside(&file, base, LARGEST_IMAGE).ok().flatten());
            let Some(bytes) = found else { continue };
            let image = TextureImage { name, bytes: bytes.into() };
            let Some(kind) = image.media_type() else { continue };
            let view = self.view(&image.bytes, None);
            let Some(members) = self.list("images").get_mut(number).and_then(Value::as_object_mut) else { continue };
            members.remove("uri");
            members.insert("bufferView".into(), json!(view));
            members.insert("mimeType".into(), json!(kind));
        }
    }
}
