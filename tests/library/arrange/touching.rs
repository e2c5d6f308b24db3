//! Solids that touch, nearly touch, or are nearly the same: valid in the numbers of the file, with the right volume.
//!
//! `cargo test --test library arrange::touching -- --nocapture` prints the table of `docs/robustness.md`.

use super::support::{self, moved, volume};
use crate::common::proofs::state;
use crate::common::shapes::{ball, cuboid, torus, turned};
use glam::{DQuat, DVec3};
use meshwright::ldi::Expression;
use meshwright::mesh::TriMesh;
use meshwright::pipeline::{BooleanError, Method, Options, Precision, VoxelSize, boolean};
use meshwright::progress::Progress;

/// Two operands and the volumes of union, intersection and, where it is asked for, difference.
struct Case {
    name: String,
    operands: [TriMesh; 2],
    volumes: Vec<f64>,
}

/// What a row of the table says of one precision.
#[derive(Debug, Default)]
struct Row {
    /// The largest error of a volume, as a part of the first operand's.
    error: f64,
    bodies: Vec<usize>,
    moved: usize,
}

/// Makes union, intersection and difference and checks that each is valid.
fn made(case: &Case, precision: Precision) -> Row {
    let options = Options { method: Method::Exact, precision, ..Options::new(VoxelSize::Along(64)) };
    let mut row = Row::default();
    let trees = [Expression::union(2), Expression::intersection(2), Expression::difference(2)];
    for (tree, expected) in trees.iter().zip(&case.volumes) {
        let mut bodies = 0;
        let found = match boolean(&case.operands, tree, &options, &Progress::none()) {
            Err(BooleanError::Nothing(_)) => 0.0,
            Err(error) => panic!("{}, {tree:?}, {precision:?}: {error}", case.name),
            Ok(outcome) => {
                let found = state(&outcome.solid, true);
                assert!(found.is_valid(), "{}, {tree:?}, {precision:?}: {:?}", case.name, found.problems());
                let single = |p: &DVec3| p.as_vec3().as_dvec3() == *p;
                assert!(precision == Precision::Double || outcome.solid.positions.iter().all(single), "{}", case.name);
                bodies = found.bodies;
                row.moved += outcome.report.exact.map_or(0, |exact| exact.separated);
                volume(&outcome.solid)
            }
        };
        row.error = row.error.max((found - expected).abs() / volume(&case.operands[0]));
        row.bodies.push(bodies);
    }
    row
}

fn unit(at: [f64; 3]) -> TriMesh {
    let at = DVec3::from_array(at);
    cuboid(at, at + DVec3::ONE)
}

/// A regular prism of radius 1 around z from 0 to 1, with a corner on the x axis, or turned by half a side.
fn prism(sides: u32, half: bool) -> TriMesh {
    support::prism(DVec3::ZERO, 1.0, [0.0, 1.0], sides, if half { 0.5 } else { 0.0 })
}

/// Two bodies that have at most a surface in common.
fn apart(name: &str, a: TriMesh, b: TriMesh) -> Case {
    let (va, vb) = (volume(&a), volume(&b));
    Case { name: name.into(), operands: [a, b], volumes: vec![va + vb, 0.0, va] }
}

/// A body that lies in another one.
fn within(name: &str, a: TriMesh, b: TriMesh) -> Case {
    let (va, vb) = (volume(&a), volume(&b));
    Case { name: name.into(), operands: [a, b], volumes: vec![va, vb, va - vb] }
}

/// A body and a copy of it, turned or moved by so little that the volumes stay the same to a part in a million. What is left of their difference
/// is thinner than the numbers of the result resolve: it is asked for where the bodies are boxes.
fn twice(name: &str, a: TriMesh, b: TriMesh) -> Case {
    let whole = volume(&a);
    let mut volumes = vec![whole, whole];
    volumes.extend((a.triangles.len() == 12).then_some(0.0));
    Case { name: name.into(), operands: [a, b], volumes }
}

fn slightly(mesh: &TriMesh, angle: f64) -> TriMesh {
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.64, 0.48).normalize(), angle);
    TriMesh { positions: mesh.positions.iter().map(|&p| turn * p).collect(), triangles: mesh.triangles.clone() }
}

fn contacts() -> Vec<Case> {
    vec![
        apart("boxes that share a face", unit([0.0; 3]), unit([1.0, 0.0, 0.0])),
        apart("boxes that share a part of a face", unit([0.0; 3]), unit([1.0, 0.5, 0.25])),
        apart("boxes that share an edge", unit([0.0; 3]), unit([1.0, 1.0, 0.0])),
        apart("boxes that share a part of an edge", unit([0.0; 3]), unit([1.0, 1.0, 0.5])),
        apart("boxes that share a corner", unit([0.0; 3]), unit([1.0; 3])),
        apart("a corner in the middle of a face", unit([0.0; 3]), tip([1.0, 0.5, 0.5])),
        apart("a corner in the middle of an edge", unit([0.0; 3]), tip([1.0, 1.0, 0.5])),
        within("a box in a box, three faces in common", cuboid(DVec3::ZERO, DVec3::splat(2.0)), unit([0.0; 3])),
        within(
            "a box through a box, side to side",
            cuboid(DVec3::ZERO, DVec3::new(1.0, 3.0, 3.0)),
            unit([0.0, 1.0, 1.0]),
        ),
        within("a body and itself", turned(torus(24, 12), 0.7), turned(torus(24, 12), 0.7)),
    ]
}

