//! Shells that are right stay as they are, whatever the voxel, and what a lattice does to the others is told.

use crate::common::shapes::{cuboid, torus_of};
use glam::{DMat3, DVec3};
use meshwright::fit::FitOptions;
use meshwright::ldi::Expression;
use meshwright::mesh::{TriMesh, ValidateOptions, Validity, validate};
use meshwright::pipeline::{Options, Outcome, Precision, TriangleSource, VoxelSize, boolean, repair};
use meshwright::progress::Progress;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn at(resolution: u32) -> Options {
    Options::new(VoxelSize::Along(resolution))
}

fn judged(mesh: &TriMesh) -> Validity {
    validate(mesh, &ValidateOptions { self_intersections: true, weld: true }, &Progress::none()).expect("not stopped")
}

fn repaired(mesh: &TriMesh, options: &Options) -> Outcome {
    let outcome = repair(mesh, options, &Progress::none()).expect("a solid");
    let validity = judged(&outcome.solid);
    assert!(validity.is_valid(), "{:?}", validity.problems());
    outcome
}

fn inside_out(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

fn moved(mesh: TriMesh, by: DVec3) -> TriMesh {
    TriMesh { positions: mesh.positions.iter().map(|&p| p + by).collect(), ..mesh }
}

fn joined(meshes: impl IntoIterator<Item = TriMesh>) -> TriMesh {
    let mut all = TriMesh::default();
    meshes.into_iter().for_each(|mesh| all.append(&mesh));
    all
}

/// A ball of triangles that all differ.
fn ball(centre: DVec3, radius: f64, rings: u32) -> TriMesh {
    let around = 2 * rings;
    let mut mesh = TriMesh { positions: vec![centre - DVec3::Z * radius], ..TriMesh::default() };
    for ring in 1..rings {
        let tilt = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for k in 0..around {
            let turn = std::f64::consts::TAU * f64::from(k) / f64::from(around);
            let way = DVec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), -tilt.cos());
            mesh.positions.push(centre + radius * way);
        }
    }
    let top = mesh.positions.len() as u32;
    mesh.positions.push(centre + DVec3::Z * radius);
    let at = |ring: u32, k: u32| match ring {
        0 => 0,
        ring if ring == rings => top,
        ring => 1 + (ring - 1) * around + k % around,
    };
    for ring in 0..rings {
        for k in 0..around {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            mesh.triangles
                .extend([[a, b, c], [a, c, d]].iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        }
    }
    mesh
}

/// The union of unit cubes of a grid, exactly, or nothing where it is no manifold.
fn cubes(filled: &[bool], n: usize) -> TriMesh {
    let is = |p: [i32; 3]| {
        p.iter().all(|&x| (0..n as i32).contains(&x)) && filled[(p[0] as usize * n + p[1] as usize) * n + p[2] as usize]
    };
    let mut quads: Vec<[DVec3; 4]> = Vec::new();
    for cell in 0..n * n * n {
        let p = [cell / (n * n), cell / n % n, cell % n].map(|x| x as i32);
        for axis in (0..3).filter(|_| is(p)) {
            for side in 0..2 {
                let mut beside = p;
                beside[axis] += 2 * side - 1;
                if is(beside) {
                    continue;
                }
                let (u, v) = (DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
                let base = DVec3::from_array(p.map(f64::from)) + DVec3::AXES[axis] * f64::from(side);
                let quad = [base, base + u, base + u + v, base + v];
                quads.push(if side == 1 { quad } else { [quad[0], quad[3], quad[2], quad[1]] });
            }
        }
    }
    let positions = quads.iter().flatten().copied().collect();
    let triangles =
        (0..quads.len() as u32).flat_map(|q| [[4 * q, 4 * q + 1, 4 * q + 2], [4 * q, 4 * q + 2, 4 * q + 3]]);
    TriMesh { positions, triangles: triangles.collect() }.welded()
}

/// Rings in a chain, each through the next, `gap` apart at the nearest.
fn chain(links: usize, gap: f64) -> TriMesh {
    let (radius, tube) = (1.0, 0.2);
    let step = 2.0 * radius - 2.0 * tube - gap;
    let link = |n: usize| {
        let ring = torus_of(24, 10, radius, tube);
        let turn =
            if n.is_multiple_of(2) { DMat3::IDENTITY } else { DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2) };
        let positions = ring.positions.iter().map(|&p| turn * p + DVec3::X * (step * n as f64)).collect();
        TriMesh { positions, ..ring }
    };
    joined((0..links).map(link))
}

/// A ball with a void that leaves a wall of this thickness.
fn hollow(wall: f64) -> TriMesh {
    joined([ball(DVec3::ZERO, 1.0, 12), inside_out(ball(DVec3::ZERO, 1.0 - wall, 12))])
}

