//! Closings and openings keep their word: what a ball of the radius reaches stays, and what it does not reach is filled, whatever the
//! voxels.

use crate::common::repaired::{morphed, without_canals};
use crate::common::shapes::{cuboid, torus, turned};
use glam::{DMat3, DVec3};
use meshwright::mesh::{TriMesh, ValidateOptions, Validity, validate};
use meshwright::morphology::Operation::{self, Close, Dilate, Erode, Open};
use meshwright::pipeline::{
    CanalOptions, MorphologyOptions, MorphologyReport, Outcome, Remove, SurfaceOptions, VoxelSize,
};
use meshwright::progress::Progress;
use meshwright::sdf::exact::{ExactDistance, PointSign};

/// Radii as parts of the gap: below a half the ball passes, above it does not.
const RATIOS: [f64; 7] = [0.3, 0.4, 0.49, 0.51, 0.7, 1.5, 3.0];

struct Done {
    outcome: Outcome,
    validity: Validity,
    report: MorphologyReport,
}

fn done(mesh: &TriMesh, operation: Operation, radius: f64, resolution: u32) -> Done {
    let surface = SurfaceOptions::new(VoxelSize::Along(resolution));
    let options = MorphologyOptions { operation, radius, sharp: None, surface };
    let outcome = morphed(mesh, &options).expect("a solid");
    let options = ValidateOptions { self_intersections: true, weld: true };
    let validity = validate(&outcome.solid, &options, &Progress::none()).expect("not stopped");
    assert!(validity.is_valid(), "{:?}", validity.problems());
    let report = outcome.report.morphology.clone().expect("morphology was done");
    Done { outcome, validity, report }
}

/// Closes by each radius with each number of voxels: the bodies and tunnels must be those of `passes` or of `filled`, nothing may be lost, and
/// where nothing is filled the solid comes back as it is.
fn check_closings(mesh: &TriMesh, gap: f64, resolutions: &[u32], passes: (usize, i64), filled: (usize, i64)) {
    for &resolution in resolutions {
        for ratio in RATIOS {
            let Done { outcome, validity, report } = done(mesh, Close, ratio * gap, resolution);
            let what = format!("radius {ratio} gaps, {resolution} voxels: {report:?}");
            let wanted = if ratio < 0.5 { passes } else { filled };
            assert_eq!((validity.bodies, validity.genus), (wanted.0, Some(wanted.1)), "{what}");
            assert!(report.volume_after > report.volume_before * (1.0 - 1e-4), "{what}");
            // Inner edges are rounded in any case.
            if ratio < 0.5 && mesh.positions.len() == 16 && passes.0 == 2 {
                assert_eq!(&outcome.solid, mesh, "{what}");
            }
        }
    }
}

fn plates(gap: f64) -> TriMesh {
    let plate = |z: f64| cuboid(DVec3::new(0.0, 0.0, z), DVec3::new(4.0, 4.0, z + 1.0));
    let mut both = plate(0.0);
    both.append(&plate(1.0 + gap));
    both
}

/// A block with a square bore of side `width` along z.
fn bored(width: f64) -> TriMesh {
    let square = |half: f64| [(-half, -half), (half, -half), (half, half), (-half, half)];
    let ring = |z: f64| square(2.0).into_iter().chain(square(width / 2.0)).map(move |(x, y)| DVec3::new(x, y, z));
    let positions = ring(0.0).chain(ring(2.0)).collect();
    let mut triangles = Vec::new();
    for k in 0..4u32 {
        let next = (k + 1) % 4;
        let mut quad = |a: u32, b: u32, c: u32, d: u32| triangles.extend([[a, b, c], [a, c, d]]);
        quad(k, next, next + 8, k + 8);
        quad(next + 4, k + 4, k + 12, next + 12);
        quad(k, k + 4, next + 4, next);
        quad(k + 8, next + 8, next + 12, k + 12);
    }
    TriMesh { positions, triangles }
}

/// Two rings, linked: the tube of each goes through the middle of the other.
fn chain() -> TriMesh {
    let ring = torus(48, 24);
    let turn = DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let mut both = ring.clone();
    let other = ring.positions.iter().map(|&p| turn * p + DVec3::X * major(&ring)).collect();
    both.append(&TriMesh { positions: other, ..ring });
    both
}

/// The radius of the middle of a ring's tube.
fn major(ring: &TriMesh) -> f64 {
    let far = ring.positions.iter().map(|p| p.truncate().length());
    let (near, far) = far.fold((f64::INFINITY, 0.0f64), |(a, b), r| (a.min(r), b.max(r)));
    (near + far) / 2.0
}

#[test]
fn plates_fuse_only_where_no_ball_passes() {
    check_closings(&plates(1.0), 1.0, &[16, 33], (2, 0), (1, 0));
}

