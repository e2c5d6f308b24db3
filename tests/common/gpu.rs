//! Layered depth images of the graphics processor against those of the main one.

use std::sync::OnceLock;

use meshwright::gpu::{Device, GpuError, GpuMethod, GpuOptions, GpuReport, Wanted, ldis};
use meshwright::lattice::Lattice;
use meshwright::ldi::{self, Layers, Operands, balance};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions, Sign, exact};
use meshwright::sdf::prism::prism;

use super::exact::lattice;
use super::fields::apart;
use super::stages;

/// The best adapter of this machine, opened once. Where there is none the test is left out, unless `MESHWRIGHT_GPU=required` says that there
/// must be one.
pub fn device() -> Option<&'static Device> {
    static DEVICE: OnceLock<Option<Device>> = OnceLock::new();
    let device = DEVICE.get_or_init(|| match Device::open(&Wanted::Any) {
        Ok(device) => Some(device),
        Err(GpuError::NoAdapter { .. }) if !required() => None,
        Err(error) => panic!("{error}: {}", error.hint()),
    });
    if device.is_none() {
        super::left_out("no graphics adapter was found");
    }
    device.as_ref()
}

fn required() -> bool {
    std::env::var_os("MESHWRIGHT_GPU").is_some_and(|value| value == "required")
}

pub fn by(method: GpuMethod) -> GpuOptions {
    GpuOptions { method, ..GpuOptions::default() }
}

pub const BOTH: [GpuMethod; 2] = [GpuMethod::Scatter, GpuMethod::Peel];

#[track_caller]
pub fn on_gpu(
    device: &Device,
    mesh: &TriMesh,
    lattice: &Lattice,
    factor: u32,
    options: &GpuOptions,
) -> (Vec<Layers>, GpuReport) {
    ldis(device, mesh, lattice, factor, options, &Progress::none()).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that every ray of every direction has the same crossings, bit by bit.
#[track_caller]
fn assert_equal(what: &str, cpu: &[Layers], gpu: &[Layers]) {
    assert_eq!(cpu.len(), gpu.len());
    for (direction, (cpu, gpu)) in cpu.iter().zip(gpu).enumerate() {
        assert_eq!((cpu.low, cpu.size, cpu.factor), (gpu.low, gpu.size, gpu.factor));
        for ray in 0..cpu.ray_count() {
            let bits = |layers: &Layers| -> Vec<(u64, u32, bool)> {
                layers.of(ray).iter().map(|hit| (hit.depth.to_bits(), hit.triangle(), hit.entering())).collect()
            };
            let same = cpu.of(ray).len() == gpu.of(ray).len() && bits(cpu) == bits(gpu);
            let place = cpu.indices(ray);
            assert!(same, "{what}, direction {direction}, ray {place:?}: {:?}, {:?}", cpu.of(ray), gpu.of(ray));
        }
    }
}

/// Compares the methods given with the main processor, and returns what that made.
#[track_caller]
pub fn compare(
    device: &Device,
    what: &str,
    mesh: &TriMesh,
    lattice: &Lattice,
    factor: u32,
    methods: &[GpuOptions],
) -> Vec<Layers> {
    let cpu = ldi::ldis(mesh, lattice, factor, &Progress::none()).expect("not stopped");
    for options in methods {
        let (gpu, _) = on_gpu(device, mesh, lattice, factor, options);
        assert_equal(&format!("{what}, {:?}", options.method), &cpu, &gpu);
    }
    cpu
}

/// Asserts that the crossings of a closed mesh are the same by both methods at 64 voxels, and by the default one at 128 and half a voxel
/// apart, and that they balance.
pub fn check_closed(device: &Device, name: &str, mesh: &TriMesh) {
    let operands = Operands::new([mesh.triangles.len()]);
    for (resolution, factor, methods) in [(64, 1, &BOTH[..]), (96, 1, &BOTH[..1]), (48, 2, &BOTH[..1])] {
        let lattice = stages::lattice_of(mesh, resolution);
        let methods: Vec<_> = methods.iter().copied().map(by).collect();
        let layers = compare(device, &format!("{name} at {resolution}"), mesh, &lattice, factor, &methods);
        for layers in layers {
            let balance = balance(&layers, &operands);
            assert!(balance.occupied > 0 && balance.unbalanced == 0, "{name}: {balance:?}");
        }
    }
}

/// Compares drawn prisms with the exact field and with their twin on the main processor.
pub fn check_prisms(device: &Device, name: &str, mesh: &TriMesh) {
    let longest = mesh.bounds().expect("triangles").size().max_element();
    for (resolution, band) in [(64.0, 6.4), (128.0, 12.8)] {
        let lattice = lattice(mesh, longest / resolution, 13);
        let options = ExactOptions { band: Band::Within(band), max_memory: None };
        let truth = exact(mesh, &lattice, Sign::Pseudonormal, &options, &Progress::none()).expect("a field");
        let (found, report) =
            meshwright::gpu::prism(device, mesh, &lattice, &options, false, &Progress::none()).expect("a field");
        let (most, wrong, count) = apart(&truth, &found, band);
        assert!(most < 1e-4 && wrong == 0, "{name} {resolution}: {most} h, {wrong} of {count} sides");
        assert!(report.bytes_down as f64 >= 4.0 * lattice.dims.as_dvec3().element_product());
        let twin = prism(mesh, &lattice, &options, &Progress::none()).expect("a field");
        let (most, wrong, _) = apart(&twin, &found, band);
        assert!(most < 3e-5 && wrong == 0, "{name} {resolution}: {most} h from the twin, {wrong} sides");
    }
}
