//! Repair and booleans on shapes made here: what comes out, and the algebra.

use crate::common::shapes::{cuboid, torus};
use glam::DVec3;
use meshwright::ldi::Expression;
use meshwright::mesh::{TriMesh, ValidateOptions, Validity, validate};
use meshwright::orient::OrientMode;
use meshwright::pipeline::{
    BooleanError, LimitError, Method, Options, Outcome, TriangleSource, VoxelSize, boolean, plan, repair,
};
use meshwright::progress::Progress;
use proptest::prelude::*;

fn options(resolution: u32) -> Options {
    Options::new(VoxelSize::Along(resolution))
}

fn checked(outcome: Outcome) -> (Outcome, Validity) {
    let all = ValidateOptions { self_intersections: true, weld: false };
    let validity = validate(&outcome.solid, &all, &Progress::none()).expect("not stopped");
    assert!(validity.is_valid(), "{:?}", validity.problems());
    (outcome, validity)
}

fn repaired(mesh: &TriMesh, resolution: u32) -> (Outcome, Validity) {
    checked(repair(mesh, &options(resolution), &Progress::none()).expect("a solid"))
}

fn combined(operands: &[TriMesh], expression: &Expression, resolution: u32) -> (Outcome, Validity) {
    checked(boolean(operands, expression, &options(resolution), &Progress::none()).expect("a solid"))
}

fn unit_box(at: DVec3) -> TriMesh {
    cuboid(at, at + DVec3::ONE)
}

fn turned_over(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

fn validate_volume(mesh: &TriMesh) -> f64 {
    validate(mesh, &ValidateOptions::default(), &Progress::none()).expect("not stopped").volume
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} and {b}");
}

#[test]
fn inside_out_files_come_out_right() {
    let (outcome, validity) = repaired(&turned_over(torus(64, 32)), 48);
    assert_eq!(outcome.report.orient[0].flipped_patches, 1);
    let (_, straight) = repaired(&torus(64, 32), 48);
    assert_eq!(validity.volume, straight.volume);
    assert_eq!(validity.genus, Some(1));
    let keep = Options { orient: OrientMode::Keep, ..options(48) };
    let kept = repair(&turned_over(torus(64, 32)), &keep, &Progress::none());
    assert!(matches!(kept, Err(BooleanError::Nothing(_))));
}

#[test]
fn a_hollow_body_keeps_its_void_also_when_all_of_it_is_inside_out() {
    let mut hollow = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    hollow.append(&turned_over(cuboid(DVec3::ONE, DVec3::splat(3.0))));
    for mesh in [hollow.clone(), turned_over(hollow)] {
        let (_, validity) = repaired(&mesh, 40);
        assert_eq!(validity.bodies, 2);
        close(validity.volume, 64.0 - 8.0, 1e-3);
    }
}

#[test]
fn overlapping_and_nested_shells_of_one_file_are_united() {
    let mut shells = unit_box(DVec3::ZERO);
    shells.append(&unit_box(DVec3::splat(0.5)));
    close(repaired(&shells, 48).1.volume, 2.0 - 0.125, 2e-3);
    let mut nested = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    nested.append(&cuboid(DVec3::ONE, DVec3::splat(3.0)));
    let (_, validity) = repaired(&nested, 40);
    assert_eq!(validity.bodies, 1);
    close(validity.volume, 64.0, 1e-3);
}

#[test]
fn each_side_of_a_box_can_be_on_its_own_and_turned() {
    // Six unconnected sides, every second one inside out.
    let solid = unit_box(DVec3::ZERO);
    let mut loose = TriMesh::default();
    for (side, pair) in solid.triangles.chunks(2).enumerate() {
        let mut quad = TriMesh { positions: solid.positions.clone(), triangles: pair.to_vec() };
        // A hair of a crack between the sides, so that they cannot be welded.
        quad.positions.iter_mut().for_each(|p| *p += 1e-7 * side as f64);
        loose.append(&if side % 2 == 0 { quad } else { turned_over(quad) });
    }
    let apart = Options { tolerance: Some(0.0), ..options(32) };
    let outcome = repair(&loose, &apart, &Progress::none()).expect("a solid");
    assert_eq!(outcome.report.orient[0].patches, 6);
    assert_eq!(outcome.report.orient[0].flipped_patches, 3);
    close(outcome.solid.validity().volume, 1.0, 1e-3);
    // With the cracks closed first it is the box.
    let (outcome, validity) = repaired(&loose, 32);
    assert_eq!((outcome.solid.triangles.len(), outcome.report.orient[0].patches), (12, 1));
    close(validity.volume, 1.0, 1e-5);
}

