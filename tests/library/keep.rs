//! Source triangles that bound the solid as they are come back as they were, and only what is broken is built anew.

use std::collections::BTreeSet;

use crate::common::shapes::{closed, cuboid, torus};
use glam::{DMat3, DVec3};
use meshwright::fit::FitOptions;
use meshwright::ldi::Expression;
use meshwright::mesh::{ClosestTree, TriMesh, ValidateOptions, validate};
use meshwright::pipeline::{Options, Outcome, TriangleSource, VoxelSize, boolean};
use meshwright::progress::Progress;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// All triangles stay: simplification off.
fn at(resolution: u32) -> Options {
    let fit = Some(FitOptions { simplify: 0.0, simplify_kept: 0.0, ..FitOptions::default() });
    Options { fit, ..Options::new(VoxelSize::Along(resolution)) }
}

fn made(operands: &[TriMesh], expression: &Expression, options: &Options) -> Outcome {
    let outcome = boolean(operands, expression, options, &Progress::none()).expect("a solid");
    let options = ValidateOptions { self_intersections: true, weld: true };
    let validity = validate(&outcome.solid, &options, &Progress::none()).expect("not stopped");
    assert!(validity.is_valid(), "{:?}", validity.problems());
    outcome
}

fn repaired(mesh: &TriMesh, options: &Options) -> Outcome {
    made(std::slice::from_ref(mesh), &Expression::Operand(0), options)
}

fn kept(outcome: &Outcome) -> usize {
    outcome.report.kept()
}

/// The triangles by their corners' coordinates, each beginning with its smallest corner.
fn triangles(mesh: &TriMesh) -> BTreeSet<[[u32; 3]; 3]> {
    let corner = |v: u32| mesh.positions[v as usize].as_vec3().to_array().map(|x| (x + 0.0).to_bits());
    let turned = |t: &[u32; 3]| {
        let corners = t.map(corner);
        let first = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
        [0, 1, 2].map(|k| corners[(first + k) % 3])
    };
    mesh.triangles.iter().map(turned).collect()
}

/// A skewed turn, so that nothing is aligned with the lattice.
fn tilted(mesh: TriMesh) -> TriMesh {
    let turn = DMat3::from_euler(glam::EulerRot::ZYX, 0.4, 0.7, 1.1);
    TriMesh { positions: mesh.positions.iter().map(|&p| turn * p).collect(), ..mesh }
}

#[test]
fn a_solid_comes_back_triangle_by_triangle() {
    for which in 0..3 {
        let (name, mesh) = closed(which);
        let outcome = repaired(&mesh, &at(48));
        assert_eq!(kept(&outcome), mesh.triangles.len(), "{name}");
        assert_eq!(triangles(&outcome.solid), triangles(&mesh), "{name}");
        assert!(outcome.report.kept_all());
    }
}

#[test]
fn walls_thinner_than_a_voxel_stay() {
    let wall = tilted(cuboid(DVec3::ZERO, DVec3::new(1.0, 0.8, 0.02)));
    let mut plate = wall.clone();
    plate.append(&tilted(cuboid(DVec3::new(0.2, 0.2, 0.5), DVec3::new(0.5, 0.5, 0.9))));
    let outcome = repaired(&plate, &at(32));
    assert_eq!(triangles(&outcome.solid), triangles(&plate));
    assert!(outcome.report.warnings.is_empty(), "{:?}", outcome.report.warnings);
}

#[test]
fn turned_patches_are_turned_back_and_kept() {
    let whole = torus(40, 20);
    let mut broken = whole.clone();
    broken.triangles[100..500].iter_mut().for_each(|t| t.swap(0, 1));
    let outcome = repaired(&broken, &at(48));
    assert_eq!(triangles(&outcome.solid), triangles(&whole));
}

#[test]
fn around_a_hole_all_but_the_nearest_triangles_stay() {
    let mesh = torus(60, 30);
    let mut open = mesh.clone();
    let hole = mesh.corners(700).iter().sum::<DVec3>() / 3.0;
    let gone = |t: usize| mesh.corners(t).iter().any(|p| p.distance(hole) < 0.2);
    open.triangles = (0..mesh.triangles.len()).filter(|&t| !gone(t)).map(|t| mesh.triangles[t]).collect();
    let outcome = repaired(&open, &at(64));
    let (found, h) = (triangles(&outcome.solid), outcome.lattice.h);
    let away = |t: usize| mesh.corners(t).iter().all(|p| p.distance(hole) > 0.2 + 6.0 * h);
    let far = TriMesh {
        triangles: (0..mesh.triangles.len()).filter(|&t| away(t)).map(|t| mesh.triangles[t]).collect(),
        ..mesh.clone()
    };
    assert!(far.triangles.len() > 3000 && triangles(&far).is_subset(&found));
    assert!(kept(&outcome) < mesh.triangles.len() && outcome.report.closed_triangles > 0);
}

