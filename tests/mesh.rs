//! Promises of `mesh`: counts on meshes whose defects are known, intersections against integer arithmetic, and
//! half-edges that stay manifolds whatever is done to them.

use glam::DVec3;
use meshwright::mesh::{
    Bounds, HalfEdges, NotManifold, TriMesh, ValidateOptions, Validity, defects, intersecting_triangles,
    self_intersections, triangles_intersect, validate,
};
use meshwright::progress::{Progress, Stopped};
use proptest::prelude::*;

mod shapes {
    use super::*;

    pub fn cube(low: DVec3, size: f64) -> TriMesh {
        let corner = |i: u32| low + size * DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        TriMesh {
            positions: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    /// A torus of n × m quads around the z axis.
    pub fn torus(n: u32, m: u32) -> TriMesh {
        let turn = |k: u32, of: u32| std::f64::consts::TAU * f64::from(k) / f64::from(of);
        let point = |i: u32, j: u32| {
            let (a, b) = (turn(i, n), turn(j, m));
            DVec3::new((3.0 + b.cos()) * a.cos(), (3.0 + b.cos()) * a.sin(), b.sin())
        };
        let id = |i: u32, j: u32| (i % n) * m + j % m;
        let quad = |i, j| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        TriMesh {
            positions: cells().map(|(i, j)| point(i, j)).collect(),
            triangles: cells().map(|(i, j)| quad(i, j)).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    /// Every triangle with vertices of its own, as in an STL file.
    pub fn soup_of(mesh: &TriMesh) -> TriMesh {
        TriMesh {
            positions: (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).collect(),
            triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        }
    }
}

use shapes::{cube, soup_of, torus};

fn checked(mesh: &TriMesh) -> Validity {
    validate(mesh, &ValidateOptions::default(), &Progress::none()).unwrap()
}

/// Flat triangles are thrown away by the tests, so many more may be drawn than are used.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, max_global_rejects: 20 * cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn unit_cube() -> TriMesh {
    cube(DVec3::ZERO, 1.0)
}

// ---------------------------------------------------------------- validity

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
    assert_eq!(corner.problems(), ["1 vertex joins several fans of triangles."]);
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

// ---------------------------------------------------------------- intersections

#[test]
fn overlapping_cubes_intersect_where_they_cross() {
    let mut mesh = unit_cube();
    mesh.append(&cube(DVec3::splat(0.5), 1.0));
    let pairs = self_intersections(&mesh, &Progress::none()).unwrap();
    assert!(!pairs.is_empty() && pairs.is_sorted());
    assert!(pairs.iter().all(|&[a, b]| a < 12 && b >= 12));
    assert_eq!(checked(&mesh).bodies, 2);
}

#[test]
fn hostile_meshes_are_judged_in_little_time_and_memory() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let same = TriMesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]; 10_000] };
    assert_eq!(intersecting_triangles(&same, &Progress::none()).unwrap().len(), 10_000);
    assert_eq!(self_intersections(&same, &Progress::none()).unwrap().len(), 9_999);
    // All of them meet all others: fifty million pairs, which must not all be tested.
    let fan = |k: u32| corners.map(|p| p + DVec3::Z * (p.x - 0.3) * f64::from(k));
    let crossed = TriMesh {
        positions: (0..10_000).flat_map(fan).collect(),
        triangles: (0..10_000).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    };
    assert_eq!(intersecting_triangles(&crossed, &Progress::none()).unwrap().len(), 10_000);
    for scale in [1e38, 1e300, 1e-38, 1e-300] {
        let mut mesh = torus(16, 12);
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        assert_eq!(intersecting_triangles(&mesh, &Progress::none()).unwrap(), Vec::<u32>::new());
        mesh.append(&mesh.clone());
        mesh.positions[192..].iter_mut().for_each(|p| *p += DVec3::new(0.3, 0.2, 0.1) * scale);
        assert!(!intersecting_triangles(&mesh, &Progress::none()).unwrap().is_empty(), "{scale}");
    }
}

