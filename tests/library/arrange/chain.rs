//! A hundred operations, one after another and in one expression.

use super::support::{coarse, volume};
use glam::DVec3;
use meshwright::ldi::Expression;
use meshwright::mesh::{Solid, TriMesh};
use meshwright::pipeline::{Method, Options, Precision, VoxelSize, boolean};
use meshwright::progress::Progress;
use std::time::Instant;

use crate::common::shapes::cuboid;

const SIDES: u32 = 24;
const RADIUS: f64 = 0.3;

/// A regular prism through the plate, around the middle of a square of the grid.
fn drill(n: u32) -> TriMesh {
    let middle = DVec3::new(f64::from(n % 10) + 1.0, f64::from(n / 10) + 1.0, 0.0);
    let angle = |k: u32| std::f64::consts::TAU * (f64::from(k) + 0.3) / f64::from(SIDES);
    let ring =
        |z: f64| (0..SIDES).map(move |k| middle + DVec3::new(RADIUS * angle(k).cos(), RADIUS * angle(k).sin(), z));
    let mut mesh = TriMesh { positions: ring(-1.0).chain(ring(2.0)).collect(), triangles: Vec::new() };
    for k in 0..SIDES {
        let next = (k + 1) % SIDES;
        mesh.triangles.extend([[k, next, next + SIDES], [k, next + SIDES, k + SIDES]]);
    }
    for k in 1..SIDES - 1 {
        mesh.triangles.extend([[0, k + 1, k], [SIDES, SIDES + k, SIDES + k + 1]]);
    }
    mesh
}

fn plate() -> TriMesh {
    cuboid(DVec3::ZERO, DVec3::new(11.0, 11.0, 1.0))
}

/// The area of a drill: that of a regular polygon, or of the polygon that it is.
fn area(drill: &TriMesh) -> f64 {
    volume(drill) / 3.0
}

fn regular() -> f64 {
    f64::from(SIDES) / 2.0 * RADIUS * RADIUS * (std::f64::consts::TAU / f64::from(SIDES)).sin()
}

fn cut(operands: &[TriMesh], expression: &Expression, precision: Precision) -> Solid {
    let options = Options { method: Method::Exact, precision, ..Options::new(VoxelSize::Along(64)) };
    let outcome = boolean(operands, expression, &options, &Progress::none()).expect("closed operands");
    outcome.solid
}

/// Drills one after another, each result the next operand; returns the volume's error after each.
fn chain(drills: &[TriMesh], precision: Precision) -> (Solid, Vec<f64>) {
    let mut errors = Vec::new();
    let mut solid = cut(&[plate()], &Expression::Operand(0), precision);
    let mut expected = 121.0;
    for drill in drills {
        solid = cut(&[solid.into(), drill.clone()], &Expression::difference(2), precision);
        expected -= area(drill);
        errors.push(volume(&solid) - expected);
    }
    (solid, errors)
}

#[test]
fn a_plate_drilled_a_hundred_times_is_exact() {
    let drills: Vec<TriMesh> = (0..100).map(|n| coarse(drill(n))).collect();
    let whole = 121.0 - 100.0 * regular();
    let start = Instant::now();
    let (solid, errors) = chain(&drills, Precision::Double);
    let one_by_one = start.elapsed().as_secs_f64();
    // All coordinates are multiples of 2⁻²⁰ and lie on the lattice: what is left is the summing up.
    let worst = errors.iter().fold(0.0, |worst: f64, error| worst.max(error.abs()));
    assert!(worst <= 1e-11, "{worst}");
    assert!((volume(&solid) - whole).abs() <= 1e-5 * whole);
    let start = Instant::now();
    let operands: Vec<TriMesh> = std::iter::once(plate()).chain(drills).collect();
    let at_once = cut(&operands, &Expression::difference(101), Precision::Double);
    let together = start.elapsed().as_secs_f64();
    assert!((volume(&at_once) - volume(&solid)).abs() <= 1e-11);
    assert_eq!(at_once.triangles.len(), solid.triangles.len());
    println!("100 drills: {one_by_one:.2} s one by one, {together:.2} s at once; {} triangles", solid.triangles.len());
    println!(
        "largest error of the volume in the chain: {worst:.1e}; off the regular polygons by {:.1e}",
        volume(&solid) - whole
    );
}

#[test]
fn errors_do_not_grow_where_coordinates_are_rounded() {
    let drills: Vec<TriMesh> = (0..100).map(drill).collect();
    let whole = 121.0 - 100.0 * regular();
    for (precision, each) in [(Precision::Double, 1e-9), (Precision::Single, 2e-6)] {
        let (solid, errors) = chain(&drills, precision);
        // Each drill's corners are rounded once: no error is more than that of the drills so far.
        for (n, error) in (1..).zip(&errors) {
            assert!(error.abs() <= each * f64::from(n), "{error} after {n}");
        }
        assert!((volume(&solid) - whole).abs() <= 100.0 * each);
        println!(
            "{precision:?}: error after 1, 10 and 100 drills {:.1e}, {:.1e}, {:.1e}",
            errors[0], errors[9], errors[99]
        );
    }
}
