//! A document that is being changed: lists with more entries, and meshes with other triangles.

use std::io;

use serde_json::{Value, json};

use super::content::{Content, Piece};
use super::write::index_accessor;
use crate::io::TextureImage;
use crate::mesh::Bounds;

const FLOAT: u32 = gltf::json::accessor::FLOAT;
const UNSIGNED_SHORT: u32 = gltf::json::accessor::UNSIGNED_SHORT;

/// As many sets of coordinates stand before one that a material asks for.
const MOST_SETS: u32 = 8;

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
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
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
        let positions = self.add(
            "accessors",
            json!({
                "bufferView": view, "componentType": FLOAT, "count": vertices, "type": "VEC3", "min": min, "max": max
            }),
        );
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
            self.add(
                "accessors",
                json!({ "bufferView": view, "componentType": FLOAT, "count": vertices, "type": "VEC2" }),
            )
        });
        let primitive = |(piece, indices): (&Piece, usize)| {
            let (material, set) = material(piece);
            let mut primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
            if let Some(colours) = colours {
                primitive["attributes"]["COLOR_0"] = json!(colours);
            }
            if let Some(coordinates) = coordinates.filter(|_| piece.textured) {
                // Sets are numbered from 0 without gaps.
                for set in (0..set.min(MOST_SETS)).chain([set]) {
                    primitive["attributes"][format!("TEXCOORD_{set}")] = json!(coordinates);
                }
            }
            if let Some(material) = material {
                primitive["material"] = json!(material);
            }
            primitive
        };
        Ok(content.pieces.iter().zip(indices).map(primitive).collect())
    }
}
