//! Layered depth images by counting, a scan, and scattering: two passes over the triangles, whatever the depth, and for as many directions at once as
//! buffers hold.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::sync::Arc;

use rayon::prelude::*;

use super::programs::Scatter;
use super::run::{Received, Run, SIDE, Sent, Source, pass};
use super::scene::{Beam, Chunk, Tile};
use super::{GpuError, GpuLimits};
use crate::ldi::Crossed;

/// Rays of one batch, at most: 16 MB, so that the processor has something to do while the next is found.
const BATCH: u64 = 1 << 22;
/// Triangles of a workgroup, as in the shader.
const WIDTH: u32 = 64;
/// So many rays along a side of a tile are one more row of invocations for each triangle, at most so many.
const STRIP: u32 = 32;
const MOST_STRIPS: u32 = 64;

/// A tile of one direction, and the number of its first ray among those of its batch.
#[derive(Debug, Clone, Copy)]
struct Place {
    direction: usize,
    beam: Beam,
    tile: Tile,
    offset: u32,
}

/// Tiles that are worked on together.
#[derive(Debug, Clone, Default)]
struct Batch {
    places: Vec<Place>,
    rays: u64,
}

impl Batch {
    /// Of these tiles, in their order.
    fn of(tiles: impl Iterator<Item = (usize, Beam, Tile)>) -> Self {
        let mut batch = Self::default();
        tiles.for_each(|tile| batch.push(tile));
        batch
    }

    fn push(&mut self, (direction, beam, tile): (usize, Beam, Tile)) {
        self.places.push(Place { direction, beam, tile, offset: self.rays as u32 });
        self.rays += tile.rays();
    }

    fn tiles(&self) -> impl Iterator<Item = (usize, Beam, Tile)> {
        self.places.iter().map(|place| (place.direction, place.beam, place.tile))
    }

    /// Two batches of half the tiles, or of half the only tile; `None` for a single ray.
    fn halves(&self) -> Option<[Self; 2]> {
        if let [Place { direction, beam, tile, .. }] = self.places[..] {
            return Some(tile.halves()?.map(|half| Self::of([(direction, beam, half)].into_iter())));
        }
        let half = self.places.len() / 2;
        Some([Self::of(self.tiles().take(half)), Self::of(self.tiles().skip(half))])
    }
}

/// A batch on its way back.
struct OnItsWay {
    batch: Batch,
    sent: Sent,
    /// Where the crossings of each ray end.
    ends: wgpu::Buffer,
}

/// The crossings of a batch, as the device wrote them.
pub(super) struct Arrived {
    batch: Batch,
    received: Received,
    /// Where the crossings of each tile begin, and those of one after the last would.
    starts: Vec<u32>,
    /// Where those of each ray end, if a ray has more than a byte tells.
    ends: Option<Vec<u32>>,
}

impl OnItsWay {
    /// Takes the batch, after a wait.
    fn take(self, run: &mut Run<'_>) -> Result<Arc<Arrived>, GpuError> {
        let Self { batch, sent, ends } = self;
        let received = run.receive(&sent)?;
        let ends = match received.words(2).first() {
            Some(0) | None => None,
            Some(_) => run.finish(run.encoder(), &[Source::Words(&ends, batch.rays)])?.pop(),
        };
        let mut arrived = Arrived { batch, received, starts: vec![0], ends };
        let sums: Vec<u32> = arrived.batch.places.par_iter().map(|place| arrived.crossings(place)).collect();
        for sum in sums {
            let last = arrived.starts.last().copied().unwrap_or(0);
            arrived.starts.push(last.wrapping_add(sum));
        }
        Ok(Arc::new(arrived))
    }
}

impl Arrived {
    /// Number `n` of the tiles: its direction, and how many rays it has.
    pub fn tiles(&self) -> impl Iterator<Item = (usize, u64)> {
        self.batch.places.iter().map(|place| (place.direction, place.tile.rays()))
    }

    /// How many crossings each ray of a tile has.
    fn counts(&self, place: &Place) -> &[u8] {
        let first = place.offset as usize;
        self.received.bytes(0).get(first..first + place.tile.rays() as usize).unwrap_or_default()
    }

    /// How many crossings a tile has.
    fn crossings(&self, place: &Place) -> u32 {
        match &self.ends {
            Some(ends) => {
                let before = (place.offset as usize).checked_sub(1).and_then(|n| ends.get(n)).map_or(0, |&end| end);
                let last = ends.get((u64::from(place.offset) + place.tile.rays()) as usize - 1);
                last.map_or(0, |&last| last.wrapping_sub(before))
            }
            None => self.counts(place).iter().fold(0, |sum, &count| sum + u32::from(count)),
        }
    }

    /// The crossings of tile number `n`; `None` where they are not those that the rays have.
    pub fn crossed(&self, n: usize) -> Option<Crossed<'_>> {
        let place = &self.batch.places[n];
        let [first, last] = [self.starts[n], self.starts[n + 1]];
        let ends = match &self.ends {
            Some(ends) => {
                let from = place.offset as usize;
                Cow::Borrowed(ends.get(from..from + place.tile.rays() as usize)?)
            }
            None => {
                let mut end = first;
                let next = |&count: &u8| {
                    end += u32::from(count);
                    end
                };
                self.counts(place).iter().map(next).collect()
            }
        };
        let triangles = words(self.received.bytes(1).get(4 * first as usize..4 * last as usize)?);
        Some(Crossed { low: place.tile.low, size: place.tile.size, first, ends, triangles })
    }
}

