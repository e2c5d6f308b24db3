//! Meshes of every kind.

use meshwright::gpu::GpuMethod;

use crate::common::gpu::{BOTH, by, check_closed, compare, device};
use crate::common::{read, sample, shapes, stages};

#[test]
fn closed_meshes_have_the_same_crossings_in_all_directions() {
    let Some(device) = device() else { return };
    let mut meshes = shapes::hard();
    meshes.extend([("knot", shapes::knot(96, 16)), ("gear", shapes::gear(24)), ("stack", shapes::stack(0.2))]);
    meshes.extend(["torus.ply", "monkey_saddle.off", "hollow_ball.stl"].map(|name| (name, read(&sample(name)))));
    for (name, mesh) in meshes {
        check_closed(device, name, &mesh);
    }
}

#[test]
fn open_meshes_have_the_same_crossings() {
    let Some(device) = device() else { return };
    for (name, mesh) in [("scan", shapes::scan()), ("mug", read(&sample("broken_mug.obj")))] {
        for (resolution, methods) in [(64, &BOTH[..]), (128, &BOTH[..1])] {
            let lattice = stages::lattice_of(&mesh, resolution);
            let methods: Vec<_> = methods.iter().copied().map(by).collect();
            compare(device, &format!("{name} at {resolution}"), &mesh, &lattice, 1, &methods);
        }
        let lattice = stages::lattice_of(&mesh, 64);
        compare(device, &format!("{name}, twice"), &mesh, &lattice, 2, &[by(GpuMethod::Peel)]);
    }
}
