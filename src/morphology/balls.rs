//! What balls of one radius reach.

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::offset::MARGIN;
use super::{Gauge, OffsetError, Remain, around};
use crate::lattice::{BRICK_VOXELS, DistanceField, Slot};
use crate::mesh::edges::Union;
use crate::mesh::{Plane, TriMesh};
use crate::progress::Progress;
use crate::sdf::exact::{Band, ExactOptions, Sign, exact};

/// A point is a triangle this long, h.
const POINT: f64 = 1e-3;

/// Centres in the same cube of this side, h, or in two that touch, lie in one space: what parts two spaces is as thick as a
/// ball, and a ball is at least four voxels wide.
const ONE_SPACE: f64 = 1.0;

/// Where the centres of balls that do not enter the solid (that do not leave it, for an opening) can be: the boundary of that
/// region.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Centres {
    /// The surface of that region as far as the lattice shows it, and a very small triangle at each of the points between the
    /// voxels. Together they bound nothing.
    pub mesh: TriMesh,
    /// For each triangle the number of the space that it bounds.
    pub spaces: Vec<u32>,
}

impl Centres {
    /// Puts the closed surface that the lattice shows and the level around what lies between the voxels together; `h` in model
    /// units.
    pub fn new(mut surface: TriMesh, between: &[Remain], h: f64) -> Self {
        for p in between.iter().map(|remain| remain.point) {
            let first = surface.positions.len() as u32;
            surface.positions.extend([DVec3::X, DVec3::Y, DVec3::Z].map(|axis| p + axis * (POINT * h)));
            surface.triangles.push([first, first + 1, first + 2]);
        }
        let spaces = spaces(&surface, ONE_SPACE * h);
        Self { mesh: surface, spaces }
    }
}

/// For each triangle the number of all that hang together, or lie in cubes of `side` (model units) that touch.
fn spaces(mesh: &TriMesh, side: f64) -> Vec<u32> {
    let mut sets = Union::of_triangles(mesh.positions.len(), mesh.triangles.iter().copied());
    join_near(&mut sets, &mesh.positions, side);
    mesh.triangles.iter().map(|t| sets.root(t[0])).collect()
}

/// Joins points that lie in cubes of `side` that touch.
fn join_near(sets: &mut Union, points: &[DVec3], side: f64) {
    let mut first: FxHashMap<IVec3, u32> = FxHashMap::default();
    for (v, &p) in (0..).zip(points) {
        let other = *first.entry((p / side).floor().as_ivec3()).or_insert(v);
        sets.join(v, other);
    }
    for (&cube, &v) in &first {
        for &other in around(cube).filter_map(|cube| first.get(&cube)) {
            sets.join(v, other);
        }
    }
}

/// The number of places in which the points lie. Points in cubes of `side` that touch lie in one place.
pub fn places(remains: &[Remain], side: f64) -> usize {
    let points: Vec<DVec3> = remains.iter().map(|remain| remain.point).collect();
    let mut sets = Union::new(points.len());
    join_near(&mut sets, &points, side);
    (0..points.len() as u32).filter(|&n| sets.root(n) == n).count()
}

/// A closing or opening by balls whose centres are known: its surface is where they reach.
pub struct Balls<'a> {
    pub(super) centres: Gauge<'a>,
    /// Model units; positive outside, for a closing.
    pub(super) radius: f64,
}

impl<'a> Balls<'a> {
    /// Balls of `radius` (model units; negative: inside, for an opening) around `centres`.
    pub fn new(centres: &'a Centres, radius: f64) -> Self {
        Self { centres: Gauge::sheet(&centres.mesh), radius }
    }

    /// The signed distance to the surface that the balls leave, negative inside of it, and its gradient, at a point that is
    /// no centre and not farther than about a radius from the surface; model units.
    pub fn at(&self, p: DVec3, likely: f64) -> (f64, DVec3) {
        let side = self.radius.signum();
        let (far, gradient) = self.centres.at(p, self.radius.abs() + likely);
        (side * (self.radius.abs() - far), -side * gradient)
    }

    /// The plane through the surface's point nearest to `p`, by one step along the gradient; model units.
    pub(super) fn tangent(&self, p: DVec3, h: f64) -> Plane {
        let (value, normal) = self.at(p, h);
        Plane { normal, offset: normal.dot(p) - value }
    }

    /// Where between `ends`, model units, that distance is 0.
    pub(super) fn passage(&self, ends: [DVec3; 2]) -> Option<f64> {
        let length = ends[0].distance(ends[1]);
        let values = ends.map(|p| self.centres.at(p, self.radius.abs() + length).0);
        self.centres.passage(ends, values, self.radius.abs())
    }

    /// That distance at the voxels of `own`, the distance to the solid itself; both count in voxels. At centres it is that one, and
    /// nowhere is more than it outside of a closing, or less inside of an opening.
    pub(super) fn field(&self, own: &DistanceField, progress: &Progress) -> Result<DistanceField, OffsetError> {
        let reach = self.radius.abs() / own.lattice.h;
        let options = ExactOptions { band: Band::Within(reach + MARGIN), max_memory: None };
        let far = exact(self.centres.mesh, &own.lattice, Sign::Pseudonormal, &options, progress)?.grid;
        let (reach, side) = (reach as f32, self.radius.signum() as f32);
        let outside = [far.outside.abs(); BRICK_VOXELS];
        let mut field = own.clone();
        field.grid.values.par_iter_mut().zip(own.grid.bricks.active()).for_each(|(values, &brick)| {
            let far = match far.bricks.slot(brick) {
                Slot::Active(n) => &far.values[n as usize],
                Slot::Inside | Slot::Outside => &outside,
            };
            for (value, far) in values.iter_mut().zip(far) {
                let before = side * *value;
                let after = if before >= reach { before } else { before.min(reach - far.abs()) };
                *value = side * after;
            }
        });
        Ok(field)
    }
}
