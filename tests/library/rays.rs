//! Every closed mesh gives balanced rays, in all 13 directions.

use crate::common::proofs::{assert_balanced, balances};
use crate::common::{read, sample, shapes};
use glam::{DMat3, DVec3};
use proptest::prelude::*;

#[test]
fn hard_meshes_and_files_balance() {
    let mut meshes = shapes::hard();
    meshes.extend([("knot", shapes::knot(96, 16)), ("gear", shapes::gear(24)), ("stack", shapes::stack(0.1))]);
    meshes.extend(["torus.ply", "monkey_saddle.off", "hollow_ball.stl"].map(|name| (name, read(&sample(name)))));
    for (name, mesh) in meshes {
        for resolution in [64, 256] {
            assert_balanced(name, &mesh, resolution, 1);
        }
        assert_balanced(name, &mesh, 64, 2);
    }
}

#[test]
fn a_missing_triangle_unbalances_rays() {
    let mut mesh = shapes::torus(32, 16);
    mesh.triangles.pop();
    assert!(balances(&mesh, 64, 1).iter().any(|b| b.unbalanced > 0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn closed_shapes_balance_under_any_rotation(
        axis in prop::array::uniform3(-1.0f64..1.0),
        angle in 0.0f64..6.3,
        which in 0usize..4,
        resolution in prop::sample::select(vec![64u32, 256]),
    ) {
        let axis = DVec3::from_array(axis).try_normalize().unwrap_or(DVec3::Z);
        let turn = DMat3::from_axis_angle(axis, angle);
        let (name, mut mesh) = shapes::closed(which);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
        assert_balanced(name, &mesh, resolution, 1);
    }
}

#[test]
fn generated_meshes_balance_at_1024() {
    for which in 0..4 {
        let (name, mesh) = shapes::closed(which);
        assert_balanced(name, &mesh, 1024, 1);
    }
}
