//! The convolution filter keeps the surface and takes the creases away.

use std::sync::Arc;

use glam::DVec3;
use meshwright::field::filter::{
    Adaptive, FilterError, FilterOptions, Kernel, Sampling, SmoothOptions, WIDEST, filtered, smooth,
};
use meshwright::field::{Body, Shared, Solid, scattered};
use meshwright::mesh::Bounds;

use super::support::{cube, surface};
use crate::common::proofs::keeps_its_zero_level_when_filtered;
use crate::common::{read, sample, shapes};

#[test]
fn the_zero_level_is_unchanged_and_no_other_arises() {
    keeps_its_zero_level_when_filtered("torus", &shapes::torus(64, 32));
    keeps_its_zero_level_when_filtered("knot", &shapes::knot(96, 16));
    keeps_its_zero_level_when_filtered("gear", &shapes::turned(shapes::gear(24), 0.3));
    keeps_its_zero_level_when_filtered("stack", &shapes::stack(0.2));
    for name in ["monkey_saddle.off", "hollow_ball.stl"] {
        keeps_its_zero_level_when_filtered(name, &read(&sample(name)));
    }
}

/// The second difference across the medial plane of a box, over the step.
fn jump(field: &Shared, step: f64) -> f64 {
    let second = |p: DVec3| {
        let at = |k: f64| field.value(p + DVec3::X * (k * step));
        (at(1.0) - 2.0 * at(0.0) + at(-1.0)).abs() / step
    };
    (-40..=40).map(|k| second(DVec3::new(0.25 + f64::from(k) * 0.001, 0.25, 0.03))).fold(0.0, f64::max)
}

#[test]
fn gradients_jump_five_times_less_across_the_medial_axis_of_a_box() {
    let block = cube(1.0);
    let smooth = filtered(block.clone(), &FilterOptions::new(0.1)).unwrap();
    let step = 1.0 / 128.0;
    let (before, after) = (jump(&block, step), jump(&smooth, step));
    assert!(after <= before / 5.0, "{before} becomes {after}");
}

#[test]
fn more_samples_are_nearer_to_the_integral() {
    let block = cube(1.0);
    let points = scattered(150, 1, &Bounds { min: DVec3::splat(-0.6), max: DVec3::splat(0.6) });
    let values = |count: usize, mirrored: bool| {
        let sampling = Sampling::Drawn { count, seed: 0, mirrored };
        let field = filtered(block.clone(), &FilterOptions { sampling, ..FilterOptions::new(0.2) }).unwrap();
        points.iter().map(|&p| field.value(p)).collect::<Vec<f64>>()
    };
    let truth = values(1 << 14, true);
    let error = |found: Vec<f64>| {
        let sum: f64 = found.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        (sum / truth.len() as f64).sqrt()
    };
    assert!(error(values(1024, false)) < 0.5 * error(values(32, false)));
    assert!(error(values(64, true)) < 0.3 * error(values(64, false)), "mirrored ones are much nearer");
}

/// A linear field is its own mean.
#[test]
fn a_plane_stays_the_plane_exactly() {
    let plane: Shared = Arc::new(Body { solid: Solid::HalfSpace, centre: DVec3::ZERO, axis: 1 });
    let smooth = filtered(plane.clone(), &FilterOptions::new(0.3)).unwrap();
    for p in scattered(200, 2, &Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) }) {
        assert!((smooth.value(p) - plane.value(p)).abs() < 1e-12);
    }
}

#[test]
fn what_could_make_other_surfaces_is_refused() {
    let block = cube(1.0);
    let with = |kernel, sign_safe| {
        filtered(block.clone(), &FilterOptions { kernel, sign_safe, ..FilterOptions::new(0.1) }).map(|_| ())
    };
    let wide = Kernel::Bump { width: 0.2 };
    let error = with(wide, false).unwrap_err();
    assert_eq!(error, FilterError::Wide { width: 0.2, cap: 0.1 });
    assert!(error.to_string().contains("at least 0.225"), "{error}");
    assert_eq!(with(wide, true), Ok(()));
    assert_eq!(with(Kernel::Bump { width: WIDEST * 0.1 }, false), Ok(()));
    assert_eq!(with(Kernel::gaussian(0.05), false), Err(FilterError::Endless));
    assert_eq!(with(Kernel::gaussian(0.05), true), Ok(()));
    assert!(matches!(with(Kernel::Bump { width: -1.0 }, false), Err(FilterError::Size { .. })));
}

#[test]
fn fewer_samples_where_they_are_enough_change_little_and_do_not_jump() {
    let block = cube(1.0);
    let sampling = Sampling::Drawn { count: 128, seed: 0, mirrored: true };
    let all = FilterOptions { sampling, ..FilterOptions::new(0.1) };
    let some = FilterOptions { adaptive: Some(Adaptive { least: 32 }), ..all };
    let [all, some] = [all, some].map(|options| filtered(block.clone(), &options).unwrap());
    let along = |k: i32| DVec3::new(f64::from(k) * 1e-4, 0.21, 0.03);
    for k in -4000..4000 {
        let (here, next) = (some.value(along(k)), some.value(along(k + 1)));
        assert!((here - next).abs() < 3e-4, "{here} and {next} at {}", along(k));
        assert!((here - all.value(along(k))).abs() < 0.05 * 0.1);
    }
}

#[test]
fn smoothing_stays_in_its_volume() {
    let block = cube(1.0);
    let volume: Shared = Arc::new(Body { solid: Solid::Sphere { radius: 0.5 }, centre: DVec3::splat(0.5), axis: 2 });
    let sampling = Sampling::Drawn { count: 64, seed: 0, mirrored: true };
    let options = SmoothOptions { depth: 0.2, radius: 0.2, sampling };
    let rounded = smooth(block.clone(), volume.clone(), &options);
    for p in scattered(1000, 3, &Bounds { min: DVec3::splat(-0.8), max: DVec3::splat(0.8) }) {
        assert!(volume.value(p) < 0.0 || rounded.value(p) == block.value(p), "{p}");
    }
    assert!(rounded.value(DVec3::splat(0.49)) > 0.0, "the corner inside is rounded off");
    assert!(rounded.value(-DVec3::splat(0.49)) < 0.0, "the corner outside is not");
    let (_, validity) = surface(&rounded, 0.03);
    assert!(validity.is_valid(), "{:?}", validity.problems());
}
