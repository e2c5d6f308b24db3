//! One job on a device: what moves up and down, and how long passes take.

use std::time::Instant;

use super::clock::Clock;
use super::{Device, GpuError, GpuReport};
use crate::progress::Progress;

/// A job.
pub(super) struct Run<'a> {
    pub device: &'a Device,
    pub progress: &'a Progress,
    pub clock: Clock,
    /// Bytes sent to the device.
    pub up: u64,
    /// Bytes read back.
    pub down: u64,
    begun: Instant,
    /// When something came back last.
    received: Instant,
}

/// What is read back.
pub(super) enum Source<'a> {
    /// The first words of a buffer.
    Words(&'a wgpu::Buffer, u64),
    /// All pixels, one word each, of a texture of this many rows and columns.
    Pixels(&'a wgpu::Texture, [u32; 2]),
}

impl Source<'_> {
    /// Words a row in the buffer it is copied to.
    fn stride(&self) -> u64 {
        match self {
            Self::Words(_, words) => *words,
            Self::Pixels(_, size) => u64::from(size[0].next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4)),
        }
    }

    fn words(&self) -> u64 {
        match self {
            Self::Words(_, words) => *words,
            Self::Pixels(_, size) => self.stride() * u64::from(size[1]),
        }
    }

    fn shape(&self) -> Shape {
        match self {
            Self::Words(_, words) => Shape::Words(*words),
            Self::Pixels(_, size) => Shape::Pixels { size: *size, stride: self.stride() },
        }
    }
}

impl<'a> Run<'a> {
    pub fn new(device: &'a Device, timings: bool, progress: &'a Progress) -> Self {
        let begun = Instant::now();
        Self { device, progress, clock: Clock::new(device, timings), up: 0, down: 0, begun, received: begun }
    }

