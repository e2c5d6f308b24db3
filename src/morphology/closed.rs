//! The second step of a closing or opening, and what the two leave as it was.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::offset::MARGIN;
use super::remains::Search;
use super::{Balls, Gauge, Offset, OffsetError, Region};
use crate::contour::{ContourOptions, Crossing, Ground, LatticeEdge, contour};
use crate::lattice::{BRICK, DistanceField, Grid, Lattice, voxel_in_brick};
use crate::mesh::Plane;
use crate::progress::{Progress, Stopped};
use crate::sdf::exact::{Band, ExactOptions, Sign, exact};

/// What a closing may fill, h, and be left out: the first step's surface is a mesh, and where it is round, its chords
/// bring the second step off by h² / 8 r, 0.06 h at r = 2 h.
const CHORD: f64 = 0.06;

/// A ball touches a point from outside when it goes into the solid by no more than this part of its radius, and no more
/// than this, h. At a concave edge of angle θ that is r θ² / 2, four times what closing fills there: in the noise of a scan
/// nearly every triangle has such an edge, and nobody who closes cracks wants them all rounded.
const TOUCHING: (f64, f64) = (0.25, 1.0);

/// How far a ball of `radius` may go into the solid at a point that it touches, model units.
fn touching(radius: f64, h: f64) -> f64 {
    (TOUCHING.0 * radius.abs()).min(TOUCHING.1 * h)
}

/// Where the way there and back ends this near to where it began, model units, nothing has changed.
pub(super) fn unchanged(radius: f64, h: f64) -> f64 {
    CHORD * h + touching(radius, h) / 4.0
}

/// What lies over a point of the surface is looked up this far from it, h.
pub(super) const BESIDE: f64 = 0.6;

/// Most samples along the edge of a triangle.
const MOST_SAMPLES: usize = 64;

/// The closing (for a positive radius of the balls) or opening of `original` that the balls leave. Where that changes nothing, the
/// vertices lie on triangles of `original`, elsewhere on planes. With a `region` nothing changes elsewhere.
///
/// # Errors
/// Those of [`exact`], and a stop.
pub fn closed(
    original: &Gauge<'_>,
    balls: &Balls<'_>,
    lattice: &Lattice,
    region: Option<&Region<'_>>,
    progress: &Progress,
) -> Result<Closed, OffsetError> {
    let h = lattice.h;
    let own = own_distance(original, balls.radius, lattice, progress)?;
    let mut field = balls.field(&own, progress)?;
    let within = (unchanged(balls.radius, h) / h) as f32;
    let holds = |voxel: IVec3| region.is_none_or(|region| region.holds(voxel));
    let changed = restore(&mut field.grid, &own.grid, within, &holds);
    let model = |voxel: IVec3| lattice.to_model(voxel.as_dvec3());
    let crossing = |edge: LatticeEdge| {
        let voxels = [edge.voxel, edge.voxel + IVec3::AXES[edge.axis as usize]];
        let ends = voxels.map(model);
        let at = |t: f64| ends[0].lerp(ends[1], t);
        let free = voxels.into_iter().any(holds);
        let stays = |t: &f64| !free || balls.at(at(*t), h).0.abs() < unchanged(balls.radius, h);
        let before = voxels.map(|voxel| own.length(own.grid.get(voxel)));
        match original.passage(ends, before, 0.0).filter(stays) {
            Some(t) => Some(Crossing { t, triangle: Some(original.distance().at(at(t))?.triangle) }),
            None => Some(Crossing { t: balls.passage(ends)?, triangle: None }),
        }
    };
    let mut contour = contour(&field, &crossing, &ContourOptions::default(), progress)?;
    let made: Vec<usize> =
        (0..contour.vertices.len()).filter(|&v| contour.vertices[v].ground == Ground::Unknown).collect();
    let planes: Vec<Plane> = made.par_iter().map(|&v| balls.tangent(contour.mesh.positions[v], h)).collect();
    progress.check()?;
    for (&v, n) in made.iter().zip(0..) {
        contour.vertices[v].ground = Ground::Plane(n);
    }
    let search = Search { body: original, level: 0.0, side: -balls.radius.signum(), lattice, field: &own.grid };
    let mut remains = search.remains(progress)?;
    remains.retain(|remain| balls.at(remain.point, h).0.abs() < unchanged(balls.radius, h));
    Ok(Closed { offset: Offset { contour, planes, remains }, changed })
}

