//! What a result must not depend on: threads, the order of triangles and operands, and where the lattice's origin lies.

use super::support::{Shell, arranged, asked, cases, coarse, moved, result, turned_shell, volume, whole_shell};
use crate::common::shapes::{torus, turned};
use glam::DVec3;
use meshwright::arrange::{ArrangeOptions, Arranged};
use meshwright::ldi::Expression;
use meshwright::mesh::TriMesh;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// All triangles as corners' coordinates, each from its lowest corner on, in order.
fn canonical(mesh: &TriMesh) -> Vec<[[u64; 3]; 3]> {
    // Numbers that sort as the coordinates do.
    let key = |x: f64| {
        let bits = (x + 0.0).to_bits();
        if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
    };
    let mut all: Vec<[[u64; 3]; 3]> = (0..mesh.triangles.len())
        .map(|t| {
            let corners = mesh.corners(t).map(|p| p.to_array().map(key));
            let first = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
            [0, 1, 2].map(|n| corners[(first + n) % 3])
        })
        .collect();
    all.sort_unstable();
    all
}

fn bits(made: &Arranged) -> (Vec<[u64; 3]>, &[[u32; 3]], &[u32]) {
    let positions = made.mesh.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
    (positions, &made.mesh.triangles, &made.sources)
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let rings =
        [torus(48, 24), moved(&turned(torus(40, 30), 0.9), DVec3::new(0.3, 0.1, 0.2)), turned(torus(36, 20), 2.0)];
    for single in [false, true] {
        for tree in [Expression::union(3), Expression::difference(3)] {
            let with = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                pool.install(|| arranged(&rings, &ArrangeOptions { single, ..asked(&tree) }).expect("closed operands"))
            };
            let one = with(1);
            assert!(one.report.points > 500, "{:?}", one.report);
            for threads in [2, 4] {
                let more = with(threads);
                assert!(bits(&one) == bits(&more) && one.report == more.report, "{threads} threads");
            }
        }
    }
}

/// The mesh with its triangles in another order, each from another corner on, and its vertices in another order.
fn shuffled(mesh: &TriMesh, seed: u64) -> TriMesh {
    let order = |count: usize, seed: u64| {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|&n| (n as u64 + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 7);
        order
    };
    let places = order(mesh.positions.len(), seed);
    let mut number = vec![0u32; places.len()];
    places.iter().enumerate().for_each(|(new, &old)| number[old] = new as u32);
    let triangle = |t: usize| {
        let corners = mesh.triangles[t].map(|v| number[v as usize]);
        [0, 1, 2].map(|n| corners[(n + t + seed as usize % 3) % 3])
    };
    TriMesh {
        positions: places.iter().map(|&v| mesh.positions[v]).collect(),
        triangles: order(mesh.triangles.len(), seed.rotate_left(17)).into_iter().map(triangle).collect(),
    }
}

fn made(operands: &[TriMesh], tree: &Expression) -> Result<Arranged, TestCaseError> {
    arranged(operands, &asked(tree)).map_err(|error| TestCaseError::fail(format!("{error}")))
}

fn is_mended(made: &Arranged) -> bool {
    made.report.rounds + made.report.separated > 0
}

/// The same triangles for operands and their triangles in another order.
fn unordered(shells: &[Shell], seed: u64) -> Result<(), TestCaseError> {
    let operands: Vec<TriMesh> = shells.iter().map(Shell::mesh).collect();
    prop_assume!(operands.iter().all(|mesh| !mesh.triangles.is_empty()));
    let mut others: Vec<TriMesh> = operands.iter().map(|mesh| shuffled(mesh, seed)).collect();
    let count = others.len();
    others.rotate_left(seed as usize % count);
    for tree in [Expression::union(count), Expression::intersection(count)] {
        let (a, b) = (made(&operands, &tree)?, made(&others, &tree)?);
        // What is mended after rounding, or moved apart at contacts, may still differ by steps of the lattice.
        if is_mended(&a) || is_mended(&b) {
            continue;
        }
        prop_assert_eq!(canonical(&a.mesh).len(), canonical(&b.mesh).len());
        prop_assert!(canonical(&a.mesh) == canonical(&b.mesh), "{:?} and {:?}", a.report, b.report);
    }
    Ok(())
}