/// Bytes as words, in place where they lie so that they can be read.
fn words(bytes: &[u8]) -> Cow<'_, [u32]> {
    bytemuck::try_cast_slice(bytes).map_or_else(|_| Cow::Owned(bytemuck::pod_collect_to_vec(bytes)), Cow::Borrowed)
}

impl Scatter {
    /// Gives the crossings of all rays of the windows to `take`, batch by batch: while it has one, the device finds the next.
    pub fn crossed(
        &self,
        run: &mut Run<'_>,
        chunks: &[Chunk],
        windows: &[(Beam, [i32; 2], [i32; 2])],
        limits: &GpuLimits,
        mut take: impl FnMut(Arc<Arrived>),
    ) -> Result<(), GpuError> {
        let entry = run.device.entry();
        let words = entry.binding_bytes.min(entry.buffer_bytes) / 4;
        // What is read back goes through one buffer.
        let most = words.min(entry.buffer_bytes / 8).min(u64::from(limits.crossings));
        let rays = words.min(entry.buffer_bytes / 16).min(BATCH);
        let mut rest = batches(windows, (rays.isqrt() as u32).min(limits.tile_side), rays);
        let mut before: Option<OnItsWay> = None;
        while let Some(batch) = rest.pop_front() {
            let pass = Pass { scatter: self, chunks, batch: &batch };
            // This waits for all that was sent before.
            let (cursor, crossings) = pass.count(run)?;
            if crossings > most {
                for half in batch.halves().ok_or(GpuError::TooLarge { crossings, most })?.into_iter().rev() {
                    rest.push_front(half);
                }
                continue;
            }
            let sent = pass.scatter(run, &cursor, crossings)?;
            if let Some(before) = before.replace(OnItsWay { batch, sent, ends: cursor }) {
                take(before.take(run)?);
            }
        }
        if let Some(last) = before {
            run.device.wait()?;
            take(last.take(run)?);
        }
        run.device.check()
    }
}

/// All tiles of all windows, in batches of at most `rays`.
fn batches(windows: &[(Beam, [i32; 2], [i32; 2])], side: u32, rays: u64) -> VecDeque<Batch> {
    let mut batches = VecDeque::from([Batch::default()]);
    for (direction, &(beam, low, size)) in windows.iter().enumerate() {
        for tile in Tile::of_window(low, size, side) {
            if batches.back().is_none_or(|batch| batch.rays + tile.rays() > rays && batch.rays > 0) {
                batches.push_back(Batch::default());
            }
            if let Some(batch) = batches.back_mut() {
                batch.push((direction, beam, tile));
            }
        }
    }
    batches
}

/// One batch.
struct Pass<'a> {
    scatter: &'a Scatter,
    chunks: &'a [Chunk],
    batch: &'a Batch,
}

impl Pass<'_> {
    /// Where each ray's crossings begin, and how many there are in all.
    fn count(&self, run: &mut Run<'_>) -> Result<(wgpu::Buffer, u64), GpuError> {
        let rays = self.batch.rays;
        let cursor = run.buffer(rays, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let mut encoder = run.encoder();
        self.cover(run, &mut encoder, "count", &self.scatter.count, &[&cursor]);
        let total = self.scatter.scan.encode(run, &mut encoder, &cursor, rays);
        let read = run.finish(encoder, &[Source::Words(&total, 1)])?;
        Ok((cursor, read.first().and_then(|words| words.first()).copied().unwrap_or(0).into()))
    }

    /// Writes the crossings; the cursors then stand at the ends of the rays.
    fn scatter(&self, run: &mut Run<'_>, cursor: &wgpu::Buffer, crossings: u64) -> Result<Sent, GpuError> {
        let triangles = run.buffer(crossings, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let mut encoder = run.encoder();
        self.cover(run, &mut encoder, "scatter", &self.scatter.scatter, &[cursor, &triangles]);
        let (usage, bytes) = (wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC, self.batch.rays.div_ceil(4));
        let (packed, largest) = (run.buffer(bytes, usage), run.buffer(1, usage));
        let count = run.upload(&[self.batch.rays as u32, 0, 0, 0], wgpu::BufferUsages::UNIFORM);
        let buffers = [&count, cursor, &packed, &largest];
        pass(run, &mut encoder, "pack", &self.scatter.pack, &buffers, bytes.div_ceil(WIDTH.into()));
        run.send(
            encoder,
            &[Source::Words(&packed, bytes), Source::Words(&triangles, crossings), Source::Words(&largest, 1)],
        )
    }

    /// All triangles in all tiles.
    fn cover(
        &self,
        run: &mut Run<'_>,
        encoder: &mut wgpu::CommandEncoder,
        name: &'static str,
        pipeline: &wgpu::ComputePipeline,
        written: &[&wgpu::Buffer],
    ) {
        let layout = pipeline.get_bind_group_layout(0);
        for &Place { beam, tile, offset, .. } in &self.batch.places {
            let views = beam.views(run, &tile, offset, self.chunks);
            let strips = (tile.size[0].max(tile.size[1]) / STRIP).clamp(1, MOST_STRIPS);
            for (chunk, view) in self.chunks.iter().zip(&views) {
                let buffers = [view, &chunk.corners];
                let all: Vec<_> = buffers.iter().chain(written).map(|buffer| buffer.as_entire_binding()).collect();
                let group = run.bind(&layout, &all);
                let timestamp_writes = run.clock.compute(name);
                let mut pass =
                    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &group, &[]);
                let groups = chunk.count.div_ceil(WIDTH);
                pass.dispatch_workgroups(groups.min(SIDE), groups.div_ceil(SIDE), strips);
            }
        }
    }
}
