//! Layered depth images by depth peeling (Bærentzen §3): one pass over the triangles for each layer.

use super::programs::{Peel, SLOTS};
use super::run::{Run, Source};
use super::scene::{self, Beam, Candidates, Chunk, Tile};
use super::{GpuError, GpuLimits, shaders};
use crate::ldi::Crossed;

/// Layers between two looks whether there are more. Even, because depths alternate between two textures.
const BATCH: usize = 4;
/// The most rays along a side of a tile: six textures of a word each.
const TILE_SIDE: u32 = 2048;

impl Peel {
    /// The crossings of all rays of a window.
    pub fn crossed(
        &self,
        run: &mut Run<'_>,
        chunks: &[Chunk],
        beam: Beam,
        (low, size): ([i32; 2], [i32; 2]),
        limits: &GpuLimits,
    ) -> Result<Vec<Crossed<'static>>, GpuError> {
        let side = run.device.entry().texture_side.min(TILE_SIDE).min(limits.tile_side);
        let tiles = Tile::of_window(low, size, side);
        let candidates = Candidates::of(run, chunks);
        tiles.into_iter().map(|tile| self.tile(run, (chunks, &candidates), beam, tile)).collect()
    }

    fn tile(
        &self,
        run: &mut Run<'_>,
        (chunks, candidates): (&[Chunk], &[Candidates]),
        beam: Beam,
        tile: Tile,
    ) -> Result<Crossed<'static>, GpuError> {
        let textures = Textures::new(run, tile.size);
        let views = beam.views(run, &tile, 0, chunks);
        let groups = self.groups(run, candidates, &views, &textures);
        let queries = run.device.raw.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Occlusion,
            count: BATCH as u32,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let passed = run.buffer(2 * BATCH as u64, usage);
        let mut layers: Vec<Vec<u32>> = Vec::new();
        let mut encoder = run.encoder();
        run.device.setup().encode(run, &mut encoder, (chunks, candidates), &views);
        textures.clear(&mut encoder);
        loop {
            for (k, groups) in groups.iter().enumerate() {
                let mut pass = textures.begin(run, &mut encoder, k, &queries);
                pass.begin_occlusion_query(k as u32);
                pass.set_pipeline(&self.pipeline);
                for (group, found) in groups.iter().zip(candidates) {
                    pass.set_bind_group(0, group, &[]);
                    pass.draw_indirect(&found.arguments, 0);
                }
                pass.end_occlusion_query();
            }
            encoder.resolve_query_set(&queries, 0..BATCH as u32, &passed, 0);
            let counts = run.finish(encoder, &[Source::Words(&passed, 2 * BATCH as u64)])?;
            let counts = counts.first().map_or(&[][..], Vec::as_slice);
            let filled = counts.chunks_exact(2).take_while(|count| count[0] | count[1] != 0).count();
            if filled > 0 {
                let sources: Vec<_> =
                    textures.slots[..filled].iter().map(|texture| Source::Pixels(texture, tile.size)).collect();
                layers.extend(run.finish(run.encoder(), &sources)?);
            }
            if filled < BATCH {
                let numbers = match layers.len() {
                    0 => Vec::new(),
                    _ => scene::numbers(run, candidates)?,
                };
                return Ok(gather(tile, &layers, &numbers));
            }
            encoder = run.encoder();
        }
    }

    /// What is bound for each layer of a batch, and each chunk.
    fn groups(
        &self,
        run: &mut Run<'_>,
        chunks: &[Candidates],
        views: &[wgpu::Buffer],
        textures: &Textures,
    ) -> Vec<Vec<wgpu::BindGroup>> {
        let layout = self.pipeline.get_bind_group_layout(0);
        let group = |k: usize, (found, view): (&Candidates, &wgpu::Buffer)| {
            let depths = view_of(&textures.depths[(k + 1) % 2]);
            let slots = view_of(&textures.slots[(k + BATCH - 1) % BATCH]);
            let textures = [&depths, &slots].map(wgpu::BindingResource::TextureView);
            let [depths, slots] = textures;
            run.bind(&layout, &[view.as_entire_binding(), found.candidates.as_entire_binding(), depths, slots])
        };
        (0..BATCH).map(|k| chunks.iter().zip(views).map(|both| group(k, both)).collect()).collect()
    }
}

/// The layers of a batch, and the depths of this layer and the one before.
struct Textures {
    slots: Vec<wgpu::Texture>,
    depths: Vec<wgpu::Texture>,
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

impl Textures {
    fn new(run: &Run<'_>, size: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let slot = |_| run.texture(size, SLOTS, usage | wgpu::TextureUsages::COPY_SRC);
        let depth = |_| run.texture(size, shaders::DEPTHS, usage);
        Self { slots: (0..BATCH).map(slot).collect(), depths: (0..2).map(depth).collect() }
    }

    /// Makes "the layer before the first": in front of everything.
    fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let (slots, depths) = (view_of(&self.slots[BATCH - 1]), view_of(&self.depths[1]));
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(colour(&slots))],
            depth_stencil_attachment: Some(depth(&depths, 0.0)),
            ..wgpu::RenderPassDescriptor::default()
        });
    }

    /// The pass of layer `k` of a batch.
    fn begin<'e>(
        &self,
        run: &mut Run<'_>,
        encoder: &'e mut wgpu::CommandEncoder,
        k: usize,
        queries: &wgpu::QuerySet,
    ) -> wgpu::RenderPass<'e> {
        let (slots, depths) = (view_of(&self.slots[k]), view_of(&self.depths[k % 2]));
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(colour(&slots))],
            depth_stencil_attachment: Some(depth(&depths, 1.0)),
            timestamp_writes: run.clock.render("peel"),
            occlusion_query_set: Some(queries),
            ..wgpu::RenderPassDescriptor::default()
        })
    }
}

fn colour(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
    }
}

fn depth(view: &wgpu::TextureView, cleared: f32) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(cleared), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

/// Puts the layers of each ray one behind the other. `numbers`: those of the triangles in the slots.
fn gather(tile: Tile, layers: &[Vec<u32>], numbers: &[u32]) -> Crossed<'static> {
    let rays = tile.rays() as usize;
    let (mut ends, mut triangles) = (Vec::with_capacity(rays), Vec::new());
    for ray in 0..rays {
        let on_ray = layers.iter().map(|layer| layer[ray]).take_while(|&slot| slot != 0);
        // A number beyond all is refused when the layers are assembled.
        triangles.extend(on_ray.map(|slot| numbers.get(slot as usize - 1).copied().unwrap_or(u32::MAX)));
        ends.push(triangles.len() as u32);
    }
    Crossed { low: tile.low, size: tile.size, first: 0, ends: ends.into(), triangles: triangles.into() }
}
