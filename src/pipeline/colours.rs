//! Colours of operands, carried to the result.

use rayon::prelude::*;

use super::{Operand, TriangleSource};
use crate::io::{Colours, Rgba};
use crate::mesh::{ClosestTree, TriMesh};

/// What closes a hole in a mesh with colours.
const CLOSED: Rgba = [200, 200, 200, 255];

/// A number for each triangle, the same for triangles of one colour. Nothing for colours that vary within triangles.
pub(super) fn classes(colours: Option<&Colours>) -> Vec<u32> {
    match colours {
        Some(Colours::Faces(list)) => list.iter().map(|&colour| u32::from_le_bytes(colour)).collect(),
        _ => Vec::new(),
    }
}

/// The colours of a result, from those of the operands; `None` when no operand has any. What closes a
/// hole, and what comes from an operand without colours, is grey. The result has one colour for
/// each triangle where the operands have.
pub fn carry_colours(mesh: &TriMesh, sources: &[TriangleSource], operands: &[Operand<'_>]) -> Option<Colours> {
    if operands.iter().all(|operand| operand.colours.is_none()) {
        return None;
    }
    let of = |operand: u32| operands.get(operand as usize).and_then(|operand| Some((operand.mesh, operand.colours?)));
    let by_face = operands.iter().all(|operand| matches!(operand.colours, None | Some(Colours::Faces(_))));
    let corners = |t: usize| match sources[t] {
        TriangleSource::Lid { .. } | TriangleSource::Closed => [CLOSED; 3],
        TriangleSource::Operand { operand, triangle } => of(operand).map_or([CLOSED; 3], |(own, colours)| {
            let source = own.corners(triangle as usize);
            mesh.corners(t).map(|p| colours.at(own, triangle as usize, weights(source, p)))
        }),
    };
    let all: Vec<[Rgba; 3]> = (0..mesh.triangles.len()).into_par_iter().map(corners).collect();
    Some(if by_face { Colours::Faces(all.iter().map(|c| c[0]).collect()) } else { Colours::Corners(all) })
}

/// The colours of `mesh`, a simpler surface of what `source` has `colours` for. Where these are by triangle, each triangle has
/// that of the one it grew out of (`origins`); else each corner has that of the nearest place.
pub fn carry_to_simpler(mesh: &TriMesh, origins: &[u32], source: &TriMesh, colours: &Colours) -> Colours {
    if matches!(colours, Colours::Faces(_)) {
        return Colours::Faces(origins.iter().map(|&t| colours.corners(source, t as usize)[0]).collect());
    }
    let tree = ClosestTree::of_mesh(source);
    let at = |p: glam::DVec3| {
        let nearest = tree.nearest(p).map_or(0, |closest| closest.id as usize);
        colours.at(source, nearest, weights(source.corners(nearest), p))
    };
    let at_vertices: Vec<Rgba> = mesh.positions.par_iter().map(|&p| at(p)).collect();
    Colours::Vertices(at_vertices)
}

/// Barycentric weights of the point of a triangle's plane under `p`, none negative.
fn weights([a, b, c]: [glam::DVec3; 3], p: glam::DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = |q: glam::DVec3, r: glam::DVec3| (q - p).cross(r - p).dot(normal).max(0.0);
    let parts = [area(b, c), area(c, a), area(a, b)];
    let sum: f64 = parts.iter().sum();
    if sum > 0.0 { parts.map(|part| part / sum) } else { [1.0 / 3.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn weights_are_those_of_the_corners_and_the_middle() {
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(weights(t, DVec3::X), [0.0, 1.0, 0.0]);
        let middle = weights(t, DVec3::new(1.0 / 3.0, 1.0 / 3.0, 5.0));
        assert!(middle.iter().all(|w| (w - 1.0 / 3.0).abs() < 1e-12), "{middle:?}");
        assert_eq!(weights(t, DVec3::new(-1.0, 0.5, 0.0)).iter().sum::<f64>(), 1.0);
        assert_eq!(weights([DVec3::ZERO; 3], DVec3::X), [1.0 / 3.0; 3]);
    }
}
