//! What `validate` counts and `defects` finds.

use glam::DVec3;
use meshwright::mesh::{Bounds, TriMesh, ValidateOptions, Validity, defects, self_intersections, validate};
use meshwright::progress::{Progress, Stopped};

use super::shapes::{checked, cube, soup_of, torus, unit_cube};

#[test]
fn a_cube_is_valid_and_measured() {
    let found = checked(&cube(DVec3::new(1e3, -5.0, 2.0), 2.0));
    let expected = Validity {
        vertices: 8,
        unused_vertices: 0,
        triangles: 12,
        open_edges: 0,
        nonmanifold_edges: 0,
        nonmanifold_vertices: 0,
        inconsistent_edges: 0,
        degenerate_triangles: 0,
        duplicate_triangles: 0,
        self_intersecting_triangles: Some(0),
        bodies: 1,
        genus: Some(0),
        volume: found.volume,
        area: 24.0,
        bounds: Some([[1e3, -5.0, 2.0], [1e3 + 2.0, -3.0, 4.0]]),
    };
    assert_eq!(found, expected);
    assert!((found.volume - 8.0).abs() < 1e-12, "{}", found.volume);
    assert!(found.is_valid());
    assert_eq!(found.problems(), Vec::<String>::new());
}

#[test]
fn genus_and_bodies_are_counted_over_all_shells() {
    let mut mesh = torus(20, 12);
    mesh.append(&torus(20, 12));
    mesh.positions[240..].iter_mut().for_each(|p| p.z += 10.0);
    mesh.append(&cube(DVec3::splat(20.0), 1.0));
    let found = checked(&mesh);
    assert!(found.is_valid(), "{:?}", found.problems());
    assert_eq!((found.bodies, found.genus), (3, Some(2)));
}

#[test]
fn a_missing_triangle_opens_three_edges() {
    let mut mesh = unit_cube();
    mesh.triangles.pop();
    let found = checked(&mesh);
    assert_eq!((found.open_edges, found.is_closed(), found.genus), (3, false, None));
    assert_eq!(found.problems(), ["3 edges are open (have one triangle)."]);
}

#[test]
fn a_flipped_triangle_is_inconsistent_and_a_flipped_body_inside_out() {
    let mut mesh = unit_cube();
    mesh.triangles[3].swap(0, 1);
    let found = checked(&mesh);
    assert_eq!((found.inconsistent_edges, found.is_closed(), found.is_oriented_manifold()), (3, true, false));
    assert_eq!(found.problems(), ["3 edges join triangles that face opposite ways."]);

    let mut mesh = unit_cube();
    mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let found = checked(&mesh);
    assert!(found.is_oriented_manifold() && !found.is_valid());
    assert_eq!(found.problems(), ["The surface is inside out: its volume is negative."]);
}

#[test]
fn cubes_that_share_an_edge_or_a_corner_are_no_manifold() {
    let joined = |offset: DVec3| {
        let mut mesh = unit_cube();
        mesh.append(&cube(offset, 1.0));
        checked(&mesh.welded())
    };
    let edge = joined(DVec3::new(1.0, 1.0, 0.0));
    assert_eq!((edge.nonmanifold_edges, edge.nonmanifold_vertices, edge.bodies), (1, 0, 1));
    assert_eq!(edge.self_intersecting_triangles, Some(0));
    let corner = joined(DVec3::ONE);
    assert_eq!((corner.nonmanifold_edges, corner.nonmanifold_vertices, corner.bodies), (0, 1, 2));
    assert_eq!(corner.problems(), ["1 vertex joins surfaces that touch only there."]);
    // Faces that coincide are duplicates, and every one of them intersects its copy.
    let face = joined(DVec3::X);
    assert!(face.nonmanifold_edges > 0 && face.self_intersecting_triangles > Some(0));
}

