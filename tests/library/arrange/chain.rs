//! A hundred operations, one after another and in one expression.

use super::support::{cases, coarse, prism, result, volume};
use glam::DVec3;
use meshwright::ldi::Expression;
use meshwright::mesh::TriMesh;
use meshwright::pipeline::{Method, Options, Precision, VoxelSize, boolean};
use meshwright::progress::Progress;
use std::time::Instant;

use crate::common::shapes::cuboid;

const SIDES: u32 = 8;
const RADIUS: f64 = 0.3;

/// How many drills come one after another: 25, or what the environment says; `MESHWRIGHT_CASES=100` is the whole plate.
fn count() -> u32 {
    cases(25).cases.min(100)
}

/// A regular prism through the plate, around the middle of a square of the grid.
fn drill(n: u32) -> TriMesh {
    let middle = DVec3::new(f64::from(n % 10) + 1.0, f64::from(n / 10) + 1.0, 0.0);
    prism(middle, RADIUS, [-1.0, 2.0], SIDES, 0.3)
}

fn plate() -> TriMesh {
    cuboid(DVec3::ZERO, DVec3::new(11.0, 11.0, 1.0))
}

/// The area of a drill.
fn regular() -> f64 {
    f64::from(SIDES) / 2.0 * RADIUS * RADIUS * (std::f64::consts::TAU / f64::from(SIDES)).sin()
}

/// By the arrangement alone.
fn arranged(operands: &[TriMesh], count: usize) -> TriMesh {
    result(operands, &Expression::difference(count), false).expect("a valid difference").mesh
}

/// By the whole pipeline, in single precision.
fn cut(operands: &[TriMesh]) -> TriMesh {
    let options = Options { method: Method::Exact, precision: Precision::Single, ..Options::new(VoxelSize::Along(64)) };
    let outcome = boolean(operands, &Expression::difference(2), &options, &Progress::none()).expect("closed operands");
    outcome.solid.into()
}

/// Drills one after another, each result the next operand; returns the last one and the volume's error after each.
fn chain(
    drills: &[TriMesh],
    area: impl Fn(&TriMesh) -> f64,
    cut: impl Fn(&[TriMesh]) -> TriMesh,
) -> (TriMesh, Vec<f64>) {
    let mut solid = plate();
    let mut expected = 121.0;
    let mut errors = Vec::new();
    for drill in drills {
        solid = cut(&[solid, drill.clone()]);
        expected -= area(drill);
        errors.push(volume(&solid) - expected);
    }
    (solid, errors)
}

/// All coordinates are multiples of 2⁻²⁰ and lie on the lattice: what volumes are off by is what adding up thousands of numbers loses.
#[test]
fn a_plate_drilled_a_hundred_times_is_exact() {
    let drills: Vec<TriMesh> = (0..100).map(|n| coarse(drill(n))).collect();
    let start = Instant::now();
    let few = &drills[..count() as usize];
    let (solid, errors) = chain(few, |drill| volume(drill) / 3.0, |operands| arranged(operands, 2));
    let one_by_one = start.elapsed().as_secs_f64();
    let worst = errors.iter().fold(0.0, |worst: f64, error| worst.max(error.abs()));
    assert!(worst <= 1e-11, "{worst}");
    let start = Instant::now();
    let holes: f64 = drills.iter().map(|drill| volume(drill) / 3.0).sum();
    let operands: Vec<TriMesh> = std::iter::once(plate()).chain(drills.iter().cloned()).collect();
    let at_once = arranged(&operands, 101);
    let together = start.elapsed().as_secs_f64();
    assert!((volume(&at_once) - (121.0 - holes)).abs() <= 1e-11);
    println!(
        "{} drills: {one_by_one:.2} s one by one, {} triangles, errors up to {worst:.1e}",
        few.len(),
        solid.triangles.len()
    );
    println!("100 at once: {together:.2} s, {} triangles", at_once.triangles.len());
}

/// Corners are rounded once, when their drill comes: what volumes are off by is that, and does not grow with what comes after.
#[test]
fn errors_do_not_grow_where_coordinates_are_rounded() {
    let drills: Vec<TriMesh> = (0..count()).map(drill).collect();
    let start = Instant::now();
    let (solid, errors) = chain(&drills, |_| regular(), cut);
    println!("by the pipeline: {:.2} s, {} triangles", start.elapsed().as_secs_f64(), solid.triangles.len());
    println!("error after the first and the last drill: {:.1e}, {:.1e}", errors[0], errors[errors.len() - 1]);
    // A drill's area is off by its perimeter times half a step of f32, at most: the corners reach 10.3, where a step is 2⁻²⁰.
    let each = f64::from(SIDES) * 2.0 * RADIUS * (std::f64::consts::PI / f64::from(SIDES)).sin() * 2f64.powi(-20);
    for (n, error) in (1..).zip(&errors) {
        assert!(error.abs() <= each * f64::from(n), "{error} after {n}");
    }
}
