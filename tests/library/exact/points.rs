//! One point at a time.

use glam::DVec3;
use meshwright::mesh::{Feature, TriMesh};
use meshwright::sdf::exact::{ExactDistance, PointSign};

use crate::common::exact::{by_looking, check_points, spread, winding};
use crate::common::shapes::{ball, gear, hard, knot};
use crate::common::{read, sample};

#[test]
fn hard_meshes_by_looking_at_all_triangles() {
    for (name, mesh) in hard() {
        check_points(name, &mesh);
    }
}

#[test]
fn parts_and_files_by_looking_at_all_triangles() {
    check_points("knot", &knot(96, 16));
    check_points("gear", &gear(24));
    for name in ["hollow_ball.stl", "monkey_saddle.off", "torus.ply"] {
        check_points(name, &read(&sample(name)));
    }
}

#[test]
fn the_gradient_is_that_of_finite_differences() {
    let mesh = ball(3, |p| 0.5 + 0.1 * (5.0 * p.x).sin());
    let exact = ExactDistance::of(&mesh, PointSign::Pseudonormal);
    let value = |p: DVec3| exact.at(p).expect("triangles").signed;
    let step = 1e-6;
    let mut checked = 0;
    for p in spread(DVec3::splat(-0.8), DVec3::splat(0.8), 500) {
        let slope = DVec3::from([0, 1, 2].map(|k| {
            let step = DVec3::AXES[k] * step;
            (value(p + step) - value(p - step)) / (2e-6)
        }));
        // On ridges of the distance, where the nearest point jumps, there is no gradient.
        if (slope.length() - 1.0).abs() < 1e-6 {
            checked += 1;
            assert!(slope.distance(exact.at(p).expect("triangles").gradient) < 1e-4, "{p}");
        }
    }
    assert!(checked > 450, "{checked}");
}

#[test]
fn on_the_surface_the_gradient_is_the_pseudonormal() {
    let mesh = crate::common::shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let exact = ExactDistance::of(&mesh, PointSign::Pseudonormal);
    for (p, expected) in [
        (DVec3::new(1.0, 0.3, 0.4), DVec3::X),
        (DVec3::new(1.0, 1.0, 0.4), DVec3::new(1.0, 1.0, 0.0).normalize()),
        (DVec3::ONE, DVec3::ONE.normalize()),
    ] {
        let nearest = exact.at(p).expect("triangles");
        assert_eq!((nearest.signed, nearest.point), (0.0, p));
        assert!(nearest.gradient.distance(expected) < 1e-12, "{} at {p}", nearest.gradient);
    }
    let above = exact.at(DVec3::new(0.5, 0.5, 3.0)).expect("triangles");
    assert_eq!((above.signed, above.point), (2.0, DVec3::new(0.5, 0.5, 1.0)));
    assert!(matches!(exact.at(DVec3::splat(2.0)).expect("triangles").feature, Feature::Corner(_)));
}

#[test]
fn crossings_of_levels_are_found() {
    let mesh = ball(4, |p| 0.5 + 0.05 * (9.0 * p.y).sin());
    let exact = ExactDistance::of(&mesh, PointSign::Pseudonormal);
    let mut found = 0;
    for pair in spread(DVec3::splat(-0.8), DVec3::splat(0.8), 400).chunks_exact(2) {
        for level in [-0.1, 0.0, 0.07] {
            let sides = [pair[0], pair[1]].map(|p| exact.at(p).expect("triangles").signed < level);
            match exact.crossing(pair[0], pair[1], level) {
                Some(t) => {
                    found += 1;
                    let signed = exact.at(pair[0].lerp(pair[1], t)).expect("triangles").signed;
                    assert!((signed - level).abs() < 1e-12, "{signed} instead of {level}");
                    assert_ne!(sides[0], sides[1]);
                }
                None => assert_eq!(sides[0], sides[1]),
            }
        }
    }
    assert!(found > 50, "{found}");
}

#[test]
fn soups_take_their_side_from_the_winding_number() {
    let mut mesh = ball(3, |_| 0.5);
    mesh.triangles.truncate(mesh.triangles.len() - 60);
    let all = 0..mesh.triangles.len();
    let tree = meshwright::vote::WindingTree::new(&mesh, all, &meshwright::progress::Progress::none());
    let exact = ExactDistance::of(&mesh, PointSign::Winding(tree.expect("not stopped")));
    for p in spread(DVec3::splat(-0.7), DVec3::splat(0.7), 400) {
        let (number, nearest) = (winding(&mesh, p), exact.at(p).expect("triangles"));
        if (number - 0.5).abs() > 0.03 {
            assert_eq!(nearest.signed < 0.0, number > 0.5, "{p}");
        }
        assert!((nearest.signed.abs() - by_looking(&mesh, p).abs()).abs() < 1e-9);
    }
}

#[test]
fn a_mesh_without_triangles_has_no_distance() {
    let exact = ExactDistance::of(&TriMesh::default(), PointSign::Pseudonormal);
    assert_eq!(exact.at(DVec3::ZERO), None);
    assert_eq!(exact.crossing(DVec3::ZERO, DVec3::ONE, 0.0), None);
    assert_eq!(exact.at_all(&[DVec3::ZERO, DVec3::ONE]), [None, None]);
}
