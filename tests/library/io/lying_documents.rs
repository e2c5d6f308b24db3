//! glTF documents of which a single word or number is wrong, each in its turn: an error or a mesh, and never a panic. The crate that walks
//! the documents panics at most of these where it is asked without care.

use meshwright::io::{Format, read_bytes};
use serde_json::{Value, json};

/// A document that names everything that the reader looks at: scenes, nodes, a skin, instances, primitives of all kinds with colours,
/// coordinates and morph targets, sparse accessors, materials, textures, images.
fn document() -> Value {
    let bytes = 96;
    json!({
        "asset": { "version": "2.0", "generator": "meshwright", "extras": { "unit": "mm" } },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "a", "mesh": 0, "skin": 0, "camera": 0, "children": [1, 2] },
            { "mesh": 0, "rotation": [0, 0, 0, 1], "translation": [1, 2, 3], "scale": [1, 1, 1],
              "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0, "SCALE": 0 } } } },
            { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }],
        "skins": [{ "joints": [0], "skeleton": 0, "inverseBindMatrices": 0 }],
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "KHR_texture_transform"],
        "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        "meshes": [{ "name": "m", "primitives": [
            { "attributes": { "POSITION": 0, "COLOR_0": 3, "TEXCOORD_0": 2 }, "indices": 1, "material": 0, "mode": 4,
              "targets": [{ "POSITION": 4 }] },
            { "attributes": { "POSITION": 4, "TEXCOORD_0": 2 }, "material": 1, "mode": 5 },
            { "attributes": { "POSITION": 0 }, "mode": 6 },
            { "attributes": { "POSITION": 0 }, "mode": 0 }
        ] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "byteOffset": 0 },
            { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" },
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2" },
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "normalized": false },
            { "componentType": 5126, "count": 3, "type": "VEC3", "sparse": { "count": 2,
              "indices": { "bufferView": 1, "componentType": 5121, "byteOffset": 0 },
              "values": { "bufferView": 0, "byteOffset": 0 } } }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36, "byteStride": 12, "target": 34962 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 3, "target": 34963 },
            { "buffer": 0, "byteOffset": 40, "byteLength": 8 }
        ],
        "buffers": [{ "byteLength": bytes, "uri": buffer() }],
        "materials": [
            { "name": "wood", "alphaMode": "BLEND", "normalTexture": { "index": 0 }, "occlusionTexture": { "index": 0 },
              "emissiveTexture": { "index": 0 }, "pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 0.5],
              "baseColorTexture": { "index": 0, "texCoord": 0 }, "metallicRoughnessTexture": { "index": 0 } } },
            { "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 } } }
        ],
        "textures": [{ "source": 0, "sampler": 0 }, { "source": 1 }],
        "samplers": [{ "magFilter": 9728, "minFilter": 9728, "wrapS": 33071, "wrapT": 33071 }],
        "images": [{ "bufferView": 2, "mimeType": "image/png", "name": "i" }, { "uri": "data:image/png;base64,iVBORw0KGgo=" }]
    })
}

/// Three corners of a triangle in floats, the numbers 0, 1, 2, and the beginning of a picture.
fn buffer() -> String {
    use base64::Engine;
    let mut bytes: Vec<u8> =
        [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0]);
    bytes.extend(b"\x89PNG\r\n\x1a\n");
    bytes.resize(96, 0);
    format!("data:;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
}

/// The places of all values in a document.
fn places(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(name, member)| places(member, &format!("{at}/{name}"), found));
        }
        Value::Array(entries) => {
            entries.iter().enumerate().for_each(|(n, entry)| places(entry, &format!("{at}/{n}"), found));
        }
        _ => {}
    }
    found.push(at.to_owned());
}

#[test]
fn no_single_lie_in_a_document_is_a_panic() {
    let whole = document();
    let loaded = read_bytes(whole.to_string().as_bytes(), Some(Format::Gltf), None).expect("the document is sound");
    assert_eq!(loaded.parts.len(), 5);
    assert!(loaded.texture.is_some() && loaded.mesh.triangles.len() == 15, "{}", loaded.mesh.triangles.len());
    let mut found = Vec::new();
    places(&whole, "", &mut found);
    let lies = [
        json!(0),
        json!(1),
        json!(2),
        json!(9),
        json!(-1),
        json!(0.5),
        json!(4294967295u32),
        json!(18446744073709551615u64),
    ];
    let lies = lies.into_iter().chain([
        json!("FLOAT"),
        json!(""),
        json!("data:,"),
        json!(null),
        json!([]),
        json!({}),
        json!([9]),
    ]);
    let lies: Vec<Value> = lies.collect();
    let (mut read, mut refused) = (0, 0);
    for place in &found {
        for lie in &lies {
            let mut document = whole.clone();
            *document.pointer_mut(place).expect("it is there") = lie.clone();
            count(&document, &mut read, &mut refused);
        }
        // Left out altogether.
        if let Some((outer, name)) = place.rsplit_once('/') {
            let mut document = whole.clone();
            match document.pointer_mut(outer) {
                Some(Value::Object(members)) => drop(members.remove(name)),
                Some(Value::Array(entries)) => drop(entries.remove(name.parse().expect("a number"))),
                _ => unreachable!("what holds a value is an object or a list"),
            }
            count(&document, &mut read, &mut refused);
        }
    }
    assert!(read > 500 && refused > 500, "{read} {refused}");
}

fn count(document: &Value, read: &mut usize, refused: &mut usize) {
    match read_bytes(document.to_string().as_bytes(), Some(Format::Gltf), None) {
        Ok(loaded) => {
            super::support::assert_sound(&loaded);
            *read += 1;
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            *refused += 1;
        }
    }
}