/// Facets of one plane that face each other: which of them comes first must not matter, neither for the points that are left out nor for the way a
/// flat region is triangulated.
#[test]
fn which_of_two_facets_that_face_each_other_comes_first_does_not_matter() {
    let whole = |low, size| Shell::Whole { low, size };
    let scenes = [
        [
            Shell::Tetrahedron([[4, 3, 4], [0, 3, 3], [3, 3, 1], [4, 4, 1]]),
            whole([0, 0, 1], [2, 3, 1]),
            whole([1, 2, 1], [2, 3, 1]),
        ],
        [
            Shell::Tetrahedron([[4, 0, 1], [4, 3, 3], [3, 4, 3], [4, 3, 0]]),
            whole([4, 2, 3], [3, 3, 2]),
            whole([2, 2, 2], [3, 3, 2]),
        ],
        [
            Shell::Tetrahedron([[2, 3, 3], [0, 0, 0], [3, 0, 0], [0, 1, 0]]),
            whole([0, 3, 0], [2, 1, 3]),
            whole([2, 2, 2], [1, 2, 3]),
        ],
        [whole([3, 3, 1], [2, 2, 2]), whole([2, 4, 1], [2, 3, 2]), whole([4, 2, 2], [1, 2, 3])],
    ];
    for shells in &scenes {
        for seed in 0..48u64 {
            let seed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            unordered(shells, seed).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        }
    }
}

/// The same result beside: `by` is many steps of the lattice, which stays the same one for a corner far out.
fn shifted(shells: &[Shell], by: [i32; 3]) -> Result<(), TestCaseError> {
    // Coordinates lie between -16 and 16, moved ones too, and one operand reaches 24: the lattice's step is 2⁻²⁵ for both.
    let far = Shell::Whole { low: [23, 23, 23], size: [1, 1, 1] }.mesh();
    let by = DVec3::from_array(by.map(f64::from)) / 8.0;
    let mut operands: Vec<TriMesh> = shells.iter().map(Shell::mesh).collect();
    prop_assume!(operands.iter().all(|mesh| !mesh.triangles.is_empty()));
    operands.push(far.clone());
    let mut others: Vec<TriMesh> = operands.iter().map(|mesh| moved(mesh, by)).collect();
    others[shells.len()] = far;
    for tree in [Expression::union(shells.len()), Expression::difference(shells.len())] {
        let (a, b) = (made(&operands, &tree)?, made(&others, &tree)?);
        if is_mended(&a) || is_mended(&b) {
            continue;
        }
        prop_assert_eq!(a.mesh.triangles.len(), b.mesh.triangles.len());
        prop_assert!((volume(&a.mesh) - volume(&b.mesh)).abs() <= 1e-13 * volume(&a.mesh).abs() + 1e-12);
        let (a, b) = (sorted(&moved(&a.mesh, by)), sorted(&b.mesh));
        for (p, q) in a.iter().zip(&b) {
            prop_assert!((*p - *q).abs().max_element() <= 2f64.powi(-44), "{} and {}", p, q);
        }
    }
    Ok(())
}

/// The vertices in order, nearly equal ones too.
fn sorted(mesh: &TriMesh) -> Vec<DVec3> {
    let mut all = mesh.positions.clone();
    let key = |p: &DVec3| (*p * 2f64.powi(30)).round().to_array().map(|x| x as i64);
    all.sort_by_key(key);
    all
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn the_order_of_triangles_and_operands_does_not_matter(
        shells in prop::collection::vec(turned_shell(), 2..=3), seed: u64,
    ) {
        unordered(&shells, seed)?;
    }

    #[test]
    fn nor_does_it_where_nearly_everything_touches(shells in prop::collection::vec(whole_shell(4), 2..=3), seed: u64) {
        unordered(&shells, seed)?;
    }

    #[test]
    fn a_shift_by_many_steps_shifts_the_result(
        shells in prop::collection::vec(turned_shell(), 2..=3), by in prop::array::uniform3(-60..60),
    ) {
        shifted(&shells, by)?;
    }

    #[test]
    fn so_it_does_where_nearly_everything_touches(
        shells in prop::collection::vec(whole_shell(4), 2..=3), by in prop::array::uniform3(-60..60),
    ) {
        shifted(&shells, by)?;
    }
}

/// Coordinates that are no multiples of the lattice's step: the surface moves by less than a step for it.
#[test]
fn coordinates_off_the_lattice_change_volumes_by_steps_alone() {
    let rings = [torus(30, 18), moved(&turned(torus(30, 18), 0.9), DVec3::new(0.3, 0.1, 0.2))];
    let on = rings.clone().map(coarse);
    for tree in [Expression::union(2), Expression::intersection(2), Expression::difference(2)] {
        let [off, on] = [&rings, &on].map(|rings| volume(&result(rings, &tree, false).expect("a solid").mesh));
        assert!((off - on).abs() <= 1e-6, "{off} and {on}");
    }
}
