//! The exact distance and its faster kin.

use meshwright::sdf::exact::Band;

use crate::common::exact::{
    check_characteristics, check_lattice, check_points, from_prisms, lattice, same_sides, threads_leave_levels_alone,
};
use crate::data;

#[test]
fn points_by_looking_at_all_triangles() {
    let Some(data) = data() else { return };
    for name in ["fandisk.off", "3holes.off", "decimated-knight.off", "quadknot.obj", "112932.stl"] {
        check_points(name, &data.mesh(&format!("clean/{name}")));
    }
}

#[test]
fn lattices_are_as_the_points() {
    let Some(data) = data() else { return };
    for (name, resolution) in [("fandisk.off", 60.0), ("88566.stl", 40.0), ("decimated-knight.off", 40.0)] {
        let mesh = data.mesh(&format!("clean/{name}"));
        let h = mesh.bounds().expect("triangles").size().max_element() / resolution;
        check_lattice(name, &mesh, &lattice(&mesh, h, 3), Band::Within(3.0));
    }
}

#[test]
fn characteristics_have_the_exact_field() {
    let Some(data) = data() else { return };
    for (name, band) in [("fandisk.off", 6.4), ("decimated-knight.off", 3.0)] {
        let mesh = data.mesh(&format!("clean/{name}"));
        let h = mesh.bounds().expect("triangles").size().max_element() / 64.0;
        let within = check_characteristics(name, &mesh, &lattice(&mesh, h, 7), Band::Within(band));
        assert!(within > 10_000, "{name}: {within}");
    }
}

#[test]
fn prisms_give_the_exact_field_of_a_knot_and_of_a_part_at_64_and_128() {
    let Some(data) = data() else { return };
    for name in ["quadknot.obj", "fandisk.off"] {
        let mesh = data.mesh(&format!("clean/{name}"));
        let longest = mesh.bounds().expect("triangles").size().max_element();
        for (resolution, band) in [(64.0, 6.4), (128.0, 12.8)] {
            let (most, wrong, count) = from_prisms(&mesh, &lattice(&mesh, longest / resolution, 13), band);
            assert!(most < 1e-4 && wrong == 0, "{name} {resolution}: {most} h, {wrong} of {count} sides");
        }
    }
}

#[test]
fn levels_have_the_sides_of_the_normals_and_threads_change_nothing() {
    let Some(data) = data() else { return };
    let knot = data.mesh("clean/quadknot.obj");
    let size = knot.bounds().expect("triangles").size().max_element();
    assert!(same_sides("quadknot", &knot, &lattice(&knot, size / 100.0, 3), Band::Within(3.0)) > 10_000);
    threads_leave_levels_alone(data.mesh("broken/camelhead.off"));
}
