use super::*;
use crate::mesh::shapes::cuboid;

fn cube() -> TriMesh {
    cuboid(DVec3::ZERO, DVec3::ONE)
}

/// Every triangle with corners of its own, each moved by up to `by` along the axes.
fn torn(mesh: &TriMesh, by: f64) -> TriMesh {
    let number = |k: usize| ((k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1u64 << 53) as f64;
    let corners = mesh.triangles.iter().flatten().enumerate();
    let moved = |(n, &v): (usize, &u32)| {
        mesh.positions[v as usize] + DVec3::new(number(3 * n), number(3 * n + 1), number(3 * n + 2)) * by
    };
    let positions = corners.map(moved).collect();
    TriMesh { positions, triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect() }
}

fn zipped(mesh: &TriMesh, tolerance: f64) -> Option<Zipped> {
    zip(mesh, Some(tolerance), &Progress::none()).expect("not stopped")
}

#[test]
fn a_torn_cube_is_whole_again_and_no_vertex_moves_farther_than_allowed() {
    let mesh = torn(&cube(), 1e-3);
    let Zipped { mesh: whole, sources, report } = zipped(&mesh, 2e-3).expect("cracks");
    assert_eq!((report.open_before, report.open_after, report.inserted), (36, 0, 0));
    assert_eq!((whole.triangles.len(), sources), (12, (0..12).collect()));
    assert!(report.farthest <= 2e-3 && report.farthest > 0.0, "{report:?}");
    let used: FxHashSet<u32> = whole.triangles.iter().flatten().copied().collect();
    assert_eq!(used.len(), 8);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for (k, &v) in triangle.iter().enumerate() {
            assert!(mesh.positions[v as usize].distance(whole.corners(t)[k]) <= 2e-3);
        }
    }
}

#[test]
fn what_is_farther_apart_stays_as_it_is() {
    assert!(zipped(&torn(&cube(), 1e-2), 1e-3).is_none());
    assert!(zipped(&cube(), 0.1).is_none());
    let mut open = cube();
    open.triangles.truncate(10);
    assert!(zipped(&open, 0.01).is_none());
    assert!(zipped(&open, 0.0).is_none());
}

/// A side of the cube in strips, each vertex of which lies a little beside the edges of the sides around.
#[test]
fn vertices_beside_edges_divide_them() {
    let mut mesh = cube();
    let is_top = |mesh: &TriMesh, t: usize| mesh.corners(t).iter().all(|p| p.z == 1.0);
    let rest = (0..12).filter(|&t| !is_top(&mesh, t)).map(|t| mesh.triangles[t]).collect();
    mesh.triangles = rest;
    let first = mesh.positions.len() as u32;
    for k in 0..=4 {
        let (x, off) = (f64::from(k) / 4.0, if k % 4 == 0 { 0.0 } else { 1e-4 });
        mesh.positions.extend([DVec3::new(x, off, 1.0 - off), DVec3::new(x, 1.0 + off, 1.0)]);
    }
    for k in 0..4 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|n| first + 2 * k + n);
        mesh.triangles.extend([[a, c, b], [b, c, d]]);
    }
    let Zipped { mesh: whole, sources, report } = zipped(&mesh, 1e-3).expect("cracks");
    assert_eq!((report.open_after, report.inserted, report.merged), (0, 6, 0), "{report:?}");
    assert_eq!(whole.triangles.len(), 18 + 6);
    assert!(sources.is_sorted());
    let volume: f64 =
        (0..whole.triangles.len()).map(|t| whole.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
    assert!((volume - 1.0).abs() < 1e-3, "{volume}");
}

#[test]
fn the_order_of_triangles_changes_nothing_but_their_order() {
    let mesh = torn(&cube(), 1e-3);
    let places = |mesh: &TriMesh| {
        let whole = zipped(mesh, 2e-3).expect("cracks").mesh;
        let mut corners: Vec<String> = (0..12).map(|t| format!("{:?}", whole.corners(t))).collect();
        corners.sort();
        corners
    };
    let mut other = mesh.clone();
    other.triangles.rotate_left(5);
    assert_eq!(places(&mesh), places(&other));
}

#[test]
fn sheets_that_lie_on_each_other_are_no_cracks_and_take_no_time() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut mesh = TriMesh::default();
    for n in 0..20_000u32 {
        mesh.positions.extend(square.map(|[x, y]| DVec3::new(x, y, f64::from(n) * 1e-9)));
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| 4 * n + v)));
    }
    let start = std::time::Instant::now();
    assert!(zipped(&mesh, 1e-3).is_none());
    assert!(start.elapsed().as_secs() < 20);
}
