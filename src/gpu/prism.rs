//! Signed distance by scan conversion of prisms (Sigg et al. 2003): the twin on the graphics processor of [`crate::sdf::prism`].

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::run::{Run, Source};
use super::{Device, GpuError, GpuReport, shaders};
use crate::lattice::{BRICK, DistanceField, Lattice};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use crate::sdf::exact::{ExactOptions, Slab, Slabs};
use crate::sdf::prism::{Frustum, MOST_CORNERS, Prisms, Table, TriangleFrame};

/// Where nothing is drawn: beyond any band.
const NOTHING: f64 = 1e30;
const DISTANCES: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Vertices of one section: a fan.
const VERTICES: u32 = 3 * (MOST_CORNERS as u32 - 2);
/// Words of a frustum; its sections and the places in a slab's list take less.
const FRUSTUM_WORDS: u64 = 48;

/// The signed distance to `mesh`, a closed, oriented manifold, in h and negative inside: what
/// [`crate::sdf::prism::prism`] gives, but for rounding in single precision. The device holds the prisms and eight slices; what
/// is read back is the whole lattice, slab by slab.
pub fn prism(
    device: &Device,
    mesh: &TriMesh,
    lattice: &Lattice,
    options: &ExactOptions,
    timings: bool,
    progress: &Progress,
) -> Result<(DistanceField, GpuReport), GpuError> {
    let mut slabs = Slabs::new(mesh, lattice, options)?;
    let (band, end) = (slabs.band(), slabs.end());
    let size = [end.x as u32, end.y as u32];
    let most = device.entry().texture_side;
    if size[0].max(size[1]) > most {
        return Err(GpuError::Slice { size, most });
    }
    let prisms = Prisms::new(mesh, lattice, band);
    progress.check()?;
    let mut run = Run::new(device, timings, progress);
    let limit = device.entry().binding_bytes.min(device.entry().buffer_bytes) / (4 * FRUSTUM_WORDS);
    let pieces = prisms.frusta.chunks((limit as usize).max(1));
    let tables: Vec<Table> = pieces.clone().map(|frusta| Table::new(frusta, end.z)).collect();
    let chunks: Vec<Chunk> =
        pieces.zip(&tables).map(|(frusta, table)| Chunk::new(&mut run, &prisms.frames, frusta, table)).collect();
    let slices = Slices::new(&run, size, band as f32);
    let mut sweeps: Vec<_> = tables.iter().map(Table::sweep).collect();
    for low in (0..end.z).step_by(BRICK as usize) {
        let lists: Vec<Vec<Vec<u32>>> =
            sweeps.iter_mut().map(|sweep| sweep.by_ref().take(BRICK as usize).collect()).collect();
        let read = slices.draw(&mut run, &chunks, &lists, low)?;
        let mut slab = Slab::new(end, low);
        for (plane, words) in slab.planes().zip(read) {
            plane.iter_mut().zip(words).for_each(|(value, word)| *value = f32::from_bits(word));
        }
        slabs.add(&slab);
    }
    let field = slabs.finish(mesh, lattice, progress)?;
    Ok((field, GpuReport { bytes_up: run.up, bytes_down: run.down, passes: run.passes() }))
}

/// Some frusta, with the frames they are of, and their sections.
struct Chunk {
    frames: wgpu::Buffer,
    frusta: wgpu::Buffer,
    sections: wgpu::Buffer,
}

impl Chunk {
    fn new(run: &mut Run<'_>, frames: &[TriangleFrame], frusta: &[Frustum], table: &Table) -> Self {
        // Frusta are in the order of their frames.
        let first = frusta.first().map_or(0, |frustum| frustum.frame);
        let last = frusta.last().map_or(0, |frustum| frustum.frame + 1);
        let frames = &frames[first as usize..last as usize];
        let usage = wgpu::BufferUsages::STORAGE;
        let words: Vec<u32> = frames.par_iter().flat_map_iter(frame_words).collect();
        let frame_buffer = run.upload(&words, usage);
        let of = |frustum: &Frustum| {
            frustum_words(frustum, frustum.frame - first, &frames[(frustum.frame - first) as usize])
        };
        let words: Vec<u32> = frusta.par_iter().flat_map_iter(of).collect();
        let frustum_buffer = run.upload(&words, usage);
        let section = |section: &crate::sdf::prism::Section| {
            let word = |k: usize| u32::from_le_bytes(std::array::from_fn(|n| section.edges[4 * k + n]));
            [section.frustum, word(0), word(1)]
        };
        let words: Vec<u32> = table.sections().iter().flat_map(section).collect();
        Self { frames: frame_buffer, frusta: frustum_buffer, sections: run.upload(&words, usage) }
    }
}

