//! `repair --each` on glTF: nodes, materials, cameras, lines, mirrored nodes.

use std::fs;

use base64::Engine;
use glam::DVec3;
use meshwright::mesh::TriMesh;
use serde_json::{Value, json};

use super::each::{assert_solid, open_box, scene, unzipped};
use super::{folder, run_in};

/// A document being made.
struct Made {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Made {
    fn put(&mut self, bytes: &[u8], kind: u32, shape: &str, count: usize) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        let view = self.views.len() - 1;
        let mut accessor = json!({ "bufferView": view, "componentType": kind, "count": count, "type": shape });
        if shape == "VEC3" && kind == 5126 {
            (accessor["min"], accessor["max"]) = (json!([0, 0, 0]), json!([99, 99, 99]));
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn mesh(&mut self, mesh: &TriMesh) -> (usize, usize) {
        let floats = |p: &DVec3| p.as_vec3().to_array();
        let places: Vec<u8> = mesh.positions.iter().flat_map(floats).flat_map(f32::to_le_bytes).collect();
        let indices: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let places = self.put(&places, 5126, "VEC3", mesh.positions.len());
        (places, self.put(&indices, 5125, "SCALAR", 3 * mesh.triangles.len()))
    }

    fn document(self, more: Value) -> Value {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        let mut document = json!({
            "asset": { "version": "2.0", "extras": { "by": "hand" } },
            "bufferViews": self.views,
            "accessors": self.accessors,
            "buffers": [{ "byteLength": self.bytes.len(), "uri": format!("data:;base64,{data}") }],
        });
        more.as_object().expect("members").iter().for_each(|(name, value)| document[name] = value.clone());
        document
    }
}

/// A tree of nodes with two meshes of two instances each, one place mirrored.
fn tree() -> Value {
    let mut made = Made { bytes: Vec::new(), views: Vec::new(), accessors: Vec::new() };
    let (body, body_order) = made.mesh(&open_box(0.0, 10.0));
    let (knob, knob_order) = made.mesh(&open_box(20.0, 24.0));
    let red: Vec<u8> = (0..8).flat_map(|_| [255u8, 0, 0, 255]).collect();
    let colours = made.put(&red, 5121, "VEC4", 8);
    made.accessors[colours]["normalized"] = json!(true);
    let normals = made.put(&[0; 96], 5126, "VEC3", 8);
    let time = made.put(&[0; 8], 5126, "SCALAR", 2);
    let moves = made.put(&[0; 24], 5126, "VEC3", 2);
    made.document(json!({
        "scene": 0,
        "scenes": [{ "name": "all", "nodes": [0, 5] }],
        "nodes": [
            { "name": "root", "translation": [1.5, 2, 3], "children": [1, 2], "extras": { "kept": true } },
            { "name": "left", "mesh": 0, "rotation": [0, 0, 0.7071067690849304, 0.7071067690849304] },
            { "name": "right", "mesh": 0, "scale": [-1, 1, 1], "children": [3] },
            { "mesh": 1, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1] },
            { "name": "again", "mesh": 1 },
            { "name": "eye", "camera": 0, "translation": [0, 0, 100], "children": [4] },
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "animations": [{
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
            "samplers": [{ "input": time, "output": moves }]
        }],
        "materials": [
            { "name": "paint", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 1, 1], "roughnessFactor": 0.3 }, "doubleSided": true },
            { "name": "paint", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 1, 1], "roughnessFactor": 0.9 } },
        ],
        "meshes": [
            { "name": "body", "extras": { "weight": 3 }, "primitives": [
                { "attributes": { "POSITION": body, "NORMAL": normals }, "indices": body_order, "material": 1 }
            ] },
            { "name": "knob", "primitives": [
                { "attributes": { "POSITION": knob, "COLOR_0": colours }, "indices": knob_order, "material": 0 },
                { "attributes": { "POSITION": knob }, "mode": 1 }
            ] },
        ],
    }))
}

#[test]
fn a_document_keeps_all_but_the_triangles_that_are_repaired() {
    let folder = folder();
    let given = tree();
    fs::write(folder.path().join("in.gltf"), given.to_string()).expect("written");
    let said = run_in(&folder, "repair OUT/in.gltf --each -o OUT/out.gltf").exits(0);
    said.says(&["2 objects, placed 4 times", "1 camera (`eye`)", "1 animation", "1 line or point set", "normals"]);
    let found: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out.gltf")).expect("written")).expect("JSON");
    for name in ["asset", "scene", "scenes", "nodes", "cameras", "materials"] {
        assert_eq!(given[name], found[name], "{name}");
    }
    let meshes = &found["meshes"];
    assert_eq!((&meshes[0]["name"], &meshes[0]["extras"]["weight"]), (&json!("body"), &json!(3)));
    assert_eq!(
        (&meshes[0]["primitives"][0]["material"], &meshes[1]["primitives"][0]["material"]),
        (&json!(1), &json!(0))
    );
    assert!(meshes[1]["primitives"][0]["attributes"]["COLOR_0"].is_u64());
    // The lines are still there, and their vertices.
    let lines = &meshes[1]["primitives"][1];
    assert_eq!(lines["mode"], 1);
    let places = &found["accessors"][lines["attributes"]["POSITION"].as_u64().expect("a number") as usize];
    assert_eq!((&places["count"], &places["max"]), (&json!(8), &json!([99, 99, 99])));
    assert_eq!(found["animations"][0]["channels"], given["animations"][0]["channels"]);
    let input = found["animations"][0]["samplers"][0]["input"].as_u64().expect("a number") as usize;
    assert_eq!(found["accessors"][input]["count"], 2);
    // What nothing names any more is gone: the normals and the old triangles.
    let count = |document: &Value, list: &str| document[list].as_array().expect("a list").len();
    assert_eq!((count(&given, "accessors"), count(&found, "accessors")), (8, 3 + 2 + 3));
    let (before, after) = (scene(&folder.path().join("in.gltf")), scene(&folder.path().join("out.gltf")));
    assert_eq!(before.placements, after.placements);
    assert_eq!(
        after.placements.iter().map(|place| place.is_mirrored()).collect::<Vec<_>>(),
        [false, true, true, false]
    );
    assert_solid(&after, 0, 1000.0);
    assert_solid(&after, 1, 64.0);
    // A binary file is the same document.
    run_in(&folder, "repair OUT/in.gltf --each -o OUT/out.glb").exits(0);
    assert_eq!(scene(&folder.path().join("out.glb")).placements, before.placements);
}

