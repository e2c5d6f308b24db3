//! Random soups of closed shells: what is inside of the result is what winding numbers say; and volumes add up.

use super::referee::{is_clear, winding};
use super::support::{
    Shell, arranged_by, asked, cases, expression, inside_out, piled, result, turned_shell, volume, whole_shell,
};
use crate::common::exact::spread;
use crate::common::proofs::state;
use glam::DVec3;
use meshwright::arrange::ArrangeOptions;
use meshwright::ldi::{Expression, Inside};
use meshwright::mesh::TriMesh;
use meshwright::orient::OrientMode;
use meshwright::pipeline::{BooleanError, Method, Options, Precision, VoxelSize, boolean};
use meshwright::progress::Progress;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Operands of several shells each; some face inwards.
fn soup(shell: impl Strategy<Value = Shell>) -> impl Strategy<Value = Vec<Vec<(Shell, bool)>>> {
    let operand = prop::collection::vec((shell, prop::bool::weighted(0.15)), 1..=2);
    prop::collection::vec(operand, 1..=3)
}

fn meshes(soup: &[Vec<(Shell, bool)>]) -> Vec<TriMesh> {
    let operand = |shells: &Vec<(Shell, bool)>| {
        let mut mesh = TriMesh::default();
        for (shell, inwards) in shells {
            mesh.append(&if *inwards { inside_out(shell.mesh()) } else { shell.mesh() });
        }
        mesh
    };
    soup.iter().map(operand).collect()
}

/// Looks at points of space: inside of the result is what the expression says of the operands' winding numbers.
fn look(
    operands: &[TriMesh],
    tree: &Expression,
    inside: Inside,
    result: &TriMesh,
    single: bool,
) -> Result<(), TestCaseError> {
    let (all, _) = piled(operands);
    let bounds = all.bounds().expect("triangles");
    let room = bounds.size() * 0.1;
    let near = if single { 1e-5 } else { 1e-6 };
    let mut looked = 0;
    for p in spread(bounds.min - room, bounds.max + room, 60) {
        if !is_clear(&all, p, near) {
            continue;
        }
        let numbers: Option<Vec<i32>> = operands.iter().map(|operand| winding(operand, p)).collect();
        let (Some(numbers), Some(found)) = (numbers, winding(result, p)) else { continue };
        let held: Vec<bool> = numbers.iter().map(|&w| inside.holds(w)).collect();
        prop_assert_eq!(found, i32::from(tree.evaluate(&held)), "at {}, operands wind {:?}", p, numbers);
        looked += 1;
    }
    prop_assert!(looked > 20, "{} points", looked);
    Ok(())
}

fn check(soup: &[Vec<(Shell, bool)>], tree: &Expression, inside: Inside, single: bool) -> Result<(), TestCaseError> {
    let operands = meshes(soup);
    prop_assume!(operands.iter().any(|mesh| !mesh.triangles.is_empty()));
    let made = arranged_by(inside, &operands, &ArrangeOptions { single, ..asked(tree) });
    let made = made.map_err(|error| TestCaseError::fail(format!("{error}")))?;
    if !made.mesh.triangles.is_empty() {
        let found = state(&made.mesh, true);
        prop_assert!(found.is_valid(), "{:?}, {:?}", found.problems(), made.report);
    }
    look(&operands, tree, inside, &made.mesh, single)
}

/// The same by the whole pipeline, which leaves shells alone that touch nothing or are buried in others.
fn check_pipeline(
    soup: &[Vec<(Shell, bool)>],
    tree: &Expression,
    inside: Inside,
    single: bool,
) -> Result<(), TestCaseError> {
    let operands = meshes(soup);
    prop_assume!(operands.iter().all(|mesh| !mesh.triangles.is_empty()) && tree.operand_count() <= operands.len());
    let precision = if single { Precision::Single } else { Precision::Double };
    let options = Options {
        method: Method::Exact,
        orient: OrientMode::Keep,
        inside,
        precision,
        ..Options::new(VoxelSize::Along(64))
    };
    match boolean(&operands, tree, &options, &Progress::none()) {
        Err(BooleanError::Nothing(_)) => look(&operands, tree, inside, &TriMesh::default(), single),
        Err(error) => Err(TestCaseError::fail(format!("{error}"))),
        Ok(outcome) => {
            let found = state(&outcome.solid, true);
            prop_assert!(found.is_valid(), "{:?}", found.problems());
            look(&operands, tree, inside, &outcome.solid, single)
        }
    }
}