fn frame_words(frame: &TriangleFrame) -> Vec<u32> {
    let bits = |v: Vec3| v.to_array().map(f32::to_bits);
    let [r, s, t] = frame.axes.map(bits);
    let [a, h, b] = frame.sizes.map(f32::to_bits);
    let base = frame.base.to_array().map(|x| x as u32);
    let rows = [(base, a), (bits(frame.origin), h), (r, b), (s, 0), (t, 0)];
    let normals = frame.normals.map(|normal| (bits(normal), 0));
    rows.into_iter().chain(normals).flat_map(|([x, y, z], w)| [x, y, z, w]).collect()
}

fn frustum_words(frustum: &Frustum, number: u32, frame: &TriangleFrame) -> Vec<u32> {
    let base: DVec3 = frame.base.as_dvec3();
    let from_base = frustum.corners.iter().map(|corner| (*corner - base).as_vec3().to_array().map(f32::to_bits));
    from_base.zip(std::iter::once(number).chain(std::iter::repeat(0))).flat_map(|([x, y, z], w)| [x, y, z, w]).collect()
}

/// The targets of eight slices, and the program.
struct Slices {
    pipeline: wgpu::RenderPipeline,
    distances: Vec<wgpu::Texture>,
    depth: wgpu::TextureView,
    size: [u32; 2],
}

impl Slices {
    fn new(run: &Run<'_>, size: [u32; 2], band: f32) -> Self {
        let target = wgpu::ColorTargetState { format: DISTANCES, blend: None, write_mask: wgpu::ColorWrites::ALL };
        let constants = [("band", f64::from(band))];
        let raw = &run.device.raw;
        let pipeline = shaders::render(raw, shaders::PRISM, "fragment", &constants, target, Some(shaders::nearest()));
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let distances = (0..BRICK).map(|_| run.texture(size, DISTANCES, usage)).collect();
        let depth = run.texture(size, shaders::DEPTHS, wgpu::TextureUsages::RENDER_ATTACHMENT);
        Self { pipeline, distances, depth: depth.create_view(&wgpu::TextureViewDescriptor::default()), size }
    }

    /// Slices `low` to `low` + 7, as the bits of their distances. `lists`: the active sections of each slice, for each chunk.
    fn draw(
        &self,
        run: &mut Run<'_>,
        chunks: &[Chunk],
        lists: &[Vec<Vec<u32>>],
        low: i32,
    ) -> Result<Vec<Vec<u32>>, GpuError> {
        let usage = wgpu::BufferUsages::STORAGE;
        let active: Vec<wgpu::Buffer> = lists.iter().map(|lists| run.upload(&lists.concat(), usage)).collect();
        let layout = self.pipeline.get_bind_group_layout(0);
        let mut encoder = run.encoder();
        let mut starts = vec![0u32; lists.len()];
        for (k, texture) in self.distances.iter().enumerate() {
            let mut groups = Vec::new();
            for ((chunk, active), start) in chunks.iter().zip(&active).zip(&starts) {
                let size = self.size.map(|side| (side as f32).to_bits());
                let view = run.upload(&[(low + k as i32) as u32, *start, size[0], size[1]], usage);
                let buffers = [&view, active, &chunk.sections, &chunk.frusta, &chunk.frames];
                groups.push(run.bind(&layout, &buffers.map(|buffer| buffer.as_entire_binding())));
            }
            let mut pass = self.begin(run, &mut encoder, texture);
            for ((group, lists), start) in groups.iter().zip(lists).zip(&mut starts) {
                let count = lists.get(k).map_or(0, |list| list.len() as u32);
                pass.set_bind_group(0, group, &[]);
                pass.draw(0..VERTICES, 0..count);
                *start += count;
            }
        }
        let sources: Vec<Source<'_>> = self.distances.iter().map(|t| Source::Pixels(t, self.size)).collect();
        run.finish(encoder, &sources)
    }

    fn begin<'e>(
        &self,
        run: &mut Run<'_>,
        encoder: &'e mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) -> wgpu::RenderPass<'e> {
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let clear = wgpu::Color { r: NOTHING, ..wgpu::Color::BLACK };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: run.clock.render("slice"),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass
    }
}
