//! Writing: one mesh, one node, positions as floats, colours as 16-bit integers, indices as 32-bit integers, in one buffer.

use std::borrow::Cow;
use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use gltf_json::buffer::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER};
use serde_json::{Value, json};

use super::super::colour::{Colours, Rgba, by_vertex, linear_from_srgb};
use super::super::error::{WriteError, WriteProblem};
use super::{BINARY_CHUNK, JSON_CHUNK, MAGIC};
use crate::io::{Format, Unit};
use crate::mesh::{Bounds, TriMesh};

const FLOAT: u32 = gltf_json::accessor::FLOAT;
const UNSIGNED_INT: u32 = gltf_json::accessor::UNSIGNED_INT;
const UNSIGNED_SHORT: u32 = gltf_json::accessor::UNSIGNED_SHORT;

/// What goes into the file.
struct Content<'a> {
    mesh: Cow<'a, TriMesh>,
    /// One for each vertex.
    colours: Option<Cow<'a, [Rgba]>>,
    unit: Option<Unit>,
}

impl<'a> Content<'a> {
    /// `mesh` with a colour for each vertex, its vertices repeated where colours meet.
    fn new(
        mesh: &'a TriMesh,
        colours: Option<&'a Colours>,
        unit: Option<Unit>,
        format: Format,
    ) -> Result<Self, WriteProblem> {
        let Some(colours) = colours else {
            return Ok(Self { mesh: Cow::Borrowed(mesh), colours: None, unit });
        };
        let (mesh, colours) = by_vertex(mesh, colours).ok_or(WriteProblem::TooLarge { format })?;
        Ok(Self { mesh, colours: Some(colours), unit })
    }

    /// Bytes of the positions, of the indices, of the colours.
    fn sizes(&self) -> [usize; 3] {
        let colours = self.colours.as_ref().map_or(0, |colours| 8 * colours.len());
        [12 * self.mesh.positions.len(), 12 * self.mesh.triangles.len(), colours]
    }

    fn document(&self, uri: Option<String>) -> Value {
        let [positions, indices, colours] = self.sizes();
        let single = self.mesh.positions.iter().map(|p| p.as_vec3().as_dvec3());
        let (min, max) = Bounds::of(single).map_or_else(Default::default, |b| (b.min.to_array(), b.max.to_array()));
        let asset = json!({ "version": "2.0", "generator": "meshwright" });
        // The numbers stay as they are, to the last bit; the node brings them to metres.
        let mut node = json!({ "mesh": 0 });
        if let Some(unit) = self.unit.filter(|unit| *unit != Unit::Metre) {
            node["scale"] = json!(vec![unit.metres(); 3]);
        }
        let mut buffer = json!({ "byteLength": positions + indices + colours });
        if let Some(uri) = uri {
            buffer["uri"] = Value::String(uri);
        }
        let count = self.mesh.positions.len();
        let mut document = json!({
            "asset": asset,
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [node],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max },
                { "bufferView": 1, "componentType": UNSIGNED_INT, "count": 3 * self.mesh.triangles.len(),
                  "type": "SCALAR" },
            ],
            "bufferViews": [
                { "buffer": 0, "byteOffset": 0, "byteLength": positions, "target": ARRAY_BUFFER },
                { "buffer": 0, "byteOffset": positions, "byteLength": indices, "target": ELEMENT_ARRAY_BUFFER },
            ],
            "buffers": [buffer],
        });
        if let Some(colours) = &self.colours {
            add_colours(&mut document, colours, positions + indices);
        }
        document
    }

    fn write_buffer(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let mut chunk = Vec::with_capacity(1 << 16);
        for points in self.mesh.positions.chunks(4096) {
            chunk.clear();
            points.iter().flat_map(|p| p.as_vec3().to_array()).for_each(|x| chunk.extend_from_slice(&x.to_le_bytes()));
            out.write_all(&chunk)?;
        }
        for triangles in self.mesh.triangles.chunks(4096) {
            chunk.clear();
            triangles.iter().flatten().for_each(|v| chunk.extend_from_slice(&v.to_le_bytes()));
            out.write_all(&chunk)?;
        }
        // In 16 bits of linear light every one of the 256 levels has its own number; in 8 bits the dark ones would not.
        let stored: Vec<u16> = (0..=255).map(|level| (linear_from_srgb(level) * 65535.0).round() as u16).collect();
        for colours in self.colours.iter().flat_map(|colours| colours.chunks(4096)) {
            chunk.clear();
            for &[red, green, blue, alpha] in colours {
                let light = [red, green, blue].map(|level| stored[usize::from(level)]);
                light.iter().chain([&(u16::from(alpha) * 257)]).for_each(|x| chunk.extend_from_slice(&x.to_le_bytes()));
            }
            out.write_all(&chunk)?;
        }
        Ok(())
    }
}

/// Adds the colours, which lie at byte `offset`, and a material without gloss that lets alpha count if any is below 255.
fn add_colours(document: &mut Value, colours: &[Rgba], offset: usize) {
    let push =
        |list: &mut Value, entry: Value| list.as_array_mut().into_iter().for_each(|list| list.push(entry.clone()));
    push(
        &mut document["accessors"],
        json!({ "bufferView": 2, "componentType": UNSIGNED_SHORT, "normalized": true, "count": colours.len(),
                "type": "VEC4" }),
    );
    push(
        &mut document["bufferViews"],
        json!({ "buffer": 0, "byteOffset": offset, "byteLength": 8 * colours.len(), "target": ARRAY_BUFFER }),
    );
    let mode = if colours.iter().all(|c| c[3] == 255) { "OPAQUE" } else { "BLEND" };
    document["materials"] = json!([{ "pbrMetallicRoughness": { "metallicFactor": 0 }, "alphaMode": mode }]);
    let primitive = &mut document["meshes"][0]["primitives"][0];
    primitive["attributes"]["COLOR_0"] = json!(2);
    primitive["material"] = json!(0);
}

/// Writes a GLB file.
pub(in crate::io) fn write_glb(
    mesh: &TriMesh,
    colours: Option<&Colours>,
    unit: Option<Unit>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let content = Content::new(mesh, colours, unit, Format::Glb)?;
    let mut json = content.document(None).to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary: usize = content.sizes().iter().sum();
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
    colours: Option<&Colours>,
    unit: Option<Unit>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let content = Content::new(mesh, colours, unit, Format::Gltf)?;
    let mut uri = b"data:application/octet-stream;base64,".to_vec();
    let mut encoder = EncoderWriter::new(&mut uri, &STANDARD);
    content.write_buffer(&mut encoder)?;
    encoder.finish()?;
    drop(encoder);
    let uri = String::from_utf8_lossy(&uri).into_owned();
    serde_json::to_writer(&mut *out, &content.document(Some(uri))).map_err(std::io::Error::from)?;
    Ok(out.write_all(b"\n")?)
}