#[test]
fn a_ball_that_just_fits_passes() {
    for resolution in [16, 33] {
        assert_eq!(done(&plates(1.0), Close, 0.5, resolution).validity.bodies, 2);
        assert_eq!(done(&bored(1.0), Close, 0.5, resolution).validity.genus, Some(1));
    }
}

#[test]
fn eight_plates_with_gaps_wider_than_the_ball_come_back_as_they_are() {
    let mut mesh = TriMesh::default();
    for n in 0..4 {
        let mut two = plates(1.0);
        two.positions.iter_mut().for_each(|p| p.z += 4.0 * f64::from(n));
        mesh.append(&two);
    }
    let mesh = turned(mesh, 0.4);
    let Done { outcome, report, .. } = done(&mesh, Close, 0.45, 128);
    assert_eq!(report.made, 0);
    assert_eq!(outcome.solid.triangles.len(), mesh.triangles.len());
}

#[test]
fn bores_are_filled_only_where_no_ball_passes() {
    check_closings(&bored(1.0), 1.0, &[16], (1, 1), (1, 0));
    let turn = DMat3::from_euler(glam::EulerRot::ZYX, 0.3, 0.9, 0.5);
    let mesh = bored(0.8);
    let mesh = TriMesh { positions: mesh.positions.iter().map(|&p| turn * p).collect(), ..mesh };
    check_closings(&mesh, 0.8, &[29], (1, 1), (1, 0));
}

#[test]
fn rings_of_a_chain_stay_apart_where_a_ball_passes_between() {
    let mesh = chain();
    let ring = TriMesh { positions: mesh.positions[..mesh.positions.len() / 2].to_vec(), triangles: Vec::new() };
    let near = ring.positions.iter().map(|p| p.truncate().length()).fold(f64::INFINITY, f64::min);
    // Between the tube in the middle and the ring around it.
    let gap = near - (major(&ring) - near);
    for (ratio, bodies, resolutions) in [(0.3, 2, &[20][..]), (0.45, 2, &[20, 28]), (0.6, 1, &[20]), (1.0, 1, &[28])] {
        for &resolution in resolutions {
            let Done { validity, report, .. } = done(&mesh, Close, ratio * gap, resolution);
            assert_eq!(validity.bodies, bodies, "{ratio} gaps of {gap}, {resolution} voxels");
            assert!(report.volume_after > report.volume_before * (1.0 - 1e-4), "{report:?}");
        }
    }
}

/// Points of a grid around the solid: those that a ball of `radius` outside of it reaches for certain, and those that none does. Found without
/// any of the program's fields: a ball is tried around every point of a finer grid.
fn reached(mesh: &TriMesh, radius: f64) -> (Vec<DVec3>, Vec<DVec3>) {
    let step = radius / 5.0;
    let slack = step * 3f64.sqrt() / 2.0;
    let bounds = mesh.bounds().expect("not empty");
    let (low, high) = (bounds.min - radius - step, bounds.max + radius + step);
    let size = ((high - low) / step).ceil().as_uvec3() + 1;
    let place = |n: u32| {
        let (x, y, z) = (n % size.x, n / size.x % size.y, n / size.x / size.y);
        low + DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * step
    };
    let points: Vec<DVec3> = (0..size.element_product()).map(place).collect();
    let distance = ExactDistance::of(mesh, PointSign::Pseudonormal).at_all(&points);
    let far: Vec<f64> = distance.iter().map(|nearest| nearest.expect("not empty").signed).collect();
    let is_in = |p: DVec3, centre: DVec3, room: f64| p.distance(centre) < radius + room;
    let reach = (radius / step).ceil() as i64 + 2;
    let near = |n: usize| {
        let (x, y, z) = (n as u32 % size.x, n as u32 / size.x % size.y, n as u32 / size.x / size.y);
        let axis = |at: u32, end: u32| (i64::from(at) - reach).max(0) as u32..=(at + reach as u32).min(end - 1);
        axis(z, size.z).flat_map(move |k| {
            axis(y, size.y).flat_map(move |j| axis(x, size.x).map(move |i| ((k * size.y + j) * size.x + i) as usize))
        })
    };
    let (mut yes, mut no) = (Vec::new(), Vec::new());
    for (n, &p) in points.iter().enumerate().step_by(7).filter(|(n, _)| far[*n] > 0.0 && far[*n] < radius) {
        if near(n).any(|c| far[c] >= radius && is_in(p, points[c], -slack / 8.0)) {
            yes.push(p);
        } else if !near(n).any(|c| far[c] >= radius - slack && is_in(p, points[c], slack)) {
            no.push(p);
        }
    }
    (yes, no)
}

