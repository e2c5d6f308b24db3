//! Simplification stays within its tolerance of the surface that was, keeps corners, and is never given up for all because
//! triangles meet somewhere; what the voxels made is valid without a fit, too; bodies that touch keep their volume.

use crate::common::shapes::cuboid;
use glam::DVec3;
use meshwright::fit::FitOptions;
use meshwright::ldi::Expression;
use meshwright::mesh::{Shape, TriMesh, ValidateOptions, Validity, validate};
use meshwright::pipeline::{BooleanError, Options, Outcome, VoxelSize, boolean};
use meshwright::progress::Progress;
use rayon::prelude::*;

fn judged(mesh: &TriMesh) -> Validity {
    let options = ValidateOptions { self_intersections: true, weld: true };
    validate(mesh, &options, &Progress::none()).expect("not stopped")
}

fn made(operands: &[TriMesh], expression: &Expression, options: &Options) -> (Outcome, Validity) {
    let outcome = boolean(operands, expression, options, &Progress::none()).expect("a solid");
    let validity = judged(&outcome.solid);
    assert!(validity.is_valid(), "{:?}", validity.problems());
    (outcome, validity)
}

/// All of the surface from the voxels, simplified within `tolerance`, h.
fn rebuilt(resolution: u32, tolerance: f64) -> Options {
    let fit = Some(FitOptions { rebuild: true, simplify: tolerance, ..FitOptions::default() });
    Options { fit, ..Options::new(VoxelSize::Along(resolution)) }
}

fn without(first: u32, others: u32) -> Expression {
    let others = (1..=others).map(|k| Expression::Operand(k as usize)).collect();
    Expression::Difference(Box::new(Expression::Operand(first as usize)), Box::new(Expression::Union(others)))
}

/// The largest distance from corners and middles of the triangles of `a` to `b`, by looking at all of its triangles. Of many
/// triangles of `a` each seventh counts.
fn farthest(a: &TriMesh, b: &TriMesh) -> f64 {
    let triangles: Vec<[DVec3; 3]> = (0..b.triangles.len()).map(|t| b.corners(t)).collect();
    let off = |p: DVec3| triangles.iter().map(|t| t.nearest(p).0.distance_squared(p)).fold(f64::INFINITY, f64::min);
    let step = if a.triangles.len() > 5000 { 7 } else { 1 };
    let points = (0..a.triangles.len() / step).into_par_iter().flat_map_iter(|t| {
        let [p, q, r] = a.corners(step * t);
        [p, q, r, (p + q + r) / 3.0, (p + q) / 2.0]
    });
    points.map(off).reduce(|| 0.0, f64::max).sqrt()
}

fn has(mesh: &TriMesh, corner: DVec3, within: f64) -> bool {
    mesh.positions.iter().any(|p| p.distance(corner) < within)
}

#[test]
fn a_corner_stays_where_planes_go_on_beyond_the_surface() {
    let mut hollow = cuboid(DVec3::ZERO, DVec3::splat(20.0));
    let mut inner = cuboid(DVec3::splat(2.0), DVec3::splat(18.0));
    inner.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    hollow.append(&inner);
    let drill = cuboid(DVec3::new(8.0, 8.0, -1.0), DVec3::new(12.0, 12.0, 2.0));
    for resolution in [64, 128] {
        let options = Options::new(VoxelSize::Along(resolution));
        let (outcome, validity) = made(&[hollow.clone(), drill.clone()], &without(0, 1), &options);
        assert!((validity.volume - 3872.0).abs() < 0.05, "{resolution}: {}", validity.volume);
        for (x, y, z) in [8.0, 12.0].into_iter().flat_map(|x| [8.0, 12.0].map(|y| (x, y, 2.0))) {
            // Where sheets touch they stay 0.02 h apart.
            let within = 0.05 * outcome.lattice.h;
            assert!(has(&outcome.solid, DVec3::new(x, y, z), within), "{resolution}: {x} {y} {z}");
        }
    }
}

