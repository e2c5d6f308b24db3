//! Sums of all before, in place.

use super::programs::Scan;
use super::run::Run;

/// Values that a workgroup sums: as in the shader.
const BLOCK: u64 = 1024;

/// One level: values, sums of their blocks, and how many there are.
struct Level {
    values: wgpu::Buffer,
    sums: wgpu::Buffer,
    blocks: u64,
    uniform: wgpu::Buffer,
}

impl Scan {
    /// Replaces each of the first `count` values (at most 2²⁶) by the sum of those before it; the result's first word will
    /// be the sum of all.
    pub fn encode(
        &self,
        run: &mut Run<'_>,
        encoder: &mut wgpu::CommandEncoder,
        values: &wgpu::Buffer,
        count: u64,
    ) -> wgpu::Buffer {
        let mut levels: Vec<Level> = Vec::new();
        let (mut values, mut count) = (values.clone(), count);
        loop {
            let blocks = count.div_ceil(BLOCK).max(1);
            let sums = run.buffer(blocks, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
            let uniform = run.upload(&[count as u32, 0, 0, 0], wgpu::BufferUsages::UNIFORM);
            levels.push(Level { values, sums: sums.clone(), blocks, uniform });
            if blocks == 1 {
                break;
            }
            (values, count) = (sums, blocks);
        }
        for level in &levels {
            Self::pass(run, encoder, &self.sum_blocks, level);
        }
        for level in levels.iter().rev().skip(1) {
            Self::pass(run, encoder, &self.raise_blocks, level);
        }
        levels[levels.len() - 1].sums.clone()
    }

    fn pass(run: &mut Run<'_>, encoder: &mut wgpu::CommandEncoder, pipeline: &wgpu::ComputePipeline, level: &Level) {
        let buffers = [&level.values, &level.sums, &level.uniform];
        let group = run.bind(&pipeline.get_bind_group_layout(0), &buffers.map(|buffer| buffer.as_entire_binding()));
        let timestamp_writes = run.clock.compute("scan");
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(level.blocks as u32, 1, 1);
    }
}
