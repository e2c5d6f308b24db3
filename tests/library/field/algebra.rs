//! Averages, morphs, blends, blobs and blur against what they must be.

use std::sync::Arc;

use glam::DVec3;
use meshwright::field::algebra::{average, complement, depth, intersection, morph, offset, union};
use meshwright::field::blend::{blend_difference, blend_intersection, blend_union};
use meshwright::field::blob::{BlobOptions, blob, blob_intersection, blob_union, compare};
use meshwright::field::{Body, FillOptions, Sampled, Shared, Solid, blur_band, blurred, fill, material, scattered};
use meshwright::lattice::Lattice;
use meshwright::mesh::Bounds;
use meshwright::progress::Progress;
use proptest::prelude::*;

use super::support::{body, cube, mesh, room, sphere, surface};
use crate::common::shapes;

#[test]
fn levels_of_all_shapes_are_valid_and_lie_on_the_level() {
    for (name, field) in super::support::all() {
        let bounded = field.extent().bounds().is_some();
        if !bounded || name == "points" {
            continue;
        }
        let h = 0.04;
        let (level, validity) = surface(&field, h);
        assert!(validity.is_valid(), "{name}: {:?}", validity.problems());
        assert!(!level.cut_off, "{name}");
        assert!(!level.contour.mesh.triangles.is_empty(), "{name}");
        let off = level.contour.mesh.positions.iter().map(|&p| field.value(p).abs()).fold(0.0, f64::max);
        // Vertices keep a hundredth of a voxel from the ends of lattice edges.
        assert!(off < 0.0101 * h * field.lipschitz().min(8.0) + 1e-6, "{name}: {} h", off / h);
    }
}

#[test]
fn the_average_of_concentric_spheres_is_the_sphere_of_the_mean_radius() {
    let h = 0.05;
    let meshes = [0.6, 1.0].map(ball_mesh);
    for fields in [[sphere(0.6, [0.0; 3]), sphere(1.0, [0.0; 3])], [mesh(&meshes[0]), mesh(&meshes[1])]] {
        for (weights, radius) in [([1.0, 1.0], 0.8), ([1.0, 3.0], 0.9)] {
            let (level, _) = surface(&average(fields.to_vec(), &weights), h);
            for p in &level.contour.mesh.positions {
                assert!((p.length() - radius).abs() < 0.05 * h, "{} of {radius}", p.length());
            }
        }
    }
}

/// So fine that its sides are nowhere farther from the sphere than 4e-4 of the radius.
fn ball_mesh(radius: f64) -> meshwright::mesh::TriMesh {
    surface(&sphere(radius, [0.0; 3]), radius / 24.0).0.contour.mesh
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_morph_is_its_ends_at_its_ends_and_continuous_between(t in 0.0..1.0f64, step in 0.0..0.01f64, seed in 0u64..1000) {
        let (a, b) = (cube(1.1), mesh(&shapes::torus_of(30, 12, 0.9, 0.3)));
        for p in scattered(10, seed, &room()) {
            let at = |t: f64| morph(a.clone(), b.clone(), t).value(p);
            prop_assert_eq!(at(0.0), a.value(p));
            prop_assert_eq!(at(1.0), b.value(p));
            let bound = (a.value(p) - b.value(p)).abs() * step + 1e-12;
            prop_assert!((at((t + step).min(1.0)) - at(t)).abs() <= bound);
        }
    }

    #[test]
    fn a_blend_away_from_the_seam_is_the_boolean(radius in 0.05..0.5f64, seed in 0u64..1000) {
        let (a, b) = (cube(1.3), sphere(0.8, [0.5, 0.2, 0.1]));
        let kinds = [
            (blend_union(a.clone(), b.clone(), radius), union(vec![a.clone(), b.clone()])),
            (blend_intersection(a.clone(), b.clone(), radius), intersection(vec![a.clone(), b.clone()])),
            (blend_difference(a.clone(), b.clone(), radius), intersection(vec![a.clone(), complement(b.clone())])),
        ];
        for p in scattered(200, seed, &room()).into_iter().filter(|&p| a.value(p).hypot(b.value(p)) >= radius) {
            for (blended, plain) in &kinds {
                let (blended, plain) = (blended.value(p), plain.value(p));
                prop_assert!(blended * plain >= 0.0, "{blended} and {plain} at {p}");
            }
        }
        for p in scattered(200, seed + 7, &room()) {
            // The union only grows, the others only shrink.
            prop_assert!(kinds[0].0.value(p) <= 0.0 || kinds[0].1.value(p) > 0.0);
            prop_assert!(kinds[1].0.value(p) >= 0.0 || kinds[1].1.value(p) < 0.0);
            prop_assert!(kinds[2].0.value(p) >= 0.0 || kinds[2].1.value(p) < 0.0);
        }
    }

    #[test]
    fn booleans_have_the_side_that_their_parts_make(seed in 0u64..1000) {
        let (a, b) = (mesh(&shapes::torus_of(30, 12, 0.9, 0.3)), cube(1.0));
        for p in scattered(60, seed, &room()) {
            let (in_a, in_b) = (a.value(p) < 0.0, b.value(p) < 0.0);
            prop_assert_eq!(union(vec![a.clone(), b.clone()]).value(p) < 0.0, in_a || in_b);
            prop_assert_eq!(intersection(vec![a.clone(), b.clone()]).value(p) < 0.0, in_a && in_b);
            prop_assert_eq!(intersection(vec![a.clone(), complement(b.clone())]).value(p) < 0.0, in_a && !in_b);
        }
    }
}

