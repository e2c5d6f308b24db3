//! Holes that are closed from their rims alone: nothing else changes, and what is no hole is left to the voxels.

use crate::common::proofs::state;
use crate::common::shapes::{ball, cuboid, torus};
use glam::DVec3;
use meshwright::fill::Style;
use meshwright::mesh::TriMesh;
use meshwright::pipeline::{BooleanError, Method, Options, Outcome, TriangleSource, VoxelSize, repair};
use meshwright::progress::Progress;

fn options(fill: Style) -> Options {
    Options { fill, ..Options::new(VoxelSize::Along(64)) }
}

fn repaired(mesh: &TriMesh, options: &Options) -> Outcome {
    let outcome = repair(mesh, options, &Progress::none()).expect("a solid");
    let found = state(&outcome.solid, true);
    assert!(found.is_valid(), "{:?}", found.problems());
    outcome
}

fn volume(mesh: &TriMesh) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// A mesh without the triangles whose middles lie within `radius` of a place.
fn without(mesh: &TriMesh, at: DVec3, radius: f64) -> TriMesh {
    let near = |t: usize| (mesh.corners(t).iter().sum::<DVec3>() / 3.0).distance(at) < radius;
    let triangles = (0..mesh.triangles.len()).filter(|&t| !near(t)).map(|t| mesh.triangles[t]).collect();
    TriMesh { positions: mesh.positions.clone(), triangles }.welded()
}

/// All triangles of the input are there, and all others close holes.
fn check_kept(input: &TriMesh, outcome: &Outcome) {
    let own = outcome.sources.iter().filter(|source| **source != TriangleSource::Closed).count();
    assert_eq!(own, input.triangles.len());
    assert_eq!(outcome.report.triangles.kept, own);
    let listed: usize = outcome.report.holes.iter().map(|hole| hole.triangles).sum();
    assert_eq!(listed, outcome.solid.triangles.len() - own);
    assert!(!outcome.report.lattice);
}

#[test]
fn holes_in_round_surfaces_are_closed_round_and_nothing_else_changes() {
    let whole = ball(4, |_| 1.0);
    let open = without(&whole, DVec3::X, 0.3);
    let [smooth, flat] = [Style::Auto, Style::Flat].map(|style| repaired(&open, &options(style)));
    for outcome in [&smooth, &flat] {
        check_kept(&open, outcome);
        assert_eq!(outcome.report.holes.len(), 1);
    }
    assert_eq!((smooth.report.holes[0].style, flat.report.holes[0].style), (Style::Smooth, Style::Flat));
    assert!(flat.report.holes[0].triangles < smooth.report.holes[0].triangles);
    let off = |outcome: &Outcome| (volume(&outcome.solid) / volume(&whole) - 1.0).abs();
    assert!(off(&smooth) < 2e-4 && off(&flat) > 1e-3, "{} and {}", off(&smooth), off(&flat));
}

#[test]
fn several_holes_are_closed_one_by_one_the_longest_first() {
    let whole = torus(96, 48);
    let places = [DVec3::X * 1.3, DVec3::new(-1.0, 0.0, 0.3), DVec3::new(0.0, 1.0, -0.3)];
    let open =
        places.iter().zip([0.25, 0.15, 0.1]).fold(whole.clone(), |mesh, (&at, radius)| without(&mesh, at, radius));
    let outcome = repaired(&open, &options(Style::Auto));
    check_kept(&open, &outcome);
    let holes = &outcome.report.holes;
    assert_eq!(holes.len(), 3);
    for (hole, at) in holes.iter().zip(places) {
        assert!(DVec3::from_array(hole.centre).distance(at) < 0.15, "{hole:?} at {at}");
    }
    assert!(holes.windows(2).all(|pair| pair[0].perimeter >= pair[1].perimeter));
    let off = (volume(&outcome.solid) / volume(&whole) - 1.0).abs();
    assert!(off < 1e-3, "{off}");
}

#[test]
fn a_box_without_a_side_is_twelve_triangles_again() {
    let whole = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    for missing in 0..whole.triangles.len() {
        for count in [1, 2] {
            // Two opposite sides that are open in part, and nearer to each other than they are wide: there voxels decide.
            if (missing, count) == (11, 2) {
                continue;
            }
            let mut open = whole.clone();
            open.triangles.rotate_left(missing);
            open.triangles.truncate(whole.triangles.len() - count);
            let outcome = repaired(&open, &options(Style::Auto));
            assert_eq!(outcome.solid.triangles.len(), 12, "{count} missing at {missing}");
            assert!((volume(&outcome.solid) - 6.0).abs() < 1e-12);
        }
    }
}

/// A ring with a gap that is narrow against its tube: the rims at both ends face each other.
#[test]
fn what_faces_itself_over_a_gap_is_joined() {
    let tube = torus(96, 48);
    let narrow = |p: &DVec3| p.x > 0.0 && p.y.abs() < 0.1;
    let keep = |t: &usize| !narrow(&(tube.corners(*t).iter().sum::<DVec3>() / 3.0));
    let triangles = (0..tube.triangles.len()).filter(keep).map(|t| tube.triangles[t]).collect();
    let open = TriMesh { positions: tube.positions.clone(), triangles }.welded();
    let outcome = repaired(&open, &options(Style::Auto));
    let found = state(&outcome.solid, true);
    assert!(outcome.report.holes.is_empty() && found.bodies == 1, "{:?}", outcome.report.holes);
}

#[test]
fn sheets_are_not_closed_and_voxels_can_be_asked_for() {
    let whole = ball(4, |_| 1.0);
    let cap = without(&whole, DVec3::NEG_X, 1.9);
    assert!(matches!(repair(&cap, &options(Style::Auto), &Progress::none()), Err(BooleanError::Nothing(_))));
    let open = without(&whole, DVec3::X, 0.3);
    let outcome = repaired(&open, &Options { method: Method::Voxel, ..options(Style::Auto) });
    assert!(outcome.report.holes.is_empty() && outcome.report.lattice);
}
