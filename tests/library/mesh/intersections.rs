//! Intersections: exact for pairs, complete for meshes.

use glam::DVec3;
use meshwright::mesh::{TriMesh, intersecting_triangles, self_intersections, triangles_intersect};
use meshwright::progress::Progress;
use proptest::prelude::*;

use super::shapes::{cases, checked, cube, torus, unit_cube};

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
