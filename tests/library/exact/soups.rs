//! Soups: the distance is that to the triangles, the side comes from elsewhere.

use glam::IVec3;
use meshwright::lattice::{Grid, Lattice};
use meshwright::ldi::{Expression, Operands};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactDistance, ExactOptions, PointSign, Sign, exact};
use meshwright::vote::{VoteRule, Winding};

use crate::common::exact::{lattice, winding};
use crate::common::fields::voxel;
use crate::common::shapes::ball;
use crate::common::{shapes, stages};

/// A ball with a hole, and a box that overlaps it.
fn soup() -> TriMesh {
    let mut mesh = ball(3, |_| 0.5);
    mesh.triangles.truncate(mesh.triangles.len() - 50);
    mesh.append(&shapes::cuboid(glam::DVec3::splat(0.1), glam::DVec3::splat(0.6)));
    mesh
}

fn field(mesh: &TriMesh, lattice: &Lattice, sign: Sign<'_>, band: Band) -> Grid<f32> {
    let options = ExactOptions { band, max_memory: None };
    exact(mesh, lattice, sign, &options, &Progress::none()).expect("a field").grid
}

/// All voxels of the lattice, and the distance of each from the triangles in h.
fn voxels(mesh: &TriMesh, lattice: &Lattice) -> Vec<(IVec3, f64)> {
    let point = ExactDistance::of(mesh, PointSign::Pseudonormal);
    let counts = (lattice.dims + 7) / 8;
    let bricks = (0..counts.element_product())
        .map(|n| IVec3::new(n % counts.x, n / counts.x % counts.y, n / (counts.x * counts.y)));
    let all = bricks.flat_map(|brick| (0..512).map(move |n| voxel(brick, n)));
    let distance = |v: IVec3| point.at(lattice.to_model(v.as_dvec3())).expect("triangles").signed.abs() / lattice.h;
    all.map(|v| (v, distance(v))).collect()
}

#[test]
fn votes_tell_the_side() {
    let mesh = soup();
    let around = lattice(&mesh, 1.0 / 24.0, 4);
    let votes = stages::votes_of(&mesh, &around, VoteRule::default());
    for (band, width) in [(Band::Within(2.5), 2.5), (Band::Full, f64::INFINITY)] {
        let grid = field(&mesh, &around, Sign::Votes(&votes), band);
        for (v, distance) in voxels(&mesh, &around) {
            let got = grid.get(v);
            assert!((f64::from(got.abs()) - distance.min(width)).abs() < 1e-4, "{got} for {distance} at {v}");
            assert_eq!(got < 0.0, votes.get(v).is_inside, "{v}");
        }
    }
}

#[test]
fn what_closes_a_wide_hole_passes_through_stored_bricks() {
    let mut mesh = shapes::cuboid(glam::DVec3::ZERO, glam::DVec3::ONE);
    mesh.triangles.drain(2..4);
    let around = lattice(&mesh, 1.0 / 50.0, 3);
    let operands = Operands::new([mesh.triangles.len()]);
    let numbers = Winding::new(&mesh, &operands, &around, &Progress::none());
    let votes = stages::votes_of(&mesh, &around, VoteRule::default());
    let expression = Expression::Operand(0);
    for sign in [Sign::Votes(&votes), Sign::Winding(&numbers, &expression)] {
        let grid = field(&mesh, &around, sign, Band::Within(2.0));
        for v in (0..around.dims.element_product()).step_by(5) {
            let v =
                IVec3::new(v % around.dims.x, v / around.dims.x % around.dims.y, v / (around.dims.x * around.dims.y));
            let p = around.to_model(v.as_dvec3());
            let inside = p.cmpgt(glam::DVec3::ZERO).all() && p.cmplt(glam::DVec3::ONE).all();
            assert_eq!(grid.get(v) < 0.0, inside, "{v}");
        }
    }
}

#[test]
fn winding_numbers_tell_the_side() {
    let mesh = soup();
    let around = lattice(&mesh, 1.0 / 24.0, 2);
    let operands = Operands::new([mesh.triangles.len()]);
    let numbers = Winding::new(&mesh, &operands, &around, &Progress::none());
    let expression = Expression::Operand(0);
    let grid = field(&mesh, &around, Sign::Winding(&numbers, &expression), Band::Within(3.0));
    let (mut inside, mut asked) = (0, 0);
    for (v, distance) in voxels(&mesh, &around).into_iter().step_by(3) {
        let got = grid.get(v);
        let number = winding(&mesh, around.to_model(v.as_dvec3()));
        assert!((f64::from(got.abs()) - distance.min(3.0)).abs() < 1e-4, "{got} for {distance} at {v}");
        if (number - 0.5).abs() > 0.01 {
            assert_eq!(got < 0.0, number > 0.5, "{v}: {number}");
            asked += 1;
            inside += usize::from(number > 0.5);
        }
    }
    assert!(inside > 500 && asked > 3 * inside, "{inside} of {asked}");
}
