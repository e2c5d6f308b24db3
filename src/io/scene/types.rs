//! The objects of a file, each in its own coordinates, and where they are placed.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DAffine3;

use super::super::colour::{Colours, WHITE};
use super::super::format::Format;
use super::super::loaded::Loaded;
use super::super::paint::Paint;
use super::super::slice::Slicer;
use super::super::texture::{Material, TextureImage, TextureMap};
use super::super::unit::Unit;
use crate::mesh::TriMesh;

/// An object of a scene: a mesh in its own coordinates, and what it looks like. Where it has both, the colour of a material is multiplied by
/// those of triangles, vertices or corners.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneObject {
    /// The name in the file; empty where it has none.
    pub name: String,
    /// The triangles. There is at least one; every coordinate is finite and every index in range.
    pub mesh: TriMesh,
    /// The colours of `mesh`.
    pub colours: Option<Colours>,
    /// The textures and materials of `mesh`. The names of the materials are numbers of [`Scene::materials`].
    pub texture: Option<TextureMap>,
    /// Its number in the scene that was read: [`Scene::suited_to`] may make several objects of one.
    pub number: usize,
    /// What it has in its file that another mesh in its place cannot keep, in a few words each.
    pub loses: Vec<&'static str>,
    /// Whether [`Scene::replace`] has given it another mesh than its file has.
    pub(in crate::io) is_replaced: bool,
    /// Where it stands in its file.
    pub(in crate::io) origin: Origin,
}

impl SceneObject {
    /// The colours and textures in the form that the writers take.
    pub fn paint(&self) -> Paint<'_> {
        Paint { colours: self.colours.as_ref(), texture: self.texture.as_ref(), beside: None }
    }
}

/// Where an object stands in its file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::io) enum Origin {
    /// The mesh of this number in glTF.
    Mesh(usize),
    /// An object of a model file of 3MF, or a piece of it: one of the volumes of a slicer, or, after the last, what is in none.
    Object { model: String, id: u32, piece: Option<usize> },
    /// An object of OBJ, or one that was made from another.
    Group,
}

/// A place of an object.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The number of the object in [`Scene::objects`].
    pub object: usize,
    /// The name of the place: that of a node in glTF, else that of the object.
    pub name: String,
    /// From the coordinates of the object to those of the scene.
    pub transform: DAffine3,
}

impl Placement {
    /// Whether the transform turns the mesh into its mirror image; triangles are turned over then, so that their outer sides stay outside.
    pub fn is_mirrored(&self) -> bool {
        self.transform.matrix3.determinant() < 0.0
    }
}

/// Something in a file that is no object to work on.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Aside {
    /// What it is, in the singular: "support object", "camera".
    pub what: String,
    /// Its name; empty where it has none.
    pub name: String,
}

/// A piece as [`read`](crate::io::read) lists it among the parts of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenePart {
    /// The name of the part.
    pub name: String,
    /// The number of its object in [`Scene::objects`]; `None` where it is no object to work on.
    pub object: Option<usize>,
}

/// A material of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneMaterial {
    /// Its name and colour, and the number of its image in [`Scene::images`].
    pub material: Material,
    pub(in crate::io) origin: MaterialOrigin,
}

/// What a material is in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::io) enum MaterialOrigin {
    /// A material that is described in full by its name, colour and image.
    Plain,
    /// The material of this number in glTF, and the set of texture coordinates of its base colour.
    Numbered { number: usize, set: u32 },
    /// An entry of a group of properties of 3MF.
    Entry { group: u32, entry: u32 },
    /// An image of 3MF.
    Picture(u32),
    /// Colours of 3MF that differ from corner to corner.
    Blend,
}

/// The objects of a file, each once, and where they are placed; see [`read_scene`](crate::io::read_scene).
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The format of the file.
    pub format: Format,
    /// The unit of length that the file states.
    pub unit: Option<Unit>,
    /// The objects that are material, in the order in which they are placed first.
    pub objects: Vec<SceneObject>,
    /// The places of the objects, in the order of the file.
    pub placements: Vec<Placement>,
    /// The parts that [`read`](crate::io::read) lists, in the same order.
    pub parts: Vec<ScenePart>,
    /// What else is in the file: supports, modifiers, negative parts, cameras, lights, lines. A file of the same kind keeps it as it is.
    pub aside: Vec<Aside>,
    /// The materials of all objects.
    pub materials: Vec<SceneMaterial>,
    /// The images of the materials.
    pub images: Vec<TextureImage>,
    /// Sentences about what was left out or read otherwise than it stands.
    pub warnings: Vec<String>,
    /// Sentences about what a file of another kind does not get.
    pub lost_elsewhere: Vec<String>,
    /// The bytes of the file.
    pub(in crate::io) bytes: Arc<[u8]>,
    /// Where the file lies.
    pub(in crate::io) path: Option<PathBuf>,
}

/// An object as a file has it.
pub(in crate::io) struct Source {
    pub(in crate::io) name: String,
    /// Where it stands; `None` for what is no object to work on.
    pub(in crate::io) origin: Option<Origin>,
    /// What it has that another mesh in its place cannot keep.
    pub(in crate::io) loses: Vec<&'static str>,
}