    /// A buffer with `words` in it.
    pub fn upload(&mut self, words: &[u32], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.buffer(words.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
        let bytes: &[u8] = bytemuck::cast_slice(words);
        self.device.queue.write_buffer(&buffer, 0, bytes);
        self.up += bytes.len() as u64;
        buffer
    }

    /// An empty buffer of `words` words, or of the few that the smallest thing in a shader takes.
    pub fn buffer(&self, words: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor =
            wgpu::BufferDescriptor { label: None, size: 4 * words.max(8), usage, mapped_at_creation: false };
        self.device.raw.create_buffer(&descriptor)
    }

    /// A texture of one word, or one byte, a pixel.
    pub fn texture(&self, size: [u32; 2], format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
        self.device.raw.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// The bindings 0, 1, ... of a pipeline's only group.
    pub fn bind(&self, layout: &wgpu::BindGroupLayout, bindings: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = bindings
            .iter()
            .enumerate()
            .map(|(n, resource)| wgpu::BindGroupEntry { binding: n as u32, resource: resource.clone() })
            .collect();
        self.device.raw.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// Submits commands of which nothing is read back yet; their times come with the next that are.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.progress.check()?;
        self.device.queue.submit([encoder.finish()]);
        self.device.check()
    }

    /// What was moved, and how long all has taken.
    pub fn report(&self) -> GpuReport {
        GpuReport {
            bytes_up: self.up,
            bytes_down: self.down,
            passes: self.clock.times(),
            seconds: self.begun.elapsed().as_secs_f64(),
            sent: self.received.duration_since(self.begun).as_secs_f64(),
        }
    }

    /// Submits the commands, waits for them, and reads back `sources`.
    pub fn finish(&mut self, encoder: wgpu::CommandEncoder, sources: &[Source<'_>]) -> Result<Vec<Vec<u32>>, GpuError> {
        let sent = self.send(encoder, sources)?;
        self.device.wait()?;
        let received = self.receive(&sent)?;
        let read = (0..sources.len()).map(|n| received.words(n)).collect();
        self.device.check()?;
        Ok(read)
    }

    /// Submits the commands, and has `sources` copied to memory that can be read after the next wait.
    pub fn send(&mut self, mut encoder: wgpu::CommandEncoder, sources: &[Source<'_>]) -> Result<Sent, GpuError> {
        self.progress.check()?;
        let times = self.clock.resolve(&mut encoder);
        let (times, names) = times.map_or((None, Vec::new()), |(buffer, names)| (Some(buffer), names));
        // Textures are copied to multiples of their rows' alignment; nothing else asks for more.
        let align = u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT) / 4;
        let mut next = 0u64;
        let mut place = |source: &Source<'_>| {
            let place = Place { start: next, source: source.shape() };
            next = (next + source.words()).next_multiple_of(align);
            place
        };
        let places: Vec<Place> = sources.iter().map(&mut place).collect();
        let times = times.map(|buffer| (place(&Source::Words(&buffer, 4 * names.len() as u64)), buffer));
        if 4 * next > self.device.entry().buffer_bytes {
            return Err(GpuError::OutOfMemory);
        }
        let staging = self.buffer(next, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        for (source, place) in sources.iter().zip(&places) {
            copy(&mut encoder, source, &staging, place.start);
        }
        if let Some((place, buffer)) = &times {
            copy(&mut encoder, &Source::Words(buffer, 4 * names.len() as u64), &staging, place.start);
        }
        self.device.queue.submit([encoder.finish()]);
        self.device.check()?;
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        Ok(Sent { staging, places, times: times.map(|(place, _)| (place, names)) })
    }

    /// What was sent, once the device has been waited for.
    pub fn receive(&mut self, sent: &Sent) -> Result<Received, GpuError> {
        self.received = Instant::now();
        let lost = |e: wgpu::MapRangeError| GpuError::Lost { reason: e.to_string() };
        let view = sent.staging.slice(..).get_mapped_range().map_err(lost)?;
        if let Some((place, names)) = &sent.times {
            self.clock.add(names, &words_of(&view, place.start, 4 * names.len() as u64));
        }
        self.down += sent.places.iter().map(|place| 4 * place.source.words()).sum::<u64>();
        Ok(Received { view, places: sent.places.clone() })
    }
}

/// What is on its way back.
pub(super) struct Sent {
    staging: wgpu::Buffer,
    places: Vec<Place>,
    times: Option<(Place, Vec<&'static str>)>,
}

/// Words in a buffer that is read.
#[derive(Debug, Clone, Copy)]
struct Place {
    start: u64,
    source: Shape,
}

/// Words one behind the other, or rows that are `stride` words apart.
#[derive(Debug, Clone, Copy)]
enum Shape {
    Words(u64),
    Pixels { size: [u32; 2], stride: u64 },
}

impl Shape {
    fn words(self) -> u64 {
        match self {
            Self::Words(words) => words,
            Self::Pixels { size, .. } => u64::from(size[0]) * u64::from(size[1]),
        }
    }
}

/// What has come back, in memory that the device wrote.
pub(super) struct Received {
    view: wgpu::BufferView,
    places: Vec<Place>,
}

impl Received {
    /// The words of source number `n`.
    pub fn words(&self, n: usize) -> Vec<u32> {
        let Place { start, source } = self.places[n];
        match source {
            Shape::Words(words) => words_of(&self.view, start, words),
            Shape::Pixels { size, stride } => {
                let row = |j| words_of(&self.view, start + j * stride, u64::from(size[0]));
                (0..u64::from(size[1])).flat_map(row).collect()
            }
        }
    }

    /// The bytes of source number `n`, where that is a buffer.
    pub fn bytes(&self, n: usize) -> &[u8] {
        let Place { start, source } = self.places[n];
        &self.view[4 * start as usize..4 * (start + source.words()) as usize]
    }
}

fn copy(encoder: &mut wgpu::CommandEncoder, source: &Source<'_>, staging: &wgpu::Buffer, start: u64) {
    match source {
        Source::Words(buffer, words) => encoder.copy_buffer_to_buffer(buffer, 0, staging, 4 * start, 4 * words),
        Source::Pixels(texture, size) => encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 4 * start,
                    bytes_per_row: Some(4 * source.stride() as u32),
                    rows_per_image: None,
                },
            },
            extent(*size),
        ),
    }
}

fn words_of(bytes: &[u8], start: u64, words: u64) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&bytes[4 * start as usize..4 * (start + words) as usize])
}

fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 }
}

/// The most workgroups along a side.
pub(super) const SIDE: u32 = 32768;

/// One pass of so many workgroups.
pub(super) fn pass(
    run: &mut Run<'_>,
    encoder: &mut wgpu::CommandEncoder,
    name: &'static str,
    pipeline: &wgpu::ComputePipeline,
    buffers: &[&wgpu::Buffer],
    groups: u64,
) {
    let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
    let group = run.bind(&pipeline.get_bind_group_layout(0), &resources);
    let timestamp_writes = run.clock.compute(name);
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    let side = u64::from(SIDE);
    pass.dispatch_workgroups(groups.min(side) as u32, groups.div_ceil(side) as u32, 1);
}
