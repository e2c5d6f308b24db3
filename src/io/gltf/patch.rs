//! Writing a scene of glTF: the document as it is, with other triangles in the meshes that were replaced.

use std::io::{self, Write};
use std::path::Path;

use serde_json::{Value, json};

use super::super::error::WriteError;
use super::super::scene::{MaterialOrigin, Origin, Scene, SceneObject};
use super::super::texture::{file_beside, read_beside};
use super::apart::is_surface;
use super::buffers::percent_decoded;
use super::changed::{Patch, set};
use super::compact;
use super::content::{Content, Piece};
use super::{Opened, pack};
use crate::io::{Format, TextureImage};

/// Images beside the document are taken into it up to this size.
const LARGEST_IMAGE: u64 = 1 << 30;

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