#[test]
fn far_from_the_origin_flat_faces_still_do_not_intersect() {
    // Rotated and rounded to f32, a thousand triangles of one face are only nearly coplanar.
    let (n, side) = (24u32, 25u32);
    let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0);
    let point = |k: u32| turn * DVec3::new(f64::from(k % side), f64::from(k / side), 0.0) + DVec3::splat(1000.0);
    let quad = |i: u32, j: u32| [j * side + i, j * side + i + 1, (j + 1) * side + i + 1, (j + 1) * side + i];
    let mesh = TriMesh {
        positions: (0..side * side).map(|k| point(k).as_vec3().as_dvec3()).collect(),
        triangles: (0..n * n).map(|k| quad(k % n, k / n)).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    };
    assert_eq!(intersecting_triangles(&mesh, &Progress::none()).unwrap(), Vec::<u32>::new());
}

type Corner = [i64; 3];

/// The test of two triangles in plain integers, by other formulas than the library's.
mod integers {
    use super::Corner;

    fn sub(a: Corner, b: Corner) -> Corner {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }
    fn cross(a: Corner, b: Corner) -> Corner {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }
    fn dot(a: Corner, b: Corner) -> i64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    pub fn normal([a, b, c]: [Corner; 3]) -> Corner {
        cross(sub(b, a), sub(c, a))
    }
    /// Whether `x`/`d` (d > 0) in the plane of the triangle lies in it.
    fn holds(t: [Corner; 3], x: Corner, d: i64) -> bool {
        let n = normal(t);
        (0..3).all(|k| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            dot(n, cross(sub(b, a), sub(x, a.map(|v| v * d)))) >= 0
        })
    }
    /// Whether closed segments in the plane of normal `n` meet.
    fn segments_meet(n: Corner, p: Corner, q: Corner, a: Corner, b: Corner) -> bool {
        let turn = |a: Corner, b: Corner, c: Corner| dot(n, cross(sub(b, a), sub(c, a))).signum();
        let on = |a: Corner, b: Corner, x: Corner| turn(a, b, x) == 0 && dot(sub(a, x), sub(b, x)) <= 0;
        let proper = turn(p, q, a) * turn(p, q, b) < 0 && turn(a, b, p) * turn(a, b, q) < 0;
        proper || on(p, q, a) || on(p, q, b) || on(a, b, p) || on(a, b, q)
    }
    /// Whether the closed segment meets the closed triangle.
    fn stabs(p: Corner, q: Corner, t: [Corner; 3]) -> bool {
        let n = normal(t);
        let (s, e) = (dot(n, sub(p, t[0])), dot(n, sub(q, t[0])));
        if s == 0 && e == 0 {
            return holds(t, p, 1) || holds(t, q, 1) || (0..3).any(|k| segments_meet(n, p, q, t[k], t[(k + 1) % 3]));
        }
        if s * e > 0 {
            return false;
        }
        // The crossing is (|e| p + |s| q) / (|s| + |e|).
        let (s, e) = (s.abs(), e.abs());
        holds(t, [0, 1, 2].map(|k| p[k] * e + q[k] * s), s + e)
    }
    pub fn intersect(a: [Corner; 3], b: [Corner; 3]) -> bool {
        let apart = |a: [Corner; 3], b: [Corner; 3]| (0..3).filter(|&k| !b.contains(&a[k])).collect::<Vec<_>>();
        let (own, other) = (apart(a, b), apart(b, a));
        let edge = |t: [Corner; 3], k: usize| (t[(k + 1) % 3], t[(k + 2) % 3]);
        match own.len() {
            0 => true,
            1 => {
                let ((p, q), tip) = (edge(a, own[0]), b[other[0]]);
                dot(normal(a), sub(tip, p)) == 0 && dot(normal(a), normal([p, q, tip])) > 0
            }
            2 => {
                let shared = |t: [Corner; 3], own: &[usize]| edge(t, 3 - own[0] - own[1]);
                let ((p, q), (r, s)) = (shared(a, &own), shared(b, &other));
                stabs(p, q, b) || stabs(r, s, a)
            }
            _ => (0..3).any(|k| stabs(edge(a, k).0, edge(a, k).1, b) || stabs(edge(b, k).0, edge(b, k).1, a)),
        }
    }
}

