//! From the blocks of a region down to those of four voxels: each level counts, scans and scatters its lists on the device.

use glam::IVec3;

use super::FieldLimits;
use super::region::Region;
use super::rows::{Picked, Placed};
use crate::gpu::GpuError;
use crate::gpu::programs::Field;
use crate::gpu::run::{Run, Source, pass};
use crate::lattice::BRICK;
use crate::sdf::exact::Scope;

/// Words of a block, as in the shader.
pub(super) const BLOCK_WORDS: u64 = 5;
/// The most values that are summed at once.
const MOST_SUMS: u64 = 1 << 26;
/// Invocations of a workgroup, as in the shaders.
const WIDTH: u64 = 64;

/// Some features on the device.
pub(super) struct Loaded {
    rows: wgpu::Buffer,
    boxes: wgpu::Buffer,
    /// What is the same in all jobs: see the shader.
    kinds: [u32; 3],
    starts: [u32; 2],
    end: IVec3,
    band: f32,
}

/// Blocks of one size that have features, and the lists of these.
pub(super) struct Level {
    pub blocks: wgpu::Buffer,
    pub count: u64,
    pub lists: wgpu::Buffer,
    entries: u64,
    size: i32,
}

/// The lists of a level's children before they are written.
struct Judged {
    masks: wgpu::Buffer,
    starts: wgpu::Buffer,
    places: wgpu::Buffer,
    entries: u64,
    count: u64,
}

/// What is too much for one buffer.
pub(super) enum Found<T> {
    Fits(T),
    /// So many features for so many blocks.
    TooMuch,
}

impl Loaded {
    pub fn new(run: &mut Run<'_>, placed: &Placed<'_>, picked: &Picked, scope: &Scope) -> Self {
        let storage = wgpu::BufferUsages::STORAGE;
        let (faces, edges) = (picked.faces.len() as u32, picked.edges.len() as u32);
        let [first_edge, first_vertex, _] = picked.rows().map(|row| row as u32);
        Self {
            rows: run.upload(&placed.rows(picked), storage),
            boxes: run.upload(&placed.boxes(picked), storage),
            kinds: [faces, faces + edges, picked.len() as u32],
            starts: [first_edge, first_vertex],
            end: scope.end,
            band: scope.band as f32,
        }
    }

    /// The uniform of the shaders, for `count` blocks of `size` voxels in `region`.
    pub fn job(&self, run: &mut Run<'_>, region: &Region, size: i32, count: u64) -> wgpu::Buffer {
        let words = |v: IVec3, last: u32| [v.x as u32, v.y as u32, v.z as u32, last];
        let [first_edge, first_vertex] = self.starts;
        let [faces, edges, all] = self.kinds;
        let rows = [
            [faces, edges, all, count as u32],
            [first_edge, first_vertex, 0, 0],
            words(region.base, size as u32),
            words(region.across, 0),
            words(self.end, 0),
            [self.band.to_bits(), 0, 0, 0],
        ];
        run.upload(rows.as_flattened(), wgpu::BufferUsages::UNIFORM)
    }

    pub fn rows(&self) -> &wgpu::Buffer {
        &self.rows
    }
}

/// What works through one region.
pub(super) struct Descent<'a> {
    pub programs: &'a Field,
    pub loaded: &'a Loaded,
    pub region: Region,
    pub limits: FieldLimits,
}

