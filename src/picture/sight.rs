//! What each sample of the image sees.

use glam::Vec3;
use rayon::prelude::*;

use super::scene::Scene;
use crate::progress::{Progress, Stopped};

/// No triangle.
const NONE: u32 = u32::MAX;
/// The hatched inside of a mesh that is cut.
const CUT: u32 = u32::MAX - 1;

/// A visible point: triangle and its depth, pixels towards the viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Visible {
    triangle: u32,
    pub(super) z: f32,
}

/// On what a visible point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum On {
    /// A triangle.
    Triangle(usize),
    /// The hatched inside of a mesh that is cut.
    Cut,
}

impl Visible {
    pub(super) fn on(&self) -> On {
        if self.triangle == CUT { On::Cut } else { On::Triangle(self.triangle as usize) }
    }

    /// Whether another point with this one's column and row lies behind it, or is of a later triangle in the same place.
    fn is_before(&self, triangle: u32, z: f32) -> bool {
        self.triangle != NONE && (z < self.z || z == self.z && self.triangle != CUT && triangle > self.triangle)
    }
}

/// The hits of all samples, row by row.
pub(super) struct Sight {
    hits: Vec<Visible>,
    /// Pixels across and down.
    pub(super) size: [usize; 2],
    /// Samples along each side of a pixel.
    pub(super) samples: usize,
}

impl Sight {
    /// Samples across.
    pub(super) fn columns(&self) -> usize {
        self.size[0] * self.samples
    }

    /// What sample `column` of sample row `row` sees.
    pub(super) fn hit(&self, row: usize, column: usize) -> Option<Visible> {
        Some(self.hits[row * self.columns() + column]).filter(|hit| hit.triangle != NONE)
    }

    /// Where a sample lies in the image, pixels.
    pub(super) fn position(&self, row: usize, column: usize) -> [f32; 2] {
        centre(self.samples, row, column)
    }
}

fn centre(samples: usize, row: usize, column: usize) -> [f32; 2] {
    [column, row].map(|k| (k as f32 + 0.5) / samples as f32)
}

/// Finds the nearest triangle at each sample, of triangles at the same depth the first one; of those behind `front` where that is given. With straight
/// lines on the image a depth buffer is several times faster than rays, above all where long thin triangles crowd.
pub(super) fn sight(
    scene: &Scene,
    size: [usize; 2],
    samples: usize,
    front: Option<&Sight>,
    progress: &Progress,
) -> Result<Sight, Stopped> {
    let columns = size[0] * samples;
    let mut hits = vec![Visible { triangle: NONE, z: f32::NEG_INFINITY }; columns * size[1] * samples];
    let bands = by_band(scene, samples, size[1] * samples);
    hits.par_chunks_mut(columns * BAND).zip(&bands).enumerate().try_for_each(|(band, (out, triangles))| {
        let mut rows: Vec<&mut [Visible]> = out.chunks_exact_mut(columns).collect();
        for &triangle in triangles {
            progress.check()?;
            let corners = &scene.corners[triangle as usize];
            let Some((from, to)) = row_range(corners, samples) else { continue };
            for row in from.max(band * BAND)..to.min(band * BAND + rows.len()) {
                let ahead = front.map(|front| &front.hits[row * columns..][..columns]);
                let counts = |column: usize, x: f32, y: f32, z: f32| {
                    ahead.is_none_or(|ahead| ahead[column].is_before(triangle, z))
                        && scene.cut.is_none_or(|cut| cut.keeps(Vec3::new(x, y, z)))
                };
                fill(rows[row - band * BAND], triangle, corners, samples, row, counts);
            }
        }
        for (n, row) in rows.iter_mut().enumerate() {
            cut_inside(
                scene,
                row,
                samples,
                band * BAND + n,
                front.map(|front| &front.hits[(band * BAND + n) * columns..]),
            );
        }
        Ok(())
    })?;
    Ok(Sight { hits, size, samples })
}

/// Where a cut is in front of an inner side, what is seen first is the inside of the mesh, cut through.
fn cut_inside(scene: &Scene, row: &mut [Visible], samples: usize, number: usize, front: Option<&[Visible]>) {
    let Some(cut) = scene.cut.filter(|_| scene.hatched) else { return };
    for (column, hit) in row.iter_mut().enumerate() {
        let inner = hit.triangle != NONE && !scene.facing[hit.triangle as usize];
        let first = front.is_none_or(|front| front[column].triangle == NONE);
        if inner && first {
            let [x, y] = centre(samples, number, column);
            if let Some(z) = cut.depth(x, y).filter(|&z| z >= hit.z) {
                *hit = Visible { triangle: CUT, z };
            }
        }
    }
}