/// Two triangles on a small integer lattice, so that touching, coplanar and folded ones are common; up to
/// two corners are shared.
fn lattice_pair() -> impl Strategy<Value = [[Corner; 3]; 2]> {
    let corner = |r: i64| prop::array::uniform3(-r..=r);
    (1..=4i64, 0..4usize, any::<bool>(), 0..6usize).prop_flat_map(move |(r, shared, flat, turn)| {
        prop::array::uniform6(corner(r)).prop_map(move |mut c| {
            if flat {
                c.iter_mut().for_each(|p| p[2] = p[0] - 2 * p[1]);
            }
            let mut b = [c[3], c[4], c[5]];
            b[..shared.min(2)].copy_from_slice(&c[..shared.min(2)]);
            b.rotate_left(turn % 3);
            if turn >= 3 {
                b.swap(0, 1);
            }
            [[c[0], c[1], c[2]], b]
        })
    })
}

fn float(t: [Corner; 3]) -> [DVec3; 3] {
    t.map(|p| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64))
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn pairs_agree_with_integer_arithmetic([a, b] in lattice_pair(), exponent in -300..300i32) {
        prop_assume!(integers::normal(a) != [0; 3] && integers::normal(b) != [0; 3]);
        let expected = integers::intersect(a, b);
        let (fa, fb) = (float(a), float(b));
        prop_assert_eq!(triangles_intersect(&fa, &fb), expected);
        prop_assert_eq!(triangles_intersect(&fb, &fa), expected);
        let scale = 2f64.powi(exponent);
        prop_assert_eq!(triangles_intersect(&fa.map(|p| p * scale), &fb.map(|p| p * scale)), expected);
        let turned = [fa[1], fa[0], fa[2]];
        prop_assert_eq!(triangles_intersect(&turned, &[fb[2], fb[0], fb[1]]), expected);
        // A shift by a big odd number leaves the differences exact but none of the coordinates small.
        let shift = DVec3::new(1048577.0, -33554433.0, 4097.0);
        prop_assert_eq!(triangles_intersect(&fa.map(|p| p + shift), &fb.map(|p| p + shift)), expected);
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn the_search_finds_what_brute_force_finds(
        points in prop::collection::vec(prop::array::uniform3(-6..=6i32), 20..40),
        picks in prop::collection::vec(prop::array::uniform3(0..1000usize), 1..60),
        scale in 0.001..1000.0f64,
    ) {
        let mesh = TriMesh {
            positions: points.iter().map(|p| DVec3::from_array(p.map(|x| f64::from(x) * scale))).collect(),
            triangles: picks.iter().map(|t| t.map(|k| (k % points.len()) as u32)).collect(),
        };
        let copies = |a: usize, b: usize| {
            let sorted = |t: usize| { let mut c = mesh.corners(t).map(|p| (p + 0.0).to_array().map(f64::to_bits)); c.sort(); c };
            sorted(a) == sorted(b)
        };
        let mut pairs = Vec::new();
        let mut faces = Vec::new();
        let count = mesh.triangles.len();
        for a in 0..count {
            let earlier = |t: usize| (0..t).find(|&e| copies(e, t));
            for b in a + 1..count {
                if triangles_intersect(&mesh.corners(a), &mesh.corners(b)) {
                    faces.extend([a as u32, b as u32]);
                    if earlier(a).is_none() && earlier(b).is_none_or(|e| e == a) {
                        pairs.push([a as u32, b as u32]);
                    }
                }
            }
        }
        faces.sort_unstable();
        faces.dedup();
        prop_assert_eq!(intersecting_triangles(&mesh, &Progress::none()).unwrap(), faces);
        prop_assert_eq!(self_intersections(&mesh, &Progress::none()).unwrap(), pairs);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut mesh = torus(60, 40);
    mesh.append(&torus(60, 40));
    mesh.positions[2400..].iter_mut().for_each(|p| *p = DVec3::new(p.x + 0.3, p.z, p.y));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (checked(&mesh), self_intersections(&mesh, &Progress::none()).unwrap()))
    };
    let one = run(1);
    assert!(one.1.len() > 100);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
}