fn check_unchanged(mesh: &TriMesh, resolution: u32) -> Result<(), TestCaseError> {
    prop_assume!(judged(mesh).is_valid());
    let outcome = repair(mesh, &at(resolution), &Progress::none()).expect("a solid");
    prop_assert_eq!(&outcome.solid, mesh);
    prop_assert!(!outcome.report.lattice && outcome.report.kept_all());
    let own = |t: usize| TriangleSource::Operand { operand: 0, triangle: t as u32 };
    prop_assert!(outcome.sources.iter().enumerate().all(|(t, source)| *source == own(t)));
    let topology = outcome.report.topology.expect("a repair has one");
    prop_assert_eq!(topology.before, Some(topology.after));
    prop_assert!(!topology.is_large());
    // Inside out it comes back the right way round, with the same corners in the same order but for the turn.
    let turned = repair(&inside_out(mesh.clone()), &at(resolution), &Progress::none()).expect("a solid");
    prop_assert_eq!(&turned.solid, mesh);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, rng_seed: RngSeed::Fixed(13), ..ProptestConfig::default() })]

    #[test]
    fn unions_of_cubes_come_back_as_they_are(
        heights in prop::collection::vec(1usize..5, 16), size in 0.01f64..100.0, resolution in 16u32..257
    ) {
        // Columns over a plate, with a void in the first that is high enough.
        let n = 4;
        let mut filled: Vec<bool> = (0..n * n * n).map(|cell| cell % n < heights[cell / n]).collect();
        if let Some(column) = (0..16).find(|&c| heights[c] == 4 && c % 4 > 0 && c % 4 < 3 && c / 4 > 0 && c / 4 < 3) {
            filled[column * n + 1] = (0..16).any(|c| heights[c] < 2);
        }
        let mut mesh = cubes(&filled, n);
        mesh.positions.iter_mut().for_each(|p| *p *= size);
        check_unchanged(&mesh, resolution)?;
    }

    #[test]
    fn chains_with_gaps_under_a_voxel_come_back_as_they_are(
        links in 2usize..6, voxels in 0.01f64..2.0, resolution in 16u32..257
    ) {
        let length = 2.4 + 1.6 * (links as f64 - 1.0);
        check_unchanged(&chain(links, voxels * length / f64::from(resolution)), resolution)?;
    }

    #[test]
    fn shells_thinner_than_a_voxel_come_back_as_they_are(voxels in 0.05f64..2.0, resolution in 16u32..257) {
        check_unchanged(&hollow(voxels * 2.0 / f64::from(resolution)), resolution)?;
    }

    #[test]
    fn what_is_apart_is_united_intersected_and_taken_away_exactly(
        at_a in prop::array::uniform3(-6i32..6), at_b in prop::array::uniform3(-6i32..6),
        size_b in prop::array::uniform3(1i32..9), which in 0usize..3, resolution in 16u32..257
    ) {
        let point = |p: [i32; 3]| DVec3::from_array(p.map(f64::from));
        let (low_a, low_b) = (point(at_a), point(at_b) + 0.5);
        let (a, b) = (cuboid(low_a, low_a + 3.0), cuboid(low_b, low_b + point(size_b)));
        let within = |p: DVec3, low: DVec3, high: DVec3| p.cmpgt(low).all() && p.cmplt(high).all();
        let (high_a, high_b) = (low_a + 3.0, low_b + point(size_b));
        let apart = high_a.cmplt(low_b).any() || high_b.cmplt(low_a).any();
        let a_in_b = within(low_a, low_b, high_b) && within(high_a, low_b, high_b);
        let b_in_a = within(low_b, low_a, high_a) && within(high_b, low_a, high_a);
        prop_assume!(apart || a_in_b || b_in_a);
        let (va, vb) = (27.0, point(size_b).element_product());
        let (expression, volume) = match which {
            0 => (Expression::union(2), if apart { va + vb } else { f64::max(va, vb) }),
            1 => (Expression::intersection(2), if apart { 0.0 } else { f64::min(va, vb) }),
            _ => (Expression::difference(2), if apart { va } else if b_in_a { va - vb } else { 0.0 }),
        };
        match boolean(&[a, b], &expression, &at(resolution), &Progress::none()) {
            Ok(outcome) => {
                prop_assert!(judged(&outcome.solid).is_valid());
                prop_assert!(!outcome.report.lattice);
                let found = judged(&outcome.solid).volume;
                prop_assert!((found - volume).abs() < 1e-12 * volume, "{} and {}", found, volume);
            }
            Err(error) => prop_assert_eq!(volume, 0.0, "{}", error),
        }
    }
}

