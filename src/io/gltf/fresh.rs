//! Writing a scene of another format: a mesh for each object, a node for each place.

use std::io::Write;

use glam::{DAffine3, DMat4};
use serde_json::{Value, json};

use super::super::colour::{Colours, Rgba, linear_from_srgb};
use super::super::error::WriteError;
use super::super::scene::Scene;
use super::changed::{Patch, set};
use super::content::{Content, Piece};
use super::pack;
use crate::io::{Format, Unit};

/// Writes a scene whose coordinates are in `unit`; without one they are written as they are.
pub(in crate::io) fn write_fresh(
    scene: &Scene,
    unit: Option<Unit>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let asset = json!({ "version": "2.0", "generator": "meshwright" });
    let mut patch = Patch { document: json!({ "asset": asset, "scene": 0 }), buffer: Vec::new() };
    let blends: Vec<bool> = scene.objects.iter().map(|object| sees_through(object.colours.as_ref())).collect();
    write_materials(scene, &blends, &mut patch);
    for (object, &blends) in scene.objects.iter().zip(&blends) {
        let content = Content::new(&object.mesh, &object.paint(), format)?;
        let plain = match object.colours.is_some() {
            true => Some(plain_material(&mut patch, blends)),
            false => None,
        };
        let own = |piece: &Piece| {
            let texture = object.texture.as_ref().zip(piece.material);
            let own = texture.and_then(|(texture, n)| texture.materials.get(n as usize));
            own.and_then(|own| scene.material_called(&own.name)).map(|(number, _)| number)
        };
        let primitives = patch.primitives(&content, |piece| (own(piece).or(plain), 0))?;
        let mut mesh = json!({ "primitives": primitives });
        if !object.name.is_empty() {
            set(&mut mesh, "name", json!(object.name));
        }
        patch.add("meshes", mesh);
    }
    write_nodes(scene, unit, &mut patch);
    pack::write(patch.document, &patch.buffer, format, out)
}

fn sees_through(colours: Option<&Colours>) -> bool {
    colours.is_some_and(|colours| !colours.is_opaque())
}

fn mode(blends: bool) -> &'static str {
    if blends { "BLEND" } else { "OPAQUE" }
}

/// The material of what has colours and no material: white without gloss. Made once.
fn plain_material(patch: &mut Patch, blends: bool) -> usize {
    let plain = json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "alphaMode": mode(blends) });
    let known = patch.list("materials").iter().position(|material| *material == plain);
    known.unwrap_or_else(|| patch.add("materials", plain))
}

/// The materials in their order, and the images that the format holds.
fn write_materials(scene: &Scene, blends: &[bool], patch: &mut Patch) {
    let mut textures: Vec<Option<usize>> = vec![None; scene.images.len()];
    let blends = blends.contains(&true);
    for own in &scene.materials {
        let mut pbr = json!({ "metallicFactor": 0 });
        if let Some([red, green, blue, alpha]) = own.material.colour {
            let [red, green, blue] = [red, green, blue].map(linear_from_srgb);
            set(&mut pbr, "baseColorFactor", json!([red, green, blue, f64::from(alpha) / 255.0]));
        }
        let image = own.material.image.map(|image| image as usize);
        if let Some(image) = image.filter(|&n| scene.images.get(n).is_some_and(|image| image.media_type().is_some())) {
            let texture = *textures[image].get_or_insert_with(|| {
                let source = patch.image(&scene.images[image]);
                patch.add("textures", json!({ "source": source }))
            });
            set(&mut pbr, "baseColorTexture", json!({ "index": texture }));
        }
        let see_through = |colour: Rgba| colour[3] < 255;
        let blends = blends || own.material.colour.is_some_and(see_through);
        let mut material = json!({ "pbrMetallicRoughness": pbr, "alphaMode": mode(blends) });
        if !own.material.name.is_empty() {
            set(&mut material, "name", json!(own.material.name));
        }
        patch.add("materials", material);
    }
}

/// A node for each place; where lengths are not in metres they hang on one that scales them.
fn write_nodes(scene: &Scene, unit: Option<Unit>, patch: &mut Patch) {
    let scale = unit.filter(|unit| *unit != Unit::Metre).map(Unit::metres);
    let first = usize::from(scale.is_some());
    let all: Vec<usize> = (first..first + scene.placements.len()).collect();
    if let Some(scale) = scale {
        patch.add("nodes", json!({ "scale": vec![scale; 3], "children": all }));
    }
    for place in &scene.placements {
        let mut node = json!({ "mesh": place.object });
        if place.transform != DAffine3::IDENTITY {
            set(&mut node, "matrix", json!(DMat4::from(place.transform).to_cols_array().to_vec()));
        }
        if !place.name.is_empty() {
            set(&mut node, "name", json!(place.name));
        }
        patch.add("nodes", node);
    }
    let tops: Vec<usize> = if scale.is_some() { vec![0] } else { all };
    let scenes: Value = json!([{ "nodes": tops }]);
    set(&mut patch.document, "scenes", scenes);
}
