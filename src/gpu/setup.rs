//! Finding the triangles that may cross the rays of a tile.

use super::programs::Setup;
use super::run::Run;
use super::scene::{Candidates, Chunk};

/// Triangles of a workgroup, as in the shader.
const WIDTH: u32 = 64;
/// The most workgroups along a side.
const SIDE: u32 = 32768;

impl Setup {
    /// Fills the chunks' candidates for one tile. `views`: the tile, for each chunk.
    pub fn encode(
        &self,
        run: &mut Run<'_>,
        encoder: &mut wgpu::CommandEncoder,
        (chunks, candidates): (&[Chunk], &[Candidates]),
        views: &[wgpu::Buffer],
    ) {
        let layout = self.pipeline.get_bind_group_layout(0);
        for ((chunk, found), view) in chunks.iter().zip(candidates).zip(views) {
            // The number of vertices, counted up by the shader.
            encoder.clear_buffer(&found.arguments, 0, Some(4));
            let buffers = [view, &chunk.corners, &found.candidates, &found.numbers, &found.arguments];
            let group = run.bind(&layout, &buffers.map(|buffer| buffer.as_entire_binding()));
            let timestamp_writes = run.clock.compute("set up");
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            let groups = chunk.count.div_ceil(WIDTH);
            pass.dispatch_workgroups(groups.min(SIDE), groups.div_ceil(SIDE), 1);
        }
    }
}