#[test]
fn duplicates_degenerates_and_unused_vertices_are_counted_apart() {
    let mut mesh = unit_cube();
    let [a, b, c] = mesh.triangles[0];
    mesh.triangles.extend([[b, c, a], [c, b, a], [a, a, b]]);
    mesh.positions.extend([DVec3::splat(9.0), DVec3::splat(0.5)]);
    let found = checked(&mesh);
    assert_eq!((found.duplicate_triangles, found.degenerate_triangles, found.unused_vertices), (2, 1, 2));
    assert_eq!(found.self_intersecting_triangles, Some(3));
    assert_eq!(found.bounds, Some([[0.0; 3], [1.0; 3]]));

    let where_ = defects(&mesh, &ValidateOptions::default(), &Progress::none()).unwrap();
    assert_eq!(where_.duplicates, [12, 13]);
    assert_eq!(where_.degenerate, [14]);
    assert_eq!(where_.self_intersecting, [0, 12, 13]);
    assert_eq!(where_.nonmanifold_edges.len(), 3);
    assert_eq!((where_.open_edges.len(), where_.nonmanifold_vertices.len()), (0, 0));
}

#[test]
fn zero_area_is_judged_exactly() {
    // Collinear for the naked eye and in f32, but not exactly.
    let tip = DVec3::new(2.0, f64::from_bits(2f64.to_bits() + 1), 0.0);
    let sliver =
        |tip| TriMesh { positions: vec![DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), tip], triangles: vec![[0, 1, 2]] };
    assert_eq!(checked(&sliver(tip)).degenerate_triangles, 0);
    assert_eq!(checked(&sliver(DVec3::new(2.0, 2.0, 0.0))).degenerate_triangles, 1);
}

#[test]
fn welding_closes_a_soup() {
    let soup = soup_of(&torus(12, 8));
    let options = ValidateOptions { weld: true, self_intersections: true };
    let found = validate(&soup, &options, &Progress::none()).unwrap();
    assert!(found.is_valid());
    assert_eq!((found.vertices, found.unused_vertices, found.genus), (96, 0, Some(1)));
    let apart = checked(&soup);
    assert_eq!((apart.open_edges, apart.bodies, apart.self_intersecting_triangles), (576, 192, Some(0)));
    let mut holed = soup.clone();
    holed.triangles.swap_remove(0);
    let where_ = defects(&holed, &options, &Progress::none()).unwrap();
    assert_eq!(where_.open_edges.len(), 3);
}

#[test]
fn defects_agree_with_the_counts() {
    let mut mesh = torus(10, 8);
    mesh.triangles.drain(3..9);
    mesh.triangles[20].swap(1, 2);
    mesh.triangles.push([0, 5, 60]);
    mesh.triangles.push([0, 1, 40]);
    let options = ValidateOptions::default();
    let (count, place) = (checked(&mesh), defects(&mesh, &options, &Progress::none()).unwrap());
    assert_eq!(count.open_edges, place.open_edges.len());
    assert_eq!(count.nonmanifold_edges, place.nonmanifold_edges.len());
    assert_eq!(count.nonmanifold_vertices, place.nonmanifold_vertices.len());
    assert_eq!(count.inconsistent_edges, place.inconsistent_edges.len());
    assert_eq!(count.self_intersecting_triangles, Some(place.self_intersecting.len()));
    assert!(count.open_edges > 0 && count.nonmanifold_vertices > 0 && count.inconsistent_edges > 0);
    assert!(!place.self_intersecting.is_empty());
}

#[test]
fn nothing_is_not_a_solid() {
    let found = checked(&TriMesh::default());
    assert!(!found.is_closed() && !found.is_valid());
    assert_eq!((found.bounds, found.problems().len()), (None, 1));
}

#[test]
fn what_was_not_checked_is_not_called_valid() {
    let options = ValidateOptions { self_intersections: false, weld: false };
    let found = validate(&unit_cube(), &options, &Progress::none()).unwrap();
    assert!(found.is_oriented_manifold() && !found.is_valid());
    assert_eq!(found.problems(), ["Self-intersections were not checked."]);
}

#[test]
fn a_deadline_stops_validation() {
    let progress = Progress::none().with_deadline(std::time::Instant::now());
    assert_eq!(validate(&unit_cube(), &ValidateOptions::default(), &progress), Err(Stopped::Deadline));
    assert_eq!(self_intersections(&unit_cube(), &progress), Err(Stopped::Deadline));
}

#[test]
fn bounds_of_used_vertices_only() {
    let mut mesh = unit_cube();
    mesh.positions.push(DVec3::splat(5.0));
    assert_eq!(mesh.bounds(), Some(Bounds { min: DVec3::ZERO, max: DVec3::ONE }));
}
