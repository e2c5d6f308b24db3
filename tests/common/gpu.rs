//! Layered depth images and exact fields of the graphics processor against those of the main one.

use std::sync::OnceLock;

use glam::IVec3;
use meshwright::gpu::{
    Device, FieldOptions, GpuError, GpuField, GpuMethod, GpuOptions, GpuReport, Wanted, distances, ldis,
};
use meshwright::lattice::{Lattice, Slot};
use meshwright::ldi::{self, Layers, Operands, balance};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions, Sign, exact};

use super::exact::lattice;
use super::fields::voxel;
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

/// The field of the graphics processor, compared with the exact one: distances to 1e-4 h, and the same side at every voxel, stored or not.
#[track_caller]
pub fn check_field(
    device: &Device,
    name: &str,
    (mesh, lattice): (&TriMesh, &Lattice),
    sign: Sign<'_>,
    band: Band,
    options: &FieldOptions,
) -> GpuField {
    let exact_options = ExactOptions { band, max_memory: None };
    let truth = exact(mesh, lattice, sign, &exact_options, &Progress::none()).expect("a field");
    let both = (&exact_options, options);
    let found =
        distances(device, mesh, lattice, sign, both, &Progress::none()).unwrap_or_else(|e| panic!("{name}: {e}"));
    let (mut most, mut wrong, mut stored) = (0.0f64, 0usize, 0usize);
    let end = (lattice.dims + 7) / 8;
    for n in 0..end.element_product() {
        let brick = IVec3::new(n % end.x, n / end.x % end.y, n / (end.x * end.y));
        if [&truth, &found.field].iter().all(|field| !matches!(field.grid.bricks.slot(brick), Slot::Active(_))) {
            wrong += usize::from(truth.grid.bricks.slot(brick) != found.field.grid.bricks.slot(brick));
            continue;
        }
        stored += 1;
        for k in 0..512 {
            let [a, b] = [&truth, &found.field].map(|field| f64::from(field.grid.get(voxel(brick, k))));
            most = most.max((a.abs() - b.abs()).abs() - 5e-7 * a.abs());
            wrong += usize::from((a < 0.0) != (b < 0.0));
        }
    }
    assert!(stored > 0 && most < 1e-4 && wrong == 0, "{name}: {most} h, {wrong} sides, {stored} bricks");
    assert!(found.measured > 0 && found.report.bytes_down >= 4 * found.measured && found.report.seconds > 0.0);
    found
}

/// Compares the fields of a closed mesh within a tenth of its size, at 64 and at 128 voxels.
#[track_caller]
pub fn check_fields(device: &Device, name: &str, mesh: &TriMesh) {
    let longest = mesh.bounds().expect("triangles").size().max_element();
    for (resolution, band) in [(64.0, 6.4), (128.0, 12.8)] {
        let lattice = lattice(mesh, longest / resolution, 13);
        let (sign, options) = (Sign::Pseudonormal, FieldOptions::default());
        let found = check_field(device, name, (mesh, &lattice), sign, Band::Within(band), &options);
        let (doubtful, measured) = (found.doubtful, found.measured);
        assert!(1000 * doubtful < measured, "{name}: {doubtful} of {measured} voxels are in doubt");
    }
}
