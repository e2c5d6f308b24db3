//! From a scene to bytes.

use std::io::Write;
use std::path::Path;

use super::super::colour::Colours;
use super::super::error::{WriteError, WriteProblem};
use super::super::format::Format;
use super::super::loaded::Part;
use super::super::paint::Paint;
use super::super::sound::check;
use super::super::texture::{Material, TextureMap};
use super::super::writing::WriteOptions;
use super::super::{gltf, obj, three_mf};
use super::types::Scene;
use crate::mesh::TriMesh;

/// All objects of a scene as one mesh, as OBJ has them: with their colours and textures, and the triangles of each.
#[derive(Debug, Clone)]
pub struct Flattened {
    /// The triangles of all objects, in order.
    pub mesh: TriMesh,
    /// Their colours.
    pub colours: Option<Colours>,
    /// Their textures and materials.
    pub texture: Option<TextureMap>,
    /// The objects.
    pub parts: Vec<Part>,
}

/// Writes a scene that is suited to the format ([`Scene::suited_to`]) to `out`. A scene of the same kind of file ([`Scene::is_kept_by`]) is
/// written as that file with other triangles in the objects that were replaced; of others there are the objects, their names, places, colours
/// and materials. `beside` names the files that belong beside OBJ.
///
/// # Errors
/// [`WriteError`] where there is nothing to write, where a mesh does not fit the format or what it looks like does not fit the mesh, where the
/// format has no objects, and where the operating system refuses.
pub fn encode_scene(
    scene: &Scene,
    options: &WriteOptions,
    beside: Option<&Path>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let format = options.format;
    if scene.objects.is_empty() {
        return Err(WriteProblem::NoTriangles.into());
    }
    let is_kept = scene.is_kept_by(format);
    for object in scene.objects.iter().filter(|object| object.is_replaced || !is_kept) {
        check(&object.mesh, format)?;
        if object.texture.as_ref().is_some_and(|texture| !texture.fits(&object.mesh)) {
            return Err(WriteProblem::Textures.into());
        }
        if let Some([found, expected]) = object.colours.as_ref().map(|colours| colours.counts(&object.mesh))
            && found != expected
        {
            return Err(WriteProblem::Colours { found, expected }.into());
        }
    }
    match format {
        Format::Glb | Format::Gltf if is_kept => gltf::write_patched(scene, format, out),
        Format::Glb | Format::Gltf => gltf::write_fresh(scene, options.unit, format, out),
        Format::ThreeMf if is_kept => three_mf::write_patched(scene, out),
        Format::ThreeMf => three_mf::write_fresh(scene, options.unit, out),
        Format::Obj => {
            let Flattened { mesh, colours, texture, parts } = flattened(scene);
            let paint = Paint { colours: colours.as_ref(), texture: texture.as_ref(), beside };
            obj::write(&mesh, &paint, &parts, out)
        }
        Format::Stl | Format::Ply | Format::Off => Err(WriteProblem::NoObjects { format }.into()),
    }
}

/// The objects of a scene as one mesh, each in its own coordinates.
pub fn flattened(scene: &Scene) -> Flattened {
    let mut mesh = TriMesh::default();
    let mut parts = Vec::new();
    let mut corners = Vec::new();
    let (mut coordinates, mut material_of) = (Vec::new(), Vec::new());
    let has_colours = scene.objects.iter().any(|object| object.colours.is_some());
    let has_texture = scene.objects.iter().any(|object| object.texture.is_some());
    let mut whole = TextureMap {
        materials: scene.materials.iter().map(|own| Material { ..own.material.clone() }).collect(),
        images: scene.images.clone(),
        ..TextureMap::default()
    };
    for object in &scene.objects {
        let first = mesh.triangles.len();
        mesh.append(&object.mesh);
        parts.push(Part { name: object.name.clone(), triangles: first..mesh.triangles.len() });
        for t in 0..object.mesh.triangles.len() {
            if has_colours {
                let own = object.colours.as_ref().map(|colours| colours.corners(&object.mesh, t));
                corners.push(own.unwrap_or([[255; 4]; 3]));
            }
            material_of.push(scene.material_of(object, t).map(|(number, _)| number as u32));
            coordinates.push(object.texture.as_ref().and_then(|texture| texture.at(t, false)));
        }
        if let Some(texture) = &object.texture {
            for file in &texture.files {
                if !whole.files.contains(file) {
                    whole.files.push(file.clone());
                }
            }
        }
    }
    let colours = has_colours.then(|| Colours::of_corners(corners, &mesh));
    let texture = has_texture.then_some(TextureMap { coordinates, material_of, ..whole });
    Flattened { mesh, colours, texture, parts }
}