#[test]
fn mirrored_instances_become_objects_of_their_own_in_3mf() {
    let folder = folder();
    fs::write(folder.path().join("in.gltf"), tree().to_string()).expect("written");
    run_in(&folder, "repair OUT/in.gltf --each -o OUT/out.3mf").exits(0).says(&[
        "2 mirrored instances written as objects of their own",
        "left out: 1 animation, 1 camera (`eye`), 1 line or point set",
    ]);
    let files = unzipped(&fs::read(folder.path().join("out.3mf")).expect("written"));
    let text = String::from_utf8(files["3D/3dmodel.model"].clone()).expect("UTF-8");
    assert!(text.contains("unit=\"meter\""));
    assert_eq!(text.matches("<object ").count(), 4);
    assert_eq!(text.matches("name=\"body\"").count(), 2);
    for part in ["left", "right", "again"] {
        assert!(text.contains(&format!("partnumber=\"{part}\"")), "{part} is missing");
    }
    assert!(text.contains("<base name=\"paint\""));
    let (before, found) = (scene(&folder.path().join("in.gltf")), scene(&folder.path().join("out.3mf")));
    let mut volumes = [0.0; 2];
    for (place, given) in found.placements.iter().zip(&before.placements) {
        assert!(!place.is_mirrored());
        // The corners are where the mirrored ones were.
        let bounds = |mesh: &TriMesh, place: &meshwright::io::Placement| {
            let at = mesh.positions.iter().map(|p| place.transform.transform_point3(*p));
            meshwright::mesh::Bounds::of(at).expect("a box")
        };
        let (a, b) =
            (bounds(&found.objects[place.object].mesh, place), bounds(&before.objects[given.object].mesh, given));
        assert!((a.min - b.min).length() < 1e-5 && (a.max - b.max).length() < 1e-5, "{a:?} {b:?}");
        volumes[usize::from(given.object == 1)] += 1.0;
    }
    assert_eq!(volumes, [2.0, 2.0]);
    for n in 0..4 {
        assert_solid(&found, n, if found.objects[n].name == "knob" { 64.0 } else { 1000.0 });
    }
}

#[test]
fn what_a_skeleton_moves_is_left_and_odd_documents_do_no_harm() {
    let folder = folder();
    let mut document = tree();
    document["skins"] = json!([{ "joints": [0] }]);
    document["nodes"][3]["skin"] = json!(0);
    fs::write(folder.path().join("skin.gltf"), document.to_string()).expect("written");
    run_in(&folder, "repair OUT/skin.gltf --each -o OUT/skinned.gltf")
        .exits(0)
        .says(&["1 object, placed 2 times", "1 skinned or morphing object (`knob`)"]);
    let found: Value =
        serde_json::from_slice(&fs::read(folder.path().join("skinned.gltf")).expect("written")).expect("JSON");
    assert_eq!(found["meshes"][1]["primitives"].as_array().map(Vec::len), Some(2));
    // `inspect` lists it, and it can be picked by nothing.
    run_in(&folder, "repair OUT/skin.gltf --each --part 3 -o OUT/no.gltf").exits(2).says(&["skeleton"]);
    let mut odd = tree();
    odd["nodes"][3]["children"] = json!([0]);
    fs::write(folder.path().join("odd.gltf"), odd.to_string()).expect("written");
    run_in(&folder, "repair OUT/odd.gltf --each -o OUT/no.gltf").exits(4).says(&["reached twice"]);
    for (list, entry) in [("bufferViews", json!([0, 0, 24])), ("meshes", json!([[]])), ("extensionsUsed", json!(3))] {
        let mut odd = tree();
        match odd[list].as_array_mut() {
            Some(list) => list.push(entry),
            None => odd[list] = entry,
        }
        fs::write(folder.path().join("odd.gltf"), odd.to_string()).expect("written");
        let status = run_in(&folder, "repair OUT/odd.gltf --each -o OUT/odd.glb --force").status;
        assert!([0, 4].contains(&status), "{list}: {status}");
    }
}
