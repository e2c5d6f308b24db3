//! The shaders, put together from the files of `shaders/`.

use crate::ldi::SNAP_BITS;

const WIDE: &str = include_str!("../../shaders/wide.wgsl");
const TRIANGLE: &str = include_str!("../../shaders/triangle.wgsl");
const FEATURE: &str = include_str!("../../shaders/feature.wgsl");
const BLOCK: &str = include_str!("../../shaders/field_block.wgsl");
const DRAW: &str = include_str!("../../shaders/draw.wgsl");

/// Finding candidates.
pub(super) const SETUP: &[&str] = &[WIDE, TRIANGLE, include_str!("../../shaders/setup.wgsl")];
/// Depth peeling.
pub(super) const PEEL: &[&str] = &[WIDE, TRIANGLE, DRAW, include_str!("../../shaders/peel.wgsl")];
/// Counting and scattering crossings.
pub(super) const SCATTER: &[&str] = &[WIDE, TRIANGLE, include_str!("../../shaders/scatter.wgsl")];
/// Numbers of crossings as bytes.
pub(super) const PACK: &[&str] = &[include_str!("../../shaders/scatter_pack.wgsl")];
/// Sorting features into the blocks of a region.
pub(super) const ENLIST: &[&str] = &[WIDE, FEATURE, include_str!("../../shaders/field_enlist.wgsl")];
/// Blocks that have any feature, close together.
pub(super) const OPEN: &[&str] = &[BLOCK, include_str!("../../shaders/field_open.wgsl")];
/// Counts that are not 0.
pub(super) const MARK: &[&str] = &[include_str!("../../shaders/field_mark.wgsl")];
/// Which features matter to which children of blocks.
pub(super) const JUDGE: &[&str] = &[WIDE, FEATURE, BLOCK, include_str!("../../shaders/field_judge.wgsl")];
/// The lists of the children.
pub(super) const SHARE: &[&str] = &[BLOCK, include_str!("../../shaders/field_share.wgsl")];
/// Distances at voxels.
pub(super) const MEASURE: &[&str] = &[WIDE, FEATURE, BLOCK, include_str!("../../shaders/field_measure.wgsl")];
/// The lists of blocks in doubt.
pub(super) const COLLECT: &[&str] = &[BLOCK, include_str!("../../shaders/field_collect.wgsl")];
/// Sums of all before.
pub(super) const SCAN: &[&str] = &[include_str!("../../shaders/scan.wgsl")];
/// Integers of 64 bits, for tests.
#[cfg(test)]
pub(super) const CHECK_WIDE: &[&str] = &[WIDE, include_str!("../../shaders/check_wide.wgsl")];

/// How much larger than they are triangles are drawn, in rays: hardware rounds vertices to 1/16 of a pixel or finer, and
/// single precision is off by 1/128 at most where a triangle reaches far beyond the largest tile.
const MARGIN: f64 = 0.25;
/// Snapped depths are below this.
const DEPTH_RANGE: f64 = (1u64 << (SNAP_BITS + 13)) as f64;

/// The constants of the shader that finds candidates.
pub(super) const SETUP_CONSTANTS: &[(&str, f64)] = &[("margin", MARGIN)];
/// The constants of the peeling shader.
pub(super) const PEEL_CONSTANTS: &[(&str, f64)] = &[("depth_range", DEPTH_RANGE)];

/// A shader of several files.
pub(super) fn module(device: &wgpu::Device, parts: &[&str]) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(parts.concat().into()),
    })
}

/// One entry point of a compute shader.
pub(super) fn compute(
    device: &wgpu::Device,
    parts: &[&str],
    entry_point: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module(device, parts),
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}

/// The format of depths.
pub(super) const DEPTHS: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A depth test that keeps the nearest fragment, of equal ones the first one drawn.
pub(super) fn nearest() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTHS,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Less),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// A pipeline that draws triangles from buffers into one target with the fragments of `entry_point`.
pub(super) fn render(
    device: &wgpu::Device,
    parts: &[&str],
    entry_point: &str,
    constants: &[(&str, f64)],
    target: wgpu::ColorTargetState,
    depth_stencil: Option<wgpu::DepthStencilState>,
) -> wgpu::RenderPipeline {
    let module = module(device, parts);
    let options = wgpu::PipelineCompilationOptions { constants, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: options,
            targets: &[Some(target)],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga;

    const ALL: &[&[&str]] =
        &[SETUP, PEEL, SCATTER, PACK, ENLIST, OPEN, MARK, JUDGE, SHARE, MEASURE, COLLECT, SCAN, CHECK_WIDE];

    #[test]
    fn every_shader_is_valid() {
        for parts in ALL {
            let source = parts.concat();
            let module =
                naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
            let flags = naga::valid::ValidationFlags::all();
            naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
        }
    }

    #[test]
    fn every_file_of_the_shaders_folder_is_used() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");
        let used: String = ALL.concat().concat();
        for entry in std::fs::read_dir(folder).expect("the folder of shaders") {
            let path = entry.expect("an entry").path();
            let text = std::fs::read_to_string(&path).expect("a readable shader");
            assert!(used.contains(&text), "{} is not validated", path.display());
        }
    }
}