#[test]
fn a_broken_link_changes_nothing_of_the_others_and_keeps_its_own_triangles() {
    // The gaps are a quarter of a voxel.
    let whole = chain(4, 0.02);
    let each = whole.triangles.len() / 4;
    for missing in [0, 7 + each, 100 + 3 * each] {
        let mut broken = whole.clone();
        broken.triangles.remove(missing);
        let outcome = repaired(&broken, &at(96));
        assert_eq!(judged(&outcome.solid).bodies, 4);
        assert_eq!(outcome.report.standing.shells, 3);
        let given: std::collections::HashSet<_> =
            (0..whole.triangles.len()).map(|t| whole.corners(t).map(|p| p.to_array().map(f64::to_bits))).collect();
        let same = (0..outcome.solid.triangles.len())
            .filter(|&t| given.contains(&outcome.solid.corners(t).map(|p| p.to_array().map(f64::to_bits))))
            .count();
        assert_eq!(same, broken.triangles.len());
        let topology = outcome.report.topology.as_ref().expect("a repair has one");
        assert_eq!((topology.fused, topology.lost_count, topology.new_tunnels), (0, 0, Some(0)));
    }
}

#[test]
fn a_void_in_an_inside_out_body_and_a_body_in_a_void_take_turns() {
    let nested = [1.0, 0.8, 0.5].map(|radius| ball(DVec3::ZERO, radius, 8));
    let right = joined([nested[0].clone(), inside_out(nested[1].clone()), nested[2].clone()]);
    assert_eq!(repaired(&right, &at(16)).solid, right);
    assert_eq!(repaired(&inside_out(right.clone()), &at(16)).solid, right);
    // Bodies within bodies, all facing outwards, are one: the inner ones are left out.
    let all_out = joined(nested.clone());
    let outcome = repaired(&all_out, &at(16));
    let corners = |mesh: &TriMesh| (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect::<Vec<_>>();
    assert_eq!(corners(&outcome.solid), corners(&nested[0]));
    assert_eq!(outcome.report.standing.left_out, 2);
}

#[test]
fn shells_that_touch_in_a_corner_or_an_edge_do_not_stand() {
    let one = cuboid(DVec3::ZERO, DVec3::ONE);
    for by in [DVec3::ONE, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.5)] {
        let both = joined([one.clone(), moved(one.clone(), by)]);
        let outcome = repaired(&both, &at(32));
        assert_eq!(outcome.report.standing.shells, 0);
        assert!((judged(&outcome.solid).volume - 2.0).abs() < 0.02);
    }
}

#[test]
fn doubles_stay_doubles_and_singles_are_what_stl_holds() {
    let mesh = moved(ball(DVec3::ZERO, 1.0 / 3.0, 9), DVec3::splat(0.1));
    assert_eq!(repaired(&mesh, &at(16)).solid, mesh);
    let single = repaired(&mesh, &Options { precision: Precision::Single, ..at(16) });
    assert!(single.solid.positions.iter().zip(&mesh.positions).all(|(a, b)| *a == b.as_vec3().as_dvec3()));
    // What is kept beside a hole has its doubles, too.
    let mut open = mesh.clone();
    open.triangles.pop();
    let closed = repaired(&open, &at(48));
    let own: std::collections::HashSet<_> = mesh.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
    let kept = closed.solid.positions.iter().filter(|p| own.contains(&p.to_array().map(f64::to_bits))).count();
    assert!(kept >= mesh.positions.len() - 4, "{kept} of {}", mesh.positions.len());
}

#[test]
fn far_from_the_origin_all_is_as_near_it() {
    for far in [DVec3::splat(1e5), DVec3::new(5e5, 4e6, 120.0), DVec3::new(0.0, -4e6, 0.0)] {
        // Details of a thousandth: a box with a groove, one triangle of it missing.
        let cut = [
            cuboid(DVec3::ZERO, DVec3::new(0.25, 0.25, 0.125)),
            cuboid(DVec3::new(0.1, 0.1, 0.12), DVec3::new(0.101, 0.3, 0.2)),
        ];
        let made = |at_place: DVec3| {
            let operands = cut.clone().map(|mesh| moved(mesh, at_place));
            let cut = boolean(&operands, &Expression::difference(2), &at(128), &Progress::none()).expect("a solid");
            let mut open = operands[0].clone();
            open.triangles.pop();
            (cut, repair(&open, &at(128), &Progress::none()).expect("a solid"))
        };
        let (near, at_far) = (made(DVec3::ZERO), made(far));
        for (near, far_one) in [(near.0, at_far.0), (near.1, at_far.1)] {
            let (a, b) = (judged(&near.solid), judged(&far_one.solid));
            assert!(b.is_valid(), "{:?}", b.problems());
            assert!((a.volume - b.volume).abs() < 1e-6, "{} and {}", a.volume, b.volume);
            assert_eq!(a.bodies, b.bodies);
        }
        let ball = moved(ball(DVec3::ZERO, 0.5, 8), far);
        assert_eq!(repaired(&ball, &at(64)).solid, ball);
    }
}

