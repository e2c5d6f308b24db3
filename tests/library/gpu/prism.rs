//! Prisms drawn by the graphics processor against the exact field, and against their twin on the main processor.

use glam::DVec3;
use meshwright::gpu;
use meshwright::lattice::Lattice;
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions, Sign, exact};
use meshwright::sdf::prism::prism;

use super::device;
use crate::common::{data_folder, fields, read, shapes};

fn around(mesh: &TriMesh, resolution: f64, room: i32) -> Lattice {
    let bounds = mesh.bounds().expect("triangles");
    let mut lattice = Lattice::around(&bounds, bounds.size().max_element() / resolution);
    lattice.origin -= DVec3::splat(f64::from(room) * lattice.h);
    lattice.dims += 2 * room;
    lattice
}

fn check(name: &str, mesh: &TriMesh) {
    for (resolution, band) in [(64.0, 6.4), (128.0, 12.8)] {
        let lattice = around(mesh, resolution, 13);
        let options = ExactOptions { band: Band::Within(band), max_memory: None };
        let truth = exact(mesh, &lattice, Sign::Pseudonormal, &options, &Progress::none()).expect("a field");
        let (found, report) =
            gpu::prism(device(), mesh, &lattice, &options, false, &Progress::none()).expect("a field");
        let (most, wrong, count) = fields::apart(&truth.grid, &found.grid, band);
        assert!(most < 1e-4 && wrong == 0, "{name} {resolution}: {most} h, {wrong} of {count} sides");
        assert!(report.bytes_down as f64 >= 4.0 * lattice.dims.as_dvec3().element_product());
        let twin = prism(mesh, &lattice, &options, &Progress::none()).expect("a field");
        let (most, wrong, _) = fields::apart(&twin.grid, &found.grid, band);
        assert!(most < 3e-5 && wrong == 0, "{name} {resolution}: {most} h from the twin, {wrong} sides");
    }
}

#[test]
fn drawn_prisms_give_the_exact_field() {
    check("ball with a void", &read(&crate::common::sample("hollow_ball.stl")));
    check("torus", &shapes::torus(96, 48));
    check("knot", &read(&data_folder().join("clean/quadknot.obj")));
    check("fandisk", &read(&data_folder().join("clean/fandisk.off")));
    check("saddle", &read(&crate::common::sample("monkey_saddle.off")));
}

#[test]
fn a_mesh_without_triangles_is_an_error() {
    let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: glam::IVec3::splat(9) };
    let options = ExactOptions { band: Band::Within(3.0), max_memory: None };
    let empty = gpu::prism(device(), &TriMesh::default(), &lattice, &options, false, &Progress::none());
    assert!(matches!(empty, Err(gpu::GpuError::Field(_))));
}
