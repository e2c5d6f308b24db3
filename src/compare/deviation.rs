//! The signed distance of every vertex, and its colour.

use rayon::prelude::*;

use super::distance::percentile;
use super::surface::Frame;
use crate::mesh::{ClosestTree, Pseudonormals, TriMesh};
use crate::progress::{Progress, Stage, Stopped};

/// Points that one thread searches before it looks whether it should stop.
const CHUNK: usize = 1 << 12;

/// Colours of far inside, on the surface, and far outside. Grey in the middle stands out from the paper.
const INSIDE: [f64; 3] = [33.0, 90.0, 200.0];
const ON: [f64; 3] = [206.0, 208.0, 211.0];
const OUTSIDE: [f64; 3] = [200.0, 30.0, 40.0];

/// How far each vertex of one mesh is from another mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviationMap {
    /// Signed distance of each vertex, model units: negative inside the reference.
    pub distances: Vec<f64>,
    /// Distances of this size and more have the full colour, model units: what 99 of 100 vertices do not exceed; if
    /// that is 0, the largest distance.
    pub range: f64,
}

impl DeviationMap {
    /// Red, green and blue of each vertex: blue inside the reference, light grey on it, red outside.
    pub fn colours(&self) -> Vec<[u8; 3]> {
        self.distances.iter().map(|&distance| self.colour(distance)).collect()
    }

    /// Red, green and blue that stand for a distance.
    pub fn colour(&self, distance: f64) -> [u8; 3] {
        colour(distance, self.range)
    }
}

/// Linear from grey at 0 to the full colour at ±`range`.
fn colour(distance: f64, range: f64) -> [u8; 3] {
    let strength = if range > 0.0 { (distance.abs() / range).min(1.0) } else { 0.0 };
    let full = if distance < 0.0 { INSIDE } else { OUTSIDE };
    std::array::from_fn(|k| (ON[k] + (full[k] - ON[k]) * strength).round() as u8)
}

/// The signed distance from the surface of `reference` to each vertex of `mesh`, used or not. The side is that of the
/// nearest triangle of the reference, by angle-weighted pseudonormals: exact where the reference is a closed, oriented
/// mesh without self-intersections, else the side of the surface nearby. `None` when no triangle of the reference has
/// an area.
pub fn deviation_map(
    mesh: &TriMesh,
    reference: &TriMesh,
    progress: &Progress,
) -> Result<Option<DeviationMap>, Stopped> {
    progress.stage(Stage::Map)?;
    let frame = Frame::around(reference, mesh);
    let mut reference = frame.scaled(reference);
    let area = |corners: [glam::DVec3; 3]| (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
    let flat: Vec<bool> = (0..reference.triangles.len()).map(|t| area(reference.corners(t)) <= 0.0).collect();
    let mut flat = flat.into_iter();
    reference.triangles.retain(|_| flat.next() == Some(false));
    if reference.triangles.is_empty() {
        return Ok(None);
    }
    let (tree, normals) = (ClosestTree::of_mesh(&reference), Pseudonormals::of(&reference));
    let distance = |(k, p): (usize, &glam::DVec3)| {
        if k.is_multiple_of(CHUNK) {
            progress.check()?;
        }
        let p = *p * frame.scale;
        let signed = tree.nearest(p).map_or(f64::INFINITY, |closest| normals.signed(p, &closest));
        Ok(if signed.abs() <= frame.rounding { 0.0 } else { signed / frame.scale })
    };
    let distances: Vec<f64> = mesh.positions.par_iter().enumerate().map(distance).collect::<Result<_, Stopped>>()?;
    let mut sizes: Vec<f64> = distances.iter().map(|d| d.abs()).collect();
    sizes.par_sort_unstable_by(f64::total_cmp);
    let p99 = percentile(&sizes, 0.99);
    let range = if p99 > 0.0 { p99 } else { sizes.last().copied().unwrap_or(0.0) };
    Ok(Some(DeviationMap { distances, range }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_go_from_blue_over_grey_to_red() {
        assert_eq!(
            [-9.0, -1.0, 0.0, 1.0, 9.0].map(|d| colour(d, 1.0)),
            [[33, 90, 200], [33, 90, 200], [206, 208, 211], [200, 30, 40], [200, 30, 40]]
        );
        assert_eq!(colour(0.5, 1.0), [203, 119, 126]);
        assert_eq!(colour(0.0, 0.0), [206, 208, 211]);
    }
}