fn rule() -> impl Strategy<Value = Inside> {
    prop_oneof![Just(Inside::Positive), Just(Inside::Nonzero), Just(Inside::Odd)]
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn points_lie_inside_where_winding_numbers_say_so(
        soup in soup(turned_shell()), tree in expression(3), inside in rule(), single: bool,
    ) {
        check(&soup, &tree, inside, single)?;
    }

    #[test]
    fn so_they_do_where_nearly_everything_touches(
        soup in soup(whole_shell(4)), tree in expression(3), inside in rule(), single: bool,
    ) {
        check(&soup, &tree, inside, single)?;
    }

    #[test]
    fn the_pipeline_says_the_same(
        soup in soup(turned_shell()), tree in expression(3), inside in rule(), single: bool,
    ) {
        check_pipeline(&soup, &tree, inside, single)?;
    }

    #[test]
    fn the_pipeline_says_the_same_where_nearly_everything_touches(
        soup in soup(whole_shell(4)), tree in expression(3), inside in rule(), single: bool,
    ) {
        check_pipeline(&soup, &tree, inside, single)?;
    }

    #[test]
    fn volumes_of_union_and_intersection_add_up(a in turned_shell(), b in turned_shell()) {
        adds_up(&[a, b], 1e-12)?;
    }

    #[test]
    fn so_they_do_on_a_grid(a in whole_shell(4), b in whole_shell(4)) {
        adds_up(&[a, b], 1e-12)?;
    }
}

/// |A ∪ B| + |A ∩ B| = |A| + |B|, and |A - B| + |A ∩ B| = |A|. Corners lie on the lattice, so that only crossings are rounded: each coordinate to
/// 2⁻⁵⁰ of the largest, unless what crosses then had to be mended or contacts moved apart, by some steps of 2⁻²⁹.
fn adds_up(shells: &[Shell; 2], relative: f64) -> Result<(), TestCaseError> {
    let operands = shells.each_ref().map(Shell::mesh);
    prop_assume!(operands.iter().all(|mesh| !mesh.triangles.is_empty()));
    let made = |tree: &Expression| result(&operands, tree, false);
    let parts = [made(&Expression::union(2))?, made(&Expression::intersection(2))?, made(&Expression::difference(2))?];
    let [union, common, rest] = parts.each_ref().map(|part| volume(&part.mesh));
    let [a, b] = operands.each_ref().map(volume);
    let mended = parts.iter().any(|part| part.report.separated + part.report.rounds > 0);
    let room = if mended { 1e-6 } else { relative * (a + b) };
    prop_assert!((union + common - a - b).abs() <= room, "{} and {} of {} and {}", union, common, a, b);
    prop_assert!((rest + common - a).abs() <= room, "{} and {} of {}", rest, common, a);
    Ok(())
}

/// A corner that lies on the lattice stays where it is, to the last bit, and so does one that does not.
#[test]
fn corners_that_are_not_cut_keep_their_coordinates() {
    let third = |mesh: TriMesh| TriMesh {
        positions: mesh.positions.iter().map(|&p| p / 3.0 + DVec3::splat(0.1)).collect(),
        ..mesh
    };
    let shells =
        [[0.0, 0.0, 0.0], [1.0, 0.6, 0.3]].map(|centre| Shell::Turned { kind: 1, centre, turn: [0.4, 0.1, 0.7] });
    let operands = shells.map(|shell| third(shell.mesh()));
    let made = result(&operands, &Expression::union(2), false).expect("a valid union");
    let given: Vec<[u64; 3]> =
        operands.iter().flat_map(|mesh| &mesh.positions).map(|p| p.to_array().map(f64::to_bits)).collect();
    let kept = made.mesh.positions.iter().filter(|p| given.contains(&p.to_array().map(f64::to_bits))).count();
    assert!(
        made.report.points > 0 && kept + made.report.points >= made.mesh.positions.len(),
        "{kept} {:?}",
        made.report
    );
    assert!(kept > given.len() / 2, "{kept} of {}", given.len());
}

/// Edges of one body lie within a face of another, with points on them: the face has a border on both of their sides.
#[test]
fn edges_within_a_face_come_to_an_end() {
    let parts = [
        vec![
            Shell::Tetrahedron([[3, 4, 0], [4, 2, 1], [2, 3, 4], [0, 1, 1]]),
            Shell::Whole { low: [0, 2, 1], size: [2, 3, 3] },
        ],
        vec![Shell::Whole { low: [0, 3, 2], size: [3, 3, 3] }],
        vec![
            Shell::Tetrahedron([[2, 0, 2], [4, 3, 1], [1, 3, 4], [4, 2, 4]]),
            Shell::Whole { low: [3, 0, 1], size: [2, 3, 2] },
        ],
    ];
    let soup = parts.map(|shells| shells.into_iter().map(|shell| (shell, false)).collect::<Vec<_>>());
    let tree = Expression::Union(vec![Expression::Operand(1), Expression::Operand(2)]);
    for single in [false, true] {
        check(&soup, &tree, Inside::Nonzero, single).expect("the right solid");
    }
}