#[test]
fn what_a_lattice_fuses_or_loses_is_told_and_large() {
    let voxels = |mesh: &TriMesh, resolution: u32| {
        let fit = Some(FitOptions { rebuild: true, ..FitOptions::default() });
        repaired(mesh, &Options { fit, ..at(resolution) }).report.topology.expect("a repair has one")
    };
    let fused = voxels(&chain(4, 0.02), 48);
    assert!(fused.fused > 0 && fused.is_large(), "{fused:?}");
    let small = joined([ball(DVec3::ZERO, 1.0, 12), ball(DVec3::X * 1.5, 0.002, 6)]);
    let lost = voxels(&small, 16);
    assert_eq!((lost.lost_count, lost.before.map(|t| t.bodies), lost.after.bodies), (1, Some(2), 1));
    assert!((lost.lost[0].at[0] - 1.5).abs() < 0.01 && lost.is_large());
    let thin = voxels(&hollow(0.02), 32);
    assert!(thin.is_large() && thin.parted > 0, "{thin:?}");
    let fine = voxels(&hollow(0.5), 48);
    assert!(!fine.is_large() && fine.before == Some(fine.after), "{fine:?}");
}

#[test]
fn simplification_by_hand_means_what_stands_as_well() {
    let mut mesh = cubes(&[true; 27], 3);
    mesh.positions.iter_mut().for_each(|p| *p /= 3.0);
    let usual = repaired(&mesh, &at(32));
    assert_eq!(usual.solid, mesh);
    let fit = Some(FitOptions { simplify_kept: 0.002, ..FitOptions::default() });
    let simple = repaired(&mesh, &Options { fit, ..at(32) });
    assert_eq!((simple.solid.triangles.len(), judged(&simple.solid).volume), (12, 1.0));
    assert!(!simple.report.lattice);
}

#[test]
fn a_body_that_crosses_itself_beside_others_leaves_them_as_they_are() {
    // A box and a box through its corner cross; two balls stand a fifth of a voxel beside them.
    let h = 4.0 / 64.0;
    let crossing = [cuboid(DVec3::ZERO, DVec3::ONE), cuboid(DVec3::splat(0.6), DVec3::splat(1.5))];
    let balls = [ball(DVec3::new(-0.5 - 0.2 * h, 0.5, 0.5), 0.5, 10), ball(DVec3::new(3.0, 0.5, 0.5), 0.5, 10)];
    let mesh = joined(crossing.into_iter().chain(balls.clone()));
    let outcome = repaired(&mesh, &at(64));
    let validity = judged(&outcome.solid);
    let boxes = 1.0 + 0.9f64.powi(3) - 0.4f64.powi(3);
    let volume = boxes + balls.iter().map(|ball| judged(ball).volume).sum::<f64>();
    assert_eq!((validity.bodies, outcome.report.standing.shells), (3, 2));
    assert!((validity.volume - volume).abs() < 1e-3, "{} and {volume}", validity.volume);
    assert_eq!(outcome.report.topology.map(|t| (t.fused, t.lost_count)), Some((0, 0)));
}

#[test]
fn bodies_smaller_than_a_voxel_far_apart_come_back_the_right_way_round() {
    let small = |at: f64| ball(DVec3::X * at, 0.004, 6);
    let mesh = joined([small(0.0), small(10.0)]);
    for resolution in [16, 64, 256] {
        assert_eq!(repaired(&inside_out(mesh.clone()), &at(resolution)).solid, mesh);
    }
}

#[test]
fn many_bodies_are_as_quick_as_their_triangles() {
    // A grid of ten thousand boxes: nothing may grow with the square of their number.
    let place = |n: usize| DVec3::new((n % 100) as f64, (n / 100) as f64, (n % 7) as f64 * 0.1);
    let mesh = joined((0..10_000).map(|n| cuboid(place(n), place(n) + 0.5)));
    let start = std::time::Instant::now();
    assert_eq!(repaired(&mesh, &at(64)).solid, mesh);
    assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
}

#[test]
fn two_coincident_skins_are_one_and_told() {
    let skins = joined([ball(DVec3::ZERO, 1.0, 12), ball(DVec3::ZERO, 1.0 - 1e-6, 12)]);
    let outcome = repaired(&skins, &at(64));
    assert_eq!(outcome.solid.triangles.len(), skins.triangles.len() / 2);
    assert_eq!((outcome.report.standing.shells, outcome.report.standing.left_out), (1, 1));
}
