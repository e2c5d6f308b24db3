//! Sharp edges and corners come back exactly, flat sides get few triangles, and the result is valid.

use glam::{DMat3, DQuat, DVec3};
use meshwright::fit::FitOptions;
use meshwright::io::Colours;
use meshwright::ldi::Expression;
use meshwright::mesh::{TriMesh, ValidateOptions, validate};
use meshwright::pipeline::{Operand, Options, Outcome, TriangleSource, VoxelSize, boolean, repair};
use meshwright::progress::Progress;
use proptest::prelude::*;

/// A box between two corners, turned by `turn`; two triangles a side, in the order -x +x -y +y -z +z.
fn cuboid(low: DVec3, high: DVec3, turn: DMat3) -> TriMesh {
    let corner = |k: u32| {
        let pick = |axis: usize| if k >> axis & 1 == 1 { high[axis] } else { low[axis] };
        turn * DVec3::new(pick(0), pick(1), pick(2))
    };
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        triangles.extend([[0, v, u], [u, v, u | v]]);
        let w = 1 << axis;
        triangles.extend([[w, w | u, w | v], [w | u, w | u | v, w | v]]);
    }
    TriMesh { positions: (0..8).map(corner).collect(), triangles }
}

fn turn(seed: u64) -> DMat3 {
    let part = |k: u64| {
        let bits = (seed * 4 + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    DMat3::from_quat(DQuat::from_xyzw(part(0), part(1), part(2), part(3)).normalize())
}

/// All of the surface from the voxels: what is kept as it is does not show the fit.
fn at(resolution: u32) -> Options {
    let fit = Some(FitOptions { rebuild: true, ..FitOptions::default() });
    Options { fit, ..Options::new(VoxelSize::Along(resolution)) }
}

fn made(operands: &[TriMesh], expression: &Expression, options: &Options) -> Outcome {
    let outcome = boolean(operands, expression, options, &Progress::none()).expect("a solid");
    let options = ValidateOptions { self_intersections: true, weld: true };
    let validity = validate(&outcome.solid, &options, &Progress::none()).expect("not stopped");
    assert!(validity.is_valid(), "{:?}", validity.problems());
    assert_eq!(outcome.sources.len(), outcome.solid.triangles.len());
    outcome
}

fn repaired(mesh: &TriMesh, options: &Options) -> Outcome {
    made(std::slice::from_ref(mesh), &Expression::Operand(0), options)
}

/// The largest distance from a corner of `wanted` to the nearest vertex of `mesh`.
fn farthest_corner(wanted: &TriMesh, mesh: &TriMesh) -> f64 {
    let nearest = |p: &DVec3| mesh.positions.iter().map(|q| q.distance(*p)).fold(f64::INFINITY, f64::min);
    wanted.positions.iter().map(nearest).fold(0.0, f64::max)
}

/// Seeds of [`turn`] for which a few triangles are left where the voxels' surface is folded over an edge.
const MOST_WITH_MORE: usize = 3;

#[test]
fn a_cube_of_any_orientation_comes_back_as_the_cube() {
    for missing in [0, 2] {
        let mut with_more = 0;
        for seed in 0..12 {
            let whole = cuboid(DVec3::ZERO, DVec3::ONE, turn(seed));
            let mut open = whole.clone();
            open.triangles.drain(..missing);
            let outcome = repaired(&open, &at(64));
            let off = farthest_corner(&whole, &outcome.solid);
            assert!(off < 1e-5, "seed {seed}, {missing} triangles missing: a corner is {off} away");
            with_more += usize::from(outcome.solid.triangles.len() != 12);
            assert_eq!(outcome.report.closed_triangles > 0, missing > 0, "seed {seed}");
        }
        assert!(with_more <= MOST_WITH_MORE, "{with_more} of 12 with {missing} missing have more than 12 triangles");
    }
}

#[test]
fn boxes_that_share_a_face_become_one_box() {
    let none = DMat3::IDENTITY;
    let (a, b) = (cuboid(DVec3::ZERO, DVec3::ONE, none), cuboid(DVec3::X, DVec3::new(2.0, 1.0, 1.0), none));
    let outcome = made(&[a, b], &Expression::union(2), &at(64));
    assert_eq!(outcome.solid.triangles.len(), 12);
    let whole = cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0), none);
    assert!(farthest_corner(&whole, &outcome.solid) < 1e-6);
}