/// A blend of two planes at right angles, on the diagonal, is near the arc that touches both at the radius.
#[test]
fn a_blended_corner_is_nearly_an_arc() {
    let plane = |axis| -> Shared { Arc::new(Body { solid: Solid::HalfSpace, centre: DVec3::ZERO, axis }) };
    let radius = 0.4;
    let blended = blend_union(plane(0), plane(1), radius);
    let arc = radius * (1.0 - 0.5f64.sqrt());
    let value = blended.value(DVec3::new(arc, arc, 0.0));
    assert!(value.abs() < 0.01 * radius, "{value}");
}

/// On the level the gradient of a blend does not jump across the seam, that of the plain boolean does.
#[test]
fn a_blend_has_no_crease() {
    let (a, b) = (sphere(0.8, [-0.5, 0.0, 0.0]), sphere(0.8, [0.5, 0.0, 0.0]));
    let jump = |field: &Shared| {
        let radial = |x: f64| {
            let (mut low, mut high) = (0.0, 2.0);
            for _ in 0..60 {
                let middle = (low + high) / 2.0;
                if field.value(DVec3::new(x, middle, 0.0)) < 0.0 { low = middle } else { high = middle }
            }
            DVec3::new(x, low, 0.0)
        };
        let normal = |x: f64| field.sample(radial(x)).gradient.normalize();
        (normal(-1e-4) - normal(1e-4)).length()
    };
    assert!(jump(&union(vec![a.clone(), b.clone()])) > 1.0);
    assert!(jump(&blend_union(a, b, 0.3)) < 0.01);
}

