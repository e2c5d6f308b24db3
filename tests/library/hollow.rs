//! Shelling out: the wall has its thickness, the surface stays as it is, drains lead into the cavity.

use crate::common::repaired::hollowed;
use crate::common::shapes;
use glam::DVec3;
use meshwright::mesh::{ClosestTree, TriMesh, ValidateOptions, Validity, validate};
use meshwright::pipeline::{Drain, HollowError, HollowOptions, MorphologyError, SurfaceOptions, VoxelSize};
use meshwright::progress::Progress;

fn state(mesh: &TriMesh) -> Validity {
    validate(mesh, &ValidateOptions::default(), &Progress::none()).expect("not stopped")
}

fn options(wall: f64, voxel: f64, drains: &[Drain]) -> HollowOptions {
    HollowOptions { wall, drains: drains.to_vec(), surface: SurfaceOptions::new(VoxelSize::Length(voxel)) }
}

fn block() -> TriMesh {
    shapes::cuboid(DVec3::ZERO, DVec3::new(10.0, 8.0, 6.0))
}

/// The triangles of `part` that `whole` has, corner for corner.
fn found_in(part: &TriMesh, whole: &TriMesh) -> usize {
    let all: Vec<[DVec3; 3]> = (0..whole.triangles.len()).map(|t| whole.corners(t)).collect();
    (0..part.triangles.len()).filter(|&t| all.contains(&part.corners(t))).count()
}

#[test]
fn a_block_becomes_a_box_with_walls_of_that_thickness() {
    let mesh = block();
    let made = hollowed(&mesh, &options(1.0, 0.2, &[])).expect("hollow");
    let after = state(&made.solid);
    assert!(after.is_valid() && after.bodies == 2, "{:?}", after.problems());
    assert!((after.volume - (480.0 - 8.0 * 6.0 * 4.0)).abs() < 0.02, "{}", after.volume);
    assert_eq!(found_in(&mesh, &made.solid), 12, "the outer surface is not as it was");
    let report = made.report.hollow.expect("a report");
    assert_eq!((report.cavities, report.left_out), (1, 0));
    assert!((report.volume_before - 480.0).abs() < 1e-9 && report.volume_after == after.volume);
    // Every point of the cavity is as far from the surface as the wall is thick.
    let tree = ClosestTree::of_mesh(&mesh);
    for (t, source) in made.sources.iter().enumerate().filter(|(_, source)| source.is_made_up()) {
        for p in made.solid.corners(t) {
            let wall = tree.nearest(p).expect("triangles").distance;
            assert!((wall - 1.0).abs() < 0.02, "a wall of {wall} at {p} ({source:?})");
        }
    }
}

/// The same surface with every triangle cut into four at the middles of its edges, some times.
fn finer(mesh: &TriMesh, times: usize) -> TriMesh {
    let mut finer = mesh.clone();
    for _ in 0..times {
        let mut next = TriMesh::default();
        for t in 0..finer.triangles.len() {
            let [a, b, c] = finer.corners(t);
            let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
            let first = next.positions.len() as u32;
            next.positions.extend([a, b, c, ab, bc, ca]);
            next.triangles.extend([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]].map(|t| t.map(|v: u32| first + v)));
        }
        finer = next.welded();
    }
    finer
}

