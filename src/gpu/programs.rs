//! The shaders as pipelines. What is done with them stands beside each kind of job.

use super::shaders;

/// Slots of triangles on the rays, as peeling draws them.
pub(super) const SLOTS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// Finds the triangles that may cross the rays of a tile.
#[derive(Debug)]
pub(super) struct Setup {
    pub pipeline: wgpu::ComputePipeline,
}

impl Setup {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { pipeline: shaders::compute(device, shaders::SETUP, "set_up", shaders::SETUP_CONSTANTS) }
    }
}

/// Draws one layer.
#[derive(Debug)]
pub(super) struct Peel {
    pub pipeline: wgpu::RenderPipeline,
}

impl Peel {
    pub fn new(device: &wgpu::Device) -> Self {
        let target = wgpu::ColorTargetState { format: SLOTS, blend: None, write_mask: wgpu::ColorWrites::ALL };
        let constants = shaders::PEEL_CONSTANTS;
        Self { pipeline: shaders::render(device, shaders::PEEL, "peel", constants, target, Some(shaders::nearest())) }
    }
}

/// Counts the crossings of each ray, and writes them.
#[derive(Debug)]
pub(super) struct Scatter {
    pub count: wgpu::ComputePipeline,
    pub scatter: wgpu::ComputePipeline,
    pub pack: wgpu::ComputePipeline,
    pub scan: Scan,
}

impl Scatter {
    pub fn new(device: &wgpu::Device) -> Self {
        let pipeline = |entry| shaders::compute(device, shaders::SCATTER, entry, &[]);
        let pack = shaders::compute(device, shaders::PACK, "pack", &[]);
        Self { count: pipeline("count"), scatter: pipeline("scatter"), pack, scan: Scan::new(device) }
    }
}

/// The two passes of a sum of all before.
#[derive(Debug)]
pub(super) struct Scan {
    pub sum_blocks: wgpu::ComputePipeline,
    pub raise_blocks: wgpu::ComputePipeline,
}

impl Scan {
    fn new(device: &wgpu::Device) -> Self {
        let pipeline = |entry| shaders::compute(device, shaders::SCAN, entry, &[]);
        Self { sum_blocks: pipeline("sum_blocks"), raise_blocks: pipeline("raise_blocks") }
    }
}

/// Distances over a lattice.
#[derive(Debug)]
pub(super) struct Field {
    pub count: wgpu::ComputePipeline,
    pub enlist: wgpu::ComputePipeline,
    pub open: wgpu::ComputePipeline,
    pub mark: wgpu::ComputePipeline,
    pub judge: wgpu::ComputePipeline,
    pub share: wgpu::ComputePipeline,
    pub measure: wgpu::ComputePipeline,
    pub collect: wgpu::ComputePipeline,
    pub scan: Scan,
}

impl Field {
    pub fn new(device: &wgpu::Device) -> Self {
        let pipeline = |parts, entry| shaders::compute(device, parts, entry, &[]);
        Self {
            count: pipeline(shaders::ENLIST, "count"),
            enlist: pipeline(shaders::ENLIST, "enlist"),
            open: pipeline(shaders::OPEN, "open"),
            mark: pipeline(shaders::MARK, "mark"),
            judge: pipeline(shaders::JUDGE, "judge"),
            share: pipeline(shaders::SHARE, "share"),
            measure: pipeline(shaders::MEASURE, "measure"),
            collect: pipeline(shaders::COLLECT, "collect"),
            scan: Scan::new(device),
        }
    }
}
