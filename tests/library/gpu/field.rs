//! The exact field by compute passes against that of the main processor.

use glam::{DVec3, IVec3};
use meshwright::gpu::{FieldLimits, FieldOptions, GpuError, distances};
use meshwright::lattice::Lattice;
use meshwright::ldi::Inside;
use meshwright::mesh::TriMesh;
use meshwright::progress::{Progress, Stopped};
use meshwright::sdf::Levels;
use meshwright::sdf::exact::{Band, ExactOptions, Sign};

use crate::common::exact::{Case, cases, lattice};
use crate::common::gpu::{check_field, check_fields, device};
use crate::common::{read, sample, shapes};

const DEFAULT: fn() -> FieldOptions = FieldOptions::default;

#[test]
fn the_field_of_hard_meshes_and_parts_is_the_exact_one() {
    let Some(device) = device() else { return };
    for Case { name, mesh, lattice, band } in cases() {
        check_field(device, name, (&mesh, &lattice), Sign::Pseudonormal, Band::Within(band), &DEFAULT());
    }
}

#[test]
fn few_voxels_of_closed_meshes_are_in_doubt() {
    let Some(device) = device() else { return };
    check_fields(device, "ball with a void", &read(&sample("hollow_ball.stl")));
    check_fields(device, "torus", &shapes::torus(96, 48));
    check_fields(device, "knot", &shapes::knot(96, 16));
    check_fields(device, "gear", &shapes::turned(shapes::gear(24), 0.3));
    check_fields(device, "saddle", &read(&sample("monkey_saddle.off")));
}

#[test]
fn bands_of_all_widths_are_filled() {
    let Some(device) = device() else { return };
    let mesh = shapes::turned(shapes::gear(24), 0.3);
    let near = lattice(&mesh, mesh.bounds().expect("triangles").size().max_element() / 50.0, 3);
    for band in [Band::Within(0.5), Band::Within(30.0), Band::Within(1e6), Band::Full] {
        check_field(device, &format!("{band:?}"), (&mesh, &near), Sign::Pseudonormal, band, &DEFAULT());
    }
}

#[test]
fn small_parts_change_nothing() {
    let Some(device) = device() else { return };
    let mesh = shapes::torus(40, 20);
    let around = lattice(&mesh, mesh.bounds().expect("triangles").size().max_element() / 70.0, 9);
    let field = |limits| {
        let options = FieldOptions { limits, ..DEFAULT() };
        let (sign, band) = (Sign::Pseudonormal, Band::Within(8.0));
        check_field(device, &format!("{limits:?}"), (&mesh, &around), sign, band, &options).field
    };
    let whole = field(FieldLimits::default());
    let all = [
        FieldLimits { bricks: 17, ..FieldLimits::default() },
        FieldLimits { entries: 4000, ..FieldLimits::default() },
        FieldLimits { words: 30_000, ..FieldLimits::default() },
    ];
    for limits in all {
        let parts = field(limits);
        assert_eq!(parts.grid.bricks.active(), whole.grid.bricks.active(), "{limits:?}");
        let apart = parts.grid.values.iter().flatten().zip(whole.grid.values.iter().flatten()).filter(|(a, b)| a != b);
        assert_eq!(apart.count(), 0, "{limits:?}");
    }
}

#[test]
fn sides_may_be_told_by_outlines() {
    let Some(device) = device() else { return };
    let mesh = shapes::torus(24, 12);
    let around = lattice(&mesh, 0.06, 5);
    let levels = Levels::of(&mesh, &around, Inside::Positive, &Progress::none()).expect("levels");
    check_field(device, "levels", (&mesh, &around), Sign::Levels(&levels), Band::Within(4.0), &DEFAULT());
}

#[test]
fn a_surface_that_reaches_far_beyond_the_lattice_has_its_distance() {
    let Some(device) = device() else { return };
    // A thin triangle from a million voxels away to a million on the other side.
    let mesh = shapes::cuboid(DVec3::new(-1e6, -1e6, 3.3), DVec3::new(1e6, 0.9e6, 17.2));
    let near = Lattice { origin: DVec3::ZERO, h: 1.0, dims: IVec3::splat(24) };
    check_field(device, "far", (&mesh, &near), Sign::Pseudonormal, Band::Within(9.0), &DEFAULT());
    let farther = shapes::cuboid(DVec3::splat(-1e9), DVec3::splat(3.0));
    let options = ExactOptions { band: Band::Within(3.0), max_memory: None };
    let found = distances(device, &farther, &near, Sign::Pseudonormal, (&options, &DEFAULT()), &Progress::none());
    assert!(matches!(found, Err(GpuError::Far { .. })), "{:?}", found.err());
}

#[test]
fn what_cannot_be_done_is_an_error() {
    let Some(device) = device() else { return };
    let near = Lattice { origin: DVec3::ZERO, h: 1.0, dims: IVec3::splat(9) };
    let options = ExactOptions { band: Band::Within(3.0), max_memory: None };
    let of = |mesh: &TriMesh, limits, exact: &ExactOptions, progress: &Progress| {
        let options = FieldOptions { limits, ..DEFAULT() };
        distances(device, mesh, &near, Sign::Pseudonormal, (exact, &options), progress).err()
    };
    let none = Progress::none();
    let empty = of(&TriMesh::default(), FieldLimits::default(), &options, &none);
    assert!(matches!(empty, Some(GpuError::Field(_))), "{empty:?}");
    let mesh = shapes::torus(12, 8);
    let little = of(&mesh, FieldLimits::default(), &ExactOptions { max_memory: Some(1000), ..options }, &none);
    assert!(matches!(little, Some(GpuError::Field(_))), "{little:?}");
    let crowded = of(&mesh, FieldLimits { entries: 3, ..FieldLimits::default() }, &options, &none);
    assert!(matches!(crowded, Some(GpuError::Crowded { most: 3, .. })), "{crowded:?}");
    let flag = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    let stopped = of(&mesh, FieldLimits::default(), &options, &Progress::none().with_flag(flag));
    assert_eq!(stopped, Some(GpuError::Stopped(Stopped::Interrupted)));
}

#[test]
fn passes_are_timed_where_the_adapter_can_and_runs_agree() {
    let Some(device) = device() else { return };
    let mesh = shapes::torus(24, 12);
    let around = lattice(&mesh, 0.06, 5);
    let options = ExactOptions { band: Band::Within(4.0), max_memory: None };
    let run = |timings| {
        let options = (&options, &FieldOptions { timings, ..DEFAULT() });
        distances(device, &mesh, &around, Sign::Pseudonormal, options, &Progress::none()).expect("a field")
    };
    let (timed, again) = (run(true), run(false));
    assert_eq!(again.report.passes, []);
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
    assert_eq!(bits(timed.field.grid.values.as_flattened()), bits(again.field.grid.values.as_flattened()));
    if device.entry().timestamps {
        for name in ["enlist", "judge", "measure", "scan", "share"] {
            let pass = timed.report.passes.iter().find(|pass| pass.pass == name);
            assert!(pass.is_some_and(|pass| pass.seconds > 0.0), "{name}: {:?}", timed.report.passes);
        }
    }
}
