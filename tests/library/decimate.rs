//! Decimation: valid in, valid out; the bounds hold; features stay.

use crate::common::proofs::{
    compared, decimated, number, state, stays_valid_when_decimated, stays_within_the_deviation,
};
use crate::common::{read, sample, shapes};
use glam::DVec3;
use meshwright::decimate::{DecimateError, DecimateOptions, decimate};
use meshwright::mesh::{Solid, SolidError, TriMesh};
use meshwright::progress::Progress;

/// A box whose sides are grids of squares of two triangles.
fn gridded(n: usize, side: impl Fn(DVec3) -> DVec3) -> TriMesh {
    let mut mesh = TriMesh::default();
    for axis in 0..3 {
        for up in [0.0, 1.0] {
            let first = mesh.positions.len() as u32;
            for k in 0..(n + 1) * (n + 1) {
                let (u, v) = ((k % (n + 1)) as f64 / n as f64, (k / (n + 1)) as f64 / n as f64);
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (up, u, v);
                mesh.positions.push(side(DVec3::from_array(p)));
            }
            for k in 0..n * n {
                let at = |du: usize, dv: usize| first + ((k / n + dv) * (n + 1) + k % n + du) as u32;
                let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                mesh.triangles.extend(if up == 1.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    mesh.welded()
}

fn cube(n: usize) -> TriMesh {
    gridded(n, |p| p)
}

/// A ball of radius 1: a cube blown up.
fn ball(n: usize) -> TriMesh {
    let tangent = |p: DVec3| DVec3::from_array((p - 0.5).to_array().map(|x| (x * std::f64::consts::FRAC_PI_2).tan()));
    gridded(n, |p| tangent(p).normalize())
}

#[test]
fn a_gridded_cube_becomes_twelve_triangles_and_keeps_its_corners_to_the_last_bit() {
    for turn in [glam::DQuat::IDENTITY, glam::DQuat::from_rotation_x(0.3) * glam::DQuat::from_rotation_z(1.1)] {
        let mut mesh = cube(12);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
        for options in [number(12), DecimateOptions { max_deviation: Some(1e-6), ..DecimateOptions::default() }] {
            let made = decimated(&mesh, &options);
            assert_eq!(made.solid.triangles.len(), 12, "{options:?}");
            assert!(made.solid.positions.iter().all(|p| mesh.positions.contains(p)), "corners moved: {:?}", made.solid);
            assert!((state(&made.solid, false).volume - 1.0).abs() < 1e-9);
        }
    }
}

/// Solids of every kind: smooth, with sharp edges, of several bodies, with voids and tunnels.
fn solids() -> Vec<(&'static str, TriMesh)> {
    let wavy = |p: DVec3| DVec3::new(p.x, p.y, p.z * (1.0 + 0.1 * (5.0 * p.x).sin() * (4.0 * p.y).cos()));
    let mut solids = vec![
        ("ball", ball(24)),
        ("wavy block", gridded(24, wavy)),
        ("torus", shapes::torus(64, 32)),
        ("knot", shapes::knot(160, 20)),
    ];
    let files = ["torus.ply", "monkey_saddle.off", "hollow_ball.stl", "noisy_cube.off"];
    solids.extend(files.map(|name| (name, read(&sample(name)))));
    solids
}

#[test]
fn valid_solids_stay_valid_with_their_bodies_and_tunnels_down_to_the_last_triangle() {
    for (name, mesh) in solids() {
        stays_valid_when_decimated(name, &mesh);
    }
    stays_valid_when_decimated("stack", &shapes::stack(0.2));
}

#[test]
fn the_surface_stays_within_the_deviation_both_ways() {
    for (name, mesh) in solids() {
        stays_within_the_deviation(name, &mesh);
    }
}

#[test]
fn sharp_edges_stay_where_they_are() {
    // A cube with a wavy top: 12 sharp edges, 4 of them curved.
    let mesh = gridded(24, |p| DVec3::new(p.x, p.y, p.z * (1.0 + 0.1 * (5.0 * p.x).sin() * (4.0 * p.y).cos())));
    let made = decimated(&mesh, &number(mesh.triangles.len() / 10));
    let found = compared(&mesh, &made.solid);
    assert!(found.sharp.recall > Some(0.99) && found.sharp.precision > Some(0.99), "{:?}", found.sharp);
    assert!(found.symmetric.expect("areas").max < 0.01);
}

#[test]
fn classes_keep_their_borders() {
    let mesh = cube(16);
    // The upper half of everything has another number.
    let upper = |t: usize| u32::from(mesh.corners(t).iter().map(|p| p.z).sum::<f64>() > 1.5);
    let classes: Vec<u32> = (0..mesh.triangles.len()).map(upper).collect();
    let solid = Solid::try_from(mesh.clone()).expect("a solid");
    let made = decimate(&solid, &classes, &number(60), &Progress::none()).expect("a solid");
    for (t, &origin) in made.origins.iter().enumerate() {
        let heights = made.solid.corners(t).map(|p| p.z);
        let fits = |z: &f64| if classes[origin as usize] == 1 { *z >= 0.5 - 1e-9 } else { *z <= 0.5 + 1e-9 };
        assert!(heights.iter().all(fits), "a triangle of class {} reaches over: {heights:?}", classes[origin as usize]);
    }
    assert!(made.report.reached);
}

#[test]
fn a_ball_keeps_its_volume_and_stays_round() {
    let mesh = ball(40);
    let made = decimated(&mesh, &number(960));
    let (before, after) = (state(&mesh, false).volume, state(&made.solid, false).volume);
    assert!((after / before - 1.0).abs() < 2e-3, "{before} became {after}");
    // 960 triangles inscribed in a ball would be off by 0.4 % in the mean; the best place halves that.
    let mean = compared(&mesh, &made.solid).symmetric.expect("areas").mean;
    assert!(mean < 2.5e-3, "{mean}");
}

#[test]
fn thin_walls_do_not_pass_through_each_other() {
    // A ball with a void that almost fills it: the coarse outer surface would pass through the inner one.
    let outer = ball(24);
    let mut mesh = outer.clone();
    let inner = TriMesh {
        positions: outer.positions.iter().map(|p| *p * 0.99).collect(),
        triangles: outer.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    };
    mesh.append(&inner);
    let before = state(&mesh, false);
    let made = decimated(&mesh, &number(400));
    let after = state(&made.solid, false);
    assert!(after.is_valid(), "{:?}", after.problems());
    assert_eq!((after.bodies, after.genus), (before.bodies, before.genus));
    assert!(made.solid.triangles.len() < mesh.triangles.len() / 2, "{}", made.solid.triangles.len());
    assert!(made.report.repeats > 0, "nothing had met, so nothing was tested");
}

#[test]
fn far_from_the_origin_and_in_any_size_the_same_is_done() {
    let mesh = ball(16);
    let plain = decimated(&mesh, &number(400));
    for scale in [2f64.powi(-60), 2f64.powi(90)] {
        let sized = TriMesh { positions: mesh.positions.iter().map(|p| *p * scale).collect(), ..mesh.clone() };
        let made = decimated(&sized, &number(400));
        assert_eq!(made.solid.triangles, plain.solid.triangles, "at scale {scale}");
    }
    let far = DVec3::new(4e6, -3e6, 1e6);
    let moved = TriMesh { positions: mesh.positions.iter().map(|p| *p + far).collect(), ..mesh.clone() };
    let made = decimated(&moved, &number(400));
    assert!(state(&made.solid, false).is_valid());
    assert!((state(&made.solid, false).volume / state(&mesh, false).volume - 1.0).abs() < 1e-2);
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let mesh = shapes::torus(80, 40);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| decimated(&mesh, &number(700)).solid)
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn what_is_no_valid_solid_is_refused() {
    let mut open = cube(4);
    open.triangles.pop();
    let mut twice = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    twice.append(&shapes::cuboid(DVec3::splat(0.5), DVec3::splat(1.5)));
    let mut inside_out = cube(4);
    inside_out.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    for mesh in [open, twice, inside_out] {
        let refused = Solid::try_from(mesh).expect_err("it is none");
        assert!(matches!(&refused, SolidError::NotSolid(what) if !what.validity.problems().is_empty()), "{refused}");
    }
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = DecimateOptions { max_deviation: Some(length), ..DecimateOptions::default() };
        let solid = Solid::try_from(cube(2)).expect("a cube");
        assert!(matches!(decimate(&solid, &[], &options, &Progress::none()), Err(DecimateError::Deviation(_))));
    }
    let enough = decimated(&cube(2), &number(48));
    assert!(enough.solid == cube(2) && enough.report.reached);
}
