//! Distances at the voxels of bricks, and what comes back of them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::IVec3;
use rayon::prelude::*;

use super::levels::{BLOCK_WORDS, Descent, Level};
use super::rows::Picked;
use crate::gpu::GpuError;
use crate::gpu::programs::Field;
use crate::gpu::run::{Received, Run, Sent, Source, pass};
use crate::lattice::{BRICK, BRICK_VOXELS, voxel_in_brick};
use crate::sdf::exact::{Features, Filled};

/// Blocks of a brick.
const OCTANTS: usize = 8;

/// The bricks of a region, on their way back.
pub(super) struct OnTheirWay {
    sent: Sent,
    octants: Level,
    /// Where the lists of blocks in doubt go.
    starts: wgpu::Buffer,
}

/// The bricks of a region, as the device wrote them.
pub(super) struct Arrived {
    received: Received,
    /// For each block the start of its list in `collected`; empty where no voxel is in doubt.
    starts: Vec<u32>,
    collected: Vec<u32>,
    picked: Arc<Picked>,
}

/// How many voxels were found, and how many of them by the main processor.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub measured: AtomicU64,
    pub doubtful: AtomicU64,
}

impl Descent<'_> {
    /// Measures the voxels of `bricks`, whose blocks are `octants`.
    pub fn measure(&self, run: &mut Run<'_>, bricks: &Level, octants: Level) -> Result<OnTheirWay, GpuError> {
        let (storage, read) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::COPY_SRC);
        let voxels = BRICK_VOXELS as u64 * bricks.count;
        let values = run.buffer(voxels, storage | read);
        // One more, which stays 0: after the scan it is the end of the last list.
        let starts = run.buffer(octants.count + 1, storage | read);
        let job = self.loaded.job(run, &self.region, BRICK / 2, octants.count);
        let mut encoder = run.encoder();
        let buffers = [&job, self.loaded.rows(), &octants.blocks, &octants.lists, &values, &starts];
        pass(run, &mut encoder, "measure", &self.programs.measure, &buffers, octants.count);
        let total = self.programs.scan.encode(run, &mut encoder, &starts, octants.count + 1);
        let sources = [
            Source::Words(&values, voxels),
            Source::Words(&bricks.blocks, BLOCK_WORDS * bricks.count),
            Source::Words(&total, 1),
        ];
        let sent = run.send(encoder, &sources)?;
        Ok(OnTheirWay { sent, octants, starts })
    }
}

impl OnTheirWay {
    /// Takes them, after a wait.
    pub fn take(self, run: &mut Run<'_>, programs: &Field, picked: &Arc<Picked>) -> Result<Arrived, GpuError> {
        let received = run.receive(&self.sent)?;
        let total = u64::from(received.words(2).first().copied().unwrap_or(0));
        let (mut starts, mut collected) = (Vec::new(), Vec::new());
        if total > 0 {
            let octants = &self.octants;
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let lists = run.buffer(total, usage);
            let count = run.upload(&[octants.count as u32, 0, 0, 0], wgpu::BufferUsages::UNIFORM);
            let mut encoder = run.encoder();
            let buffers = [&count, &octants.blocks, &octants.lists, &self.starts, &lists];
            pass(run, &mut encoder, "collect", &programs.collect, &buffers, octants.count);
            let sources = [Source::Words(&self.starts, octants.count + 1), Source::Words(&lists, total)];
            let mut read = run.finish(encoder, &sources)?.into_iter();
            (starts, collected) = (read.next().unwrap_or_default(), read.next().unwrap_or_default());
        }
        Ok(Arrived { received, starts, collected, picked: picked.clone() })
    }
}

impl Arrived {
    /// The bricks that reach into the band; voxels in doubt are measured in double precision.
    pub fn filled(&self, features: &Features, counts: &Counts) -> Vec<Filled> {
        let (values, blocks) = (self.received.bytes(0), self.received.bytes(1));
        let bricks = values.par_chunks_exact(4 * BRICK_VOXELS).zip(blocks.par_chunks_exact(4 * BLOCK_WORDS as usize));
        let brick = |(n, (values, block)): (usize, (&[u8], &[u8]))| {
            let mut own = Box::new([f32::INFINITY; BRICK_VOXELS]);
            let (mut any, mut doubts) = (0u64, 0u32);
            for (own, bytes) in own.iter_mut().zip(values.chunks_exact(4)) {
                let word = word(bytes);
                *own = f32::from_bits(word);
                any += u64::from(own.is_finite());
                doubts |= word & 1;
            }
            if any == 0 {
                return None;
            }
            counts.measured.fetch_add(any, Ordering::Relaxed);
            let base = IVec3::new(word(&block[..4]) as i32, word(&block[4..8]) as i32, word(&block[8..12]) as i32);
            if doubts != 0 {
                counts.doubtful.fetch_add(self.decide(features, n, base, &mut own), Ordering::Relaxed);
            }
            Some(Filled { brick: base / BRICK, values: own })
        };
        bricks.enumerate().filter_map(brick).collect()
    }

    /// Measures the doubtful voxels of brick number `n` again, and says how many there were.
    fn decide(&self, features: &Features, n: usize, base: IVec3, values: &mut [f32; BRICK_VOXELS]) -> u64 {
        let mut count = 0;
        for (k, value) in values.iter_mut().enumerate().filter(|(_, value)| value.to_bits() & 1 == 1) {
            count += 1;
            let voxel = voxel_in_brick(k);
            let half = voxel / (BRICK / 2);
            let octant = OCTANTS * n + (half.x + 2 * half.y + 4 * half.z) as usize;
            let list = match self.starts.get(octant..octant + 2) {
                Some(&[from, to]) => self.collected.get(from as usize..to as usize).unwrap_or_default(),
                _ => &[],
            };
            if let Some(signed) = self.picked.signed(features, base + voxel, list) {
                *value = signed as f32;
            }
        }
        count
    }
}

fn word(bytes: &[u8]) -> u32 {
    bytes.try_into().map_or(0, u32::from_le_bytes)
}
