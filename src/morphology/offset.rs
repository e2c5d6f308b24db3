//! One level of the distance to a solid, as a contour with its tangent planes.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::OffsetError;
use super::remains::{Remain, Search};
use crate::contour::{Contour, ContourOptions, Crossing, Edge, NO_TRIANGLE, contour};
use crate::lattice::{BRICK, BRICK_VOXELS, Bricks, Grid, Lattice};
use crate::mesh::around::Around;
use crate::mesh::{Feature, Plane, TriMesh};
use crate::progress::Progress;
use crate::sdf::exact::{Band, ExactDistance, ExactOptions, Nearest, PointSign, Sign, exact};

/// Voxels of the field beyond the level.
pub(super) const MARGIN: f64 = 2.5;

/// A point whose value is nearer to the level than this, h, is at it.
const AT_LEVEL: f64 = 1e-7;

/// Steps towards one point of the level; the second half of them halve what is left.
const MOST_STEPS: usize = 60;

/// The surface is nearer than the distance in single precision times this.
const LIKELY: f64 = 1.001;

/// A solid, or a sheet, that can be asked for its distance, or for the distance that keeps its edges sharp.
pub struct Body<'a> {
    pub(super) mesh: &'a TriMesh,
    distance: ExactDistance,
    around: Around,
    /// How many times the offset a sharp edge may reach, at most; `None`: edges become round.
    mitre: Option<f64>,
    /// Whether it encloses nothing: all its points are outside.
    sheet: bool,
}

impl<'a> Body<'a> {
    /// The solid bounded by `mesh`, a closed, oriented manifold. With `mitre`, edges that an offset would make round stay
    /// sharp as far as this many times the offset from where they were, at least 1.
    pub fn new(mesh: &'a TriMesh, mitre: Option<f64>) -> Self {
        let distance = ExactDistance::of(mesh, PointSign::Pseudonormal);
        Self { mesh, distance, around: Around::new(mesh), mitre: mitre.map(|limit| limit.max(1.0)), sheet: false }
    }

    /// A sheet without an inside, whatever its triangles are; only positive levels have a surface.
    pub fn sheet(mesh: &'a TriMesh) -> Self {
        let distance = ExactDistance::of(mesh, PointSign::Unsigned);
        Self { mesh, distance, around: Around::new(mesh), mitre: None, sheet: true }
    }

    /// The plain distance.
    pub fn distance(&self) -> &ExactDistance {
        &self.distance
    }

    /// The value that is levelled at `p`, model units, and its gradient; infinite for an empty solid. It is found soonest
    /// if the surface is nearer than `likely`, model units.
    pub fn at(&self, p: DVec3, likely: f64) -> (f64, DVec3) {
        match self.distance.within(p, likely).or_else(|| self.distance.at(p)) {
            Some(nearest) => self.mitred(p, &nearest),
            None => (f64::INFINITY, DVec3::ZERO),
        }
    }

    /// Where the value is `level` between `ends` (model units), where it is `values`; `None` where these lie on one side
    /// of the level. Newton's method, held between the points known to lie on either side.
    pub(super) fn passage(&self, ends: [DVec3; 2], values: [f64; 2], level: f64) -> Option<f64> {
        let way = ends[1] - ends[0];
        let mut low = (0.0, values[0] - level);
        let mut high = (1.0, values[1] - level);
        if (low.1 < 0.0) == (high.1 < 0.0) {
            return None;
        }
        let between = |low: (f64, f64), high: (f64, f64)| low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
        let mut t = between(low, high);
        for step in 0..MOST_STEPS {
            let (value, gradient) = self.at(ends[0] + way * t, level.abs() + 2.0 * way.length());
            let off = value - level;
            if off.abs() < AT_LEVEL * way.length() {
                break;
            }
            let end = if (off < 0.0) == (low.1 < 0.0) { &mut low } else { &mut high };
            *end = (t, off);
            let newton = t - off / gradient.dot(way);
            let within = newton > low.0 && newton < high.0;
            t = if within && step < MOST_STEPS / 2 { newton } else { (low.0 + high.0) / 2.0 };
        }
        Some(t)
    }

    /// Over an edge or a corner the farthest of its faces' planes counts, so that they go on until they meet.
    fn mitred(&self, p: DVec3, nearest: &Nearest) -> (f64, DVec3) {
        let plain = (nearest.signed, nearest.gradient);
        let Some(limit) = self.mitre.filter(|_| nearest.feature != Feature::Inside) else { return plain };
        let corners = self.mesh.triangles[nearest.triangle as usize];
        let ends = match nearest.feature {
            Feature::Edge(k) => [corners[usize::from(k)], corners[(usize::from(k) + 1) % 3]],
            Feature::Corner(k) => [corners[usize::from(k)]; 2],
            Feature::Inside => return plain,
        };
        let sign = nearest.signed.signum();
        let faces = self.around.of(ends[0]).iter().filter(|&&t| self.mesh.triangles[t as usize].contains(&ends[1]));
        let planes = faces.map(|&t| Plane::through(self.mesh.corners(t as usize)));
        let farthest = planes
            .map(|plane| (sign * plane.distance(p), plane.normal))
            .filter(|(far, _)| far.is_finite())
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((far, normal)) = farthest else { return plain };
        let least = nearest.signed.abs() / limit;
        if far < least { (sign * least, nearest.gradient) } else { (sign * far, normal) }
    }
}