#[test]
fn what_balls_reach_stays_open_and_what_they_do_not_reach_is_filled() {
    let cases = [(plates(1.0), 0.45), (plates(1.0), 0.8), (bored(1.0), 0.47), (bored(1.0), 0.7), (chain(), 0.4)];
    for (mesh, radius) in cases {
        let (yes, no) = reached(&mesh, radius);
        assert!(yes.len() > 500, "{} points", yes.len());
        for resolution in [18, 32] {
            let Done { outcome, report, .. } = done(&mesh, Close, radius, resolution);
            let distance = ExactDistance::of(&outcome.solid, PointSign::Pseudonormal);
            let signed = |p: &DVec3| distance.at(*p).expect("not empty").signed;
            let within = 0.6 * report.voxel;
            let deepest = yes.iter().map(signed).fold(f64::INFINITY, f64::min);
            assert!(deepest > -within, "{radius}, {resolution}: filled to {deepest}, voxel {}", report.voxel);
            let open = no.iter().map(signed).fold(f64::NEG_INFINITY, f64::max);
            assert!(open < within, "{radius}, {resolution}: open by {open}, voxel {}", report.voxel);
        }
    }
}

#[test]
fn opening_keeps_walls_that_hold_a_ball_and_takes_others() {
    for (ratio, stays, resolutions) in [(0.3, true, &[16][..]), (0.49, true, &[28]), (0.52, false, &[16, 28])] {
        for &resolution in resolutions {
            // A block and a thin plate beside it.
            let mut mesh = cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 3.0));
            mesh.append(&cuboid(DVec3::new(0.0, 0.0, 4.0), DVec3::new(4.0, 4.0, 4.4)));
            let Done { validity, report, .. } = done(&mesh, Open, ratio * 0.4, resolution);
            assert_eq!(validity.bodies, if stays { 2 } else { 1 }, "{ratio}, {resolution}: {report:?}");
            // Edges and corners are rounded by a ball of the radius: of each edge (1 - π/4) r² goes, on less than its length.
            let radius = ratio * 0.4;
            let edges = if stays { 4.0 * (11.0 + 8.4) } else { 4.0 * 11.0 };
            let plate = if stays { 0.0 } else { 6.4 };
            let most = plate + edges * (1.0 - std::f64::consts::FRAC_PI_4) * radius * radius;
            let lost = report.volume_before - report.volume_after;
            assert!(lost < most * 1.05 + 1e-3 && lost > plate, "{ratio}, {resolution}: {lost} of {most}");
        }
    }
}

#[test]
fn what_is_left_of_an_erosion_or_between_dilations_may_be_thin() {
    for resolution in [12, 16, 40] {
        // Of a wall 1 thick 0.1 is left.
        let wall = cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 1.0));
        let Done { validity, report, .. } = done(&wall, Erode, 0.45, resolution);
        assert_eq!(validity.bodies, 1, "{resolution}: {report:?}");
        let truth = 3.1 * 3.1 * 0.1;
        assert!((report.volume_after / truth - 1.0).abs() < 0.03, "{resolution}: {} for {truth}", report.volume_after);
        // Between two plates 1 apart 0.1 stays open.
        let Done { validity, report, .. } = done(&plates(1.0), Dilate, 0.45, resolution);
        assert_eq!(validity.bodies, 2, "{resolution}: {report:?}");
        assert_eq!(report.too_thin, 0, "{resolution}: {report:?}");
    }
}

#[test]
fn what_is_too_thin_for_any_voxel_is_told() {
    let wall = cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 1.0));
    let mut mesh = wall.clone();
    mesh.append(&cuboid(DVec3::new(0.0, 0.0, 3.0), DVec3::new(4.0, 4.0, 6.0)));
    let Done { validity, report, .. } = done(&mesh, Erode, 0.499_9, 24);
    assert_eq!(validity.bodies, 1);
    assert!(report.too_thin > 0, "{report:?}");
    let place = report.thin_place.expect("a place");
    assert!((place[2] - 0.5).abs() < 1e-3 && place[0] > 0.4 && place[0] < 3.6, "{place:?}");
}

#[test]
fn canals_that_the_ball_passes_are_not_listed() {
    for (mesh, gap) in [(plates(1.0), 1.0), (bored(1.0), 1.0)] {
        for resolution in [16, 32] {
            for (diameter, count) in [(0.6, 0), (0.9, 0), (0.98, 0), (1.02, 1), (1.4, 1)] {
                let options = CanalOptions {
                    max_diameter: diameter * gap,
                    remove: Remove::None,
                    surface: SurfaceOptions::new(VoxelSize::Along(resolution)),
                };
                let list = without_canals(&mesh, &options).expect("a solid").1.canals;
                assert_eq!(list.len(), count, "{diameter} gaps, {resolution} voxels: {list:?}");
                assert!(list.iter().all(|canal| canal.diameter < diameter * gap), "{list:?}");
                assert!(list.iter().all(|canal| (canal.diameter - gap).abs() < 0.05 * gap), "{list:?}");
            }
        }
    }
}
