//! What is drawn: chunks of triangles, and tiles of one direction's rays.

use glam::IVec3;
use rayon::prelude::*;

use super::run::{Run, Source};
use super::{GpuError, GpuMethod, GpuOptions};
use crate::lattice::Direction;
use crate::ldi::SNAP_BITS;

/// Coordinates of a triangle.
const WORDS: u64 = 9;
/// Words of a candidate, as in the shader.
const CANDIDATE_WORDS: u64 = 24;
/// Vertices that are drawn for each candidate, as in the shader.
const VERTICES: u64 = 9;

/// Some of the triangles.
pub(super) struct Chunk {
    pub corners: wgpu::Buffer,
    first: u32,
    pub count: u32,
}

/// Those of a chunk that may cross the rays of a tile.
pub(super) struct Candidates {
    pub candidates: wgpu::Buffer,
    pub numbers: wgpu::Buffer,
    /// What draws the candidates.
    pub arguments: wgpu::Buffer,
    count: u32,
}

impl Candidates {
    /// Room for those of each chunk.
    pub fn of(run: &mut Run<'_>, chunks: &[Chunk]) -> Vec<Self> {
        let (storage, read) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::COPY_SRC);
        let room = |chunk: &Chunk| Self {
            candidates: run.buffer(CANDIDATE_WORDS * u64::from(chunk.count), storage),
            numbers: run.buffer(chunk.count.into(), storage | read),
            arguments: run.upload(&[0, 1, 0, 0], storage | wgpu::BufferUsages::INDIRECT),
            count: chunk.count,
        };
        chunks.iter().map(room).collect()
    }
}

/// Uploads the triangles, in as many chunks as the adapter needs.
pub(super) fn upload(
    run: &mut Run<'_>,
    vertices: &[IVec3],
    triangles: &[[u32; 3]],
    options: &GpuOptions,
) -> Result<Vec<Chunk>, GpuError> {
    let entry = run.device.entry();
    let words = match options.method {
        GpuMethod::Peel => CANDIDATE_WORDS,
        GpuMethod::Scatter => WORDS,
    };
    let fit = entry.binding_bytes.min(entry.buffer_bytes) / (4 * words);
    // Vertices of one draw are numbered with 32 bits.
    let most = fit.min(u64::from(u32::MAX) / VERTICES).min(u64::from(options.limits.triangles)).max(1) as usize;
    let mut chunks = Vec::new();
    for (n, part) in triangles.chunks(most).enumerate() {
        run.progress.check()?;
        let mut corners = vec![0u32; WORDS as usize * part.len()];
        corners.par_chunks_mut(WORDS as usize).zip(part).for_each(|(corners, triangle)| {
            for (corner, &v) in corners.chunks_exact_mut(3).zip(triangle) {
                corner.copy_from_slice(&vertices[v as usize].to_array().map(|c| c as u32));
            }
        });
        let corners = run.upload(&corners, wgpu::BufferUsages::STORAGE);
        chunks.push(Chunk { corners, first: (n * most) as u32, count: part.len() as u32 });
        run.device.check()?;
    }
    Ok(chunks)
}

/// The numbers of the triangles in the slots, those of the chunks one after another.
pub(super) fn numbers(run: &mut Run<'_>, chunks: &[Candidates]) -> Result<Vec<u32>, GpuError> {
    let sources: Vec<_> = chunks.iter().map(|chunk| Source::Words(&chunk.numbers, u64::from(chunk.count))).collect();
    Ok(run.finish(run.encoder(), &sources)?.concat())
}

/// A rectangle of the rays of one direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tile {
    /// Indices of the first ray.
    pub low: [i32; 2],
    /// Rays along u and v.
    pub size: [u32; 2],
}

impl Tile {
    /// The tiles, at most `side` rays long, that make up a window.
    pub fn of_window(low: [i32; 2], size: [i32; 2], side: u32) -> Vec<Self> {
        let side = side.max(1) as usize;
        let along = |n: i32| (0..n).step_by(side).map(move |at| (at, (n - at).min(side as i32) as u32));
        along(size[1])
            .flat_map(|(v, height)| {
                along(size[0]).map(move |(u, width)| Self { low: [low[0] + u, low[1] + v], size: [width, height] })
            })
            .collect()
    }

    /// The number of rays.
    pub fn rays(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// Two halves; `None` for a single ray.
    pub fn halves(&self) -> Option<[Self; 2]> {
        let axis = usize::from(self.size[1] > self.size[0]);
        let first = self.size[axis] / 2;
        if first == 0 {
            return None;
        }
        let (mut a, mut b) = (*self, *self);
        a.size[axis] = first;
        b.size[axis] -= first;
        b.low[axis] += first as i32;
        Some([a, b])
    }
}

/// A direction, with the rays' distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beam {
    pub direction: Direction,
    pub factor: u32,
}

impl Beam {
    /// The uniform `View` of the shaders, for each chunk. `offset`: the number of the tile's first ray among those of all tiles that are worked on
    /// together.
    pub fn views(&self, run: &mut Run<'_>, tile: &Tile, offset: u32, chunks: &[Chunk]) -> Vec<wgpu::Buffer> {
        let step = (1u32 << SNAP_BITS) / self.factor;
        let Direction { main, shear_u, shear_v } = self.direction;
        let [low_u, low_v, shear_u, shear_v] = [tile.low[0], tile.low[1], shear_u, shear_v].map(|k| k as u32);
        let [width, height] = tile.size;
        let view = |chunk: &Chunk| {
            let (first, count) = (chunk.first, chunk.count);
            let words = [low_u, low_v, width, height, shear_u, shear_v, main as u32, step, first, count, offset, 0];
            run.upload(&words, wgpu::BufferUsages::UNIFORM)
        };
        chunks.iter().map(view).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_and_their_halves_cover_every_ray_once() {
        let (low, size) = ([-5, 3], [23, 17]);
        for side in [1, 4, 16, 100] {
            let mut seen = vec![0; 23 * 17];
            let mut rest = Tile::of_window(low, size, side);
            let mut tiles = Vec::new();
            while let Some(tile) = rest.pop() {
                match tile.halves().filter(|_| tile.rays() > 30) {
                    Some(halves) => rest.extend(halves),
                    None => tiles.push(tile),
                }
            }
            for tile in tiles {
                assert!(tile.size.iter().all(|&n| n > 0 && n <= side));
                for n in 0..tile.rays() as i32 {
                    let (i, j) = (n % tile.size[0] as i32, n / tile.size[0] as i32);
                    seen[((tile.low[1] + j - low[1]) * size[0] + tile.low[0] + i - low[0]) as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "at {side}");
        }
        assert_eq!(Tile { low, size: [1, 1] }.halves(), None);
    }
}
