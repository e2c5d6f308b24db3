//! Textures of operands, carried to the result.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::kind::same;
use super::{Outcome, TriangleSource, classes};
use crate::io::{Colours, Material, TexCoords, TextureImage, TextureMap};
use crate::mesh::{ClosestTree, TriMesh};

/// A corner may lie so far beyond the triangle that it is projected onto, times the triangle's size; farther ones get the coordinates of the
/// nearest place of the triangle.
const FARTHEST: f64 = 1.0;

/// A number for each triangle, for [`Options::classes`](super::Options::classes): the same for triangles of one colour, one material and one
/// piece of a texture. Nothing where there is nothing to keep apart.
pub fn classes_of(mesh: &TriMesh, colours: Option<&Colours>, texture: Option<&TextureMap>) -> Vec<u32> {
    let of_colours = classes(colours);
    let Some(texture) = texture else { return of_colours };
    let charts = texture.charts(mesh);
    let mut numbers: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    let pairs = charts.iter().enumerate().map(|(t, &chart)| (chart, of_colours.get(t).copied().unwrap_or(0)));
    let all = pairs.map(|pair| {
        let next = numbers.len() as u32;
        *numbers.entry(pair).or_insert(next)
    });
    let all: Vec<u32> = all.collect();
    if all.iter().all(|number| *number == 0) { Vec::new() } else { all }
}

/// The textures of the result, from those of the operands; `None` when no operand has any. A triangle that is an operand's has what that has;
/// one that is made anew has the coordinates of its corners projected onto the triangle that it lies on; and one that is made up those
/// of the nearest triangle.
pub fn carry_texture(outcome: &Outcome, operands: &[(&TriMesh, Option<&TextureMap>)]) -> Option<TextureMap> {
    carried_to(&outcome.mesh, &outcome.sources, operands)
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
    carried_to(mesh, &sources, &[(source, Some(texture))])
}

fn carried_to(
    result: &TriMesh,
    sources: &[TriangleSource],
    operands: &[(&TriMesh, Option<&TextureMap>)],
) -> Option<TextureMap> {
    let (mut whole, offsets) = joined(operands)?;
    let nearest = Nearest::of(sources, operands);
    let source = |t: usize| match sources[t] {
        TriangleSource::Operand { operand, triangle } => Some((operand, triangle)),
        TriangleSource::Closed => nearest.as_ref()?.to(result.corners(t)),
    };
    let carried = |t: usize| {
        let Some((operand, triangle)) = source(t) else { return (None, None) };
        let Some(&(mesh, Some(texture))) = operands.get(operand as usize) else { return (None, None) };
        let own = texture.at(triangle as usize, whole.downward);
        let own = own.map(|own| projected(result.corners(t), mesh.corners(triangle as usize), own));
        let material = texture.material_of.get(triangle as usize).copied().flatten();
        (own, material.and_then(|material| offsets[operand as usize].get(material as usize).copied()))
    };
    let all: Vec<(Option<TexCoords>, Option<u32>)> = (0..result.triangles.len()).into_par_iter().map(carried).collect();
    (whole.coordinates, whole.material_of) = all.into_iter().unzip();
    Some(whole)
}

/// The materials and images of all operands, each once, and for each operand the new numbers of its materials.
fn joined(operands: &[(&TriMesh, Option<&TextureMap>)]) -> Option<(TextureMap, Vec<Vec<u32>>)> {
    let mut textures = operands.iter().filter_map(|(_, texture)| *texture);
    let first = textures.next()?;
    let mut whole = TextureMap { downward: first.downward, ..TextureMap::default() };
    let place = |list: &mut Vec<TextureImage>, image: &TextureImage| {
        list.iter().position(|known| known == image).unwrap_or_else(|| {
            list.push(image.clone());
            list.len() - 1
        })
    };
    let mut numbers: FxHashMap<(String, Option<[u8; 4]>, Option<u32>), u32> = FxHashMap::default();
    let mut offsets = Vec::new();
    for (_, texture) in operands {
        let Some(texture) = texture else {
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
struct Nearest {
    tree: ClosestTree<[DVec3; 3]>,
    /// The operand and the number of each triangle.
    names: Vec<(u32, u32)>,
}

impl Nearest {
    /// `None` where nothing is made up.
    fn of(sources: &[TriangleSource], operands: &[(&TriMesh, Option<&TextureMap>)]) -> Option<Self> {
        sources.contains(&TriangleSource::Closed).then(|| {
            let names: Vec<(u32, u32)> = (0..)
                .zip(operands)
                .flat_map(|(operand, (mesh, _))| (0..mesh.triangles.len() as u32).map(move |t| (operand, t)))
                .collect();
            let corners = names.iter().map(|&(operand, t)| operands[operand as usize].0.corners(t as usize));
            Self { tree: ClosestTree::new(corners.collect()), names }
        })
    }

    /// The triangle nearest to the middle of one.
    fn to(&self, corners: [DVec3; 3]) -> Option<(u32, u32)> {
        let closest = self.tree.nearest(corners.iter().sum::<DVec3>() / 3.0)?;
        self.names.get(closest.id as usize).copied()
    }
}

/// The coordinates at `corners`, by their places on the plane of a triangle that has `own` at its own corners: exactly these where corners are the
/// same.
fn projected(corners: [DVec3; 3], triangle: [DVec3; 3], own: TexCoords) -> TexCoords {
    if let Some(order) = same(corners, triangle) {
        return order.map(|k| own[k]);
    }
    corners.map(|p| {
        if let Some(k) = (0..3).find(|&k| triangle[k] == p) {
            return own[k];
        }
        let weights = weights(triangle, p);
        [0, 1].map(|axis| (0..3).map(|k| weights[k] * f64::from(own[k][axis])).sum::<f64>() as f32)
    })
}

/// Barycentric weights of the point of a triangle's plane under `p`; of the nearest point of the triangle where that is far beyond it.
fn weights([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let part = |q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) / area;
    let parts = [part(b, c), part(c, a), part(a, b)];
    if area > 0.0 && parts.iter().all(|part| (-FARTHEST..=1.0 + FARTHEST).contains(part)) {
        return parts;
    }
    let inside = parts.map(|part| if part.is_finite() { part.max(0.0) } else { 0.0 });
    let sum: f64 = inside.iter().sum();
    if sum > 0.0 { inside.map(|part| part / sum) } else { [1.0 / 3.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: TexCoords = [[0.1, 0.2], [0.7, 0.2], [0.1, 0.9]];

    #[test]
    fn corners_that_are_the_same_have_the_same_coordinates_to_the_last_bit() {
        let triangle = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.7, 0.0, -3.3), DVec3::new(5.0, 1.0, 0.7)];
        assert_eq!(projected(triangle, triangle, OWN), OWN);
        let over = [triangle[0], triangle[2], triangle[1]];
        assert_eq!(projected(over, triangle, OWN), [OWN[0], OWN[2], OWN[1]]);
        let half = [triangle[1], triangle[2], (triangle[0] + triangle[1]) / 2.0];
        let found = projected(half, triangle, OWN);
        assert_eq!(found[..2], [OWN[1], OWN[2]]);
        assert!((found[2][0] - 0.4).abs() < 1e-6 && (found[2][1] - 0.2).abs() < 1e-6, "{found:?}");
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