// ---------------------------------------------------------------- half-edges

fn topology(mesh: &TriMesh) -> HalfEdges {
    HalfEdges::new(&mesh.triangles, mesh.positions.len()).unwrap()
}

/// Whether every relation between the half-edges holds, and the triangles are a closed manifold of this genus.
fn assert_sound(mesh: &HalfEdges, genus: i64) {
    let half_edges = 0..3 * mesh.triangle_ids() as u32;
    for h in half_edges.filter(|&h| mesh.is_live(h)) {
        assert_eq!(mesh.twin(mesh.twin(h)), h);
        assert_eq!((mesh.origin(h), mesh.target(h)), (mesh.target(mesh.twin(h)), mesh.origin(mesh.twin(h))));
        assert!(mesh.is_live(mesh.twin(h)) && mesh.next(mesh.next(mesh.next(h))) == h && mesh.prev(mesh.next(h)) == h);
    }
    for v in (0..mesh.vertex_ids() as u32).filter(|&v| mesh.is_live_vertex(v)) {
        let ring: Vec<u32> = mesh.ring(v).collect();
        assert!(ring.len() >= 3 && ring.len() == mesh.valence(v));
        assert!(ring.iter().all(|&h| mesh.origin(h) == v));
        assert!((0..ring.len()).all(|k| mesh.target(ring[(k + 1) % ring.len()]) == mesh.apex(ring[k])));
    }
    let compact = mesh.compacted();
    assert_eq!(compact.triangles.len(), mesh.live_triangles());
    let soup = TriMesh { positions: vec![DVec3::ZERO; compact.vertices.len()], triangles: compact.triangles };
    let options = ValidateOptions { self_intersections: false, weld: false };
    let found = validate(&soup, &options, &Progress::none()).unwrap();
    assert!(found.is_oriented_manifold(), "{:?}", found.problems());
    assert_eq!((found.genus, found.unused_vertices, found.duplicate_triangles), (Some(genus), 0, 0));
}

/// The collapse of `from` into `to` on a plain list of triangles, and whether a manifold comes out of it.
fn collapses_by_brute_force(mesh: &HalfEdges, from: u32, to: u32) -> bool {
    let moved = mesh.to_triangles().into_iter().map(|t| t.map(|v| if v == from { to } else { v }));
    let left: Vec<[u32; 3]> = moved.filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).collect();
    let vertices = mesh.vertex_ids();
    left.len() + 2 == mesh.live_triangles()
        && HalfEdges::new(&left, vertices)
            .is_ok_and(|m| (0..vertices as u32).all(|v| !m.is_live_vertex(v) || m.valence(v) >= 3))
}