#[test]
fn a_missing_face_is_closed() {
    let mut open = unit_box(DVec3::ZERO);
    open.triangles.truncate(10);
    let (outcome, validity) = repaired(&open, 32);
    close(validity.volume, 1.0, 1e-12);
    assert_eq!((outcome.report.holes.len(), outcome.solid.triangles.len()), (1, 12));
    // So it is from voxels, with rays that cannot tell.
    let voxels = Options { method: Method::Voxel, ..options(32) };
    let outcome = repair(&open, &voxels, &Progress::none()).expect("a solid");
    close(validate_volume(&outcome.solid), 1.0, 0.02);
    assert!(outcome.report.ldi.silent_rays > 0);
}

#[test]
fn facing_boxes_fuse_and_a_minus_a_is_empty() {
    let (a, b) = (unit_box(DVec3::ZERO), unit_box(DVec3::X));
    let (_, validity) = combined(&[a.clone(), b.clone()], &Expression::union(2), 64);
    assert_eq!(validity.bodies, 1);
    close(validity.volume, 2.0, 1e-3);
    let mut both = a.clone();
    both.append(&b);
    assert_eq!(repaired(&both, 64).1.bodies, 1);
    for (operands, expression) in
        [([a.clone(), a.clone()], Expression::difference(2)), ([a.clone(), b], Expression::intersection(2))]
    {
        let empty = boolean(&operands, &expression, &options(64), &Progress::none());
        assert!(matches!(empty, Err(BooleanError::Nothing(_))));
    }
    let (twice, _) = combined(&[a.clone(), a.clone()], &Expression::union(2), 64);
    assert_eq!(twice.solid.triangles.len(), 12);
    close(validate_volume(&twice.solid), 1.0, 1e-9);
}

#[test]
fn a_symmetric_difference_is_the_union_without_the_intersection() {
    let operands = [unit_box(DVec3::ZERO), unit_box(DVec3::new(0.31, 0.47, 0.22))];
    let [a, b] = [0, 1].map(|n| Box::new(Expression::Operand(n)));
    let (_, validity) = combined(&operands, &Expression::SymmetricDifference(a, b), 64);
    close(validity.volume, 2.0 - 2.0 * 0.69 * 0.53 * 0.78, 2e-3);
}

#[test]
fn an_open_sheet_encloses_nothing_and_says_so() {
    let sheet = TriMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.1)],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
    };
    match repair(&sheet, &options(32), &Progress::none()) {
        Err(error @ BooleanError::Nothing(_)) => assert!(error.to_string().contains("open sheet"), "{error}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn limits_are_refused_with_what_would_work() {
    let mut far = unit_box(DVec3::ZERO);
    far.positions.iter_mut().for_each(|p| *p += 1e7);
    assert_eq!(repair(&far, &options(64), &Progress::none()).expect("a solid").solid, far);
    far.triangles.pop();
    far.positions.iter_mut().for_each(|p| *p *= 1e29);
    let voxels = |resolution| Options { method: Method::Voxel, ..options(resolution) };
    assert!(matches!(repair(&far, &voxels(64), &Progress::none()), Err(BooleanError::Lattice(_))));
    // What is right needs no memory; what is open does, where it is made from voxels.
    let mut solid = unit_box(DVec3::ZERO);
    assert!(repair(&solid, &Options { max_memory: Some(20_000_000), ..options(2000) }, &Progress::none()).is_ok());
    solid.triangles.pop();
    let small = Options { max_memory: Some(20_000_000), ..voxels(2000) };
    match repair(&solid, &small, &Progress::none()) {
        Err(BooleanError::Limit(LimitError::Memory { voxel_that_fits: Some(h), needed, .. })) => {
            assert!(needed > 20_000_000);
            let fitting = Options { voxel: VoxelSize::Length(h), ..small };
            assert!(repair(&solid, &fitting, &Progress::none()).is_ok());
        }
        other => panic!("{other:?}"),
    }
    assert!(plan(std::slice::from_ref(&solid), &voxels(2000)).expect("a plan").memory > 20_000_000);
    let missing = boolean(&[solid], &Expression::union(2), &options(32), &Progress::none());
    assert!(matches!(missing, Err(BooleanError::MissingOperand { operand: 1, given: 1 })));
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let mut broken = torus(64, 32);
    broken.triangles.drain(100..160);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| repair(&broken, &options(64), &Progress::none()).expect("a solid").solid)
    };
    assert_eq!(run(1), run(2));
    assert_eq!(run(1), run(7));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10, ..ProptestConfig::default() })]

    #[test]
    fn booleans_of_boxes_have_the_exact_volumes(
        shift in prop::array::uniform3(-0.8f64..0.8),
        scale in 0.5f64..1.5,
    ) {
        let shift = DVec3::from_array(shift);
        // Where sides come nearer to each other than two voxels, a sheet is left that the voxels may lose.
        let gaps = [shift, shift + scale - 1.0].map(DVec3::abs);
        prop_assume!(gaps.iter().all(|gap| gap.min_element() > 0.08));
        let operands = [unit_box(DVec3::ZERO), cuboid(shift, shift + scale)];
        let overlap = ((shift + scale).min(DVec3::ONE) - shift.max(DVec3::ZERO)).max(DVec3::ZERO).element_product();
        prop_assume!(overlap > 0.02);
        let second = scale.powi(3);
        for (expression, volume) in [
            (Expression::union(2), 1.0 + second - overlap),
            (Expression::intersection(2), overlap),
            (Expression::difference(2), 1.0 - overlap),
        ] {
            prop_assume!(volume > 0.02);
            let got = combined(&operands, &expression, 64).1.volume;
            prop_assert!((got - volume).abs() < 0.01 * volume.max(0.2), "{:?}: {} and {}", expression, got, volume);
        }
    }
}

