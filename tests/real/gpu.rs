//! The graphics processor against the main one.

use meshwright::gpu::GpuMethod;

use crate::common::gpu::{BOTH, by, check_closed, check_fields, compare, device};
use crate::common::stages;
use crate::data;

#[test]
fn all_clean_meshes_have_the_same_crossings_in_all_directions() {
    let (Some(data), Some(device)) = (data(), device()) else { return };
    for (name, mesh) in data.clean() {
        check_closed(device, &name, &mesh);
    }
}

#[test]
fn the_open_bunny_has_the_same_crossings() {
    let (Some(data), Some(device)) = (data(), device()) else { return };
    let bunny = data.mesh("broken/stanford-bunny.obj");
    let lattice = stages::lattice_of(&bunny, 64);
    compare(device, "bunny", &bunny, &lattice, 1, &BOTH.map(by));
    compare(device, "bunny, twice", &bunny, &lattice, 2, &[by(GpuMethod::Peel)]);
}

/// What comes after the crossings is the same code, so that the solid is the same as well.
#[test]
fn open_and_broken_parts_have_the_same_crossings() {
    let (Some(data), Some(device)) = (data(), device()) else { return };
    for name in ["broken/wallhole.obj", "broken/octagonal_pocket.stl"] {
        let mesh = data.mesh(name);
        compare(device, name, &mesh, &stages::lattice_of(&mesh, 48), 1, &BOTH.map(by));
    }
}

#[test]
fn the_fields_of_closed_meshes_are_the_exact_ones() {
    let (Some(data), Some(device)) = (data(), device()) else { return };
    for (name, mesh) in data.clean() {
        check_fields(device, &name, &mesh);
    }
}

#[test]
fn the_field_of_the_open_bunny_is_the_exact_one() {
    let (Some(data), Some(device)) = (data(), device()) else { return };
    check_fields(device, "bunny", &data.mesh("broken/stanford-bunny.obj"));
}
