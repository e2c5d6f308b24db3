//! Tiles, chunks, and errors.

use glam::DVec3;
use meshwright::gpu::{Device, GpuError, GpuLimits, GpuMethod, GpuOptions, Wanted, adapters, ldis};
use meshwright::mesh::TriMesh;
use meshwright::progress::{Progress, Stopped};

use crate::common::gpu::{BOTH, by, compare, device, on_gpu};
use crate::common::{shapes, stages};

#[test]
fn tiles_chunks_and_halved_tiles_change_nothing() {
    let Some(device) = device() else { return };
    let mesh = shapes::torus(40, 20);
    let lattice = stages::lattice_of(&mesh, 50);
    let all = [
        GpuLimits { tile_side: 13, ..GpuLimits::default() },
        GpuLimits { triangles: 17, tile_side: 64, ..GpuLimits::default() },
        GpuLimits { crossings: 100, ..GpuLimits::default() },
    ];
    for limits in all {
        let options = BOTH.map(|method| GpuOptions { limits, ..by(method) });
        compare(device, &format!("{limits:?}"), &mesh, &lattice, 1, &options);
    }
}

#[test]
fn a_ray_with_more_crossings_than_fit_is_an_error() {
    let Some(device) = device() else { return };
    let sheet = [DVec3::ZERO, DVec3::new(9.0, 0.0, 1.0), DVec3::new(0.0, 9.0, 1.0)];
    let mesh = TriMesh { positions: sheet.to_vec(), triangles: vec![[0, 1, 2]; 50] };
    let limits = GpuLimits { crossings: 49, ..GpuLimits::default() };
    let options = GpuOptions { limits, ..by(GpuMethod::Scatter) };
    let lattice = stages::lattice_of(&mesh, 8);
    let result = ldis(device, &mesh, &lattice, 1, &options, &Progress::none());
    assert_eq!(result.err(), Some(GpuError::TooLarge { crossings: 50, most: 49 }));
}

#[test]
fn rays_with_more_crossings_than_a_byte_tells_lose_none() {
    let Some(device) = device() else { return };
    let sheet = [DVec3::ZERO, DVec3::new(9.0, 0.0, 1.0), DVec3::new(0.0, 9.0, 1.0)];
    let lattice = stages::lattice_of(&TriMesh { positions: sheet.to_vec(), triangles: vec![[0, 1, 2]] }, 8);
    for count in [254, 255, 256, 300] {
        let mesh = TriMesh { positions: sheet.to_vec(), triangles: vec![[0, 1, 2]; count] };
        let whole = by(GpuMethod::Scatter);
        let limits = GpuLimits { tile_side: 5, crossings: 20_000, ..GpuLimits::default() };
        let layers = compare(device, "a sheet", &mesh, &lattice, 1, &[whole, GpuOptions { limits, ..whole }]);
        assert!(layers.iter().any(|layers| layers.deepest() == count));
    }
}

#[test]
fn an_adapter_that_does_not_exist_is_an_error_that_names_those_that_do() {
    let error = Device::open(&Wanted::Named("no such adapter".into())).err();
    let present = adapters().into_iter().map(|adapter| adapter.name).collect();
    assert_eq!(error, Some(GpuError::NoAdapter { wanted: "named `no such adapter`".into(), present }));
}

#[test]
fn a_set_flag_stops_between_directions() {
    let Some(device) = device() else { return };
    let mesh = shapes::torus(12, 8);
    let flag = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    let progress = Progress::none().with_flag(flag);
    for method in BOTH {
        let result = ldis(device, &mesh, &stages::lattice_of(&mesh, 16), 1, &by(method), &progress);
        assert_eq!(result.err(), Some(GpuError::Stopped(Stopped::Interrupted)));
    }
}

#[test]
fn what_moves_is_counted_and_passes_are_timed_where_the_adapter_can() {
    let Some(device) = device() else { return };
    let mesh = shapes::torus(24, 12);
    let lattice = stages::lattice_of(&mesh, 32);
    for (method, passes) in
        [(GpuMethod::Scatter, &["count", "pack", "scan", "scatter"][..]), (GpuMethod::Peel, &["peel", "set up"])]
    {
        let (layers, report) = on_gpu(device, &mesh, &lattice, 1, &GpuOptions { timings: true, ..by(method) });
        let crossings: usize = layers.iter().map(|layers| layers.hits.len()).sum();
        assert!(report.bytes_up >= 36 * mesh.triangles.len() as u64);
        assert!(report.bytes_down >= 4 * crossings as u64);
        if device.entry().timestamps {
            let names: Vec<_> = report.passes.iter().map(|pass| pass.pass).collect();
            assert_eq!(names, passes);
            // A pass for each direction, but for the sums, which are of all at once.
            let enough = |name: &str, count: usize| count >= if matches!(name, "scan" | "pack") { 1 } else { 13 };
            let sound = report.passes.iter().all(|pass| enough(pass.pass, pass.count) && pass.seconds > 0.0);
            assert!(sound && report.sent <= report.seconds, "{report:?}");
        }
        assert_eq!(on_gpu(device, &mesh, &lattice, 1, &by(method)).1.passes, []);
    }
}