/// A level of a field.
pub struct Offset {
    /// The surface; each vertex's `triangle` is the number of its plane.
    pub contour: Contour,
    /// The tangent planes, model units, normals outwards.
    pub planes: Vec<Plane>,
    /// The level around what is too thin for any voxel to lie in it: of the outside for a level above 0, of the inside for one
    /// below.
    pub remains: Vec<Remain>,
}

/// The surface where the distance to `body` is `level` (model units, negative inside), on a lattice that must
/// hold it with a voxel to spare. The contour is empty when nothing is as deep.
///
/// # Errors
/// Those of [`exact`], and a stop.
pub fn offset(body: &Body<'_>, level: f64, lattice: &Lattice, progress: &Progress) -> Result<Offset, OffsetError> {
    let field = field(body, level, lattice, progress)?;
    let model = |voxel: IVec3| lattice.to_model(voxel.as_dvec3());
    let crossing = |edge: Edge| {
        let (from, to) = (model(edge.voxel), model(edge.voxel + IVec3::AXES[edge.axis as usize]));
        let value = |voxel: IVec3| f64::from(field.get(voxel)) * lattice.h + level;
        let values = [value(edge.voxel), value(edge.voxel + IVec3::AXES[edge.axis as usize])];
        let t = body.passage([from, to], values, level)?;
        Some(Crossing { t, triangle: NO_TRIANGLE })
    };
    let mut contour = contour(lattice, &field, &crossing, &ContourOptions::default(), progress)?;
    let planes: Vec<Plane> = contour.mesh.positions.par_iter().map(|&p| tangent(body, level, p, lattice.h)).collect();
    progress.check()?;
    contour.vertices.iter_mut().zip(0..).for_each(|(vertex, n)| vertex.triangle = n);
    let remains = Search { body, level, side: level.signum(), lattice, field: &field }.remains(progress)?;
    Ok(Offset { contour, planes, remains })
}

/// The plane through the level's point nearest to `p`, by one step along the gradient.
pub(super) fn tangent(body: &Body<'_>, level: f64, p: DVec3, h: f64) -> Plane {
    let (value, normal) = body.at(p, level.abs() + h);
    Plane { normal, offset: normal.dot(p) - (value - level) }
}

/// The distance less the level, in h, over the lattice.
fn field(body: &Body<'_>, level: f64, lattice: &Lattice, progress: &Progress) -> Result<Grid<f32>, OffsetError> {
    let level_h = level / lattice.h;
    let reach = level_h.abs() * body.mitre.unwrap_or(1.0);
    let options = ExactOptions { band: Band::Within(reach + MARGIN), max_memory: None };
    let mut grid = exact(body.mesh, lattice, Sign::Pseudonormal, &options, progress)?;
    if body.sheet {
        grid.values.par_iter_mut().flatten().for_each(|value| *value = value.abs());
        grid.bricks = Arc::new(Bricks::new(grid.bricks.active().iter().copied()));
    }
    let bricks = grid.bricks.clone();
    if body.mitre.is_some() {
        let undecided = |d: f64| d * level > 0.0 && d.abs() >= level_h.abs() && d.abs() <= reach + 1.0;
        grid.values.par_iter_mut().zip(bricks.active()).for_each(|(values, &brick)| {
            for (n, value) in
                (0i32..).zip(values.iter_mut()).take(BRICK_VOXELS).filter(|(_, v)| undecided(f64::from(**v)))
            {
                let voxel = BRICK * brick + IVec3::new(n & 7, n >> 3 & 7, n >> 6);
                *value = (body.at(lattice.to_model(voxel.as_dvec3()), f64::from(value.abs()) * lattice.h * LIKELY).0
                    / lattice.h) as f32;
            }
        });
        progress.check()?;
    }
    shift(&mut grid, -level_h as f32);
    Ok(grid)
}

/// Adds `by` to all values, so that another level of the field is where it is zero.
pub(super) fn shift(grid: &mut Grid<f32>, by: f32) {
    grid.values.par_iter_mut().flatten().for_each(|value| *value += by);
    (grid.inside, grid.outside) = (grid.inside + by, grid.outside + by);
}
