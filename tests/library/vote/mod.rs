//! A vote is an exact point-in-solid test, and the bricks that are stored hold the whole surface.

mod beyond;
mod lids;

use crate::common::{shapes, stages};
use glam::{DMat3, DVec3, IVec3};
use meshwright::lattice::{BRICK, Grid, Lattice, brick_of, voxel_in_brick};
use meshwright::mesh::TriMesh;
use meshwright::vote::{VoteRule, Votes, doubts};
use proptest::prelude::*;

fn all_voxels(lattice: &Lattice) -> impl Iterator<Item = IVec3> {
    let d = lattice.dims;
    (0..d.z).flat_map(move |z| (0..d.y).flat_map(move |y| (0..d.x).map(move |x| IVec3::new(x, y, z))))
}

/// Votes on every voxel of the lattice, in the order of [`all_voxels`].
fn dense(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule) -> Vec<bool> {
    let top = brick_of(lattice.dims - 1);
    let bricks = (0..=top.z).flat_map(|z| (0..=top.y).flat_map(move |y| (0..=top.x).map(move |x| IVec3::new(x, y, z))));
    let mut inside = std::collections::HashMap::new();
    stages::with_jury(mesh, lattice, rule, |jury| {
        for brick in bricks {
            for (n, votes) in jury.brick(brick).expect("not stopped").iter().enumerate() {
                inside.insert(brick * BRICK + voxel_in_brick(n), votes.is_inside);
            }
        }
    });
    all_voxels(lattice).map(|v| inside[&v]).collect()
}

fn sparse(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule) -> Grid<Votes> {
    stages::votes_of(mesh, lattice, rule)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn a_turned_box_is_voted_exactly(
        axis in prop::array::uniform3(-1.0f64..1.0),
        angle in 0.0f64..6.3,
        resolution in 20u32..60,
    ) {
        let axis = DVec3::from_array(axis).try_normalize().unwrap_or(DVec3::Z);
        let turn = DMat3::from_axis_angle(axis, angle);
        let half = DVec3::new(1.0, 0.6, 0.3);
        let mut mesh = shapes::cuboid(-half, half);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
        let lattice = stages::lattice_of(&mesh, resolution);
        let votes = sparse(&mesh, &lattice, VoteRule::default());
        for voxel in all_voxels(&lattice) {
            let p = turn.transpose() * lattice.to_model(voxel.as_dvec3());
            let depth = (half - p.abs()).min_element();
            // Vertices are snapped to 2⁻¹⁶ h.
            if depth.abs() > 1e-4 * lattice.h {
                prop_assert_eq!(votes.get(voxel).is_inside, depth > 0.0, "{} at depth {}", voxel, depth);
            }
        }
        prop_assert_eq!(doubts(&votes, &lattice).doubtful, 0);
    }

    #[test]
    fn the_stored_bricks_agree_with_a_vote_on_every_voxel(
        missing in prop::collection::vec(0usize..2048, 0..60),
        resolution in 24u32..48,
        rule in prop::sample::select(vec![VoteRule::Winding, VoteRule::HalfRays, VoteRule::Majority, VoteRule::Paper]),
    ) {
        // Holes make the surface grow where no ray crosses anything.
        let mut mesh = shapes::torus(64, 16);
        let mut missing = missing;
        missing.sort_unstable();
        missing.dedup();
        missing.iter().rev().for_each(|&t| { mesh.triangles.swap_remove(t); });
        let lattice = stages::lattice_of(&mesh, resolution);
        let grid = sparse(&mesh, &lattice, rule);
        for (voxel, inside) in all_voxels(&lattice).zip(dense(&mesh, &lattice, rule)) {
            prop_assert_eq!(grid.get(voxel).is_inside, inside, "{}", voxel);
        }
    }
}

#[test]
fn a_void_stays_a_void() {
    let mut mesh = shapes::cuboid(DVec3::ZERO, DVec3::splat(4.0));
    let mut inner = shapes::cuboid(DVec3::ONE, DVec3::splat(3.0));
    inner.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    mesh.append(&inner);
    let lattice = stages::lattice_of(&mesh, 64);
    let votes = sparse(&mesh, &lattice, VoteRule::default());
    let at = |x: f64| votes.get(lattice.to_lattice(DVec3::splat(x)).round().as_ivec3()).is_inside;
    assert!(!at(2.0) && at(0.5) && at(3.5));
}