/// What the reader of a format has found: every object once, the parts of `loaded` named by their numbers in `sources`.
pub(in crate::io) struct Unplaced {
    pub(in crate::io) loaded: Loaded,
    pub(in crate::io) sources: Vec<Source>,
    /// Places; the numbers are those of `sources`.
    pub(in crate::io) placements: Vec<Placement>,
    /// The parts as the reader of the whole lists them, where they are not the places.
    pub(in crate::io) parts: Vec<(String, usize)>,
    /// The true name and the origin of each material, by the name that it has in `loaded`.
    pub(in crate::io) materials: BTreeMap<String, (String, MaterialOrigin)>,
    pub(in crate::io) aside: Vec<Aside>,
    pub(in crate::io) lost_elsewhere: Vec<String>,
}

impl Scene {
    /// Puts together what a reader has found. What has no triangles is no object.
    pub(in crate::io) fn of(found: Unplaced, bytes: &[u8], path: Option<PathBuf>) -> Self {
        let Unplaced { mut loaded, sources, placements, parts, mut materials, aside, lost_elsewhere } = found;
        let mut scene = Self {
            format: loaded.format,
            unit: loaded.unit,
            objects: Vec::new(),
            placements: Vec::new(),
            parts: Vec::new(),
            aside,
            materials: Vec::new(),
            images: Vec::new(),
            warnings: std::mem::take(&mut loaded.warnings),
            lost_elsewhere,
            bytes: Arc::from(bytes),
            path,
        };
        if let Some(texture) = &mut loaded.texture {
            for (n, material) in texture.materials.iter_mut().enumerate() {
                let key = std::mem::replace(&mut material.name, n.to_string());
                let (name, origin) = materials.remove(&key).unwrap_or((key, MaterialOrigin::Plain));
                scene.materials.push(SceneMaterial { material: Material { name, ..material.clone() }, origin });
            }
            scene.images = texture.images.clone();
        }
        let mut numbers: Vec<Option<Option<usize>>> = vec![None; sources.len()];
        let mut slicer = Slicer::new(&loaded);
        for part in &loaded.parts {
            let number = part.name.parse::<usize>().ok();
            let Some((number, source)) = number.and_then(|n| Some((n, sources.get(n)?))) else { continue };
            let Some(origin) = source.origin.clone() else {
                numbers[number] = Some(None);
                continue;
            };
            numbers[number] = Some(Some(scene.objects.len()));
            let (mesh, colours, texture) = slicer.slice(part.triangles.clone());
            let (name, loses) = (source.name.clone(), source.loses.clone());
            let number = scene.objects.len();
            scene.objects.push(SceneObject { name, mesh, colours, texture, number, loses, is_replaced: false, origin });
        }
        for (name, source) in &parts {
            let object = numbers.get(*source).copied().flatten().flatten();
            scene.parts.push(ScenePart { name: name.clone(), object });
        }
        for place in placements {
            let Some(object) = numbers.get(place.object).copied().flatten() else { continue };
            if parts.is_empty() {
                scene.parts.push(ScenePart { name: place.name.clone(), object });
            }
            scene.placements.extend(object.map(|object| Placement { object, ..place }));
        }
        scene
    }

    /// Gives an object another mesh. The materials of `texture` must go by the names that they have in the object.
    pub fn replace(&mut self, object: usize, mesh: TriMesh, colours: Option<Colours>, texture: Option<TextureMap>) {
        let Some(place) = self.objects.get_mut(object) else { return };
        (place.mesh, place.colours, place.texture, place.is_replaced) = (mesh, colours, texture, true);
        if self.format == Format::ThreeMf {
            let colours = self.blends_of(&self.objects[object]);
            self.objects[object].colours = colours;
        }
    }

    /// The colours of an object of 3MF where they blend; elsewhere its materials have them.
    fn blends_of(&self, object: &SceneObject) -> Option<Colours> {
        let colours = object.colours.as_ref()?;
        let corners = |t: usize| match self.material_of(object, t).map(|(_, material)| material.origin) {
            Some(MaterialOrigin::Blend) => colours.corners(&object.mesh, t),
            _ => [WHITE; 3],
        };
        let corners = (0..object.mesh.triangles.len()).map(corners).collect();
        Some(Colours::of_corners(corners, &object.mesh)).filter(|colours| !colours.is_white())
    }

    /// How often an object is placed.
    pub fn places_of(&self, object: usize) -> usize {
        self.placements.iter().filter(|place| place.object == object).count()
    }

    /// The material of the scene that goes by the name of a material of an object.
    pub fn material_called(&self, name: &str) -> Option<(usize, &SceneMaterial)> {
        let number: usize = name.parse().ok()?;
        Some((number, self.materials.get(number)?))
    }

    /// The material of a triangle of an object.
    pub(in crate::io) fn material_of(&self, object: &SceneObject, triangle: usize) -> Option<(usize, &SceneMaterial)> {
        self.material_called(&object.texture.as_ref()?.material(triangle)?.name)
    }

    /// Whether a file of `format` is written by changing the file that the scene was read from, so that all else in it stays.
    pub fn is_kept_by(&self, format: Format) -> bool {
        let family = |format: Format| if format == Format::Gltf { Format::Glb } else { format };
        matches!(family(format), Format::Glb | Format::ThreeMf) && family(format) == family(self.format)
    }
}
