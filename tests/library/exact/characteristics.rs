//! Characteristics and scan conversion against the exact field.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, IVec3};
use meshwright::lattice::{Grid, Lattice};
use meshwright::mesh::TriMesh;
use meshwright::progress::{Progress, Stopped};
use meshwright::sdf::characteristics::{characteristics, cost};
use meshwright::sdf::exact::{Band, ExactError, ExactOptions};
use proptest::prelude::*;

use crate::common::exact::{Case, cases, check_characteristics, check_cut_lattices, lattice};
use crate::common::shapes::{ball, hard, turned};

fn options(band: Band) -> ExactOptions {
    ExactOptions { band, max_memory: None }
}

fn field(mesh: &TriMesh, lattice: &Lattice, band: Band) -> Grid<f32> {
    characteristics(mesh, lattice, &options(band), &Progress::none()).expect("a field").grid
}

#[test]
fn hard_meshes_and_parts_have_the_exact_field() {
    for Case { name, mesh, lattice, band } in cases() {
        let within = check_characteristics(name, &mesh, &lattice, Band::Within(band));
        assert!(within > 1000, "{name}: {within}");
    }
}

#[test]
fn bands_of_any_width_and_none() {
    let mesh = ball(3, |p| 0.5 + 0.1 * (7.0 * p.x).sin());
    let around = lattice(&mesh, 1.0 / 20.0, 5);
    let widths = [0.01, 1.0, 2.5, 9.0, 20.0, 400.0];
    let counts: Vec<usize> =
        widths.iter().map(|&h| check_characteristics("ball", &mesh, &around, Band::Within(h))).collect();
    assert!(counts.is_sorted() && counts[0] > 0, "{counts:?}");
    let all = check_characteristics("ball", &mesh, &around, Band::Full);
    assert_eq!(all, counts[5]);
}

#[test]
fn a_lattice_that_cuts_the_body_or_misses_it() {
    check_cut_lattices(check_characteristics, field);
}

#[test]
fn a_vast_lattice_costs_no_more_than_the_band() {
    let mesh = ball(2, |_| 1.0);
    let h = 0.05;
    let vast = Lattice { origin: DVec3::splat(-12_000.0 * h), h, dims: IVec3::splat(24_000) };
    let grid = field(&mesh, &vast, Band::Within(3.0));
    assert!(grid.bricks.len() <= 2 * field(&mesh, &lattice(&mesh, h, 6), Band::Within(3.0)).bricks.len());
    assert_eq!((grid.get(IVec3::splat(12_000)), grid.get(IVec3::splat(11_000))), (-3.0, 3.0));
}

/// Where edges bend by no more than numbers are rounded, and lie on planes of voxels, no voxel falls between two towers.
#[test]
fn nearly_flat_edges_leave_no_gap() {
    for bend in [0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6] {
        let tilt = |p: DVec3| p + DVec3::Z * if p.z > 0.0 { bend * (4.0 - p.x.abs() - p.y.abs()) } else { 0.0 };
        let mut mesh = ball(4, |p| 4.0 / (p.abs().max_element()));
        mesh.positions.iter_mut().for_each(|p| *p = tilt(*p));
        // Voxels lie on the ridges x = 0 and y = 0.
        let around = Lattice { origin: DVec3::splat(-10.0), h: 0.5, dims: IVec3::splat(41) };
        check_characteristics(&format!("bend of {bend}"), &mesh, &around, Band::Within(12.0));
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let mesh = hard().swap_remove(3).1;
    let around = lattice(&mesh, 1.0 / 40.0, 5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let grid = pool.install(|| field(&mesh, &around, Band::Within(12.0)));
        let bits: Vec<u32> = grid.values.iter().flatten().map(|value| value.to_bits()).collect();
        (grid.bricks, bits)
    };
    assert!(with(1) == with(3));
}

#[test]
fn what_cannot_be_is_refused() {
    let mesh = ball(2, |_| 1.0);
    let around = lattice(&mesh, 0.05, 3);
    let ask = |mesh: &TriMesh, lattice: &Lattice, band: Band, max_memory: Option<u64>| {
        characteristics(mesh, lattice, &ExactOptions { band, max_memory }, &Progress::none()).map(drop)
    };
    let band = Band::Within(3.0);
    assert_eq!(ask(&TriMesh::default(), &around, band, None), Err(ExactError::Empty));
    assert_eq!(ask(&mesh, &around, Band::Within(-1.0), None), Err(ExactError::Band(-1.0)));
    let none = Lattice { dims: IVec3::new(3, 0, 3), ..around };
    assert!(matches!(ask(&mesh, &none, band, None), Err(ExactError::Lattice { .. })));
    let needed = cost(&mesh, &around, band).memory;
    assert_eq!(ask(&mesh, &around, band, Some(needed)), Ok(()));
    let refused = Err(ExactError::Memory { needed, allowed: needed - 1 });
    assert_eq!(ask(&mesh, &around, band, Some(needed - 1)), refused);
    let stop = Progress::none().with_flag(Arc::new(AtomicBool::new(true)));
    let stopped = characteristics(&mesh, &around, &options(band), &stop).map(drop);
    assert_eq!(stopped, Err(ExactError::Stopped(Stopped::Interrupted)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Star-shaped bodies with random radii, down to spikes and slivers.
    #[test]
    fn random_stars_have_the_exact_field(
        radii in prop::collection::vec(prop_oneof![0.05..0.6f64, Just(0.4), 0.3..0.31f64], 66),
        angle in 0.0..6.0f64,
        h in 0.02..0.2f64,
        width in 1.0..20.0f64,
    ) {
        let mut mesh = ball(2, |_| 1.0);
        let radii = radii.iter().cycle().skip(1);
        mesh.positions.iter_mut().zip(radii).for_each(|(p, radius)| *p *= *radius);
        let mesh = turned(mesh, angle);
        check_characteristics("star", &mesh, &lattice(&mesh, h, 2), Band::Within(width));
    }
}

#[test]
fn nearly_flat_ridges_of_a_thin_plate() {
    let bend = 1e-8;
    let ridge = |z: f64| {
        let point = move |y: f64| [-4.3, 0.0, 4.3].map(|x: f64| DVec3::new(x, y, z + bend * (4.3 - x.abs())));
        [point(-4.3), point(4.3)]
    };
    let positions = [ridge(1e-6), ridge(0.0)].into_iter().flatten().flatten().collect();
    let mut triangles: Vec<[u32; 3]> = vec![[6, 0, 3], [6, 3, 9], [8, 5, 2], [8, 11, 5]];
    for k in 0..2 {
        triangles.extend([[k, k + 1, k + 4], [k, k + 4, k + 3], [6 + k, k + 10, k + 7], [6 + k, k + 9, k + 10]]);
        triangles.extend([[6 + k, k + 7, k + 1], [6 + k, k + 1, k], [9 + k, k + 4, k + 10], [9 + k, k + 3, k + 4]]);
    }
    let mesh = TriMesh { positions, triangles };
    let around = Lattice { origin: DVec3::splat(-10.0), h: 0.5, dims: IVec3::splat(41) };
    check_characteristics("plate", &mesh, &around, Band::Within(12.0));
}
