//! Writing: one mesh, one node, positions as floats, colours as 16-bit integers, texture coordinates as floats, indices as 32-bit
//! integers, and images, in one buffer.

use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use gltf::json::buffer::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER};
use serde_json::{Value, json};

use super::super::colour::{Rgba, linear_from_srgb};
use super::super::error::{WriteError, WriteProblem};
use super::content::{Content, Piece};
use super::{BINARY_CHUNK, JSON_CHUNK, MAGIC};
use crate::io::{Format, Material, Paint, Unit};
use crate::mesh::{Bounds, TriMesh};

const FLOAT: u32 = gltf::json::accessor::FLOAT;
const UNSIGNED_INT: u32 = gltf::json::accessor::UNSIGNED_INT;
const UNSIGNED_SHORT: u32 = gltf::json::accessor::UNSIGNED_SHORT;

/// The lists of a document that point to one another.
struct Lists {
    accessors: Vec<Value>,
    views: Vec<Value>,
    /// Bytes of the views so far.
    bytes: usize,
}

impl Lists {
    /// Adds a view of the next bytes and returns its number.
    fn view(&mut self, bytes: usize, target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes, "byteLength": bytes });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes += bytes.next_multiple_of(4);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn document(content: &Content<'_>, unit: Option<Unit>, uri: Option<String>) -> Value {
    let mesh = &content.mesh;
    let single = mesh.positions.iter().map(|p| p.as_vec3().as_dvec3());
    let (min, max) = Bounds::of(single).map_or_else(Default::default, |b| (b.min.to_array(), b.max.to_array()));
    let asset = json!({ "version": "2.0", "generator": "meshwright" });
    // The numbers stay as they are, to the last bit; the node brings them to metres.
    let mut node = json!({ "mesh": 0 });
    if let Some(unit) = unit.filter(|unit| *unit != Unit::Metre) {
        node["scale"] = json!(vec![unit.metres(); 3]);
    }
    let count = mesh.positions.len();
    let mut lists = Lists { accessors: Vec::new(), views: Vec::new(), bytes: 0 };
    let view = lists.view(12 * count, Some(ARRAY_BUFFER));
    let positions = lists.accessor(json!({
        "bufferView": view, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max
    }));
    let view = lists.view(12 * mesh.triangles.len(), Some(ELEMENT_ARRAY_BUFFER));
    let indices: Vec<usize> = content.pieces.iter().map(|piece| lists.accessor(index_accessor(view, piece))).collect();
    let colours = content.colours.as_ref().map(|colours| {
        let view = lists.view(8 * colours.len(), Some(ARRAY_BUFFER));
        lists.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED_SHORT, "normalized": true, "count": count, "type": "VEC4"
        }))
    });
    let coordinates = content.coordinates.as_ref().map(|coordinates| {
        let view = lists.view(8 * coordinates.len(), Some(ARRAY_BUFFER));
        lists.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": "VEC2" }))
    });
    let images: Vec<Value> = (content.images.iter())
        .map(|image| {
            let view = lists.view(image.bytes.len(), None);
            json!({ "bufferView": view, "mimeType": image.media_type(), "name": image.name })
        })
        .collect();
    let primitives: Vec<Value> = (content.pieces.iter().zip(indices))
        .map(|(piece, indices)| primitive(content, piece, [Some(positions), colours, coordinates], indices))
        .collect();
    let mut buffer = json!({ "byteLength": lists.bytes });
    if let Some(uri) = uri {
        buffer["uri"] = Value::String(uri);
    }
    let mut document = json!({
        "asset": asset,
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [node],
        "meshes": [{ "primitives": primitives }],
        "accessors": lists.accessors,
        "bufferViews": lists.views,
        "buffers": [buffer],
    });
    let materials = materials(content);
    if !materials.is_empty() {
        document["materials"] = Value::Array(materials);
    }
    if !images.is_empty() {
        let textures: Vec<Value> = (0..images.len()).map(|source| json!({ "source": source })).collect();
        (document["textures"], document["images"]) = (Value::Array(textures), Value::Array(images));
    }
    document
}

