//! Distance estimates at the voxels of cells that hold LDI points (Bærentzen §3.3).

use std::sync::Arc;

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use crate::lattice::{BRICK, BRICK_VOXELS, Bricks, Grid, Slot, brick_of, voxel_in_brick};
use crate::ldi::Spans;
use crate::mesh::Plane;
use crate::progress::{Progress, Stopped};

/// One LDI point, relative to its brick.
#[derive(Debug, Clone, Copy)]
struct Point {
    /// Position, voxels from the brick's first voxel.
    at: Vec3,
    /// The triangle, and in the lowest bit whether its normal points into the result.
    triangle: u32,
}

/// The LDI points of the active bricks.
struct Bins {
    starts: Vec<u32>,
    points: Vec<Point>,
}

impl Bins {
    fn of(&self, slot: Slot) -> &[Point] {
        match slot {
            Slot::Active(n) => &self.points[self.starts[n as usize] as usize..self.starts[n as usize + 1] as usize],
            _ => &[],
        }
    }
}

/// The estimate of each voxel, in h; NaN for voxels of cells without points. `planes` are those of
/// the soup's triangles, in lattice coordinates.
pub fn estimate(
    spans: &[Spans],
    planes: &[Plane],
    bricks: &Arc<Bricks>,
    progress: &Progress,
) -> Result<Grid<f32>, Stopped> {
    let bins = bin(spans, bricks, progress)?;
    let checked = |&brick: &IVec3| progress.check().map(|()| estimate_brick(brick, &bins, bricks, planes));
    let values = bricks.active().par_iter().map(checked).collect::<Result<_, Stopped>>()?;
    Ok(Grid { bricks: bricks.clone(), values, inside: f32::NAN, outside: f32::NAN })
}

/// Sorts the points by brick; within one by direction, ray and depth.
fn bin(spans: &[Spans], bricks: &Bricks, progress: &Progress) -> Result<Bins, Stopped> {
    let checked = |spans| progress.check().map(|()| points(spans, bricks));
    let found: Vec<Vec<(u32, Point)>> = spans.par_iter().map(checked).collect::<Result<_, Stopped>>()?;
    progress.check()?;
    let mut starts = vec![0u32; bricks.len() + 2];
    for &(n, _) in found.iter().flatten() {
        starts[n as usize + 2] += 1;
    }
    for n in 2..starts.len() {
        starts[n] += starts[n - 1];
    }
    let none = Point { at: Vec3::ZERO, triangle: 0 };
    let mut points = vec![none; starts[starts.len() - 1] as usize];
    for &(n, point) in found.iter().flatten() {
        let at = &mut starts[n as usize + 1];
        points[*at as usize] = point;
        *at += 1;
    }
    starts.pop();
    Ok(Bins { starts, points })
}

/// The points on the speaking rays of one direction, each with the number of its brick.
fn points(spans: &Spans, bricks: &Bricks) -> Vec<(u32, Point)> {
    let layers = &spans.layers;
    let mut found = Vec::with_capacity(layers.hits.len());
    let mut last = (IVec3::MIN, None);
    for ray in (0..layers.ray_count()).filter(|&ray| !spans.is_silent(ray)) {
        let hits = layers.of(ray);
        if hits.is_empty() {
            continue;
        }
        let (u, v) = layers.position(ray);
        for hit in hits {
            let p = layers.direction.unshear(u, v, hit.depth);
            if p.cmplt(DVec3::ZERO).any() {
                continue; // beyond the lattice
            }
            let brick = brick_of(p.as_ivec3());
            if brick != last.0 {
                last = (brick, bricks.number(brick));
            }
            if let Some(n) = last.1 {
                let at = (p - (brick * BRICK).as_dvec3()).as_vec3();
                found.push((n, Point { at, triangle: hit.triangle() << 1 | hit.reversed() as u32 }));
            }
        }
    }
    found
}

fn estimate_brick(brick: IVec3, bins: &Bins, bricks: &Bricks, planes: &[Plane]) -> [f32; BRICK_VOXELS] {
    let mut nearest = [(f32::MAX, u32::MAX); BRICK_VOXELS];
    // The cells of the bricks before this one reach its first voxels.
    for n in 0..8 {
        let step = IVec3::new(n & 1, n >> 1 & 1, n >> 2);
        let shift = (step * BRICK).as_vec3();
        for point in bins.of(bricks.slot(brick - step)) {
            offer(point.at - shift, point.triangle, &mut nearest);
        }
    }
    let mut values = [f32::NAN; BRICK_VOXELS];
    let base = brick * BRICK;
    for (n, (value, &(_, triangle))) in values.iter_mut().zip(&nearest).enumerate() {
        if triangle != u32::MAX {
            let p: DVec3 = (base + voxel_in_brick(n)).as_dvec3();
            let d = planes[(triangle >> 1) as usize].distance(p);
            *value = (if triangle & 1 == 1 { -d } else { d }) as f32;
        }
    }
    values
}

/// Offers a point to the eight voxels of its cell, as far as they lie in the brick.
#[inline]
fn offer(at: Vec3, triangle: u32, nearest: &mut [(f32, u32); BRICK_VOXELS]) {
    // Shifted points lie at -8 or above.
    let cell = (at + BRICK as f32).as_ivec3() - BRICK;
    if cell.min_element() < -1 {
        return;
    }
    for n in 0..8 {
        let voxel = cell + IVec3::new(n & 1, n >> 1 & 1, n >> 2);
        if voxel.min_element() >= 0 && voxel.max_element() < BRICK {
            let d = at.distance_squared(voxel.as_vec3());
            let slot = &mut nearest[(voxel.x | voxel.y << 3 | voxel.z << 6) as usize];
            if d < slot.0 {
                *slot = (d, triangle);
            }
        }
    }
}