/// A tetrahedron whose corner at `at` points to lower x.
fn tip(at: [f64; 3]) -> TriMesh {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.05], [1.0, 0.6, 0.1], [1.0, 0.3, 0.5]];
    let positions = corners.map(|p| DVec3::from_array(p) + DVec3::from_array(at)).to_vec();
    TriMesh { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] }
}

fn gaps() -> Vec<Case> {
    let mut all = Vec::new();
    for (words, gap) in [("1e-6", 1e-6), ("1e-9", 1e-9), ("one step of f32", f64::from(f32::EPSILON))] {
        all.push(apart(&format!("facing boxes, {words} apart"), unit([0.0; 3]), unit([1.0 + gap, 0.0, 0.0])));
        let a = unit([0.0; 3]);
        let volumes = vec![2.0 - gap, gap, 1.0 - gap];
        let name = format!("facing boxes, {words} into each other");
        all.push(Case { name, operands: [a, unit([1.0 - gap, 0.0, 0.0])], volumes });
        let name = format!("facing boxes beside, {words} apart");
        all.push(apart(&name, unit([0.0; 3]), unit([1.0 + gap, 0.5, 0.25])));
    }
    all
}

fn tangents() -> Vec<Case> {
    let around = cuboid(DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE);
    let beside = cuboid(DVec3::new(1.0, -1.0, 0.0), DVec3::new(2.0, 1.0, 1.0));
    let apothem = (std::f64::consts::PI / 32.0).cos();
    let at_side = moved(&beside, DVec3::X * (apothem - 1.0));
    vec![
        within("a cylinder in a box, along four lines", around, prism(32, false)),
        apart("a cylinder beside a box, along a line", beside.clone(), prism(32, false)),
        apart("a cylinder beside a box, along one of its sides", at_side, prism(32, true)),
        apart(
            "a cylinder beside a box, a line within the box's face",
            moved(&beside, DVec3::Z * -0.25),
            prism(32, false),
        ),
    ]
}

fn nearly_the_same() -> Vec<Case> {
    let bodies = [
        ("a box", cuboid(DVec3::splat(-0.5), DVec3::new(0.5, 0.7, 0.3))),
        ("a torus", turned(torus(24, 12), 0.7)),
        ("a ball", ball(3, |_| 1.0)),
        ("a cylinder", prism(32, false)),
    ];
    let copies = |(name, body): &(&str, TriMesh)| {
        vec![
            twice(&format!("{name} twice, turned by 1e-7"), body.clone(), slightly(body, 1e-7)),
            twice(
                &format!("{name} twice, moved by 1e-9"),
                body.clone(),
                moved(body, DVec3::new(1e-9, 0.7e-9, -0.4e-9)),
            ),
        ]
    };
    bodies.iter().flat_map(copies).collect()
}

/// Prints the rows and checks that no volume is off by more than `double` and `single`.
fn check(cases: Vec<Case>, double: f64, single: f64) {
    for case in cases {
        let [wide, narrow] = [Precision::Double, Precision::Single].map(|precision| made(&case, precision));
        let bodies: Vec<String> = wide.bodies.iter().map(usize::to_string).collect();
        println!(
            "| {} | {} | {:.1e} | {:.1e} | {} |",
            case.name,
            bodies.join(", "),
            wide.error,
            narrow.error,
            wide.moved.max(narrow.moved)
        );
        assert!(wide.error <= double && narrow.error <= single, "{}: {wide:?}, {narrow:?}", case.name);
    }
}

/// Coordinates are whole or halves, so that only vertices that were moved apart change a volume: by some steps.
#[test]
fn contacts_are_valid_and_have_the_right_volume() {
    check(contacts(), 1e-7, 3e-6);
}

/// The lattice has steps of 4e-9 here, and f32 of 1.2e-7: gaps below that are closed.
#[test]
fn small_gaps_are_kept_or_closed() {
    check(gaps(), 1e-8, 3e-7);
}

#[test]
fn tangents_are_valid_and_have_the_right_volume() {
    check(tangents(), 1e-7, 3e-6);
}

/// A turn by 1e-7 takes volume of about that much off the intersection.
#[test]
fn bodies_that_are_nearly_the_same_stay_one() {
    check(nearly_the_same(), 1e-6, 3e-6);
}
