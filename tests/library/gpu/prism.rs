//! Prisms drawn by the graphics processor against the exact field, and against their twin on the main processor.

use glam::DVec3;
use meshwright::gpu;
use meshwright::lattice::Lattice;
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions};

use crate::common::gpu::{check_prisms, device};
use crate::common::{read, sample, shapes};

#[test]
fn drawn_prisms_give_the_exact_field() {
    let Some(device) = device() else { return };
    check_prisms(device, "ball with a void", &read(&sample("hollow_ball.stl")));
    check_prisms(device, "torus", &shapes::torus(96, 48));
    check_prisms(device, "knot", &shapes::knot(96, 16));
    check_prisms(device, "gear", &shapes::turned(shapes::gear(24), 0.3));
    check_prisms(device, "saddle", &read(&sample("monkey_saddle.off")));
}

#[test]
fn a_mesh_without_triangles_is_an_error() {
    let Some(device) = device() else { return };
    let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: glam::IVec3::splat(9) };
    let options = ExactOptions { band: Band::Within(3.0), max_memory: None };
    let empty = gpu::prism(device, &TriMesh::default(), &lattice, &options, false, &Progress::none());
    assert!(matches!(empty, Err(gpu::GpuError::Field(_))));
}
