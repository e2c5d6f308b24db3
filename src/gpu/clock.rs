//! Seconds of passes, by timestamp queries.

use std::collections::BTreeMap;

use super::{Device, PassTime};

/// The most passes between two looks.
const MOST: u32 = 128;

/// Times passes, where that is asked for and the adapter can.
pub(super) struct Clock {
    queries: Option<wgpu::QuerySet>,
    resolved: Option<wgpu::Buffer>,
    /// Nanoseconds a tick.
    period: f64,
    /// Passes since the last look.
    pending: Vec<&'static str>,
    sums: BTreeMap<&'static str, PassTime>,
}

impl Clock {
    pub fn new(device: &Device, timings: bool) -> Self {
        let wanted = timings && device.entry().timestamps;
        let queries = wanted.then(|| {
            device.raw.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MOST,
            })
        });
        let resolved = wanted.then(|| {
            device.raw.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(2 * MOST) * 8,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        });
        let period = f64::from(device.queue.get_timestamp_period());
        Self { queries, resolved, period, pending: Vec::new(), sums: BTreeMap::new() }
    }

    /// What a render pass called `name` must be given.
    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, [first, last]) = self.next(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(last),
        })
    }

    /// What a compute pass called `name` must be given.
    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, [first, last]) = self.next(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(last),
        })
    }

    fn next(&mut self, name: &'static str) -> Option<(&wgpu::QuerySet, [u32; 2])> {
        let queries = self.queries.as_ref()?;
        let n = self.pending.len() as u32;
        if n == MOST {
            return None;
        }
        self.pending.push(name);
        Some((queries, [2 * n, 2 * n + 1]))
    }

    /// Writes the pending times to a buffer: that, and the names of the passes.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) -> Option<(wgpu::Buffer, Vec<&'static str>)> {
        let (queries, resolved) = (self.queries.as_ref()?, self.resolved.as_ref()?);
        let names = std::mem::take(&mut self.pending);
        if names.is_empty() {
            return None;
        }
        encoder.resolve_query_set(queries, 0..2 * names.len() as u32, resolved, 0);
        Some((resolved.clone(), names))
    }

    /// Adds up times that were resolved: four words a pass.
    pub fn add(&mut self, names: &[&'static str], words: &[u32]) {
        let tick = |words: &[u32]| u64::from(words[1]) << 32 | u64::from(words[0]);
        for (&name, times) in names.iter().zip(words.chunks_exact(4)) {
            let ticks = tick(&times[2..]).saturating_sub(tick(&times[..2]));
            let sum = self.sums.entry(name).or_insert(PassTime { pass: name, count: 0, seconds: 0.0 });
            sum.count += 1;
            sum.seconds += ticks as f64 * self.period * 1e-9;
        }
    }

    pub fn times(&self) -> Vec<PassTime> {
        self.sums.values().cloned().collect()
    }
}
