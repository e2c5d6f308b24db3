//! What the tests of the arrangement share: closed shells, expressions over them, and what is measured of results.

use crate::common::proofs::state;
use crate::common::shapes::{cuboid, torus_of};
use glam::{DQuat, DVec3};
use meshwright::arrange::{ArrangeError, ArrangeOptions, Arranged, arrange};
use meshwright::ldi::{Expression, Inside, Operands};
use meshwright::mesh::TriMesh;
use meshwright::orient::OrientMode;
use meshwright::progress::Progress;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// What is asked of an arrangement: the triangles as they face, in double precision.
pub fn asked(expression: &Expression) -> ArrangeOptions<'_> {
    ArrangeOptions { expression, orient: OrientMode::Keep, single: false, suspects: &[], classes: &[] }
}

/// A regular prism along z, with a corner so many sides on from the x axis.
pub fn prism(middle: DVec3, radius: f64, heights: [f64; 2], sides: u32, turned: f64) -> TriMesh {
    let angle = |k: u32| std::f64::consts::TAU * (f64::from(k) + turned) / f64::from(sides);
    let ring =
        |z: f64| (0..sides).map(move |k| middle + DVec3::new(radius * angle(k).cos(), radius * angle(k).sin(), z));
    let mut mesh = TriMesh { positions: heights.into_iter().flat_map(ring).collect(), triangles: Vec::new() };
    for k in 0..sides {
        let next = (k + 1) % sides;
        mesh.triangles.extend([[k, next, next + sides], [k, next + sides, k + sides]]);
    }
    for k in 1..sides - 1 {
        mesh.triangles.extend([[0, k + 1, k], [sides, sides + k, sides + k + 1]]);
    }
    mesh
}

/// All triangles of operands, one operand after another.
pub fn piled(operands: &[TriMesh]) -> (TriMesh, Operands) {
    let mut mesh = TriMesh::default();
    operands.iter().for_each(|operand| mesh.append(operand));
    (mesh, Operands::new(operands.iter().map(|operand| operand.triangles.len())))
}

pub fn arranged(operands: &[TriMesh], options: &ArrangeOptions<'_>) -> Result<Arranged, ArrangeError> {
    arranged_by(Inside::Positive, operands, options)
}

/// The arrangement of operands of which these winding numbers are inside.
pub fn arranged_by(
    inside: Inside,
    operands: &[TriMesh],
    options: &ArrangeOptions<'_>,
) -> Result<Arranged, ArrangeError> {
    let (mesh, counts) = piled(operands);
    arrange(&mesh, &counts.with_inside(inside), options, &Progress::none())
}

/// The arrangement of operands in double precision, or in single.
pub fn result(operands: &[TriMesh], expression: &Expression, single: bool) -> Result<Arranged, TestCaseError> {
    let made = arranged(operands, &ArrangeOptions { single, ..asked(expression) });
    let made = made.map_err(|error| TestCaseError::fail(format!("{error}")))?;
    if !made.mesh.triangles.is_empty() {
        let found = state(&made.mesh, true);
        prop_assert!(found.is_valid(), "{:?}, {:?}", found.problems(), made.report);
        prop_assert!(!single || made.mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p));
        prop_assert_eq!(made.sources.len(), made.mesh.triangles.len());
    }
    Ok(made)
}

/// Six times the signed volume about a point; exact where corners are small whole numbers.
pub fn six_volumes(mesh: &TriMesh, about: DVec3) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|p| p - about));
    corners.map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

/// The signed volume.
pub fn volume(mesh: &TriMesh) -> f64 {
    let middle = mesh.bounds().map_or(DVec3::ZERO, |bounds| (bounds.min + bounds.max) / 2.0);
    six_volumes(mesh, middle) / 6.0
}

pub fn area(mesh: &TriMesh) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    corners.map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// By how much a volume may change where vertices at contacts are moved, and where what crossed once it was rounded was mended: some steps
/// more in each round; a step is at most 2⁻²⁸ of the largest coordinate, or 2⁻²² of it in single precision.
pub fn moved_volume(made: &Arranged, single: bool) -> f64 {
    let largest = made.mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let step = largest * if single { 2f64.powi(-22) } else { 2f64.powi(-28) };
    let steps = match (made.report.separated, made.report.rounds) {
        (0, 0) => 0.0,
        (_, 0) => 2.0,
        (_, rounds) => 16.0 * 2f64.powi(rounds as i32),
    };
    area(&made.mesh) * steps * step
}

