//! Textures of operands, carried to the result.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::colours::classes;
use super::kind::same;
use super::{Operand, TriangleSource};
use crate::io::{Colours, Material, Rgba, TexCoords, TextureImage, TextureMap};
use crate::mesh::{ClosestTree, TriMesh};

/// A corner may lie so far beyond the triangle that it is projected onto, times the triangle's size; farther ones get the coordinates of the
/// nearest place of the triangle.
const FARTHEST: f64 = 1.0;

/// Nearer than this, times the triangle's size, a corner counts as on the triangle.
const NEAR: f64 = 0.01;

/// So far towards the middle of its triangle a corner is looked at, to find the triangle that it belongs to of those that meet there.
const INWARDS: f64 = 1e-3;

/// A piece of an image, a material, a colour.
type Class = (Option<u32>, Option<u32>, u32);

/// A number for each triangle: the same for triangles of one colour, one material and one
/// piece of an image; coordinates without an image do not count. Nothing where there is nothing to keep apart.
pub fn classes_of(mesh: &TriMesh, colours: Option<&Colours>, texture: Option<&TextureMap>) -> Vec<u32> {
    let of_colours = classes(colours);
    let Some(texture) = texture else { return of_colours };
    let charts = texture.charts(mesh);
    let mut numbers: FxHashMap<Class, u32> = FxHashMap::default();
    let key = |(t, &chart): (usize, &u32)| {
        let chart = texture.image(t).map(|_| chart);
        (chart, texture.material_of.get(t).copied().flatten(), of_colours.get(t).copied().unwrap_or(0))
    };
    let all = charts.iter().enumerate().map(key).map(|key| {
        let next = numbers.len() as u32;
        *numbers.entry(key).or_insert(next)
    });
    let all: Vec<u32> = all.collect();
    if all.iter().all(|number| *number == 0) { Vec::new() } else { all }
}

impl Operand<'_> {
    /// A number for each triangle, different where colours, materials or pieces of images differ: simplification keeps apart what has
    /// different numbers. Empty where there is nothing to keep apart.
    pub(super) fn classes(&self) -> Vec<u32> {
        match self.texture {
            Some(_) => classes_of(self.mesh, self.colours, self.texture),
            None => classes(self.colours),
        }
    }
}