#[test]
fn every_triangle_of_the_result_knows_where_it_comes_from() {
    let whole = cuboid(DVec3::ZERO, DVec3::ONE, turn(3));
    let mut open = whole.clone();
    let lid = open.triangles.split_off(10);
    let lid_normal = normal(&TriMesh { triangles: lid, ..whole.clone() }, 0);
    let outcome = repaired(&open, &at(48));
    for (t, source) in outcome.sources.iter().enumerate() {
        let own = normal(&outcome.solid, t);
        match *source {
            TriangleSource::Lid { .. } | TriangleSource::Closed => assert!(own.dot(lid_normal) > 0.999),
            TriangleSource::Operand { operand, triangle } => {
                assert_eq!(operand, 0);
                assert!(own.dot(normal(&open, triangle as usize)) > 0.999);
            }
        }
    }
}

fn normal(mesh: &TriMesh, t: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(t);
    (b - a).cross(c - a).normalize()
}

#[test]
fn sides_keep_their_colours() {
    let mesh = cuboid(DVec3::ZERO, DVec3::ONE, turn(5));
    let colour = |t: usize| [40 * (t / 2) as u8, 200, 10, 255];
    let colours = Colours::Faces((0..12).map(colour).collect());
    let operand = Operand { mesh: &mesh, colours: Some(&colours), texture: None, negative: None };
    let outcome = repair(operand, &at(48), &Progress::none()).expect("a solid");
    let Some(Colours::Faces(carried)) = &outcome.colours else { panic!("no colour for each triangle") };
    for (t, found) in carried.iter().enumerate() {
        let facing = (0..12).max_by(|&a, &b| {
            let agreement = |k: usize| normal(&mesh, k).dot(normal(&outcome.solid, t));
            agreement(a).total_cmp(&agreement(b))
        });
        assert_eq!(*found, colour(facing.expect("twelve")), "triangle {t}");
    }
}

#[test]
fn without_a_fit_the_voxels_show_and_without_simplification_all_triangles_stay() {
    let mesh = cuboid(DVec3::ZERO, DVec3::ONE, turn(1));
    let raw = repaired(&mesh, &Options { fit: None, ..at(32) });
    assert!(raw.report.fit.is_none() && farthest_corner(&mesh, &raw.solid) > 1e-3);
    let all = FitOptions { rebuild: true, simplify: 0.0, ..FitOptions::default() };
    let kept = repaired(&mesh, &Options { fit: Some(all), ..at(32) });
    assert!(kept.solid.triangles.len() > 2000 && farthest_corner(&mesh, &kept.solid) < 1e-5);
}

#[test]
fn a_repaired_mesh_repaired_again_stays() {
    let bar = cuboid(DVec3::new(0.0, 0.3, 0.3), DVec3::new(2.0, 0.6, 0.7), turn(9));
    let block = cuboid(DVec3::ZERO, DVec3::ONE, turn(2));
    let difference = Expression::Difference(Box::new(Expression::Operand(0)), Box::new(Expression::Operand(1)));
    let once = made(&[block, bar], &difference, &at(64)).solid;
    let differ = |again: &Outcome| {
        let options = meshwright::compare::CompareOptions { samples: 20_000, ..Default::default() };
        let found =
            meshwright::compare::compare(&once, &again.solid, &options, &Progress::none()).expect("not stopped");
        let found = found.symmetric.expect("both have triangles");
        (found.max / again.lattice.h, found.mean / again.lattice.h)
    };
    let (largest, _) = differ(&repaired(&once, &Options::new(VoxelSize::Along(64))));
    assert!(largest < 1e-3, "{largest} h");
    // Built anew all over, one place in a hundred of the intersection curve is given up and stays rounded: 0.13 h.
    let (largest, mean) = differ(&repaired(&once, &at(64)));
    assert!(largest < 0.15, "{largest} h");
    assert!(mean < 1e-4, "{mean} h on average");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Boxes in any position, united and cut: valid whatever comes out, at the bodies' true volume.
    #[test]
    fn what_is_fitted_is_valid(seed in 0u64..1 << 40, shift in prop::array::uniform3(-0.9f64..0.9), cut in any::<bool>()) {
        let a = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5), turn(seed));
        let mut b = cuboid(DVec3::new(-0.6, -0.2, -0.3), DVec3::new(0.6, 0.2, 0.3), turn(seed + 1));
        b.positions.iter_mut().for_each(|p| *p += DVec3::from_array(shift));
        let [a_only, b_only] = [0, 1].map(Expression::Operand);
        let expression = if cut {
            Expression::Difference(Box::new(a_only), Box::new(b_only))
        } else {
            Expression::Union(vec![a_only, b_only])
        };
        let outcome = made(&[a, b], &expression, &at(40));
        prop_assert!(!outcome.solid.triangles.is_empty());
    }
}