pub fn inside_out(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

pub fn moved(mesh: &TriMesh, by: DVec3) -> TriMesh {
    TriMesh { positions: mesh.positions.iter().map(|&p| p + by).collect(), triangles: mesh.triangles.clone() }
}

/// The mesh with coordinates that are multiples of 2⁻²⁰: they lie on the lattice of the arrangement as long as none is more than 512.
pub fn coarse(mut mesh: TriMesh) -> TriMesh {
    let unit = 2f64.powi(20);
    mesh.positions.iter_mut().for_each(|p| *p = (*p * unit).round() / unit);
    mesh
}

/// A closed shell.
#[derive(Debug, Clone)]
pub enum Shell {
    /// A box between whole coordinates.
    Whole { low: [i32; 3], size: [i32; 3] },
    /// A tetrahedron with whole corners; one without a volume is nothing.
    Tetrahedron([[i32; 3]; 4]),
    /// A box, a torus or a tetrahedron in general position.
    Turned { kind: usize, centre: [f64; 3], turn: [f64; 3] },
}

impl Shell {
    /// The shell, facing outwards.
    pub fn mesh(&self) -> TriMesh {
        let vector = |p: [i32; 3]| DVec3::from_array(p.map(f64::from));
        match *self {
            Self::Whole { low, size } => cuboid(vector(low), vector(low) + vector(size)),
            Self::Tetrahedron(corners) => {
                let positions = corners.map(vector).to_vec();
                let sides = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
                let mesh = TriMesh { positions, triangles: sides };
                match six_volumes(&mesh, DVec3::ZERO) {
                    0.0 => TriMesh::default(),
                    volume if volume < 0.0 => inside_out(mesh),
                    _ => mesh,
                }
            }
            Self::Turned { kind, centre, turn } => {
                let mut mesh = match kind % 3 {
                    0 => cuboid(DVec3::new(-1.0, -0.7, -0.6), DVec3::new(1.0, 0.7, 0.6)),
                    1 => torus_of(7, 5, 0.9, 0.4),
                    _ => Self::Tetrahedron([[-1, -1, -1], [1, 1, -1], [1, -1, 1], [-1, 1, 1]]).mesh(),
                };
                let turn = DQuat::from_scaled_axis(DVec3::from_array(turn));
                mesh.positions.iter_mut().for_each(|p| *p = turn * *p + DVec3::from_array(centre));
                coarse(mesh)
            }
        }
    }
}

/// Boxes and tetrahedra on a small grid, where nearly everything touches in a special way.
pub fn whole_shell(most: i32) -> impl Strategy<Value = Shell> {
    let corner = move || prop::array::uniform3(0..=most);
    let size = prop::array::uniform3(1..=most / 2 + 1);
    prop_oneof![
        (corner(), size).prop_map(|(low, size)| Shell::Whole { low, size }),
        prop::array::uniform4(corner()).prop_map(Shell::Tetrahedron),
    ]
}

/// Boxes, tori and tetrahedra in general position.
pub fn turned_shell() -> impl Strategy<Value = Shell> {
    let (centre, turn) = (prop::array::uniform3(-1.0..1.0), prop::array::uniform3(-3.0..3.0));
    (0usize..3, centre, turn).prop_map(|(kind, centre, turn)| Shell::Turned { kind, centre, turn })
}

/// Expressions over operands 0 to `operands` - 1.
pub fn expression(operands: usize) -> impl Strategy<Value = Expression> {
    let leaf = (0..operands).prop_map(Expression::Operand);
    leaf.prop_recursive(3, 12, 3, |inner| {
        let list = || prop::collection::vec(inner.clone(), 1..=3);
        let pair = || (inner.clone().prop_map(Box::new), inner.clone().prop_map(Box::new));
        prop_oneof![
            list().prop_map(Expression::Union),
            list().prop_map(Expression::Intersection),
            pair().prop_map(|(a, b)| Expression::Difference(a, b)),
            pair().prop_map(|(a, b)| Expression::SymmetricDifference(a, b)),
        ]
    })
}

/// A number of cases for a property; the environment may ask for more:
/// `MESHWRIGHT_CASES=1000 cargo test --release --test library arrange`.
pub fn cases(cases: u32) -> ProptestConfig {
    let asked = std::env::var("MESHWRIGHT_CASES").ok().and_then(|count| count.parse().ok());
    let cases = asked.unwrap_or(cases);
    ProptestConfig { cases, max_global_rejects: 20 * cases, failure_persistence: None, ..ProptestConfig::default() }
}