/// The textures of a result, from those of the operands; `None` when no operand has any. A triangle that is an operand's has what that has;
/// one that is made anew has the coordinates of its corners projected onto the triangle that it lies on, or onto that of the same piece of the texture
/// under the corner; and one that is made up those of the nearest triangle.
pub fn carry_texture(result: &TriMesh, sources: &[TriangleSource], operands: &[Operand<'_>]) -> Option<TextureMap> {
    let (mut whole, offsets) = joined(operands)?;
    let under = Under::of(result, sources, operands);
    let carried = |t: usize| {
        let corners = result.corners(t);
        let (name, lies_there) = match sources[t] {
            TriangleSource::Operand { operand, triangle } => ((operand, triangle), true),
            TriangleSource::Lid { .. } | TriangleSource::Closed => {
                match under.nearest(corners.iter().sum::<DVec3>() / 3.0) {
                    Some(name) => (name, false),
                    None => return (None, None),
                }
            }
        };
        let (operand, triangle) = (name.0 as usize, name.1 as usize);
        let Some(&Operand { mesh, texture: Some(texture), .. }) = operands.get(operand) else { return (None, None) };
        let places = |triangle: usize| texture.at(triangle, whole.downward);
        let own = places(triangle).map(|own| {
            let source = mesh.corners(triangle);
            if let Some(order) = same(corners, source) {
                return order.map(|k| own[k]);
            }
            corners.map(|p| match lies_there && !is_near(source, p) {
                true => {
                    // A triangle that spans many others: those under its corners are nearer.
                    let within = p.lerp(corners.iter().sum::<DVec3>() / 3.0, INWARDS);
                    let found = under.piece(name, within).and_then(|t| Some((mesh.corners(t), places(t)?)));
                    let (source, own) = found.unwrap_or((source, own));
                    at(p, source, own)
                }
                false => at(p, source, own),
            })
        });
        let material = texture.material_of.get(triangle).copied().flatten();
        (own, material.and_then(|material| offsets[operand].get(material as usize).copied()))
    };
    let all: Vec<(Option<TexCoords>, Option<u32>)> = (0..result.triangles.len()).into_par_iter().map(carried).collect();
    (whole.coordinates, whole.material_of) = all.into_iter().unzip();
    Some(whole)
}

/// The textures of `mesh`, a simpler surface of what `source` has `texture` for, by the triangles that its own grew out of.
pub fn carry_texture_to_simpler(
    mesh: &TriMesh,
    origins: &[u32],
    source: &TriMesh,
    texture: &TextureMap,
) -> Option<TextureMap> {
    let sources: Vec<TriangleSource> =
        origins.iter().map(|&triangle| TriangleSource::Operand { operand: 0, triangle }).collect();
    carry_texture(mesh, &sources, &[Operand { mesh: source, colours: None, texture: Some(texture), negative: None }])
}

/// The name, the colour and the image of a material.
type Look = (String, Option<Rgba>, Option<u32>);

/// The materials and images of all operands, each once, and for each operand the new numbers of its materials.
fn joined(operands: &[Operand<'_>]) -> Option<(TextureMap, Vec<Vec<u32>>)> {
    let mut textures = operands.iter().filter_map(|operand| operand.texture);
    let first = textures.next()?;
    let mut whole = TextureMap { downward: first.downward, ..TextureMap::default() };
    let place = |list: &mut Vec<TextureImage>, image: &TextureImage| {
        list.iter().position(|known| known == image).unwrap_or_else(|| {
            list.push(image.clone());
            list.len() - 1
        })
    };
    let mut numbers: FxHashMap<Look, u32> = FxHashMap::default();
    let mut offsets = Vec::new();
    for operand in operands {
        let Some(texture) = operand.texture else {
            offsets.push(Vec::new());
            continue;
        };
        whole.files.extend(texture.files.iter().cloned());
        let images: Vec<u32> = texture.images.iter().map(|image| place(&mut whole.images, image) as u32).collect();
        let of_material = |material: &Material| {
            let image = material.image.and_then(|image| images.get(image as usize).copied());
            let next = numbers.len() as u32;
            let number = *numbers.entry((material.name.clone(), material.colour, image)).or_insert(next);
            if number == next {
                whole.materials.push(Material { image, ..material.clone() });
            }
            number
        };
        offsets.push(texture.materials.iter().map(of_material).collect());
    }
    Some((whole, offsets))
}

/// The operands' triangles, searched by nearness.
struct Under {
    /// All of them; `None` where nothing is made up.
    all: Option<Tree>,
    /// Those of each operand with textures, and their pieces of texture; nothing where all triangles of the result are kept.
    pieces: Vec<Option<(Vec<u32>, Tree)>>,
}

/// Triangles, and the operand and the number of each.
struct Tree {
    tree: ClosestTree<[DVec3; 3]>,
    names: Vec<(u32, u32)>,
}

impl Tree {
    fn of(operands: &[Operand<'_>], which: impl Iterator<Item = usize>) -> Self {
        let names: Vec<(u32, u32)> =
            which.flat_map(|n| (0..operands[n].mesh.triangles.len() as u32).map(move |t| (n as u32, t))).collect();
        let corners = names.iter().map(|&(operand, t)| operands[operand as usize].mesh.corners(t as usize)).collect();
        Self { tree: ClosestTree::new(corners), names }
    }

    fn nearest(&self, p: DVec3) -> Option<(u32, u32)> {
        self.names.get(self.tree.nearest(p)?.id as usize).copied()
    }
}

impl Under {
    fn of(result: &TriMesh, sources: &[TriangleSource], operands: &[Operand<'_>]) -> Self {
        let is_made = |t: usize| match sources[t] {
            TriangleSource::Operand { operand, triangle } => {
                let own = operands.get(operand as usize).map(|own| own.mesh.corners(triangle as usize));
                own.is_some_and(|own| same(result.corners(t), own).is_none())
            }
            TriangleSource::Lid { .. } | TriangleSource::Closed => false,
        };
        let made = (0..sources.len()).into_par_iter().any(is_made);
        let piece = |(n, operand): (usize, &Operand<'_>)| {
            let charts = operand.texture.filter(|_| made)?.charts(operand.mesh);
            Some((charts, Tree::of(operands, std::iter::once(n))))
        };
        let all = sources.iter().any(|source| source.is_made_up());
        Self {
            all: all.then(|| Tree::of(operands, 0..operands.len())),
            pieces: operands.iter().enumerate().map(piece).collect(),
        }
    }

    /// The triangle of all operands that is nearest to a point.
    fn nearest(&self, p: DVec3) -> Option<(u32, u32)> {
        self.all.as_ref()?.nearest(p)
    }

    /// The triangle of an operand nearest to a point, if it is of the same piece of the texture as this one.
    fn piece(&self, (operand, triangle): (u32, u32), p: DVec3) -> Option<usize> {
        let (charts, tree) = self.pieces[operand as usize].as_ref()?;
        let (_, found) = tree.nearest(p)?;
        (charts.get(found as usize)? == charts.get(triangle as usize)?).then_some(found as usize)
    }
}

/// The coordinates at a point, by its place on the plane of a triangle that has `own` at its corners.
fn at(p: DVec3, triangle: [DVec3; 3], own: TexCoords) -> [f32; 2] {
    if let Some(k) = (0..3).find(|&k| triangle[k] == p) {
        return own[k];
    }
    let weights = weights(triangle, p);
    [0, 1].map(|axis| (0..3).map(|k| weights[k] * f64::from(own[k][axis])).sum::<f64>() as f32)
}

/// Whether the point under `p` is not far beyond the triangle.
fn is_near(triangle: [DVec3; 3], p: DVec3) -> bool {
    let parts = parts(triangle, p);
    parts.iter().all(|part| (-NEAR..=1.0 + NEAR).contains(part))
}

/// Barycentric weights of the point of a triangle's plane under `p`; of the nearest point of the triangle where that is far beyond it.
fn weights(triangle: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let parts = parts(triangle, p);
    if parts.iter().all(|part| (-FARTHEST..=1.0 + FARTHEST).contains(part)) {
        return parts;
    }
    let inside = parts.map(|part| if part.is_finite() { part.max(0.0) } else { 0.0 });
    let sum: f64 = inside.iter().sum();
    if sum > 0.0 { inside.map(|part| part / sum) } else { [1.0 / 3.0; 3] }
}

/// Barycentric weights of the point of a triangle's plane under `p`; not finite for a triangle without area.
fn parts([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let part = |q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) / area;
    [part(b, c), part(c, a), part(a, b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: TexCoords = [[0.1, 0.2], [0.7, 0.2], [0.1, 0.9]];

    #[test]
    fn corners_have_the_coordinates_to_the_last_bit_and_places_between_a_mixture() {
        let triangle = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.7, 0.0, -3.3), DVec3::new(5.0, 1.0, 0.7)];
        assert_eq!(triangle.map(|p| at(p, triangle, OWN)), OWN);
        let found = at((triangle[0] + triangle[1]) / 2.0, triangle, OWN);
        assert!((found[0] - 0.4).abs() < 1e-6 && (found[1] - 0.2).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn coordinates_count_where_there_is_an_image() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
        let mesh = TriMesh { positions, triangles: vec![[0, 1, 2], [2, 1, 3]] };
        let material = |image| Material { name: String::new(), colour: None, image };
        let texture = |image| TextureMap {
            coordinates: vec![Some(OWN); 2],
            material_of: vec![Some(0); 2],
            materials: vec![material(image)],
            ..TextureMap::default()
        };
        assert_eq!(classes_of(&mesh, None, Some(&texture(None))), Vec::<u32>::new());
        assert_eq!(classes_of(&mesh, None, Some(&texture(Some(0)))), [0, 1]);
        let colours = Colours::Faces(vec![[0; 4], [1; 4]]);
        assert_eq!(classes_of(&mesh, Some(&colours), Some(&texture(None))), [0, 1]);
    }

    #[test]
    fn places_beside_the_triangle_go_on_evenly_and_not_for_ever() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(weights(triangle, DVec3::new(1.5, 0.0, 9.0)), [-0.5, 1.5, 0.0]);
        let far = weights(triangle, DVec3::new(100.0, 0.0, 0.0));
        assert_eq!(far, [0.0, 1.0, 0.0]);
        assert_eq!(weights([DVec3::ZERO; 3], DVec3::X), [1.0 / 3.0; 3]);
    }
}