#[test]
fn blobs_are_one_half_on_the_surface_and_join_near_each_other() {
    for gain in [0.3, 0.5, 0.8] {
        let options = BlobOptions { radius: 0.5, gain };
        for (distance, expected) in [(-0.5, 1.0), (-2.0, 1.0), (0.0, 0.5), (0.5, 0.0), (3.0, 0.0)] {
            assert!((options.blob(distance) - expected).abs() < 1e-12, "{gain}: {distance}");
        }
        let steep: Vec<f64> = (-60..60).map(|k| options.blob(f64::from(k) * 0.01)).collect();
        assert!(steep.windows(2).all(|pair| pair[1] <= pair[0]));
    }
    let options = BlobOptions { radius: 0.5, gain: 0.5 };
    let apart = [sphere(0.4, [-0.5, 0.0, 0.0]), sphere(0.4, [0.5, 0.0, 0.0])];
    // Half of the radius from each surface: a quarter of a blob each, which makes one half.
    let middle = DVec3::new(0.0, 0.0, 0.0);
    let [one, other] = apart.clone();
    assert!(blob_union(apart.to_vec(), options).value(middle) < 0.0 && union(apart.to_vec()).value(middle) > 0.0);
    assert!(blob_union(vec![one.clone()], options).value(middle) > 0.0);
    assert!(blob_intersection(vec![one.clone(), one.clone()], options).value(DVec3::new(-0.5, 0.0, 0.0)) < 0.0);
    assert!((blob(one.clone(), options).value(middle) - 0.1).abs() < 1e-12, "with the gain 1/2 it is the distance");
    let far = DVec3::new(0.0, 0.0, 1.5);
    assert_eq!(compare(one.clone(), other, options).value(far), 0.0, "nothing is different where both are far");
    assert!(compare(one, apart[1].clone(), options).value(DVec3::new(-0.5, 0.0, 0.0)) > 0.8);
}

#[test]
fn a_blurred_plane_is_the_plane_and_a_blurred_box_is_rounder() {
    let h = 0.05;
    let bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
    let lattice = Lattice::around(&bounds, h);
    let sigma = 2.0 * h;
    let blur = |field: &Shared| {
        let options = FillOptions { band: Some(blur_band(sigma)), max_memory: None };
        let sharp = fill(&**field, &lattice, &options, &Progress::none()).unwrap();
        Sampled::new(blurred(&sharp, sigma, &Progress::none()).unwrap())
    };
    use meshwright::field::Field;
    let plane = blur(&body(Solid::HalfSpace, [0.0, 0.0, 0.013]));
    // Away from the border, beyond which nothing is known.
    let inner = Bounds { min: DVec3::splat(-0.4), max: DVec3::splat(0.4) };
    for p in scattered(500, 1, &inner).into_iter().map(|p| DVec3::new(p.x, p.y, 0.1 * p.z)) {
        assert!((plane.value(p) - (p.z - 0.013)).abs() < 1e-5, "{} at {p}", plane.value(p));
    }
    let block = blur(&cube(1.0));
    let corner = DVec3::splat(0.5);
    assert!(block.value(corner) > 0.02 && block.value(DVec3::new(0.5, 0.0, 0.0)).abs() < 1e-3);
}

#[test]
fn a_property_is_what_it_is_on_each_shape_and_between_them_in_between() {
    let shapes = vec![sphere(0.2, [-1.0, 0.0, 0.0]), sphere(0.2, [1.0, 0.0, 0.0]), sphere(0.2, [0.0, 1.0, 0.0])];
    let property = material(shapes, vec![1.0, 3.0, 8.0]);
    for (x, y, expected) in [(-0.8, 0.0, 1.0), (0.0, 0.8, 8.0)] {
        assert!((property.value(DVec3::new(x, y, 0.0)) - expected).abs() < 1e-9);
    }
    for p in scattered(200, 4, &room()) {
        assert!((1.0..=8.0).contains(&property.value(p)));
    }
    let two = material(vec![sphere(0.2, [-1.0, 0.0, 0.0]), sphere(0.2, [1.0, 0.0, 0.0])], vec![1.0, 3.0]);
    assert!((two.value(DVec3::ZERO) - 2.0).abs() < 1e-12, "half way");
}

#[test]
fn the_depth_is_that_of_the_deepest_point() {
    for (field, expected) in [
        (sphere(0.7, [0.3, 0.2, 0.1]), 0.7),
        (body(Solid::Box { size: DVec3::new(2.0, 1.0, 0.5) }, [0.0; 3]), 0.25),
        (mesh(&shapes::torus_of(60, 30, 0.9, 0.3)), 0.298),
        (offset(cube(1.0), -0.7), 0.0),
    ] {
        let found = depth(&field);
        assert!((found - expected).abs() <= 0.012 * expected, "{found} instead of {expected}");
    }
}
