//! Boxes between whole coordinates: volumes by counting unit cubes, exact to the last one.

use super::support::{cases, expression, moved_volume, result, six_volumes};
use crate::common::shapes::cuboid;
use glam::DVec3;
use meshwright::ldi::Expression;
use meshwright::mesh::TriMesh;
use meshwright::pipeline::{BooleanError, Method, Options, Precision, VoxelSize, boolean};
use meshwright::progress::Progress;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Boxes lie within 0 to this along each axis.
const SIDE: i32 = 8;

type Box3 = ([i32; 3], [i32; 3]);

fn boxes() -> impl Strategy<Value = Vec<Box3>> {
    let one = (prop::array::uniform3(0..SIDE - 3), prop::array::uniform3(1..=3));
    prop::collection::vec(one, 1..=6)
}

fn mesh((low, size): &Box3) -> TriMesh {
    let (low, size) = (low.map(f64::from), size.map(f64::from));
    cuboid(DVec3::from_array(low), DVec3::from_array(low) + DVec3::from_array(size))
}

/// How many unit cubes are inside.
fn counted(boxes: &[Box3], expression: &Expression) -> u32 {
    let holds = |(low, size): &Box3, cube: [i32; 3]| (0..3).all(|k| (low[k]..low[k] + size[k]).contains(&cube[k]));
    let is_inside = |n: &i32| {
        let cube = [n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE)];
        let inside: Vec<bool> = boxes.iter().map(|one| holds(one, cube)).collect();
        expression.evaluate(&inside)
    };
    (0..SIDE * SIDE * SIDE).filter(is_inside).count() as u32
}

fn check(boxes: &[Box3], expression: &Expression, single: bool) -> Result<(), TestCaseError> {
    let operands: Vec<TriMesh> = boxes.iter().map(mesh).collect();
    let made = result(&operands, expression, single)?;
    let count = counted(boxes, expression);
    let off = six_volumes(&made.mesh, DVec3::ZERO) - 6.0 * f64::from(count);
    // Corners are whole numbers. Only points on straight edges may be fractions; where these cross once they are rounded, or where contacts are moved
    // apart, the volume changes by some steps of the lattice.
    let room = 6.0 * moved_volume(&made, single) + if single { 1e-3 } else { 1e-12 };
    prop_assert!(off.abs() <= room, "off by {off}, {room} allowed, of {count}: {:?}", made.report);
    prop_assert_eq!(made.mesh.triangles.is_empty(), count == 0);
    Ok(())
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn random_expressions_have_the_volume_of_their_cubes(boxes in boxes(), tree in expression(6), single: bool) {
        check(&boxes, &tree, single)?;
    }

    #[test]
    fn plain_operations_have_the_volume_of_their_cubes(boxes in boxes(), single: bool) {
        for tree in [Expression::union(6), Expression::intersection(boxes.len()), Expression::difference(6)] {
            check(&boxes, &tree, single)?;
        }
    }
}

proptest! {
    #![proptest_config(cases(100))]

    /// The whole pipeline: shells that touch nothing stand, the others are arranged.
    #[test]
    fn the_pipeline_says_the_same(boxes in boxes(), tree in expression(6), single: bool) {
        let needed = tree.operand_count();
        prop_assume!(needed <= boxes.len());
        let operands: Vec<TriMesh> = boxes.iter().map(mesh).collect();
        let precision = if single { Precision::Single } else { Precision::Double };
        let options = Options { method: Method::Exact, precision, ..Options::new(VoxelSize::Along(64)) };
        let count = counted(&boxes, &tree);
        match boolean(&operands, &tree, &options, &Progress::none()) {
            Err(BooleanError::Nothing(_)) => prop_assert_eq!(count, 0),
            Err(error) => prop_assert!(false, "{}", error),
            Ok(outcome) => {
                let off = six_volumes(&outcome.solid, DVec3::ZERO) - 6.0 * f64::from(count);
                let separated = outcome.report.exact.as_ref().map_or(0, |exact| exact.separated);
                let room = if separated > 0 || single { 1e-3 } else { 1e-6 };
                prop_assert!(off.abs() <= room, "off by {} of {}", off, count);
            }
        }
    }
}
