//! A scene as a format can hold it.

use glam::{DAffine3, DVec3};

use super::super::colour::Colours;
use super::super::error::FileProblem;
use super::super::format::Format;
use super::super::soup::{Expansion, LONGEST_NAME};
use super::super::text::counted;
use super::super::texture::TextureMap;
use super::types::{Origin, Placement, Scene, SceneObject};
use crate::mesh::TriMesh;

impl Scene {
    /// The scene as a file of `format` holds it: vertices that are repeated in glTF are one in the others; the triangles of a material follow one another in glTF; what is placed as a mirror image
    /// becomes an object of its own in 3MF, unless the scene is of 3MF itself; and in OBJ, which places nothing, every place is an object of its own.
    /// With sentences on what became of instances.
    ///
    /// # Errors
    /// [`FileProblem::TooLarge`] where the instances that OBJ needs one by one are far more than the size of the file justifies.
    pub fn suited_to(mut self, format: Format) -> Result<(Self, Vec<String>), FileProblem> {
        let is_kept = self.is_kept_by(format);
        let mut notes = Vec::new();
        if !is_kept {
            let objects = self.objects.iter_mut().map(|object| &mut object.name);
            objects.chain(self.placements.iter_mut().map(|place| &mut place.name)).for_each(clean);
        }
        if self.format.repeats_vertices() && !format.repeats_vertices() {
            self.objects.iter_mut().for_each(SceneObject::weld);
        }
        match format {
            Format::ThreeMf if !is_kept => notes.extend(self.part_mirrored()),
            Format::Obj => notes.extend(self.place_all()?),
            Format::Glb | Format::Gltf => {
                let all = self.objects.iter_mut().filter(|object| object.is_replaced || !is_kept);
                all.for_each(SceneObject::sort_by_material);
            }
            _ => {}
        }
        Ok((self, notes))
    }

    /// Makes objects of their own of mirror images.
    fn part_mirrored(&mut self) -> Option<String> {
        let mut copies = vec![None; self.objects.len()];
        let mut count = 0;
        for place in &mut self.placements {
            if !place.is_mirrored() {
                continue;
            }
            count += 1;
            let copy = *copies[place.object].get_or_insert_with(|| {
                let copy = self.objects[place.object].mirrored();
                self.objects.push(copy);
                self.objects.len() - 1
            });
            place.object = copy;
            place.transform *= DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        }
        self.order_by_place();
        (count > 0).then(|| {
            let places = counted(count, "mirrored instance");
            let own = if count == 1 { "an object of its own" } else { "objects of their own" };
            format!("{places} written as {own}: not all programs take a transform of 3MF that mirrors")
        })
    }

    /// Makes an object of every place.
    fn place_all(&mut self) -> Result<Option<String>, FileProblem> {
        let mut allowance = Expansion::for_input(self.bytes.len() as u64);
        let (given, places) = (self.objects.len(), self.placements.len());
        let mut objects = Vec::new();
        let mut placements = Vec::new();
        for place in &self.placements {
            let object = &self.objects[place.object];
            allowance.spend((object.mesh.positions.len() + object.mesh.triangles.len()) as u64)?;
            let mut placed = if place.is_mirrored() { object.mirrored() } else { object.clone() };
            let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
            let transform = if place.is_mirrored() { place.transform * mirror } else { place.transform };
            if transform != DAffine3::IDENTITY {
                placed.mesh.positions.iter_mut().for_each(|p| *p = transform.transform_point3(*p));
            }
            if !place.name.is_empty() {
                placed.name.clone_from(&place.name);
            }
            let transform = DAffine3::IDENTITY;
            placements.push(Placement { object: objects.len(), name: placed.name.clone(), transform });
            objects.push(placed);
        }
        (self.objects, self.placements) = (objects, placements);
        Ok((places > given)
            .then(|| format!("obj has no instances: {} written one by one", counted(places, "instance"))))
    }

    /// Brings the objects into the order in which they are placed first, and forgets those that are placed nowhere.
    fn order_by_place(&mut self) {
        let mut objects: Vec<Option<SceneObject>> = std::mem::take(&mut self.objects).into_iter().map(Some).collect();
        let mut numbers = vec![0; objects.len()];
        for place in &mut self.placements {
            if let Some(object) = objects[place.object].take() {
                numbers[place.object] = self.objects.len();
                self.objects.push(object);
            }
            place.object = numbers[place.object];
        }
    }
}

/// Makes a name one that every format holds.
fn clean(name: &mut String) {
    let plain: String =
        name.chars().map(|c| if c.is_control() || c == '\u{fffe}' || c == '\u{ffff}' { ' ' } else { c }).collect();
    let mut end = plain.len().min(LONGEST_NAME);
    while !plain.is_char_boundary(end) {
        end -= 1;
    }
    *name = plain[..end].trim().to_owned();
}

impl SceneObject {
    /// The mirror image along x, with the outer sides outside.
    fn mirrored(&self) -> Self {
        let turned = |[a, b, c]: [u32; 3]| [a, c, b];
        let mesh = TriMesh {
            positions: self.mesh.positions.iter().map(|p| DVec3::new(-p.x, p.y, p.z)).collect(),
            triangles: self.mesh.triangles.iter().copied().map(turned).collect(),
        };
        let colours = self.colours.clone().map(|colours| match colours {
            Colours::Corners(list) => Colours::Corners(list.into_iter().map(|[a, b, c]| [a, c, b]).collect()),
            other => other,
        });
        let texture = self.texture.clone().map(|texture| {
            let turned = |corners: [[f32; 2]; 3]| [corners[0], corners[2], corners[1]];
            let coordinates = texture.coordinates.iter().map(|corners| corners.map(turned)).collect();
            TextureMap { coordinates, ..texture }
        });
        let (name, is_replaced, loses) = (self.name.clone(), self.is_replaced, self.loses.clone());
        Self { name, mesh, colours, texture, number: self.number, loses, is_replaced, origin: Origin::Group }
    }

    /// Merges vertices at equal positions, which mean the same place where the format repeats them.
    fn weld(&mut self) {
        if let Some(colours @ Colours::Vertices(_)) = &self.colours {
            let corners = (0..self.mesh.triangles.len()).map(|t| colours.corners(&self.mesh, t));
            self.colours = Some(Colours::Corners(corners.collect()));
        }
        self.mesh = self.mesh.welded();
    }

    /// Brings the triangles of each material together.
    fn sort_by_material(&mut self) {
        let Some(texture) = &self.texture else { return };
        let Some(order) = texture.by_material() else { return };
        self.texture = Some(texture.picked(&order));
        self.mesh.triangles = order.iter().map(|&t| self.mesh.triangles[t as usize]).collect();
        self.colours = self.colours.take().map(|colours| match colours {
            Colours::Vertices(_) => colours,
            Colours::Faces(list) => Colours::Faces(order.iter().map(|&t| list[t as usize]).collect()),
            Colours::Corners(list) => Colours::Corners(order.iter().map(|&t| list[t as usize]).collect()),
        });
    }
}