/// A plate with square holes through it and pits in it, turned a little.
fn drilled(seed: u64) -> Vec<TriMesh> {
    let number = |k: u64| {
        let x = (seed * 64 + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((x ^ x >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1u64 << 53) as f64
    };
    let turn = glam::DMat3::from_euler(glam::EulerRot::ZYX, number(60), number(61), number(62));
    let turn = if seed.is_multiple_of(2) { glam::DMat3::IDENTITY } else { turn };
    let mut all = vec![cuboid(DVec3::ZERO, DVec3::new(24.0, 16.0, 4.0))];
    for k in 0..6 {
        let low = DVec3::new(
            2.0 + 7.5 * (k % 3) as f64 + number(4 * k),
            2.0 + 7.0 * (k / 3) as f64 + number(4 * k + 1),
            -1.0,
        );
        let size = DVec3::new(2.0 + 3.0 * number(4 * k + 2), 2.0 + 3.0 * number(4 * k + 3), 0.0);
        let top = if number(50 + k) < 0.5 { 5.0 } else { 2.0 };
        let hole = cuboid(low, low.with_z(top) + size);
        all.push(hole);
    }
    all.iter_mut().flat_map(|mesh| &mut mesh.positions).for_each(|p| *p = turn * *p);
    all
}

#[test]
fn a_larger_tolerance_gives_no_more_triangles() {
    for seed in 0..2 {
        let meshes = drilled(seed);
        let whole = made(&meshes, &without(0, 6), &rebuilt(60, 0.0)).0;
        let mut fewest = usize::MAX;
        for tolerance in [0.002, 0.02, 0.2] {
            let (simple, _) = made(&meshes, &without(0, 6), &rebuilt(60, tolerance));
            let h = simple.lattice.h;
            let off = farthest(&whole.solid, &simple.solid).max(farthest(&simple.solid, &whole.solid)) / h;
            // Places that are given up are a voxel rounder, in the one or in the other.
            assert!(off <= tolerance + 1.5, "seed {seed}: {off} h for {tolerance}");
            let triangles = simple.solid.triangles.len();
            assert!(
                triangles as f64 <= 1.02 * fewest as f64 + 4.0,
                "seed {seed}, {tolerance}: {triangles} after {fewest}"
            );
            fewest = fewest.min(triangles);
        }
    }
}

#[test]
fn a_round_surface_is_simplified_within_the_tolerance_both_ways() {
    let torus = crate::common::shapes::torus(96, 48);
    let whole = made(std::slice::from_ref(&torus), &Expression::Operand(0), &rebuilt(40, 0.0)).0;
    let mut last = whole.solid.triangles.len();
    for tolerance in [0.05, 0.3, 1.0] {
        let simple = made(std::slice::from_ref(&torus), &Expression::Operand(0), &rebuilt(40, tolerance)).0;
        let off = farthest(&whole.solid, &simple.solid).max(farthest(&simple.solid, &whole.solid)) / simple.lattice.h;
        assert!(off <= 1.05 * tolerance, "{off} h for {tolerance}");
        let triangles = simple.solid.triangles.len();
        assert!(triangles < last, "{triangles} after {last} for {tolerance}");
        last = triangles;
    }
}

#[test]
fn boxes_side_by_side_become_few_triangles_at_any_resolution() {
    for seed in 0..3u64 {
        let number = |k: u64, most: u64| ((seed * 1000 + k + 7).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33) % most;
        let mut soup = TriMesh::default();
        for k in 0..12 {
            let low = [number(6 * k, 12), number(6 * k + 1, 10), number(6 * k + 2, 6)].map(|x| x as f64);
            let size = [3, 4, 5].map(|n| 2.0 + number(6 * k + n, 4) as f64);
            soup.append(&cuboid(DVec3::from_array(low), DVec3::from_array(low) + DVec3::from_array(size)));
        }
        for resolution in [60, 96] {
            let (outcome, _) =
                made(std::slice::from_ref(&soup), &Expression::Operand(0), &Options::new(VoxelSize::Along(resolution)));
            let triangles = outcome.solid.triangles.len();
            assert!(triangles < 200 * 12, "seed {seed} at {resolution}: {triangles}");
        }
    }
}

/// A few random triangles on a coarse grid of places, so that many touch.
fn soup(seed: u64) -> TriMesh {
    let number = |k: u64, most: u64| {
        let x = (seed * 4096 + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((x ^ x >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 33) % most
    };
    if seed.is_multiple_of(3) {
        let at = |k: u64| DVec3::new(number(k, 5) as f64, number(k + 1, 5) as f64, number(k + 2, 5) as f64);
        let mut pair = cuboid(at(0), at(0) + at(3) + 1.0);
        pair.append(&cuboid(at(6), at(6) + at(9) + 1.0));
        return pair;
    }
    let count = 5 + number(0, 12);
    let positions = (0..3 * count).map(|k| DVec3::from_array([1, 2, 3].map(|n| number(3 * k + n, 4) as f64 * 2.0)));
    let positions: Vec<DVec3> = positions.collect();
    let triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriMesh { positions, triangles }
}

#[test]
fn small_soups_are_valid_in_welded_positions_with_and_without_a_fit() {
    let solids: usize = (0..200u64)
        .into_par_iter()
        .map(|seed| {
            let mesh = soup(seed);
            let resolution = 5 + (seed % 12) as u32 + if seed.is_multiple_of(40) { 16 } else { 0 };
            let plain = Options::new(VoxelSize::Along(resolution));
            let bare = Options { fit: None, ..plain };
            let both = [plain, bare].map(|options| {
                match boolean(std::slice::from_ref(&mesh), &Expression::Operand(0), &options, &Progress::none()) {
                    Ok(outcome) => {
                        let validity = judged(&outcome.solid);
                        assert!(
                            validity.is_valid(),
                            "seed {seed} at {resolution}, fit {}: {:?}",
                            options.fit.is_some(),
                            validity.problems()
                        );
                        1
                    }
                    Err(BooleanError::Nothing(_) | BooleanError::Empty { .. }) => 0,
                    Err(other) => panic!("seed {seed}: {other}"),
                }
            });
            both[0] + both[1]
        })
        .sum();
    assert!(solids > 200, "{solids}");
}

/// Octahedra of radius 1 around some points.
fn octahedra(centres: &[[i32; 3]]) -> TriMesh {
    let mut all = TriMesh::default();
    for centre in centres {
        let centre = DVec3::from_array(centre.map(f64::from));
        let tip = |k: usize| centre + DVec3::AXES[k / 2] * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut triangles = Vec::new();
        for n in 0..8u32 {
            let [a, b, c] = [n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2)];
            triangles.push(if n.count_ones().is_multiple_of(2) { [a, b, c] } else { [a, c, b] });
        }
        all.append(&TriMesh { positions: (0..6).map(tip).collect(), triangles });
    }
    all
}

#[test]
fn octahedra_that_touch_in_corners_come_back_exactly() {
    let mesh = octahedra(&[[0, 0, 0], [2, 0, 0], [4, 0, 0], [6, 0, 0]]);
    for resolution in [48, 64, 96] {
        let (outcome, validity) =
            made(std::slice::from_ref(&mesh), &Expression::Operand(0), &rebuilt(resolution, 0.002));
        assert!((validity.volume - 16.0 / 3.0).abs() < 1e-3, "{resolution}: {}", validity.volume);
        assert_eq!(validity.bodies, 4, "{resolution}");
        assert!(
            mesh.positions.iter().all(|&p| outcome
                .solid
                .positions
                .iter()
                .any(|q| q.distance(p) < 0.05 * outcome.lattice.h))
        );
    }
}

#[test]
fn octahedra_that_touch_along_edges_keep_their_volume() {
    let square: Vec<[i32; 3]> = (0..9).map(|n| [n % 3 + n / 3, n % 3 - n / 3, 0]).collect();
    let dense: Vec<[i32; 3]> =
        (0..27).map(|n| [n % 3, n / 3 % 3, n / 9]).filter(|c| c.iter().sum::<i32>() % 2 == 0).collect();
    for centres in [square, dense] {
        let mesh = octahedra(&centres);
        for resolution in [48, 64, 96] {
            let (_, validity) =
                made(std::slice::from_ref(&mesh), &Expression::Operand(0), &Options::new(VoxelSize::Along(resolution)));
            let share = validity.volume / (centres.len() as f64 * 4.0 / 3.0) - 1.0;
            // Where voxels on both sides of an edge touch, there is a little more than it should be.
            assert!((-2e-3..8e-3).contains(&share), "{} at {resolution}: {share}", centres.len());
        }
    }
}
