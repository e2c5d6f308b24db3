//! The meshes of a document, each once and in its own coordinates, and the nodes that place them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::{DAffine3, DMat4};
use gltf::mesh::Mode;
use gltf::{Document, Semantic};
use serde::Deserialize;

use super::super::error::FileError;
use super::super::scene::{Aside, MaterialOrigin, Origin, Placement, Source, Unplaced};
use super::scene::{Reader, tops, walk};
use super::texture::Looks;
use super::{Opened, checked, unit};

/// A mesh at a place.
struct Placed {
    mesh: usize,
    name: String,
    transform: DMat4,
}

/// Reads the meshes of an opened document.
pub(super) fn read(mut opened: Opened<'_>, path: Option<&Path>) -> Result<Unplaced, FileError> {
    let (document, buffers) = (&opened.document, &opened.buffers);
    let looks = Looks::numbered(document, buffers, path);
    let mut reader = Reader::new(document, &opened.instancing, buffers, &mut opened.allowance, looks);
    let mut aside = of_nodes(document, opened.text);
    let mut posed = BTreeSet::new();
    let places = places(document, &mut reader, &mut posed)?;
    let mut met = vec![false; document.meshes().len()];
    let mut order: Vec<usize> = Vec::new();
    for place in &places {
        // A number that leads nowhere is told by the reader of the mesh.
        if met.get_mut(place.mesh).is_none_or(|met| !std::mem::replace(met, true)) {
            order.push(place.mesh);
        }
    }
    for &mesh in &order {
        reader.mesh(mesh, &mesh.to_string(), &DMat4::IDENTITY)?;
    }
    let mut soup = reader.finish_apart();
    let mut lost_elsewhere = std::mem::take(&mut soup.warnings);
    lost_elsewhere.extend(opened.looks.take());
    if soup.triangles.is_empty() {
        soup.warnings.clone_from(&lost_elsewhere);
    }
    let loaded = soup.finish(opened.format, Some(unit(document, opened.text)))?;
    posed.extend(document.meshes().map(|mesh| mesh.index()).filter(|&mesh| has_targets(document, mesh)));
    let sources = document.meshes().map(|mesh| {
        let name = mesh.name().unwrap_or_default().to_owned();
        let stays = posed.contains(&mesh.index());
        if stays && met[mesh.index()] {
            let what = "skinned or morphing object".into();
            aside.push(Aside { what, name: name.clone() });
        }
        let origin = (!stays).then_some(Origin::Mesh(mesh.index()));
        Source { name, origin, loses: lost(document, &mesh) }
    });
    let sources: Vec<Source> = sources.collect();
    aside.extend(unused(document, &met));
    let place = |place: Placed| {
        let own = sources.get(place.mesh).map(|source| source.name.clone()).unwrap_or_default();
        let name = if place.name.is_empty() { own } else { place.name };
        Placement { object: place.mesh, name, transform: affine(&place.transform) }
    };
    let placements = places.into_iter().map(place).collect();
    let (materials, parts) = (materials(document), Vec::new());
    Ok(Unplaced { loaded, sources, placements, parts, materials, aside, lost_elsewhere })
}

/// What a matrix does to points that are not infinitely far away.
fn affine(matrix: &DMat4) -> DAffine3 {
    DAffine3::from_mat4(*matrix)
}

/// All places of meshes, in the order of the nodes. `posed` gets the meshes that a skeleton moves.
fn places(
    document: &Document,
    reader: &mut Reader<'_, '_>,
    posed: &mut BTreeSet<usize>,
) -> Result<Vec<Placed>, FileError> {
    let mut places = Vec::new();
    let Some(tops) = tops(document)? else {
        let all =
            (0..document.meshes().len()).map(|mesh| Placed { mesh, name: String::new(), transform: DMat4::IDENTITY });
        return Ok(all.collect());
    };
    walk(document, &tops, |i, node, transform| {
        let Some((mesh, has_skin)) = checked::mesh_of(document, node) else { return Ok(()) };
        if has_skin {
            posed.insert(mesh);
        }
        let name = node.name().unwrap_or_default();
        reader.each_copy(i, transform, |reader, transform| {
            reader.count_place()?;
            places.push(Placed { mesh, name: name.to_owned(), transform: *transform });
            Ok(())
        })
    })?;
    Ok(places)
}

/// What the vertices of a mesh have that new ones cannot get.
fn lost(document: &Document, mesh: &gltf::Mesh<'_>) -> Vec<&'static str> {
    let has = |semantic: Semantic| checked::primitives(document, mesh).any(|primitive| primitive.has(semantic.clone()));
    let kinds = [
        (has(Semantic::Normals), "normals of its vertices"),
        (has(Semantic::TexCoords(1)), "further sets of texture coordinates"),
    ];
    kinds.into_iter().filter(|(there, _)| *there).map(|(_, what)| what).collect()
}

fn has_targets(document: &Document, mesh: usize) -> bool {
    let mesh = checked::mesh(document, mesh).ok();
    mesh.is_some_and(|mesh| checked::primitives(document, &mesh).any(|primitive| primitive.has_morph_targets()))
}

/// The name of each material and its number, by its number in words.
fn materials(document: &Document) -> BTreeMap<String, (String, MaterialOrigin)> {
    let all = document.materials().filter_map(|material| {
        let number = material.index()?;
        let set = checked::base_texture(document, &material).map_or(0, |(_, set)| set);
        let name = material.name().unwrap_or_default().to_owned();
        Some((number.to_string(), (name, MaterialOrigin::Numbered { number, set })))
    });
    all.collect()
}

/// Meshes that are placed nowhere, and what meshes have beside triangles.
fn unused(document: &Document, met: &[bool]) -> Vec<Aside> {
    let mut aside = Vec::new();
    for mesh in document.meshes() {
        let name = mesh.name().unwrap_or_default().to_owned();
        if !met[mesh.index()] {
            aside.push(Aside { what: "unplaced object".into(), name });
            continue;
        }
        let is_other =
            |primitive: &checked::Primitive<'_>| !is_surface(primitive.mode(), primitive.has(Semantic::Positions));
        let others = checked::primitives(document, &mesh).filter(is_other).count();
        if others > 0 {
            aside.push(Aside { what: "line or point set".into(), name });
        }
    }
    aside
}

/// Whether a primitive is of triangles that are somewhere.
pub(super) fn is_surface(mode: Option<Mode>, has_positions: bool) -> bool {
    has_positions && matches!(mode, Some(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan))
}

/// Cameras and lights.
#[derive(Deserialize)]
struct Furnished {
    #[serde(default)]
    nodes: Vec<Furniture>,
}

#[derive(Deserialize)]
struct Furniture {
    name: Option<String>,
    camera: Option<serde_json::Value>,
    extensions: Option<serde_json::Map<String, serde_json::Value>>,
}

fn of_nodes(document: &Document, text: &[u8]) -> Vec<Aside> {
    let mut aside = Vec::new();
    let nodes = serde_json::from_slice::<Furnished>(text).map_or_else(|_| Vec::new(), |found| found.nodes);
    for node in nodes {
        let name = node.name.unwrap_or_default();
        let has_light = node.extensions.is_some_and(|extensions| extensions.contains_key("KHR_lights_punctual"));
        let kinds = [("camera", node.camera.is_some()), ("light", has_light)];
        let found = kinds.into_iter().filter(|(_, there)| *there);
        aside.extend(found.map(|(what, _)| Aside { what: what.into(), name: name.clone() }));
    }
    let animations = document.animations().len();
    aside.extend((0..animations).map(|_| Aside { what: "animation".into(), name: String::new() }));
    aside
}
