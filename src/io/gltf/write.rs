//! Writing: one mesh, one node, positions as floats, indices as 32-bit integers, in one buffer.

use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use serde_json::{Value, json};

use super::super::error::{WriteError, WriteProblem};
use super::{BINARY_CHUNK, JSON_CHUNK, MAGIC};
use crate::io::{Format, Unit};
use crate::mesh::{Bounds, TriMesh};

const FLOAT: u32 = gltf_json::accessor::FLOAT;
const UNSIGNED_INT: u32 = gltf_json::accessor::UNSIGNED_INT;

/// Bytes of the positions, then of the indices.
fn sizes(mesh: &TriMesh) -> [usize; 2] {
    [12 * mesh.positions.len(), 12 * mesh.triangles.len()]
}

fn document(mesh: &TriMesh, unit: Option<Unit>, uri: Option<String>) -> Value {
    let [positions, indices] = sizes(mesh);
    let single = mesh.positions.iter().map(|p| p.as_vec3().as_dvec3());
    let (min, max) = Bounds::of(single).map_or_else(Default::default, |b| (b.min.to_array(), b.max.to_array()));
    let mut asset = json!({ "version": "2.0", "generator": "meshwright" });
    if let Some(unit) = unit {
        asset["extras"] = json!({ "unit": unit.word() });
    }
    let mut buffer = json!({ "byteLength": positions + indices });
    if let Some(uri) = uri {
        buffer["uri"] = Value::String(uri);
    }
    json!({
        "asset": asset,
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": FLOAT, "count": mesh.positions.len(), "type": "VEC3",
              "min": min, "max": max },
            { "bufferView": 1, "componentType": UNSIGNED_INT, "count": 3 * mesh.triangles.len(), "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": positions, "target": gltf_json::buffer::ARRAY_BUFFER },
            { "buffer": 0, "byteOffset": positions, "byteLength": indices,
              "target": gltf_json::buffer::ELEMENT_ARRAY_BUFFER },
        ],
        "buffers": [buffer],
    })
}

fn write_buffer(mesh: &TriMesh, out: &mut dyn Write) -> std::io::Result<()> {
    let mut chunk = Vec::with_capacity(1 << 16);
    for points in mesh.positions.chunks(4096) {
        chunk.clear();
        points.iter().flat_map(|p| p.as_vec3().to_array()).for_each(|x| chunk.extend_from_slice(&x.to_le_bytes()));
        out.write_all(&chunk)?;
    }
    for triangles in mesh.triangles.chunks(4096) {
        chunk.clear();
        triangles.iter().flatten().for_each(|v| chunk.extend_from_slice(&v.to_le_bytes()));
        out.write_all(&chunk)?;
    }
    Ok(())
}

/// Writes a GLB file.
pub(in crate::io) fn write_glb(mesh: &TriMesh, unit: Option<Unit>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut json = document(mesh, unit, None).to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary: usize = sizes(mesh).iter().sum();
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
    Ok(write_buffer(mesh, out)?)
}

/// Writes a glTF file in JSON, with the buffer as a data URI.
pub(in crate::io) fn write_json(mesh: &TriMesh, unit: Option<Unit>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut uri = b"data:application/octet-stream;base64,".to_vec();
    let mut encoder = EncoderWriter::new(&mut uri, &STANDARD);
    write_buffer(mesh, &mut encoder)?;
    encoder.finish()?;
    drop(encoder);
    let uri = String::from_utf8_lossy(&uri).into_owned();
    let document = document(mesh, unit, Some(uri));
    serde_json::to_writer(&mut *out, &document).map_err(std::io::Error::from)?;
    Ok(out.write_all(b"\n")?)
}
