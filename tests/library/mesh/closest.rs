//! The tree of nearest shapes against looking at all of them.

use glam::DVec3;
use meshwright::mesh::{ClosestTree, Feature, Pseudonormals, Shape};
use proptest::prelude::*;

use super::shapes::{cases, cube, torus};

/// Coordinates of which many are equal, so that shapes degenerate, coincide and tie.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-3i32..=3).prop_map(f64::from), -3.0..3.0f64, Just(1e-9), Just(1.0 + 1e-9)]
}

fn point() -> impl Strategy<Value = DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from)
}

fn placed() -> impl Strategy<Value = (f64, DVec3)> {
    let size = prop_oneof![Just(1.0), Just(1e-120), Just(1e120), 1e-3..1e3f64];
    let place = prop_oneof![Just(0.0), Just(1e3), Just(1e7)];
    (size, place).prop_map(|(size, place)| (size, DVec3::new(place, -place, 0.0)))
}

/// The nearest of all shapes, the first of equal ones.
fn by_looking<S: Shape>(shapes: &[S], p: DVec3) -> (u32, f64) {
    let square = |shape: &S| shape.nearest(p).0.distance_squared(p);
    let best = shapes.iter().map(square).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).expect("shapes");
    (best.0 as u32, best.1.sqrt())
}

fn agree<S: Shape>(shapes: &[S], points: &[DVec3], grow: f64) -> Result<(), TestCaseError> {
    let tree = ClosestTree::new(shapes.iter().map(|shape| shape.scaled(grow)).collect());
    let farthest = |p: DVec3| p.abs().max_element();
    let around = shapes.iter().map(Shape::bounds).map(|b| farthest(b.min).max(farthest(b.max))).fold(0.0, f64::max);
    for &p in points {
        // Growing rounds coordinates, unless it is by a power of two.
        let rounding = 1e-14 * around.max(farthest(p));
        let near = |a: f64, b: f64| (a - b).abs() <= rounding;
        let found = tree.nearest(p * grow).expect("the tree is not empty");
        let (_, distance) = by_looking(shapes, p);
        let own = shapes[found.id as usize].nearest(p).0.distance(p);
        prop_assert!(near(own, distance), "{own} {distance}");
        prop_assert!(near(found.distance / grow, distance), "{} {distance}", found.distance / grow);
        let limited = tree.nearest_within(p * grow, found.distance * 0.999);
        prop_assert!(limited.is_none() || found.distance == 0.0);
        prop_assert_eq!(tree.nearest_within(p * grow, found.distance * 1.001 + f64::MIN_POSITIVE), Some(found));
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn triangles_as_by_looking_at_all(
        corners in prop::collection::vec([point(), point(), point()], 1..60),
        points in prop::collection::vec(point(), 1..12),
        (grow, shift) in placed(),
    ) {
        let corners: Vec<[DVec3; 3]> = corners.iter().map(|t| t.map(|p| p + shift)).collect();
        let points: Vec<DVec3> = points.iter().map(|&p| 3.0 * p + shift).collect();
        agree(&corners, &points, grow)?;
    }

    #[test]
    fn segments_as_by_looking_at_all(
        ends in prop::collection::vec([point(), point()], 1..60),
        points in prop::collection::vec(point(), 1..12),
        (grow, shift) in placed(),
    ) {
        let ends: Vec<[DVec3; 2]> = ends.iter().map(|t| t.map(|p| p + shift)).collect();
        let points: Vec<DVec3> = points.iter().map(|&p| 3.0 * p + shift).collect();
        agree(&ends, &points, grow)?;
    }

    /// With a power of two nothing rounds: number, distance and ties are exactly those of the list.
    #[test]
    fn of_equal_distances_the_first_is_taken(
        corners in prop::collection::vec([point(), point(), point()], 1..30),
        points in prop::collection::vec(point(), 1..12),
    ) {
        let twice: Vec<[DVec3; 3]> = corners.iter().chain(&corners).copied().collect();
        let tree = ClosestTree::new(twice.clone());
        for p in points {
            let found = tree.nearest(p).expect("the tree is not empty");
            prop_assert_eq!((found.id, found.distance), by_looking(&twice, p));
        }
    }

    /// No point of a triangle is nearer than the one that is said to be, and that one is on the triangle.
    #[test]
    fn the_nearest_point_of_a_triangle(triangle in [point(), point(), point()], p in point(), p_far in point()) {
        let [a, b, c] = triangle;
        for p in [p, 2.0 * p_far] {
            let (nearest, feature) = triangle.nearest(p);
            let distance = nearest.distance(p);
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let other = a + (b - a) * (f64::from(i) / 40.0) + (c - a) * (f64::from(j) / 40.0);
                    prop_assert!(distance <= other.distance(p) + 1e-12);
                }
            }
            // Seen from itself, a point of the triangle is nearest at no distance.
            prop_assert!(triangle.nearest(nearest).0.distance(nearest) < 1e-12);
            match feature {
                Feature::Corner(k) => prop_assert_eq!(nearest, triangle[usize::from(k)]),
                Feature::Edge(k) => {
                    let k = usize::from(k);
                    prop_assert!([triangle[k], triangle[(k + 1) % 3]].nearest(nearest).0.distance(nearest) < 1e-12);
                }
                Feature::Inside => {}
            }
        }
    }

    /// Against the distance to a box as a formula has it.
    #[test]
    fn the_side_of_a_cube(p in [-1.0..2.0f64, -1.0..2.0f64, -1.0..2.0f64]) {
        let mesh = cube(DVec3::ZERO, 1.0);
        let p = DVec3::from(p);
        let out = (p - 0.5).abs() - 0.5;
        let expected = out.max(DVec3::ZERO).length() + out.max_element().min(0.0);
        let closest = ClosestTree::of_mesh(&mesh).nearest(p).expect("the tree is not empty");
        let signed = Pseudonormals::of(&mesh).signed(p, &closest);
        prop_assert!((signed - expected).abs() < 1e-12, "{signed} {expected}");
    }
}

#[test]
fn vertices_of_a_mesh_are_at_no_distance_and_corners() {
    let mesh = torus(24, 12);
    let tree = ClosestTree::of_mesh(&mesh);
    for &p in &mesh.positions {
        let found = tree.nearest(p).expect("the tree is not empty");
        assert_eq!((found.distance, found.point), (0.0, p));
        assert!(matches!(found.feature, Feature::Corner(_)));
    }
}

#[test]
fn an_empty_tree_finds_nothing_and_many_equal_shapes_do_no_harm() {
    assert_eq!(ClosestTree::<[DVec3; 2]>::new(Vec::new()).nearest(DVec3::ONE), None);
    let same = vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; 20_000];
    let tree = ClosestTree::new(same);
    assert_eq!(tree.len(), 20_000);
    let found = tree.nearest(DVec3::new(0.25, 0.25, 2.0)).expect("the tree is not empty");
    assert_eq!((found.id, found.distance, found.feature), (0, 2.0, Feature::Inside));
}