/// The surface of a closing or opening.
pub struct Closed {
    /// The surface itself; the remains are points of the solid's own surface at walls (gaps, for an opening) that no voxel shows.
    pub offset: Offset,
    /// Whether the result differs from the solid at any voxel.
    pub changed: bool,
}

/// The distance to the solid, counted in voxels, as far as balls around it reach.
pub(super) fn own_distance(
    original: &Gauge<'_>,
    radius: f64,
    lattice: &Lattice,
    progress: &Progress,
) -> Result<DistanceField, OffsetError> {
    let band = Band::Within(radius.abs() / lattice.h + MARGIN);
    Ok(exact(original.mesh, lattice, Sign::Pseudonormal, &ExactOptions { band, max_memory: None }, progress)?)
}

/// Puts the distance before back where it differs by less than `within`, or where `holds` does not; whether a voxel outside of the solid
/// (inside, for an opening) keeps another side.
fn restore(field: &mut Grid<f32>, own: &Grid<f32>, within: f32, holds: &(impl Fn(IVec3) -> bool + Sync)) -> bool {
    let bricks = field.bricks.clone();
    let restored = field.values.par_iter_mut().zip(&own.values).zip(bricks.active()).map(|((values, own), &brick)| {
        let mut changed = false;
        for (n, (value, &before)) in values.iter_mut().zip(own).enumerate() {
            if (*value - before).abs() < within || !holds(BRICK * brick + voxel_in_brick(n)) {
                *value = before;
            }
            changed |= (*value < 0.0) != (before < 0.0);
        }
        changed
    });
    restored.reduce(|| false, |a, b| a | b)
}

/// How many points of a triangle a ball reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reached {
    /// Number of points that were tried.
    pub tried: u32,
    /// Number of these that a ball touches from outside.
    pub touched: u32,
}

/// For each triangle of `body` how many of its points (corners, and others about `h` apart) a ball of `radius` (model units)
/// touches from outside without meeting the solid elsewhere; from inside for a negative radius (Bærentzen §5.2: the
/// offset point has to be at that distance). Points that are not beside the `region` count as touched.
pub fn reached(
    body: &Gauge<'_>,
    radius: f64,
    lattice: &Lattice,
    region: Option<&Region<'_>>,
    progress: &Progress,
) -> Result<Vec<Reached>, Stopped> {
    let h = lattice.h;
    let of = |t: usize| {
        if t.is_multiple_of(1024) {
            progress.check()?;
        }
        let corners = body.mesh.corners(t);
        let normal = Plane::through(corners).normal;
        let touches = |p: &DVec3| {
            if region.is_some_and(|region| !region.is_beside(lattice.to_lattice(*p) + normal * BESIDE)) {
                return true;
            }
            let far =
                body.distance().within(*p + normal * radius, radius.abs()).map_or(radius.abs(), |n| n.signed.abs());
            far >= radius.abs() - touching(radius, h)
        };
        let points = samples(corners, h);
        let touched = points.iter().filter(|p| touches(p)).count() as u32;
        Ok(Reached { tried: points.len() as u32, touched })
    };
    (0..body.mesh.triangles.len()).into_par_iter().map(of).collect()
}

/// Points of a triangle about `spacing` apart, its corners among them.
pub(super) fn samples([a, b, c]: [DVec3; 3], spacing: f64) -> Vec<DVec3> {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let steps = ((longest / spacing).ceil() as usize).clamp(1, MOST_SAMPLES);
    let share = |k: usize| k as f64 / steps as f64;
    (0..=steps)
        .flat_map(|i| (0..=steps - i).map(move |j| (i, j)))
        .map(|(i, j)| a + (b - a) * share(i) + (c - a) * share(j))
        .collect()
}