/// Rows of samples that one thread fills at a time.
const BAND: usize = 32;

/// The triangles, ascending, that touch each band of rows.
fn by_band(scene: &Scene, samples: usize, rows: usize) -> Vec<Vec<u32>> {
    let mut bands = vec![Vec::new(); rows.div_ceil(BAND)];
    for &id in &scene.obstacles {
        let Some((from, to)) = row_range(&scene.corners[id as usize], samples) else { continue };
        let last = to.min(rows).div_ceil(BAND);
        bands.iter_mut().take(last).skip(from / BAND).for_each(|band| band.push(id));
    }
    bands
}

/// The rows of samples between a triangle's top and bottom, and perhaps one more on each side.
fn row_range(corners: &[Vec3; 3], samples: usize) -> Option<(usize, usize)> {
    let ys = corners.map(|c| c.y * samples as f32);
    let (top, bottom) = (ys[0].min(ys[1]).min(ys[2]), ys[0].max(ys[1]).max(ys[2]));
    (bottom >= 0.0).then_some(((top - 1.0).max(0.0) as usize, (bottom + 1.0) as usize + 1))
}

/// Puts a triangle into one row of samples, where it is the nearest so far and `counts`: column, x, y and depth.
fn fill(
    out: &mut [Visible],
    triangle: u32,
    corners: &[Vec3; 3],
    samples: usize,
    row: usize,
    counts: impl Fn(usize, f32, f32, f32) -> bool,
) {
    let [_, y] = centre(samples, row, 0);
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if a.y.min(b.y) <= y && y <= a.y.max(b.y) {
            let x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
            // Level edges divide 0 by 0; both ends count.
            let (from, to) = if x.is_finite() { (x, x) } else { (a.x.min(b.x), a.x.max(b.x)) };
            (low, high) = (low.min(from), high.max(to));
        }
    }
    if low > high {
        return;
    }
    // One column more on each side makes up for rounding; the exact test decides.
    let from = ((low * samples as f32 - 1.5).max(0.0) as usize).min(out.len());
    let to = ((high * samples as f32 + 1.5).max(0.0) as usize).min(out.len());
    for (column, hit) in (from..).zip(&mut out[from..to.max(from)]) {
        let [x, y] = centre(samples, row, column);
        if let Some(z) = depth(corners, x, y).filter(|&z| z > hit.z && counts(column, x, y, z)) {
            *hit = Visible { triangle, z };
        }
    }
}

/// The depth of a triangle at (x, y), if it is there. Edges belong to both triangles, so that
/// no sample slips through between neighbours: the sign of each determinant is the same, but for the turn, in both.
fn depth([a, b, c]: &[Vec3; 3], x: f32, y: f32) -> Option<f32> {
    let from = |p: &Vec3| (f64::from(p.x) - f64::from(x), f64::from(p.y) - f64::from(y));
    let (a2, b2, c2) = (from(a), from(b), from(c));
    let turn = |p: (f64, f64), q: (f64, f64)| p.0 * q.1 - p.1 * q.0;
    let (wa, wb, wc) = (turn(b2, c2), turn(c2, a2), turn(a2, b2));
    let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
    let sum = wa + wb + wc;
    if !inside || sum == 0.0 {
        return None;
    }
    Some(((wa * f64::from(a.z) + wb * f64::from(b.z) + wc * f64::from(c.z)) / sum) as f32)
}

/// The weights of the corners at (x, y), which lies in the triangle as seen. They sum to 1.
pub(super) fn weights([a, b, c]: &[Vec3; 3], x: f32, y: f32) -> [f32; 3] {
    let turn = |p: &Vec3, q: &Vec3| (p.x - x) * (q.y - y) - (p.y - y) * (q.x - x);
    let w = [turn(b, c), turn(c, a), turn(a, b)];
    let sum = w[0] + w[1] + w[2];
    if sum == 0.0 { [1.0 / 3.0; 3] } else { w.map(|w| w / sum) }
}
