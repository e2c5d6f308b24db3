//! One job on a device: what moves up and down, and how long passes take.

use super::clock::Clock;
use super::{Device, GpuError, PassTime};
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
}

impl<'a> Run<'a> {
    pub fn new(device: &'a Device, timings: bool, progress: &'a Progress) -> Self {
        Self { device, progress, clock: Clock::new(device, timings), up: 0, down: 0 }
    }

    /// Seconds of each kind of pass so far.
    pub fn passes(&self) -> Vec<PassTime> {
        self.clock.times()
    }

    /// A buffer with `words` in it.
    pub fn upload(&mut self, words: &[u32], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.buffer(words.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
        let bytes: &[u8] = bytemuck::cast_slice(words);
        self.device.queue.write_buffer(&buffer, 0, bytes);
        self.up += bytes.len() as u64;
        buffer
    }

    /// An empty buffer of `words` words.
    pub fn buffer(&self, words: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor =
            wgpu::BufferDescriptor { label: None, size: 4 * words.max(4), usage, mapped_at_creation: false };
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

    /// Submits the commands, waits for them, and reads back `sources`.
    pub fn finish(
        &mut self,
        mut encoder: wgpu::CommandEncoder,
        sources: &[Source<'_>],
    ) -> Result<Vec<Vec<u32>>, GpuError> {
        self.progress.check()?;
        let times = self.clock.resolve(&mut encoder);
        let (times, words) = times.map_or((None, 0), |(buffer, words)| (Some(buffer), words));
        let mut all: Vec<Source<'_>> = times.iter().map(|buffer| Source::Words(buffer, words)).collect();
        let own = all.len();
        all.extend(sources.iter().map(|source| match source {
            Source::Words(buffer, words) => Source::Words(buffer, *words),
            Source::Pixels(texture, size) => Source::Pixels(texture, *size),
        }));
        let mut read = self.read(encoder, &all)?;
        let rest = read.split_off(own);
        if let Some(times) = read.first() {
            self.clock.add(times);
        }
        self.down += rest.iter().map(|words| 4 * words.len() as u64).sum::<u64>();
        Ok(rest)
    }

    fn read(&self, mut encoder: wgpu::CommandEncoder, sources: &[Source<'_>]) -> Result<Vec<Vec<u32>>, GpuError> {
        // Textures are copied to multiples of their rows' alignment; nothing else asks for more.
        let align = u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT) / 4;
        let mut starts = vec![0u64];
        for source in sources {
            starts.push((starts[starts.len() - 1] + source.words()).next_multiple_of(align));
        }
        let total = starts[sources.len()];
        let most = self.device.entry().buffer_bytes;
        if 4 * total > most {
            return Err(GpuError::OutOfMemory);
        }
        let staging = self.buffer(total, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        for (source, &start) in sources.iter().zip(&starts) {
            match source {
                Source::Words(buffer, words) => {
                    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 4 * start, 4 * words)
                }
                Source::Pixels(texture, size) => encoder.copy_texture_to_buffer(
                    texture.as_image_copy(),
                    wgpu::TexelCopyBufferInfo {
                        buffer: &staging,
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
        self.device.queue.submit([encoder.finish()]);
        self.device.check()?;
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        self.device.wait()?;
        let lost = |e: wgpu::MapRangeError| GpuError::Lost { reason: e.to_string() };
        let view = staging.slice(..).get_mapped_range().map_err(lost)?;
        let take = |(source, &start): (&Source<'_>, &u64)| match source {
            Source::Words(_, words) => words_of(&view, start, *words),
            Source::Pixels(_, size) => {
                let row = |j| words_of(&view, start + j * source.stride(), u64::from(size[0]));
                (0..u64::from(size[1])).flat_map(row).collect()
            }
        };
        let read = sources.iter().zip(&starts).map(take).collect();
        self.device.check()?;
        Ok(read)
    }
}

fn words_of(bytes: &[u8], start: u64, words: u64) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&bytes[4 * start as usize..4 * (start + words) as usize])
}

fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 }
}
