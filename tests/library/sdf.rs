//! The robust field is close to the true distance, and marching extends it without losing much.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::common::{shapes, stages};
use glam::{DVec3, IVec3};
use meshwright::lattice::{BRICK, DistanceField, Grid, Lattice, voxel_in_brick};
use meshwright::ldi::Spans;
use meshwright::mesh::{Plane, TriMesh};
use meshwright::progress::Progress;
use meshwright::sdf::{RobustOptions, Trust, correct, estimate, march, robust, smooth};
use meshwright::vote::{VoteRule, Votes, vote_near_surface};

fn field(spans: &[Spans], planes: &[Plane], votes: (&Grid<Votes>, &Lattice), options: &RobustOptions) -> DistanceField {
    robust(spans, planes, votes, options, &Progress::none()).expect("not stopped")
}

fn robust_of(mesh: &TriMesh, lattice: &Lattice, options: &RobustOptions) -> DistanceField {
    let spans = stages::spans_of(mesh, lattice);
    let votes = stages::votes_of(mesh, lattice, VoteRule::default());
    field(&spans, &stages::planes_of(mesh, lattice), (&votes, lattice), options)
}

/// Voxels with a neighbour of the other sign, with their values.
fn transition(grid: &Grid<f32>) -> Vec<(IVec3, f32)> {
    let steps = [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z];
    voxels(grid).filter(|&(v, d)| steps.iter().any(|&s| (grid.get(v + s) < 0.0) != (d < 0.0))).collect()
}

fn voxels(grid: &Grid<f32>) -> impl Iterator<Item = (IVec3, f32)> + '_ {
    let bricks = grid.bricks.active().iter().zip(&grid.values);
    bricks.flat_map(|(&b, values)| values.iter().enumerate().map(move |(n, &d)| (b * BRICK + voxel_in_brick(n), d)))
}

/// Distance to a torus of radii 1 and 0.35 around z.
fn to_torus(p: DVec3) -> f64 {
    (p.truncate().length() - 1.0).hypot(p.z) - 0.35
}

#[test]
fn a_finely_meshed_torus_has_the_torus_distance() {
    let mesh = shapes::torus(512, 256);
    let lattice = stages::lattice_of(&mesh, 96);
    let grid = robust_of(&mesh, &lattice, &RobustOptions::default()).grid;
    let near = transition(&grid);
    assert!(near.len() > 10_000);
    let errors = near.iter().map(|&(v, d)| (d as f64 - to_torus(lattice.to_model(v.as_dvec3())) / lattice.h).abs());
    let (sum, max) = errors.fold((0.0, 0.0f64), |(sum, max), e| (sum + e, max.max(e)));
    assert!(sum / (near.len() as f64) < 0.002 && max < 0.02, "mean {} max {max}", sum / near.len() as f64);
}

#[test]
fn marching_reaches_the_band_with_small_error_and_keeps_signs() {
    let mesh = shapes::torus(512, 256);
    let lattice = stages::lattice_of(&mesh, 96);
    let near = robust_of(&mesh, &lattice, &RobustOptions::default());
    let band = 8.0;
    let grid = march(&near, band, &Progress::none()).expect("not stopped").grid;
    let (mut reached, mut sum, mut max) = (0usize, 0.0, 0.0f64);
    for (v, d) in voxels(&grid) {
        let inside = v.min_element() >= 0 && (lattice.dims - v).min_element() > 0;
        let truth = to_torus(lattice.to_model(v.as_dvec3())) / lattice.h;
        if inside && truth.abs() < 7.0 {
            assert!((d < 0.0) == (truth < 0.0) || truth.abs() < 0.01, "{v}: {d} for {truth}");
            let error = (d as f64 - truth).abs();
            (reached, sum, max) = (reached + 1, sum + error, max.max(error));
        } else if inside && truth.abs() > 9.0 {
            assert_eq!(d.abs(), band, "{v}");
        }
    }
    assert!(reached > 100_000);
    assert!(sum / (reached as f64) < 0.02 && max < 0.3, "mean {} max {max}", sum / reached as f64);
}

#[test]
fn correction_does_not_change_signs_and_walls_of_one_voxel_survive() {
    let mesh = shapes::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1.2 / 64.0));
    let lattice = stages::lattice_of(&mesh, 64);
    let spans = stages::spans_of(&mesh, &lattice);
    let votes = stages::votes_of(&mesh, &lattice, VoteRule::default());
    let grid = field(&spans, &stages::planes_of(&mesh, &lattice), (&votes, &lattice), &RobustOptions::default()).grid;
    let inside = voxels(&grid).filter(|(_, d)| *d < 0.0).count();
    assert!(inside >= 64 * 64 - 200, "{inside}");
    for (v, d) in voxels(&grid) {
        assert_eq!(d < 0.0, votes.get(v).is_inside, "{v}");
    }
    // The paper's smoothing wears the wall away: that is why votes are trusted.
    let paper = RobustOptions { trust: Trust::Nothing, ..RobustOptions::default() };
    let worn = field(&spans, &stages::planes_of(&mesh, &lattice), (&votes, &lattice), &paper).grid;
    assert!(voxels(&worn).filter(|(_, d)| *d < 0.0).count() < inside);
}

#[test]
fn a_set_flag_stops_the_vote_and_every_part_of_the_field() {
    let stop = Progress::none().with_flag(Arc::new(AtomicBool::new(true)));
    let mesh = shapes::torus(32, 16);
    let lattice = stages::lattice_of(&mesh, 32);
    let (spans, planes) = (stages::spans_of(&mesh, &lattice), stages::planes_of(&mesh, &lattice));
    let votes = stages::votes_of(&mesh, &lattice, VoteRule::default());
    let options = RobustOptions::default();
    let go = Progress::none();
    let estimates = estimate(&spans, &planes, &votes.bricks, &go).expect("not stopped");
    let smoothed = smooth(&votes, &estimates, &options, &go).expect("not stopped");
    assert!(estimate(&spans, &planes, &votes.bricks, &stop).is_err());
    assert!(smooth(&votes, &estimates, &options, &stop).is_err());
    assert!(correct(smoothed, &estimates, &options, &stop).is_err());
    stages::with_jury(&mesh, &lattice, VoteRule::default(), |jury| assert!(vote_near_surface(jury, &stop).is_err()));
}
