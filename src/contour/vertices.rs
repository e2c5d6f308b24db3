//! The vertices: one on each lattice edge whose ends differ in sign.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::signs::{Brick, Crossed, Neighbour, Signs};
use super::{ContourOptions, ContourVertex, Crossing, Ground, LatticeEdge};
use crate::lattice::{BRICK, Grid, Lattice, Slot};
use crate::progress::{Progress, Stopped};

/// Bricks per task; a fixed number, so that the order never depends on the threads.
pub(super) const TASK: usize = 64;

/// All vertices, in the order of their owners.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    /// Model units, each coordinate an `f32`.
    pub positions: Vec<DVec3>,
    /// Place on the edge, from its lower voxel, before rounding.
    pub places: Vec<f64>,
    /// Where they come from.
    pub sources: Vec<ContourVertex>,
}

/// The distance at a voxel of a neighbour.
#[inline]
pub(super) fn value(signs: &Signs, distance: &Grid<f32>, neighbour: Neighbour, index: usize) -> f64 {
    let slot = match neighbour {
        Neighbour::Visited(n) => signs.bricks[n as usize].slot,
        Neighbour::Uniform(true) => Slot::Inside,
        Neighbour::Uniform(false) => Slot::Outside,
    };
    f64::from(match slot {
        Slot::Active(n) => distance.values[n as usize][index],
        Slot::Inside => distance.inside,
        Slot::Outside => distance.outside,
    })
}

/// The neighbour and the index in it of the voxel (x, y, z), each 0 to 8, seen from `brick`.
#[inline]
pub(super) fn locate(brick: &Brick, x: usize, y: usize, z: usize) -> (Neighbour, usize) {
    (brick.around[x >> 3 | y >> 3 << 1 | z >> 3 << 2], (x & 7) | (y & 7) << 3 | (z & 7) << 6)
}

/// Where an edge is crossed, 0 at its lower end, given the distances at both ends.
fn interpolated(low: f64, high: f64) -> f64 {
    // a voxel beyond the lattice is outside whatever its distance says
    let (low, high) = (low.abs(), high.abs());
    low / (low + high)
}

/// `p` rounded to `f32`, strictly between the rounded ends of its edge if any `f32` is.
fn rounded(lattice: &Lattice, edge: LatticeEdge, place: f64) -> DVec3 {
    let axis = edge.axis as usize;
    let mut p = edge.voxel.as_dvec3();
    let coordinate = |n: f64| (lattice.origin[axis] + n * lattice.h) as f32;
    let (low, high) = (coordinate(p[axis]), coordinate(p[axis] + 1.0));
    p[axis] += place;
    let mut p = lattice.to_model(p).as_vec3();
    if low.next_up() < high {
        p[axis] = p[axis].clamp(low.next_up(), high.next_down());
    }
    p.as_dvec3()
}

/// Makes the vertices. `crossed` belongs to the bricks of `signs`.
pub(super) fn vertices(
    lattice: &Lattice,
    distance: &Grid<f32>,
    crossing: &(impl Fn(LatticeEdge) -> Option<Crossing> + Sync),
    options: &ContourOptions,
    (signs, crossed): (&Signs, &[Crossed]),
    progress: &Progress,
) -> Result<Vertices, Stopped> {
    let margin = options.margin.clamp(0.0, 0.5);
    let vertex = |brick: &Brick, k: usize, z: usize, axis: usize| {
        let (x, y) = (k & 7, k >> 3);
        let edge = LatticeEdge { voxel: brick.at * BRICK + IVec3::new(x as i32, y as i32, z as i32), axis: axis as u8 };
        let inside_low = (signs.planes(brick.around[0])[z] >> k) & 1 == 1;
        let hit = crossing(edge);
        let place = hit.map(|c| c.t).filter(|t| t.is_finite()).unwrap_or_else(|| {
            let (neighbour, index) = locate(brick, x, y, z);
            let low = value(signs, distance, neighbour, index);
            let (neighbour, index) =
                locate(brick, x + usize::from(axis == 0), y + usize::from(axis == 1), z + usize::from(axis == 2));
            interpolated(low, value(signs, distance, neighbour, index))
        });
        let place = if place.is_finite() { place.clamp(margin, 1.0 - margin) } else { 0.5 };
        let (low, high) = (edge.voxel, edge.voxel + IVec3::AXES[axis]);
        let (voxel, outside) = if inside_low { (low, high) } else { (high, low) };
        let ground = hit.and_then(|c| c.triangle).map_or(Ground::Unknown, Ground::Triangle);
        (rounded(lattice, edge, place), place, ContourVertex { ground, voxel, outside })
    };
    let parts: Vec<Vertices> = signs
        .bricks
        .par_chunks(TASK)
        .zip(crossed.par_chunks(TASK))
        .map(|(bricks, crossed)| {
            progress.check()?;
            let mut part = Vertices::default();
            for (brick, crossed) in bricks.iter().zip(crossed) {
                for z in 0..8 {
                    let [mx, my, mz] = crossed.masks.map(|m| m[z]);
                    for k in bits(mx | my | mz) {
                        for (axis, _) in [mx, my, mz].iter().enumerate().filter(|(_, m)| (*m >> k) & 1 == 1) {
                            let (position, place, source) = vertex(brick, k, z, axis);
                            part.positions.push(position);
                            part.places.push(place);
                            part.sources.push(source);
                        }
                    }
                }
            }
            Ok(part)
        })
        .collect::<Result<_, Stopped>>()?;
    let mut all = Vertices::default();
    for part in parts {
        all.positions.extend(part.positions);
        all.places.extend(part.places);
        all.sources.extend(part.sources);
    }
    Ok(all)
}

/// The numbers of the set bits.
pub(super) fn bits(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let k = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (k < 64).then_some(k)
    })
}