#[test]
fn drains_lead_from_the_surface_into_the_cavity_and_leave_the_rest() {
    let mesh = finer(&block(), 4);
    let drains = [
        Drain { diameter: 1.5, at: DVec3::new(3.0, 4.0, -2.0) },
        Drain { diameter: 1.0, at: DVec3::new(10.5, 4.0, 3.0) },
    ];
    let made = hollowed(&mesh, &options(1.0, 0.125, &drains)).expect("hollow");
    let after = state(&made.solid);
    // Two holes into one cavity: one surface with one tunnel.
    assert!(after.is_valid(), "{:?}", after.problems());
    assert_eq!((after.bodies, after.genus), (1, Some(1)));
    let holes = std::f64::consts::FRAC_PI_4 * (1.5 * 1.5 + 1.0);
    assert!((after.volume - (480.0 - 192.0 - holes)).abs() < 0.05, "{}", after.volume);
    let report = made.report.hollow.expect("a report");
    assert_eq!(report.drains.len(), 2);
    for (drain, way) in report.drains.iter().zip([DVec3::Z, DVec3::NEG_X]) {
        assert!(
            DVec3::from_array(drain.direction).distance(way) < 1e-9 && (drain.depth - 1.0).abs() < 0.02,
            "{drain:?}"
        );
    }
    // What no drain cuts, nor is beside what one cuts, is as it was.
    let all: Vec<[DVec3; 3]> = (0..made.solid.triangles.len()).map(|t| made.solid.corners(t)).collect();
    let near = |p: DVec3| drains.iter().any(|d| p.distance(d.at) < 0.5 * d.diameter + 3.0);
    let away = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).filter(|corners| !corners.iter().any(|&p| near(p)));
    let (kept, lost): (Vec<_>, Vec<_>) = away.partition(|corners| all.contains(corners));
    assert!(lost.is_empty() && kept.len() > 2000, "{} triangles are as they were, {} are not", kept.len(), lost.len());
    // Nothing is left in the way of the holes.
    let tree = ClosestTree::of_mesh(&made.solid);
    for depth in [-0.1, 0.5, 1.0, 1.2] {
        for p in [DVec3::new(3.0, 4.0, depth), DVec3::new(10.0 - depth, 4.0, 3.0)] {
            assert!(tree.nearest(p).expect("triangles").distance > 0.4, "something is in the way at {p}");
        }
    }
}

#[test]
fn a_void_that_is_there_already_gets_a_wall_too() {
    let mut mesh = shapes::cuboid(DVec3::ZERO, DVec3::splat(12.0));
    let void = shapes::cuboid(DVec3::splat(5.0), DVec3::splat(7.0));
    mesh.append(&TriMesh { triangles: void.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..void });
    let made = hollowed(&mesh, &options(1.0, 0.2, &[])).expect("hollow");
    let after = state(&made.solid);
    assert!(after.is_valid() && after.bodies == 4, "{} surfaces, {:?}", after.bodies, after.problems());
    assert_eq!(found_in(&mesh, &made.solid), 24);
}

#[test]
fn what_cannot_be_hollow_is_refused_with_words() {
    let mesh = block();
    let words = |options: &HollowOptions| hollowed(&mesh, options).expect_err("refused").to_string();
    let refused = words(&options(4.0, 0.5, &[]));
    assert!(refused.contains("nothing would be hollow"), "{refused}");
    let refused = words(&options(0.3, 0.2, &[]));
    assert!(refused.contains("need a voxel of at most"), "{refused}");
    let narrow = Drain { diameter: 0.3, at: DVec3::ZERO };
    let refused = words(&options(1.0, 0.2, &[narrow]));
    assert!(refused.contains("drains of 0.3 need a voxel"), "{refused}");
    for wall in [0.0, -1.0, f64::NAN] {
        assert!(matches!(
            hollowed(&mesh, &options(wall, 0.2, &[])),
            Err(HollowError::Erosion(MorphologyError::Radius { .. }))
        ));
    }
}

#[test]
fn a_drain_that_meets_no_cavity_is_refused_with_its_place() {
    // Thin at the tail, so that the cavity is in the head alone.
    let mut mesh = shapes::cuboid(DVec3::ZERO, DVec3::splat(10.0));
    mesh.append(&shapes::cuboid(DVec3::new(10.0 - 1e-3, 4.0, 4.0), DVec3::new(20.0, 6.0, 6.0)));
    let drain = Drain { diameter: 1.2, at: DVec3::new(16.0, 5.0, 7.0) };
    let refused = hollowed(&mesh, &options(1.0, 0.25, &[drain])).expect_err("no cavity is there");
    assert!(
        matches!(refused, HollowError::Drain { number: 1, .. }) && refused.to_string().contains("drain 1 at 16 5 7")
    );
}