/// A piece; the accessors are those of positions, colours and texture coordinates.
fn primitive(content: &Content<'_>, piece: &Piece, accessors: [Option<usize>; 3], indices: usize) -> Value {
    let [positions, colours, coordinates] = accessors;
    let mut primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
    if let Some(colours) = colours {
        primitive["attributes"]["COLOR_0"] = json!(colours);
    }
    if let Some(coordinates) = coordinates.filter(|_| piece.textured) {
        primitive["attributes"]["TEXCOORD_0"] = json!(coordinates);
    }
    if let Some(material) = content.material_of(piece) {
        primitive["material"] = json!(material);
    }
    primitive
}

pub(super) fn index_accessor(view: usize, piece: &Piece) -> Value {
    let mut accessor =
        json!({ "bufferView": view, "componentType": UNSIGNED_INT, "count": 3 * piece.count, "type": "SCALAR" });
    if piece.first > 0 {
        accessor["byteOffset"] = json!(12 * piece.first);
    }
    accessor
}

/// The materials, all without gloss; the last one is for colours alone. Alpha counts where there is one below 255.
fn materials(content: &Content<'_>) -> Vec<Value> {
    let see_through = |colours: &[Rgba]| colours.iter().any(|c| c[3] < 255);
    let blends = content.colours.as_deref().is_some_and(see_through);
    let mode = |blends: bool| if blends { "BLEND" } else { "OPAQUE" };
    let own = content.texture.iter().flat_map(|texture| &texture.materials).map(|material: &Material| {
        let mut pbr = json!({ "metallicFactor": 0 });
        let colour = material.colour.filter(|_| content.has_factors());
        if let Some([red, green, blue, alpha]) = colour {
            let [red, green, blue] = [red, green, blue].map(linear_from_srgb);
            pbr["baseColorFactor"] = json!([red, green, blue, f64::from(alpha) / 255.0]);
        }
        if let Some(image) = content.image_number(material) {
            pbr["baseColorTexture"] = json!({ "index": image });
        }
        let blends = blends || colour.is_some_and(|colour| colour[3] < 255);
        let mut written = json!({ "pbrMetallicRoughness": pbr, "alphaMode": mode(blends) });
        if !material.name.is_empty() {
            written["name"] = json!(material.name);
        }
        written
    });
    let plain = content
        .colours
        .as_ref()
        .map(|_| json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "alphaMode": mode(blends) }));
    own.chain(plain).collect()
}

/// Writes a GLB file.
pub(in crate::io) fn write_glb(
    mesh: &TriMesh,
    paint: &Paint<'_>,
    unit: Option<Unit>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let content = Content::new(mesh, paint, Format::Glb)?;
    let mut json = document(&content, unit, None).to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary = content.bytes();
    let too_large = |_| WriteProblem::TooLarge { format: Format::Glb };
    let total = u32::try_from(12 + 8 + json.len() + 8 + binary).map_err(too_large)?;
    out.write_all(MAGIC)?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    for (length, kind) in [(json.len(), JSON_CHUNK), (binary, BINARY_CHUNK)] {
        out.write_all(&u32::try_from(length).map_err(too_large)?.to_le_bytes())?;
        out.write_all(kind)?;
        if kind == JSON_CHUNK {
            out.write_all(&json)?;
        }
    }
    Ok(content.write_buffer(out)?)
}

/// Writes a glTF file in JSON, with the buffer as a data URI.
pub(in crate::io) fn write_json(
    mesh: &TriMesh,
    paint: &Paint<'_>,
    unit: Option<Unit>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let content = Content::new(mesh, paint, Format::Gltf)?;
    let mut uri = b"data:application/octet-stream;base64,".to_vec();
    let mut encoder = EncoderWriter::new(&mut uri, &STANDARD);
    content.write_buffer(&mut encoder)?;
    encoder.finish()?;
    drop(encoder);
    let uri = String::from_utf8_lossy(&uri).into_owned();
    serde_json::to_writer(&mut *out, &document(&content, unit, Some(uri))).map_err(std::io::Error::from)?;
    Ok(out.write_all(b"\n")?)
}
