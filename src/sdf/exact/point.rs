//! The exact signed distance at any point: the nearest triangle by the box tree, the side by the
//! pseudonormal of the face, edge or vertex that is nearest.

use std::cell::RefCell;

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::{Closest, ClosestTree, Feature, Pseudonormals, TriMesh};
use crate::vote::WindingTree;

/// So many neighbouring points are asked in one go.
const PACKET: usize = 256;
/// Steps towards one crossing: halving alone ends at the spacing of `f64` numbers.
const MOST_STEPS: u32 = 200;

thread_local! {
    /// Room for the finds of a packet.
    static CLOSEST: RefCell<Vec<Closest>> = const { RefCell::new(Vec::new()) };
}

/// Which side of the surface a point is on.
pub enum PointSign {
    /// By the angle-weighted pseudonormal at the nearest point (Bærentzen and Aanæs 2005): exact for
    /// closed, oriented meshes without self-intersections; elsewhere the side as seen from the nearest point.
    Pseudonormal,
    /// Inside above a winding number of ½: for soups. The number errs by up to 0.02, which matters only
    /// near the middle of what closes a hole.
    Winding(WindingTree),
    /// No point is inside: the plain distance from what encloses nothing.
    Unsigned,
}

/// The signed distance to a mesh at any point.
pub struct ExactDistance {
    tree: ClosestTree<[DVec3; 3]>,
    normals: Pseudonormals,
    sign: PointSign,
}

/// What [`ExactDistance`] says of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// The signed distance of the point, model units, negative inside.
    pub signed: f64,
    /// The nearest point of the surface, model units.
    pub point: DVec3,
    /// The triangle it lies on; of several at exactly the same distance the first.
    pub triangle: u32,
    /// Where on the triangle it lies.
    pub feature: Feature,
    /// Gradient of the signed distance, a unit vector that points out; on the surface itself the
    /// pseudonormal, which may be zero where sheets face each other.
    pub gradient: DVec3,
}

impl ExactDistance {
    /// Prepares `mesh`, whose coordinates are finite, for being asked.
    pub fn of(mesh: &TriMesh, sign: PointSign) -> Self {
        let (tree, normals) = rayon::join(|| ClosestTree::of_mesh(mesh), || Pseudonormals::of(mesh));
        Self { tree, normals, sign }
    }

    /// Distance, nearest point and gradient at `p` (model units); `None` for a mesh without triangles.
    pub fn at(&self, p: DVec3) -> Option<Nearest> {
        self.within(p, f64::INFINITY)
    }

    /// What [`Self::at`] says, if the surface is not farther from `p` than `limit`; both in model units.
    pub fn within(&self, p: DVec3, limit: f64) -> Option<Nearest> {
        self.tree.nearest_within(p, limit).map(|closest| self.nearest(p, &closest))
    }

    fn nearest(&self, p: DVec3, closest: &Closest) -> Nearest {
        let signed = match &self.sign {
            PointSign::Pseudonormal => self.normals.signed(p, closest),
            PointSign::Winding(tree) if tree.winding(p) > 0.5 => -closest.distance,
            PointSign::Winding(_) | PointSign::Unsigned => closest.distance,
        };
        let away = (p - closest.point).normalize_or_zero();
        let gradient = match signed {
            s if away == DVec3::ZERO || s == 0.0 => self.normals.at(closest),
            s if s < 0.0 => -away,
            _ => away,
        };
        Nearest { signed, point: closest.point, triangle: closest.id, feature: closest.feature, gradient }
    }

    /// [`Self::at`] for many points, in their order, on all threads. Points that follow each other are
    /// best near each other.
    pub fn at_all(&self, points: &[DVec3]) -> Vec<Option<Nearest>> {
        let packet = |points: &[DVec3]| {
            let mut found = Vec::with_capacity(points.len());
            self.packet(points, &mut found);
            let empty = found.is_empty();
            found.into_iter().map(Some).chain(points.iter().filter(move |_| empty).map(|_| None)).collect::<Vec<_>>()
        };
        points.par_chunks(PACKET).flat_map_iter(packet).collect()
    }

    /// [`Self::at`] for points near each other, in their order, on this thread; nothing for a mesh without triangles.
    /// `found` is emptied first.
    pub fn packet(&self, points: &[DVec3], found: &mut Vec<Nearest>) {
        found.clear();
        CLOSEST.with_borrow_mut(|closest| {
            self.tree.nearest_all(points, closest);
            found.extend(points.iter().zip(closest).map(|(&p, closest)| self.nearest(p, closest)));
        });
    }

    /// Where the signed distance passes `level` (model units) on the way from `from` to `to` (model
    /// units): 0 at `from`, 1 at `to`, to about 1e-14 of the way. `None` where both ends are on the same side
    /// of the level, or the mesh is empty. Of several passages one is found.
    pub fn crossing(&self, from: DVec3, to: DVec3, level: f64) -> Option<f64> {
        let value = |t: f64| self.at(from.lerp(to, t)).map(|nearest| nearest.signed - level);
        let (mut low, mut high) = ((0.0, value(0.0)?), (1.0, value(1.0)?));
        if (low.1 < 0.0) == (high.1 < 0.0) {
            return None;
        }
        // Regula falsi with the Illinois rule: the end that stays counts half, so that both ends move.
        for _ in 0..MOST_STEPS {
            let t = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
            if !(t > low.0 && t < high.0) || high.0 - low.0 < 1e-15 {
                return Some(t.clamp(low.0, high.0));
            }
            let at = value(t)?;
            if at == 0.0 {
                return Some(t);
            }
            if (at < 0.0) == (low.1 < 0.0) {
                (low, high.1) = ((t, at), high.1 / 2.0);
            } else {
                (high, low.1) = ((t, at), low.1 / 2.0);
            }
        }
        Some((low.0 + high.0) / 2.0)
    }
}