/// A box with corners at whole numbers, so that boxes often share planes, edges and corners.
fn whole_box() -> impl Strategy<Value = TriMesh> {
    (prop::array::uniform3(0i32..5), prop::array::uniform3(3i32..8)).prop_map(|(low, size)| {
        let [low, size] = [low, size].map(|v| DVec3::from(v.map(f64::from)));
        cuboid(low, low + size)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Also where their surfaces lie on each other, and either could leave its triangles.
    #[test]
    fn operands_may_be_given_in_any_order(a in whole_box(), b in whole_box(), c in whole_box()) {
        let make = |operands: &[&TriMesh], expression: &Expression| {
            let operands: Vec<TriMesh> = operands.iter().map(|mesh| (*mesh).clone()).collect();
            boolean(&operands, expression, &options(20), &Progress::none()).map(|outcome| {
                let name = |source: &TriangleSource| match *source {
                    TriangleSource::Operand { operand, triangle } => operands[operand as usize].corners(triangle as usize).map(Some),
                    TriangleSource::Lid { .. } | TriangleSource::Closed => [None; 3],
                };
                let sources: Vec<_> = outcome.sources.iter().map(name).collect();
                (outcome.solid, sources)
            })
        };
        let union = make(&[&a, &b, &c], &Expression::union(3));
        prop_assert_eq!(&make(&[&c, &a, &b], &Expression::union(3)), &union);
        prop_assert_eq!(&make(&[&b, &a, &c], &Expression::union(3)), &union);
        let difference = make(&[&a, &b, &c], &Expression::difference(3));
        prop_assert_eq!(&make(&[&a, &c, &b], &Expression::difference(3)), &difference);
    }
}

#[test]
fn reports_and_errors_name_operands_in_the_order_given() {
    let (low, high) = (unit_box(DVec3::ZERO), turned_over(unit_box(DVec3::splat(0.5))));
    for operands in [[low.clone(), high.clone()], [high.clone(), low.clone()]] {
        let (outcome, _) = combined(&operands, &Expression::union(2), 24);
        for (operand, report) in operands.iter().zip(&outcome.report.orient) {
            assert_eq!(report.flipped_patches, usize::from(*operand == high));
        }
    }
    let flat = TriMesh { positions: vec![DVec3::splat(-9.0); 3], triangles: vec![[0, 1, 2]] };
    let failed = boolean(&[low, flat], &Expression::union(2), &options(24), &Progress::none());
    assert!(matches!(failed, Err(BooleanError::Empty { operand: 1 })), "{failed:?}");
}

/// Formats number vertices in their own way: as the file has them, by first use, or one for each corner.
#[test]
fn the_numbers_of_vertices_do_not_matter() {
    let mut mesh = torus(20, 10);
    mesh.append(&cuboid(DVec3::splat(-0.3), DVec3::new(1.2, 0.3, 0.3)));
    mesh.triangles.remove(7);
    let corners = |mesh: &TriMesh| (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect::<Vec<_>>();
    let apart = TriMesh {
        positions: corners(&mesh).into_iter().flatten().collect(),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    };
    let last = mesh.positions.len() as u32 - 1;
    let backwards = TriMesh {
        positions: mesh.positions.iter().rev().copied().collect(),
        triangles: mesh.triangles.iter().map(|t| t.map(|v| last - v)).collect(),
    };
    let (plain, _) = repaired(&mesh, 24);
    for other in [mesh.welded(), apart, backwards] {
        let (found, _) = repaired(&other, 24);
        assert_eq!(corners(&found.solid), corners(&plain.solid));
        assert_eq!(found.sources, plain.sources);
    }
}