impl Descent<'_> {
    /// The bricks of the region that may reach into the band, and the features that can be nearest in each.
    pub fn bricks(&self, run: &mut Run<'_>) -> Result<Found<Level>, GpuError> {
        let mut level = match self.top(run)? {
            Found::Fits(level) => level,
            Found::TooMuch => return Ok(Found::TooMuch),
        };
        while level.size > BRICK && level.count > 0 {
            level = match self.children(run, &level, false)? {
                Found::Fits(level) => level,
                Found::TooMuch => return Ok(Found::TooMuch),
            };
        }
        Ok(if level.count > self.limits.bricks { Found::TooMuch } else { Found::Fits(level) })
    }

    /// The eight blocks of every brick, whether they have features or not.
    pub fn octants(&self, run: &mut Run<'_>, bricks: &Level) -> Result<Found<Level>, GpuError> {
        self.children(run, bricks, true)
    }

    /// The blocks of the region.
    fn top(&self, run: &mut Run<'_>) -> Result<Found<Level>, GpuError> {
        let (loaded, count) = (self.loaded, self.region.blocks());
        if count > MOST_SUMS {
            return Ok(Found::TooMuch);
        }
        let storage = wgpu::BufferUsages::STORAGE;
        let cursor = run.buffer(count, storage | wgpu::BufferUsages::COPY_SRC);
        let features = u64::from(loaded.kinds[2]);
        let job = loaded.job(run, &self.region, self.region.size, 0);
        let mut encoder = run.encoder();
        let programs = self.programs;
        let shared = [&job, &loaded.rows, &loaded.boxes, &cursor];
        pass(run, &mut encoder, "enlist", &programs.count, &shared, features.div_ceil(WIDTH));
        let places = self.places(run, &mut encoder, &cursor, count);
        let entries = programs.scan.encode(run, &mut encoder, &cursor, count);
        let [entries, kept] = totals(run, encoder, &entries, &places.1)?;
        if entries > self.limits.entries {
            return Ok(Found::TooMuch);
        }
        let level = Level {
            blocks: run.buffer(BLOCK_WORDS * kept, storage | wgpu::BufferUsages::COPY_SRC),
            count: kept,
            lists: run.buffer(entries, storage),
            entries,
            size: self.region.size,
        };
        let mut encoder = run.encoder();
        let enlisted = [&job, &loaded.rows, &loaded.boxes, &cursor, &level.lists];
        pass(run, &mut encoder, "enlist", &programs.enlist, &enlisted, features.div_ceil(WIDTH));
        let (base, across) = (self.region.base, self.region.across);
        let words = [count as u32, 0, across.x as u32, across.y as u32, self.region.size as u32, 0, 0, 0];
        let grid: Vec<u32> = words.into_iter().chain(base.to_array().map(|k| k as u32)).chain([0]).collect();
        let grid = run.upload(&grid, wgpu::BufferUsages::UNIFORM);
        pass(
            run,
            &mut encoder,
            "share",
            &programs.open,
            &[&grid, &cursor, &places.0, &level.blocks],
            count.div_ceil(WIDTH),
        );
        run.submit(encoder)?;
        Ok(Found::Fits(level))
    }

    /// The children of a level: all of them, or those that have features.
    fn children(&self, run: &mut Run<'_>, level: &Level, all: bool) -> Result<Found<Level>, GpuError> {
        let children = 8 * level.count;
        if children + 1 > MOST_SUMS.min(self.limits.words / BLOCK_WORDS) {
            return Ok(Found::TooMuch);
        }
        let judged = self.judge(run, level, all)?;
        if judged.entries > self.limits.entries {
            return Ok(Found::TooMuch);
        }
        let storage = wgpu::BufferUsages::STORAGE;
        let child = Level {
            blocks: run.buffer(BLOCK_WORDS * judged.count, storage | wgpu::BufferUsages::COPY_SRC),
            count: judged.count,
            lists: run.buffer(judged.entries, storage),
            entries: judged.entries,
            size: level.size / 2,
        };
        let parents = [level.count as u32, level.size as u32, all.into(), 0];
        let parents = run.upload(&parents, wgpu::BufferUsages::UNIFORM);
        let mut encoder = run.encoder();
        let Judged { masks, starts, places, .. } = &judged;
        let buffers = [&parents, &level.blocks, &level.lists, masks, starts, places, &child.lists, &child.blocks];
        pass(run, &mut encoder, "share", &self.programs.share, &buffers, level.count);
        run.submit(encoder)?;
        Ok(Found::Fits(child))
    }

    fn judge(&self, run: &mut Run<'_>, level: &Level, all: bool) -> Result<Judged, GpuError> {
        let (storage, children) = (wgpu::BufferUsages::STORAGE, 8 * level.count);
        let masks = run.buffer(level.entries, storage);
        // One more, which stays 0: after the scan it is the end of the last list.
        let starts = run.buffer(children + 1, storage | wgpu::BufferUsages::COPY_SRC);
        let job = self.loaded.job(run, &self.region, level.size, level.count);
        let mut encoder = run.encoder();
        let buffers = [&job, &self.loaded.rows, &level.blocks, &level.lists, &masks, &starts];
        pass(run, &mut encoder, "judge", &self.programs.judge, &buffers, level.count);
        let kept = (!all).then(|| self.places(run, &mut encoder, &starts, children));
        let total = self.programs.scan.encode(run, &mut encoder, &starts, children + 1);
        Ok(match kept {
            Some((places, kept)) => {
                let [entries, count] = totals(run, encoder, &total, &kept)?;
                Judged { masks, starts, places, entries, count }
            }
            None => {
                let [entries, _] = totals(run, encoder, &total, &total)?;
                Judged { masks, places: starts.clone(), starts, entries, count: children }
            }
        })
    }

    /// Numbers of those of `count` counts that are not 0 among themselves, and how many there are.
    fn places(
        &self,
        run: &mut Run<'_>,
        encoder: &mut wgpu::CommandEncoder,
        counts: &wgpu::Buffer,
        count: u64,
    ) -> (wgpu::Buffer, wgpu::Buffer) {
        let places = run.buffer(count, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let uniform = run.upload(&[count as u32, 0, 0, 0], wgpu::BufferUsages::UNIFORM);
        pass(run, encoder, "scan", &self.programs.mark, &[&uniform, counts, &places], count.div_ceil(WIDTH));
        let kept = self.programs.scan.encode(run, encoder, &places, count);
        (places, kept)
    }
}

/// The first words of two buffers.
fn totals(
    run: &mut Run<'_>,
    encoder: wgpu::CommandEncoder,
    first: &wgpu::Buffer,
    second: &wgpu::Buffer,
) -> Result<[u64; 2], GpuError> {
    let read = run.finish(encoder, &[Source::Words(first, 1), Source::Words(second, 1)])?;
    let word = |n: usize| read.get(n).and_then(|words| words.first()).map_or(0, |&word| u64::from(word));
    Ok([word(0), word(1)])
}
