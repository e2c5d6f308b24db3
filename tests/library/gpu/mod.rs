//! Layered depth images of the graphics processor against those of the main one. Needs a Vulkan driver; a software one does.

mod equal;
mod limits;
mod prism;
mod process;
mod soups;

use std::sync::OnceLock;

use meshwright::gpu::{Device, GpuMethod, GpuOptions, GpuReport, Wanted, ldis};
use meshwright::lattice::Lattice;
use meshwright::ldi::{self, Layers};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;

/// The best adapter of this machine, opened once.
fn device() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| Device::open(&Wanted::Any).unwrap_or_else(|e| panic!("{e}: {}", e.hint())))
}

fn by(method: GpuMethod) -> GpuOptions {
    GpuOptions { method, ..GpuOptions::default() }
}

const BOTH: [GpuMethod; 2] = [GpuMethod::Scatter, GpuMethod::Peel];

#[track_caller]
fn on_gpu(mesh: &TriMesh, lattice: &Lattice, factor: u32, options: &GpuOptions) -> (Vec<Layers>, GpuReport) {
    ldis(device(), mesh, lattice, factor, options, &Progress::none()).unwrap_or_else(|e| panic!("{e}"))
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

/// Compares both methods, or those given, with the main processor, and returns what that made.
#[track_caller]
fn compare(what: &str, mesh: &TriMesh, lattice: &Lattice, factor: u32, methods: &[GpuOptions]) -> Vec<Layers> {
    let cpu = ldi::ldis(mesh, lattice, factor, &Progress::none()).expect("not stopped");
    for options in methods {
        let (gpu, _) = on_gpu(mesh, lattice, factor, options);
        assert_equal(&format!("{what}, {:?}", options.method), &cpu, &gpu);
    }
    cpu
}
