//! Over lattices.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, IVec3};
use meshwright::lattice::{Grid, Lattice};
use meshwright::mesh::TriMesh;
use meshwright::progress::{Progress, Stopped};
use meshwright::sdf::exact::{Band, ExactDistance, ExactError, ExactOptions, PointSign, Sign, cost, exact};
use proptest::prelude::*;

use crate::common::exact::{Case, cases, check_cut_lattices, check_lattice, lattice, winding};
use crate::common::shapes::{ball, hard, turned};

fn options(band: Band) -> ExactOptions {
    ExactOptions { band, max_memory: None }
}

fn field(mesh: &TriMesh, lattice: &Lattice, band: Band) -> Grid<f32> {
    exact(mesh, lattice, Sign::Pseudonormal, &options(band), &Progress::none()).expect("a field").grid
}

#[test]
fn all_voxels_of_hard_meshes_and_parts_are_as_the_points() {
    for Case { name, mesh, lattice, band } in cases() {
        let within = check_lattice(name, &mesh, &lattice, Band::Within(band));
        assert!(within > 1000, "{name}: {within}");
    }
}

#[test]
fn bands_of_any_width_and_none() {
    let mesh = ball(3, |p| 0.5 + 0.1 * (7.0 * p.x).sin());
    let around = lattice(&mesh, 1.0 / 20.0, 3);
    let widths = [0.01, 1.0, 2.5, 9.0, 400.0];
    let counts: Vec<usize> = widths.iter().map(|&h| check_lattice("ball", &mesh, &around, Band::Within(h))).collect();
    assert!(counts.is_sorted(), "{counts:?}");
    let all = check_lattice("ball", &mesh, &around, Band::Full);
    assert_eq!(all, counts[4]);
}

#[test]
fn a_lattice_that_cuts_the_body_or_misses_it() {
    check_cut_lattices(check_lattice, field);
}

#[test]
fn scale_and_place_do_not_matter() {
    let mesh = ball(3, |p| 0.5 + 0.1 * (7.0 * p.z).cos());
    for (scale, shift) in [(1e-6, DVec3::ZERO), (1e5, DVec3::ZERO), (1.0, DVec3::new(4e3, -7e3, 1e3))] {
        let mut moved = mesh.clone();
        moved.positions.iter_mut().for_each(|p| *p = *p * scale + shift);
        check_lattice("ball", &moved, &lattice(&moved, scale / 25.0, 2), Band::Within(3.0));
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let mesh = hard().swap_remove(3).1;
    let around = lattice(&mesh, 1.0 / 40.0, 5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let grid = pool.install(|| field(&mesh, &around, Band::Within(30.0)));
        let bits: Vec<u32> = grid.values.iter().flatten().map(|value| value.to_bits()).collect();
        (grid.bricks, bits)
    };
    let one = with(1);
    assert!(one == with(2) && one == with(5));
}

#[test]
fn a_vast_lattice_costs_no_more_than_the_band() {
    let mesh = ball(2, |_| 1.0);
    let h = 0.05;
    let vast = Lattice { origin: DVec3::splat(-12_000.0 * h), h, dims: IVec3::splat(24_000) };
    let grid = field(&mesh, &vast, Band::Within(3.0));
    let near = lattice(&mesh, h, 6);
    assert!(grid.bricks.len() <= 2 * field(&mesh, &near, Band::Within(3.0)).bricks.len());
    assert_eq!((grid.get(IVec3::splat(12_000)), grid.get(IVec3::splat(11_000))), (-3.0, 3.0));
    let at = IVec3::new(12_000 + 19, 12_000, 12_000);
    let truth = ExactDistance::of(&mesh, PointSign::Pseudonormal).at(vast.to_model(at.as_dvec3())).expect("triangles");
    assert!((f64::from(grid.get(at)) - truth.signed / h).abs() < 1e-4, "{}", grid.get(at));
}

#[test]
fn costs_are_foretold() {
    for (name, mesh) in hard() {
        for (resolution, width) in [(40.0, 2.0), (40.0, 12.0), (100.0, 3.0)] {
            let around = lattice(&mesh, 1.0 / resolution, width as i32);
            let told = cost(&mesh, &around, Band::Within(width)).voxels as f64;
            let taken = 512.0 * field(&mesh, &around, Band::Within(width)).bricks.len() as f64;
            assert!(
                told > 0.7 * taken && told < 3.0 * taken + 1e5,
                "{name}: {told} for {taken} at {resolution}, {width}"
            );
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let mesh = ball(2, |_| 1.0);
    let around = lattice(&mesh, 0.05, 3);
    let ask = |mesh: &TriMesh, lattice: &Lattice, band: Band, max_memory: Option<u64>| {
        exact(mesh, lattice, Sign::Pseudonormal, &ExactOptions { band, max_memory }, &Progress::none()).map(drop)
    };
    let band = Band::Within(3.0);
    assert_eq!(ask(&TriMesh::default(), &around, band, None), Err(ExactError::Empty));
    for width in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(ask(&mesh, &around, Band::Within(width), None), Err(ExactError::Band(width)));
    }
    assert!(matches!(ask(&mesh, &around, Band::Within(f64::NAN), None), Err(ExactError::Band(_))));
    let none = Lattice { dims: IVec3::new(3, 0, 3), ..around };
    assert!(matches!(ask(&mesh, &none, band, None), Err(ExactError::Lattice { .. })));
    let wide = Lattice { dims: IVec3::new(3, 3, i32::MAX), ..around };
    assert!(matches!(ask(&mesh, &wide, band, None), Err(ExactError::Lattice { .. })));
    let needed = cost(&mesh, &around, band).memory;
    assert_eq!(ask(&mesh, &around, band, Some(needed)), Ok(()));
    let refused = Err(ExactError::Memory { needed, allowed: needed - 1 });
    assert_eq!(ask(&mesh, &around, band, Some(needed - 1)), refused);
    let stop = Progress::none().with_flag(Arc::new(AtomicBool::new(true)));
    let stopped = exact(&mesh, &around, Sign::Pseudonormal, &options(band), &stop).map(drop);
    assert_eq!(stopped, Err(ExactError::Stopped(Stopped::Interrupted)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Star-shaped bodies with random radii, down to spikes and slivers.
    #[test]
    fn random_closed_meshes(
        radii in prop::collection::vec(prop_oneof![0.05..0.6f64, Just(0.4), 0.3..0.31f64], 66),
        angle in 0.0..6.0f64,
        h in 0.02..0.2f64,
        width in prop_oneof![0.5..5.0f64, 5.0..60.0f64],
    ) {
        let at = std::cell::Cell::new(0usize);
        let mut seen: Vec<(DVec3, f64)> = Vec::new();
        let base = ball(2, |_| 1.0);
        for &p in &base.positions {
            seen.push((p, radii[at.replace(at.get() + 1) % radii.len()]));
        }
        let mut mesh = base;
        mesh.positions.iter_mut().zip(&seen).for_each(|(p, (_, radius))| *p *= *radius);
        let mesh = turned(mesh, angle);
        let around = lattice(&mesh, h, 2);
        check_lattice("star", &mesh, &around, Band::Within(width));
        let grid = field(&mesh, &around, Band::Within(width));
        for n in 0..40 {
            let v = IVec3::new(n * 7 % around.dims.x, n * 5 % around.dims.y, n * 3 % around.dims.z);
            if grid.get(v).abs() > 1e-4 {
                let inside = winding(&mesh, around.to_model(v.as_dvec3())) > 0.5;
                prop_assert_eq!(grid.get(v) < 0.0, inside, "{}", v);
            }
        }
    }
}
