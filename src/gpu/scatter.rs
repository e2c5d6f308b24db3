//! Layered depth images by counting, a scan, and scattering: every triangle is drawn twice, whatever the depth.

use super::programs::{Scatter, TARGET};
use super::run::{Run, Source};
use super::scene::{Beam, Chunk, Tile};
use super::{GpuError, GpuLimits};
use crate::ldi::Crossed;

/// The most rays along a side of a tile.
const TILE_SIDE: u32 = 4096;

impl Scatter {
    /// The crossings of all rays of a window.
    pub fn crossed(
        &self,
        run: &mut Run<'_>,
        chunks: &[Chunk],
        beam: Beam,
        (low, size): ([i32; 2], [i32; 2]),
        limits: &GpuLimits,
    ) -> Result<Vec<Crossed>, GpuError> {
        let entry = run.device.entry();
        let words = entry.binding_bytes.min(entry.buffer_bytes) / 4;
        let side = entry.texture_side.min(TILE_SIDE).min(words.isqrt() as u32).min(limits.tile_side);
        // What is read back goes through one buffer.
        let most = words.min(entry.buffer_bytes / 8).min(u64::from(limits.crossings));
        let mut rest = Tile::of_window(low, size, side);
        let mut found = Vec::new();
        while let Some(tile) = rest.pop() {
            let views = beam.views(run, &tile, chunks);
            let pass = Pass { scatter: self, chunks, views: &views, tile, target: target(run, tile) };
            let (cursor, crossings) = pass.count(run)?;
            if crossings <= most {
                found.push(pass.scatter(run, &cursor, crossings)?);
            } else {
                rest.extend(tile.halves().ok_or(GpuError::TooLarge { crossings, most })?);
            }
        }
        Ok(found)
    }
}

fn target(run: &Run<'_>, tile: Tile) -> wgpu::TextureView {
    let texture = run.texture(tile.size, TARGET, wgpu::TextureUsages::RENDER_ATTACHMENT);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// One tile.
struct Pass<'a> {
    scatter: &'a Scatter,
    chunks: &'a [Chunk],
    views: &'a [wgpu::Buffer],
    tile: Tile,
    target: wgpu::TextureView,
}

impl Pass<'_> {
    /// Where each ray's crossings begin, and how many there are in all.
    fn count(&self, run: &mut Run<'_>) -> Result<(wgpu::Buffer, u64), GpuError> {
        let rays = self.tile.rays();
        let cursor = run.buffer(rays, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let mut encoder = run.encoder();
        run.device.setup().encode(run, &mut encoder, self.chunks, self.views);
        self.draw(run, &mut encoder, "count", &self.scatter.count, &[&cursor]);
        let total = self.scatter.scan.encode(run, &mut encoder, &cursor, rays);
        let read = run.finish(encoder, &[Source::Words(&total, 1)])?;
        Ok((cursor, read.first().and_then(|words| words.first()).copied().unwrap_or(0).into()))
    }

    /// Writes the crossings; the cursors then stand at the ends of the rays.
    fn scatter(&self, run: &mut Run<'_>, cursor: &wgpu::Buffer, crossings: u64) -> Result<Crossed, GpuError> {
        let mut crossed = Crossed {
            low: self.tile.low,
            size: self.tile.size,
            ends: vec![0; self.tile.rays() as usize],
            triangles: Vec::new(),
        };
        if crossings == 0 {
            return Ok(crossed);
        }
        let triangles = run.buffer(crossings, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let mut encoder = run.encoder();
        self.draw(run, &mut encoder, "scatter", &self.scatter.scatter, &[cursor, &triangles]);
        let sources = [Source::Words(cursor, self.tile.rays()), Source::Words(&triangles, crossings)];
        let mut read = run.finish(encoder, &sources)?.into_iter();
        if let (Some(ends), Some(triangles)) = (read.next(), read.next()) {
            (crossed.ends, crossed.triangles) = (ends, triangles);
        }
        Ok(crossed)
    }

    fn draw(
        &self,
        run: &mut Run<'_>,
        encoder: &mut wgpu::CommandEncoder,
        name: &'static str,
        pipeline: &wgpu::RenderPipeline,
        written: &[&wgpu::Buffer],
    ) {
        let layout = pipeline.get_bind_group_layout(0);
        let mut groups = Vec::new();
        for (chunk, view) in self.chunks.iter().zip(self.views) {
            let buffers = [view, &chunk.candidates];
            let all: Vec<_> = buffers.iter().chain(written).map(|buffer| buffer.as_entire_binding()).collect();
            groups.push(run.bind(&layout, &all));
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Discard },
            })],
            timestamp_writes: run.clock.render(name),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(pipeline);
        for (group, chunk) in groups.iter().zip(self.chunks) {
            pass.set_bind_group(0, group, &[]);
            pass.draw_indirect(&chunk.arguments, 0);
        }
    }
}