fn flips_by_brute_force(mesh: &HalfEdges, h: u32) -> bool {
    let (u, v) = (mesh.origin(h), mesh.target(h));
    let (c, d) = (mesh.apex(h), mesh.apex(mesh.twin(h)));
    let (one, two) = (h / 3, mesh.twin(h) / 3);
    let mut list: Vec<[u32; 3]> = (0..mesh.triangle_ids() as u32)
        .filter(|&t| t != one && t != two && mesh.is_live_triangle(t))
        .map(|t| mesh.triangle(t))
        .collect();
    list.extend([[d, c, u], [c, d, v]]);
    let vertices = mesh.vertex_ids();
    HalfEdges::new(&list, vertices)
        .is_ok_and(|m| (0..vertices as u32).all(|v| !m.is_live_vertex(v) || m.valence(v) >= 3))
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn legal_operations_keep_the_manifold(
        ring in 3..9u32,
        tube in 3..7u32,
        sphere in any::<bool>(),
        steps in prop::collection::vec((0..100usize, any::<u32>()), 1..150),
    ) {
        let (start, genus) = if sphere { (unit_cube(), 0) } else { (torus(ring, tube), 1) };
        let mut mesh = topology(&start);
        let mut vertices = start.positions.len();
        for (kind, pick) in steps {
            let h = pick % (3 * mesh.triangle_ids() as u32);
            if !mesh.is_live(h) {
                prop_assert!(!mesh.can_collapse(h) && !mesh.can_flip(h));
                continue;
            }
            let (u, v) = (mesh.origin(h), mesh.target(h));
            let (c, d) = (mesh.apex(h), mesh.apex(mesh.twin(h)));
            match kind {
                0..50 => {
                    let legal = mesh.can_collapse(h);
                    prop_assert_eq!(legal, collapses_by_brute_force(&mesh, u, v));
                    prop_assert_eq!(mesh.collapse(h), v);
                    prop_assert_eq!(mesh.is_live_vertex(u), !legal);
                    vertices -= usize::from(legal);
                }
                50..80 => {
                    let legal = mesh.can_flip(h);
                    prop_assert_eq!(legal, flips_by_brute_force(&mesh, h));
                    prop_assert_eq!(mesh.flip(h), legal);
                    if legal {
                        prop_assert_eq!((mesh.origin(h), mesh.target(h)), (d, c));
                        prop_assert_eq!(mesh.find(u, v), None);
                    }
                }
                _ => {
                    let new = mesh.split(h);
                    vertices += 1;
                    prop_assert_eq!((mesh.origin(h), mesh.target(h), mesh.valence(new)), (u, new, 4));
                    prop_assert!([u, v, c, d].iter().all(|&w| mesh.find(new, w).is_some()));
                }
            }
        }
        assert_sound(&mesh, genus);
        prop_assert_eq!(mesh.compacted().vertices.len(), vertices);
    }
}

#[test]
fn collapsing_as_long_as_possible_leaves_the_smallest_manifolds() {
    for (mesh, genus, at_most) in [(unit_cube(), 0, 4), (torus(30, 20), 1, 20)] {
        let mut edited = topology(&mesh);
        loop {
            let next = edited.edges().find(|&h| edited.can_collapse(h));
            let Some(h) = next else { break };
            edited.collapse(h);
        }
        assert_sound(&edited, genus);
        assert!(edited.live_triangles() <= at_most, "{}", edited.live_triangles());
    }
}

#[test]
fn what_is_no_closed_oriented_manifold_is_refused_with_the_place() {
    let refused = |change: fn(&mut Vec<[u32; 3]>)| {
        let mut mesh = unit_cube();
        change(&mut mesh.triangles);
        HalfEdges::new(&mesh.triangles, 8).unwrap_err()
    };
    let edges = |t: [u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|e| [e[0].min(e[1]), e[0].max(e[1])]);
    let last = edges(*unit_cube().triangles.last().unwrap());
    assert!(last.contains(&refused(|t| t.truncate(11)).edge));
    assert!(last.contains(&refused(|t| t[11].swap(0, 1)).edge));
    assert!(last.contains(&refused(|t| t.push(t[11])).edge));
    assert_eq!(refused(|t| t[4] = [1, 6, 6]), NotManifold { edge: [6, 6] });
    assert_eq!(refused(|t| t[4] = [1, 6, 8]).edge, [8, 1]);

    // Two closed surfaces with one vertex in common.
    let mut bow = unit_cube();
    bow.append(&cube(DVec3::ONE, 1.0));
    let bow = bow.welded();
    let shared = bow.positions.iter().position(|&p| p == DVec3::ONE).unwrap() as u32;
    assert_eq!(HalfEdges::new(&bow.triangles, 15).unwrap_err().edge[0], shared);
}

#[test]
fn bounds_of_used_vertices_only() {
    let mut mesh = unit_cube();
    mesh.positions.push(DVec3::splat(5.0));
    assert_eq!(mesh.bounds(), Some(Bounds { min: DVec3::ZERO, max: DVec3::ONE }));
}
