//! Every closed mesh gives balanced rays, in all 13 directions.

use crate::common::{data, shapes, stages};
use glam::{DMat3, DVec3};
use meshwright::ldi::{Balance, Layers, Operands, balance, ldis};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use proptest::prelude::*;

fn balances(mesh: &TriMesh, resolution: u32, factor: u32) -> Vec<Balance> {
    let layers = ldis(mesh, &stages::lattice_of(mesh, resolution), factor, &Progress::none()).expect("not stopped");
    let operands = Operands::new([mesh.triangles.len()]);
    layers.iter().map(|layers: &Layers| balance(layers, &operands)).collect()
}

fn assert_balanced(name: &str, mesh: &TriMesh, resolution: u32, factor: u32) {
    for (direction, balance) in balances(mesh, resolution, factor).into_iter().enumerate() {
        assert!(balance.occupied > 0, "{name} at {resolution}: direction {direction} hits nothing");
        assert_eq!(balance.unbalanced, 0, "{name} at {resolution}, factor {factor}, direction {direction}");
    }
}

#[test]
fn clean_real_meshes_balance() {
    for (name, mesh) in data("clean") {
        for resolution in [64, 256, 1024] {
            assert_balanced(&name, &mesh, resolution, 1);
        }
        assert_balanced(&name, &mesh, 64, 2);
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
