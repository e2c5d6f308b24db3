//! The layered depth image of one direction.

use glam::IVec3;
use rayon::prelude::*;

use crate::lattice::Direction;

/// The most triangles a soup may have: their numbers share 32 bits with two marks.
pub const MAX_TRIANGLES: usize = 1 << 30;
/// The most crossings of all directions together: they are numbered with 32 bits.
pub const MAX_CROSSINGS: u64 = 1 << 32;

/// One crossing of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Depth along the direction's main axis, voxels.
    pub depth: f64,
    tagged: u32,
}

impl Hit {
    /// A crossing at `depth` (voxels) with triangle `triangle` (below [`MAX_TRIANGLES`]).
    #[inline]
    pub fn new(depth: f64, triangle: u32, entering: bool) -> Self {
        Self { depth, tagged: triangle << 2 | entering as u32 }
    }

    /// The crossing as one where the result is `entering`, whichever way the triangle looks.
    #[inline]
    pub fn of_result(self, entering: bool) -> Self {
        let reversed = (entering != self.entering()) != self.reversed();
        Self { depth: self.depth, tagged: self.tagged & !3 | (reversed as u32) << 1 | entering as u32 }
    }

    /// The crossing with the triangle turned over.
    #[inline]
    pub fn turned(self) -> Self {
        Self { depth: self.depth, tagged: self.tagged ^ 1 }
    }

    /// Number of the triangle in the soup.
    #[inline]
    pub fn triangle(self) -> u32 {
        self.tagged >> 2
    }

    /// Whether the outside of the result lies on the triangle's inner side (the removed operand of
    /// a difference).
    #[inline]
    pub fn reversed(self) -> bool {
        self.tagged >> 1 & 1 == 1
    }

    /// Whether the ray, going in its direction, enters here (against the triangle's normal).
    #[inline]
    pub fn entering(self) -> bool {
        self.tagged & 1 == 1
    }
}

/// All crossings of the rays of one direction, sorted along each ray.
#[derive(Debug, Clone)]
pub struct Layers {
    /// The direction.
    pub direction: Direction,
    /// Rays per voxel along u and v.
    pub factor: u32,
    /// Smallest ray indices along u and v; ray (i, j) lies at u = i / factor, v = j / factor.
    pub low: [i32; 2],
    /// Number of rays along u and v.
    pub size: [i32; 2],
    /// `hits[offsets[r]..offsets[r + 1]]` are the crossings of ray number `r` (u runs fastest).
    pub offsets: Vec<u32>,
    /// The crossings.
    pub hits: Vec<Hit>,
}

impl Layers {
    /// The rays of one direction; their crossings, offsets too, are still missing.
    pub(super) fn empty(direction: Direction, dims: IVec3, factor: u32) -> Self {
        let (low, size) = Self::window(direction, dims, factor);
        Self { direction, factor, low, size, offsets: Vec::new(), hits: Vec::new() }
    }

    /// What [`Self::low`] and [`Self::size`] are for a lattice of `dims` voxels.
    pub fn window(direction: Direction, dims: IVec3, factor: u32) -> ([i32; 2], [i32; 2]) {
        let (low, size) = direction.ray_window(dims);
        let f = factor as i32;
        // The rays between the voxels' own stop at the last voxel's.
        (low.map(|k| k * f), size.map(|n| (n - 1) * f + 1))
    }

    /// Number of rays.
    pub fn ray_count(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// The number of the ray with indices (i, j); `None` outside of the window.
    #[inline]
    pub fn ray(&self, i: i32, j: i32) -> Option<usize> {
        let (u, v) = (i - self.low[0], j - self.low[1]);
        let known = u >= 0 && v >= 0 && u < self.size[0] && v < self.size[1];
        known.then(|| v as usize * self.size[0] as usize + u as usize)
    }

    /// Indices (i, j) of ray number `ray`.
    #[inline]
    pub fn indices(&self, ray: usize) -> (i32, i32) {
        let (i, j) = (ray % self.size[0] as usize, ray / self.size[0] as usize);
        (i as i32 + self.low[0], j as i32 + self.low[1])
    }

    /// u and v, in voxels, of ray number `ray`.
    #[inline]
    pub fn position(&self, ray: usize) -> (f64, f64) {
        let (i, j) = self.indices(ray);
        let f = self.factor as f64;
        (i as f64 / f, j as f64 / f)
    }

    /// The crossings of ray number `ray`.
    #[inline]
    pub fn of(&self, ray: usize) -> &[Hit] {
        &self.hits[self.offsets[ray] as usize..self.offsets[ray + 1] as usize]
    }

    /// The most crossings on one ray.
    pub fn deepest(&self) -> usize {
        self.offsets.windows(2).map(|w| (w[1] - w[0]) as usize).max().unwrap_or(0)
    }

    /// Counts, makes offsets, scatters, and sorts each ray. `found` holds (ray, hit) in any order
    /// that does not depend on the number of threads.
    pub(super) fn fill(&mut self, found: &[Vec<(u32, Hit)>]) {
        let mut offsets = vec![0u32; self.ray_count() + 2];
        for &(ray, _) in found.iter().flatten() {
            offsets[ray as usize + 2] += 1;
        }
        for r in 2..offsets.len() {
            offsets[r] += offsets[r - 1];
        }
        let mut hits = vec![Hit::new(0.0, 0, false); offsets[offsets.len() - 1] as usize];
        for &(ray, hit) in found.iter().flatten() {
            let at = &mut offsets[ray as usize + 1];
            hits[*at as usize] = hit;
            *at += 1;
        }
        offsets.pop();
        self.offsets = offsets;
        self.hits = hits;
        self.sort();
    }

    /// For each row of rays where its rays begin, and its crossings.
    pub(super) fn rows(&mut self) -> Vec<(&[u32], &mut [Hit])> {
        let width = self.size[0] as usize;
        let mut rest = self.hits.as_mut_slice();
        let mut done = 0;
        let mut rows = Vec::with_capacity(self.size[1] as usize);
        for starts in self.offsets.chunks(width).take(self.size[1] as usize) {
            let end = self.offsets[(rows.len() + 1) * width];
            let (mine, others) = rest.split_at_mut((end - done) as usize);
            rows.push((starts, mine));
            rest = others;
            done = end;
        }
        rows
    }

    pub(super) fn sort(&mut self) {
        self.rows().into_par_iter().with_min_len(32).for_each(|(starts, hits)| {
            let len = hits.len() as u32;
            let base = starts[0];
            for (k, &start) in starts.iter().enumerate() {
                let end = starts.get(k + 1).map_or(len, |&e| e - base);
                let ray = &mut hits[(start - base) as usize..end as usize];
                if ray.len() > 1 {
                    ray.sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth).then(a.tagged.cmp(&b.tagged)));
                }
            }
        });
    }
}

#[cfg(test)]
impl Layers {
    /// One ray along x, eight voxels long, with these crossings: depth, triangle, entering.
    pub(super) fn of_one_ray(hits: &[(f64, u32, bool)]) -> Self {
        let mut layers = Self::empty(crate::lattice::DIRECTIONS[0], IVec3::new(8, 1, 1), 1);
        layers.offsets = vec![0, hits.len() as u32];
        layers.hits = hits.iter().map(|&(depth, triangle, entering)| Hit::new(depth, triangle, entering)).collect();
        layers
    }
}
