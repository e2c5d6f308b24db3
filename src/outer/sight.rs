//! From which sides a ball touches triangles.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::{Reach, Sight};
use crate::mesh::{ClosestTree, Plane, TriMesh};
use crate::progress::{Progress, Stopped};

/// A ball touches a point where it goes into the surface elsewhere by at most this part of its radius. A larger part would let it look through pinholes at what is close behind; with
/// a smaller one it would not touch what is round inwards, between edges of a few degrees.
const TOUCHING: f64 = 0.05;

/// The voxels around the centre are looked at so far above it, voxels: on a flat surface those on the far side are free then, however the lattice lies.
const ABOVE: f64 = 0.5;

/// A surface that is nearer to a point on the way to it than this part of what is left of the way lies in between.
const BETWEEN: f64 = 1.0 / 16.0;

/// What is left of the way when it has arrived, as a part of the radius.
const ARRIVED: f64 = 1e-6;

/// Triangles that are lower than this part of their longest side have no sides to speak of: their corners are rounded.
const SLIVER: f64 = 1e-7;

/// Places along the side of a triangle, at most.
const MOST_PLACES: usize = 16;

/// Where a ball is that touches a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sights {
    /// On the side of the normal.
    pub front: Sight,
    /// On the other side.
    pub back: Sight,
}

/// For each triangle where the ball is that touches it. Of several places of a triangle the most open one counts.
///
/// # Errors
/// Only a stop.
pub fn sights(mesh: &TriMesh, reach: &Reach, progress: &Progress) -> Result<Vec<Sights>, Stopped> {
    let scene = Scene { tree: ClosestTree::of_mesh(mesh), reach };
    let of = |t: usize| {
        if t.is_multiple_of(256) {
            progress.check()?;
        }
        let corners = mesh.corners(t);
        if is_sliver(corners) {
            return Ok(Sights { front: Sight::Nowhere, back: Sight::Nowhere });
        }
        let normal = Plane::through(corners).normal;
        let places = places(corners, reach.radius);
        let best = |way: DVec3| {
            let mut best = Sight::Nowhere;
            for &p in &places {
                best = best.max(scene.sight(p, way));
                if best == Sight::Outside {
                    break;
                }
            }
            best
        };
        Ok(Sights { front: best(normal), back: best(-normal) })
    };
    (0..mesh.triangles.len()).into_par_iter().map(of).collect()
}

struct Scene<'a> {
    tree: ClosestTree<[DVec3; 3]>,
    reach: &'a Reach,
}

impl Scene<'_> {
    /// Where a ball is that touches a surface at `p` and lies on the side `way` (a unit vector) of it.
    fn sight(&self, p: DVec3, way: DVec3) -> Sight {
        let radius = self.reach.radius;
        let lattice = &self.reach.lattice;
        let low = (lattice.to_lattice(p + way * radius) + way * ABOVE).floor().as_ivec3();
        let near = (0..8).map(|n| self.reach.at(low + IVec3::new(n & 1, n >> 1 & 1, n >> 2)));
        let most = near.fold(Sight::Nowhere, Sight::max);
        if most > Sight::Nowhere && self.has_room(p, way) { most } else { Sight::Nowhere }
    }

    /// Whether the ball touches nothing else, and nothing lies between its centre and where it touches.
    fn has_room(&self, p: DVec3, way: DVec3) -> bool {
        let radius = self.reach.radius;
        let mut left = radius;
        let mut least = (1.0 - TOUCHING) * radius;
        while left > ARRIVED * radius {
            let limit = left * (1.0 - 1e-9);
            let Some(nearest) = self.tree.nearest_within(p + way * left, limit) else { return true };
            if nearest.distance < least {
                return false;
            }
            left -= nearest.distance;
            least = BETWEEN * left;
        }
        true
    }
}

fn is_sliver([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() <= SLIVER * longest
}

/// Points within a triangle, about `spacing` apart.
fn places([a, b, c]: [DVec3; 3], spacing: f64) -> Vec<DVec3> {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let count = ((longest / spacing).ceil() as usize).clamp(1, MOST_PLACES);
    let at = |i: usize, j: usize, off: f64| {
        let [u, v] = [i, j].map(|k| (k as f64 + off) / count as f64);
        a + (b - a) * u + (c - a) * v
    };
    let upright = (0..count).flat_map(|i| (0..count - i).map(move |j| (i, j, 1.0 / 3.0)));
    let turned = (0..count).flat_map(|i| (0..(count - i).saturating_sub(1)).map(move |j| (i, j, 2.0 / 3.0)));
    upright.chain(turned).map(|(i, j, off)| at(i, j, off)).collect()
}
