//! One level of the distance to a solid, as a contour with its tangent planes.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::remains::{Remain, Search};
use super::{Gauge, OffsetError};
use crate::contour::{Contour, ContourOptions, Crossing, Ground, LatticeEdge, contour};
use crate::lattice::{BRICK, Bricks, DistanceField, Lattice, voxel_in_brick};
use crate::mesh::Plane;
use crate::progress::Progress;
use crate::sdf::exact::{Band, ExactOptions, Sign, exact};

/// Voxels of the field beyond the level.
pub(super) const MARGIN: f64 = 2.5;

/// The surface is nearer than the distance in single precision times this.
const LIKELY: f64 = 1.001;

/// A level of the distance to a body.
pub struct Offset {
    /// The surface; its vertices lie on the solid's triangles or on planes.
    pub contour: Contour,
    /// The planes that vertices lie on, tangent to the level, model units, normals outwards.
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
pub fn offset(body: &Gauge<'_>, level: f64, lattice: &Lattice, progress: &Progress) -> Result<Offset, OffsetError> {
    let field = field(body, level, lattice, progress)?;
    let model = |voxel: IVec3| lattice.to_model(voxel.as_dvec3());
    let crossing = |edge: LatticeEdge| {
        let (from, to) = (model(edge.voxel), model(edge.voxel + IVec3::AXES[edge.axis as usize]));
        let value = |voxel: IVec3| field.length(field.grid.get(voxel)) + level;
        let values = [value(edge.voxel), value(edge.voxel + IVec3::AXES[edge.axis as usize])];
        let t = body.passage([from, to], values, level)?;
        Some(Crossing { t, triangle: None })
    };
    let mut contour = contour(&field, &crossing, &ContourOptions::default(), progress)?;
    let planes: Vec<Plane> = contour.mesh.positions.par_iter().map(|&p| tangent(body, level, p, lattice.h)).collect();
    progress.check()?;
    contour.vertices.iter_mut().zip(0..).for_each(|(vertex, n)| vertex.ground = Ground::Plane(n));
    let remains = Search { body, level, side: level.signum(), lattice, field: &field.grid }.remains(progress)?;
    Ok(Offset { contour, planes, remains })
}

/// The plane through the level's point nearest to `p`, by one step along the gradient.
pub(super) fn tangent(body: &Gauge<'_>, level: f64, p: DVec3, h: f64) -> Plane {
    let (value, normal) = body.at(p, level.abs() + h);
    Plane { normal, offset: normal.dot(p) - (value - level) }
}

/// The distance less the level over the lattice, counted in voxels.
fn field(body: &Gauge<'_>, level: f64, lattice: &Lattice, progress: &Progress) -> Result<DistanceField, OffsetError> {
    let level_h = level / lattice.h;
    let reach = level_h.abs() * body.mitre.unwrap_or(1.0);
    let options = ExactOptions { band: Band::Within(reach + MARGIN), max_memory: None };
    let mut field = exact(body.mesh, lattice, Sign::Pseudonormal, &options, progress)?;
    let grid = &mut field.grid;
    if body.sheet {
        grid.values.par_iter_mut().flatten().for_each(|value| *value = value.abs());
        grid.bricks = Arc::new(Bricks::new(grid.bricks.active().iter().copied()));
    }
    let bricks = grid.bricks.clone();
    if body.mitre.is_some() {
        let undecided = |d: f64| d * level > 0.0 && d.abs() >= level_h.abs() && d.abs() <= reach + 1.0;
        grid.values.par_iter_mut().zip(bricks.active()).for_each(|(values, &brick)| {
            for (n, value) in values.iter_mut().enumerate().filter(|(_, value)| undecided(f64::from(**value))) {
                let voxel = BRICK * brick + voxel_in_brick(n);
                *value = (body.at(lattice.to_model(voxel.as_dvec3()), f64::from(value.abs()) * lattice.h * LIKELY).0
                    / lattice.h) as f32;
            }
        });
        progress.check()?;
    }
    field.shift(-level_h as f32);
    Ok(field)
}