#[test]
fn a_boolean_keeps_what_it_does_not_cut() {
    let ring = torus(64, 32);
    let bounds = ring.bounds().expect("not empty");
    let size = bounds.size();
    let box_low = bounds.min + size * DVec3::new(0.55, 0.21, 0.17);
    let cutter = cuboid(box_low, box_low + size);
    let difference = Expression::Difference(Box::new(Expression::Operand(0)), Box::new(Expression::Operand(1)));
    let outcome = made(&[ring.clone(), cutter.clone()], &difference, &at(64));
    let (found, h) = (triangles(&outcome.solid), outcome.lattice.h);
    let (inside, outside) = (box_low - 4.0 * h, box_low + 4.0 * h);
    let left = (0..ring.triangles.len()).filter(|&t| ring.corners(t).iter().all(|p| p.cmplt(inside).any()));
    let left = TriMesh { triangles: left.map(|t| ring.triangles[t]).collect(), ..ring.clone() };
    assert!(!left.triangles.is_empty() && triangles(&left).is_subset(&found));
    let cut_off = (0..ring.triangles.len()).filter(|&t| ring.corners(t).iter().all(|p| p.cmpgt(outside).all()));
    assert!(cut_off.map(|t| ring.triangles[t]).all(|t| {
        let one = TriMesh { triangles: vec![t], ..ring.clone() };
        triangles(&one).is_disjoint(&found)
    }));
}

#[test]
fn parts_inside_of_others_and_a_void_are_told_apart() {
    let (outer, inner) = (cuboid(DVec3::ZERO, DVec3::ONE), cuboid(DVec3::splat(0.3), DVec3::splat(0.6)));
    let mut both = outer.clone();
    both.append(&inner);
    assert_eq!(triangles(&repaired(&both, &at(32)).solid), triangles(&outer));
    let mut hollow = outer.clone();
    let mut inwards = inner.clone();
    inwards.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    hollow.append(&inwards);
    assert_eq!(triangles(&repaired(&hollow, &at(32)).solid), triangles(&hollow));
    let difference = Expression::Difference(Box::new(Expression::Operand(0)), Box::new(Expression::Operand(1)));
    assert_eq!(triangles(&made(&[outer, inner], &difference, &at(32)).solid), triangles(&hollow));
}

#[test]
fn every_kept_triangle_knows_its_source() {
    let mesh = torus(30, 15);
    let outcome = repaired(&mesh, &at(40));
    for (t, source) in outcome.sources.iter().enumerate() {
        let TriangleSource::Operand { triangle, .. } = *source else { panic!("triangle {t} closes nothing") };
        let one = |mesh: &TriMesh, t: usize| triangles(&TriMesh { triangles: vec![mesh.triangles[t]], ..mesh.clone() });
        assert_eq!(one(&mesh, triangle as usize), one(&outcome.solid, t), "triangle {t}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 14, rng_seed: RngSeed::Fixed(24), ..ProptestConfig::default() })]

    /// Whatever is torn out: the result is valid, and what is said to be of the source is near it.
    #[test]
    fn what_is_joined_is_valid_and_where_it_was(
        which in prop::sample::select(vec![1usize, 3]),
        share in 0.0f64..0.15,
        seed in any::<u64>(),
        resolution in 20u32..60,
    ) {
        let mesh = tilted(closed(which).1);
        let mut broken = mesh.clone();
        let dice = |t: u64| {
            let mixed = (seed ^ t.wrapping_mul(0x9e37_79b9_7f4a_7c15)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let bits = (mixed ^ (mixed >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (bits >> 11) as f64 / (1u64 << 53) as f64
        };
        broken.triangles = (0..).zip(&mesh.triangles).filter(|(t, _)| dice(*t) >= share).map(|(_, t)| *t).collect();
        let outcome = repaired(&broken, &at(resolution));
        let tree = ClosestTree::of_mesh(&broken);
        let off = |t: usize| {
            let corners = outcome.solid.corners(t);
            corners.iter().map(|p| tree.nearest(*p).map_or(0.0, |c| c.distance)).fold(0.0, f64::max)
        };
        let of_source = |t: &usize| matches!(outcome.sources[*t], TriangleSource::Operand { .. });
        let farthest = (0..outcome.solid.triangles.len()).filter(of_source).map(off).fold(0.0, f64::max);
        prop_assert!(farthest < 2.0 * outcome.lattice.h, "{} h", farthest / outcome.lattice.h);
    }
}
