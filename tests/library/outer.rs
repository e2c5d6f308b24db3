//! The surface as a ball sees it from outside: what it sees stays bit for bit, what it does not come to goes, and what it does not pass is closed.

use std::collections::HashSet;

use glam::DVec3;
use meshwright::mesh::TriMesh;
use meshwright::outer::ReachError;
use meshwright::pipeline::{BooleanError, Options, Outcome, OuterError, OuterOptions, VoxelSize, outer, plan_outer};
use meshwright::progress::Progress;

use crate::common::proofs::state;
use crate::common::shapes::{ball, cuboid, gear, torus, torus_of, turned};

fn options(ball: f64) -> OuterOptions {
    OuterOptions { ball, thickness: None, solid: Options::new(VoxelSize::Along(64)) }
}

fn seen(mesh: &TriMesh, ball: f64) -> Outcome {
    let outcome = outer(mesh, &options(ball), &Progress::none()).unwrap_or_else(|e| panic!("{e}"));
    let found = state(&outcome.solid, true);
    assert!(found.is_valid(), "{:?}", found.problems());
    outcome
}

fn refused(mesh: &TriMesh, ball: f64) -> OuterError {
    outer(mesh, &options(ball), &Progress::none()).expect_err("no solid")
}

/// The corners of triangles, bit for bit, in any order.
fn corners(mesh: &TriMesh) -> HashSet<[[u64; 3]; 3]> {
    let of = |t: usize| {
        let mut corners = mesh.corners(t).map(|p| p.to_array().map(|c| (c + 0.0).to_bits()));
        corners.sort_unstable();
        corners
    };
    (0..mesh.triangles.len()).map(of).collect()
}

fn volume(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Every triangle cut in four, in its plane.
fn finer(mesh: &TriMesh, times: u32) -> TriMesh {
    let mut mesh = mesh.clone();
    for _ in 0..times {
        let cut = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            let [d, e, f] = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
            [a, d, f, d, b, e, f, e, c, d, e, f]
        };
        let positions: Vec<DVec3> = (0..mesh.triangles.len()).flat_map(cut).collect();
        let triangles = (0..positions.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        mesh = TriMesh { positions, triangles }.welded();
    }
    mesh
}

/// The mesh with every vertex moved to the inside.
fn shrunk(mesh: &TriMesh, by: f64) -> TriMesh {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a);
        corners.iter().for_each(|&v| normals[v as usize] += normal);
    }
    let positions = mesh.positions.iter().zip(&normals).map(|(p, n)| *p - n.normalize() * by).collect();
    TriMesh { positions, triangles: mesh.triangles.clone() }
}

fn normal(mesh: &TriMesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(c - a).normalize()
}

/// How a body is made double.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Skin {
    /// The inner skin faces as the outer one.
    Alike,
    /// It faces the other way.
    Flipped,
    /// It does, and through the pinholes the two are one surface.
    Joined,
}

struct Double {
    mesh: TriMesh,
    /// The triangles of the outer skin that are there.
    outer: TriMesh,
    pinholes: usize,
    /// The width of the widest.
    widest: f64,
    /// What lids over the pinholes may add to or take from the volume.
    room: f64,
}

/// A body with a second skin inside, and pinholes through both: all triangles around some vertices, or single triangles.
fn double(whole: &TriMesh, gap: f64, pinholes: usize, skin: Skin) -> Double {
    let inner = shrunk(whole, gap);
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); whole.positions.len()];
    for (t, corners) in whole.triangles.iter().enumerate() {
        corners.iter().for_each(|&v| around[v as usize].push(t));
    }
    let (mut taken, mut missing) = (vec![false; whole.positions.len()], vec![false; whole.triangles.len()]);
    let (mut made, mut widest, mut room) = (0, 0.0f64, 0.0);
    // A walk over all vertices, so that the pinholes are spread.
    for k in 0..whole.positions.len() {
        let v = k * 379 % whole.positions.len();
        let list = if made % 3 == 2 { &around[v][..1] } else { &around[v][..] };
        let mut vertices: Vec<u32> = list.iter().flat_map(|&t| whole.triangles[t]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        // At an edge of a box the ball sees the walls that join both skins.
        let bends = |&v: &u32| around[v as usize].iter().any(|&t| normal(whole, t).dot(normal(whole, list[0])) < 0.5);
        if made == pinholes
            || vertices.iter().any(|&v| taken[v as usize])
            || skin == Skin::Joined && vertices.iter().any(bends)
        {
            continue;
        }
        // No two share a vertex.
        vertices.iter().for_each(|&v| taken[v as usize] = true);
        list.iter().for_each(|&t| missing[t] = true);
        let at = |v: u32| whole.positions[v as usize];
        let width =
            vertices.iter().flat_map(|&a| vertices.iter().map(move |&b| at(a).distance(at(b)))).fold(0.0, f64::max);
        widest = widest.max(width);
        room += width.powi(3);
        made += 1;
    }
    assert_eq!(made, pinholes);
    let left = |mesh: &TriMesh| TriMesh {
        positions: mesh.positions.clone(),
        triangles: (0..mesh.triangles.len()).filter(|&t| !missing[t]).map(|t| mesh.triangles[t]).collect(),
    };
    let outer = left(whole);
    let mut second = left(&inner);
    if skin != Skin::Alike {
        second.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let mut mesh = outer.clone();
    mesh.append(&second);
    if skin == Skin::Joined {
        let count = whole.positions.len() as u32;
        let sides: HashSet<[u32; 2]> =
            outer.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]).collect();
        let mut rims: Vec<[u32; 2]> = sides.iter().copied().filter(|&[a, b]| !sides.contains(&[b, a])).collect();
        rims.sort_unstable();
        for [a, b] in rims {
            mesh.triangles.extend([[b, a, a + count], [b, a + count, b + count]]);
        }
    }
    Double { mesh: mesh.welded(), outer: outer.welded(), pinholes, widest, room }
}

/// Twenty bodies of about 2 across, each with a gap for its second skin.
fn bodies() -> Vec<(String, TriMesh, f64)> {
    let mut all: Vec<(String, TriMesh, f64)> = Vec::new();
    let bumps = |k: f64| move |p: DVec3| 1.0 + 0.08 * (k * p.x).sin() * (k * p.y + 1.0).cos() + 0.1 * p.z;
    for k in 0..6 {
        all.push((format!("ball {k}"), ball(4, bumps(f64::from(k))), 0.05));
    }
    for (k, size) in
        [[2.0, 2.0, 2.0], [2.0, 1.4, 1.0], [1.0, 1.0, 2.0], [2.0, 2.0, 0.8], [1.5, 1.2, 1.1]].iter().enumerate()
    {
        let whole = finer(&cuboid(DVec3::ZERO, DVec3::from_array(*size)), 4);
        all.push((format!("box {k}"), turned(whole, 0.3 * k as f64), 0.05));
    }
    for (k, tube) in [0.3, 0.35, 0.4, 0.45, 0.5].into_iter().enumerate() {
        all.push((format!("torus {k}"), turned(torus_of(96, 40, 1.0, tube), 0.4 * k as f64), 0.05));
    }
    for (k, stretch) in [0.6, 1.5, 2.0, 2.5].into_iter().enumerate() {
        let mut whole = ball(4, |_| 0.8);
        whole.positions.iter_mut().for_each(|p| p.z *= stretch);
        all.push((format!("egg {k}"), whole, 0.05));
    }
    assert_eq!(all.len(), 20);
    all
}

fn check_double(name: &str, whole: &TriMesh, double: &Double) {
    let ball = 1.3 * double.widest;
    let outcome = seen(&double.mesh, ball);
    let (clean, found) = (state(whole, true), outcome.solid.validity());
    assert_eq!((found.bodies, found.genus), (clean.bodies, clean.genus), "{name}");
    let (skin, result) = (corners(&double.outer), corners(&outcome.solid));
    let gone = skin.difference(&result).count();
    assert_eq!(gone, 0, "{name}: {gone} of {} outer triangles are not there", skin.len());
    // All others are lids: nothing of the inner skin is there.
    let own = outcome.sources.iter().filter(|source| !source.is_made_up()).count();
    assert_eq!(own, skin.len(), "{name}");
    assert_eq!(outcome.report.holes.len(), double.pinholes, "{name}");
    let off = (found.volume - clean.volume).abs();
    assert!(off <= double.room, "{name}: {off} of {}", double.room);
    let report = outcome.report.outer.as_ref().expect("a report");
    assert_eq!((report.outer_triangles, report.sheet_triangles), (skin.len(), 0), "{name}");
    assert_eq!(report.outer_triangles + report.inner_triangles, double.mesh.triangles.len(), "{name}");
    assert_eq!(report.cut, 0, "{name}");
}

#[test]
fn twenty_double_bodies_with_a_pinhole_lose_their_inner_skins() {
    for (k, (name, whole, gap)) in bodies().into_iter().enumerate() {
        let skin = [Skin::Alike, Skin::Flipped, Skin::Joined][k % 3];
        check_double(&format!("{name}, {skin:?}"), &whole, &double(&whole, gap, 1, skin));
    }
}

#[test]
fn twenty_double_bodies_with_ten_pinholes_do() {
    for (k, (name, whole, gap)) in bodies().into_iter().enumerate() {
        let skin = [Skin::Joined, Skin::Alike, Skin::Flipped][k % 3];
        check_double(&format!("{name}, {skin:?}"), &whole, &double(&whole, gap, 10, skin));
    }
}

#[test]
fn twenty_double_bodies_with_a_hundred_pinholes_do() {
    for (k, (name, whole, gap)) in bodies().into_iter().enumerate() {
        let skin = [Skin::Flipped, Skin::Joined, Skin::Alike][k % 3];
        check_double(&format!("{name}, {skin:?}"), &whole, &double(&whole, gap, 100, skin));
    }
}

#[test]
fn what_is_right_stays_as_it_is() {
    let groove = {
        // A slot that the ball does not enter, into a block of which the ball sees all else.
        let profile = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.6, 2.0], [1.6, 0.8], [1.4, 0.8], [1.4, 2.0], [0.0, 2.0]];
        let at = |z: f64| profile.iter().map(move |[x, y]| DVec3::new(*x, *y, z));
        let side = |k: u32| [[k, (k + 1) % 8, (k + 1) % 8 + 8], [k, (k + 1) % 8 + 8, k + 8]];
        let cap = [[0, 1, 5], [1, 4, 5], [1, 2, 4], [2, 3, 4], [0, 5, 6], [0, 6, 7]];
        let triangles =
            (0..8).flat_map(side).chain(cap.map(|[a, b, c]| [a, c, b])).chain(cap.map(|t| t.map(|v| v + 8)));
        TriMesh { triangles: triangles.collect(), positions: at(0.0).chain(at(2.0)).collect() }
    };
    let mut apart = cuboid(DVec3::ZERO, DVec3::ONE);
    apart.append(&cuboid(DVec3::new(1.05, 0.0, 0.0), DVec3::new(2.0, 1.0, 1.0)));
    for (name, mesh) in [("groove", groove), ("narrow gap", apart), ("torus", torus(48, 24)), ("gear", gear(12))] {
        assert!(state(&mesh, true).is_valid(), "{name}");
        let outcome = seen(&mesh, 0.4);
        assert_eq!(corners(&outcome.solid), corners(&mesh), "{name}");
        assert_eq!(outcome.report.outer.as_ref().map(|outer| outer.inner_triangles), Some(0), "{name}");
        let mut inside_out = mesh.clone();
        inside_out.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let turned = seen(&inside_out, 0.4);
        assert_eq!(corners(&turned.solid), corners(&mesh), "{name}");
        assert!(turned.report.orient[0].flipped_patches > 0, "{name}");
    }
}

#[test]
fn buried_parts_voids_and_faces_within_unions_go() {
    let room = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    let mut furnished = room.clone();
    furnished.append(&cuboid(DVec3::splat(1.0), DVec3::splat(2.0)));
    let mut hollow = cuboid(DVec3::splat(0.5), DVec3::splat(3.5));
    hollow.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    furnished.append(&hollow);
    let outcome = seen(&furnished, 0.5);
    assert_eq!(corners(&outcome.solid), corners(&room));
    assert_eq!(outcome.report.outer.as_ref().map(|outer| (outer.inner_triangles, outer.inner_patches)), Some((24, 2)));
    // Two that cross, and one that shares a face with the first.
    let mut crossing = room.clone();
    crossing.append(&cuboid(DVec3::splat(2.0), DVec3::splat(6.0)));
    let outcome = seen(&crossing, 0.5);
    assert!(
        (volume(&outcome.solid) - 120.0).abs() < 1e-9
            && outcome.report.outer.as_ref().is_some_and(|outer| outer.cut > 0)
    );
    let mut sharing = room.clone();
    sharing.append(&cuboid(DVec3::new(4.0, 1.0, 1.0), DVec3::new(5.0, 2.0, 2.0)));
    assert!((volume(&seen(&sharing, 0.5).solid) - 65.0).abs() < 1e-9);
    // A wall across the room, whose edges lie on its sides.
    let mut parted = room.clone();
    let wall = [[2.0, 0.0, 0.0], [2.0, 4.0, 0.0], [2.0, 4.0, 4.0], [2.0, 0.0, 4.0]].map(DVec3::from_array);
    parted.append(&TriMesh { positions: wall.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] });
    let outcome = seen(&parted, 0.5);
    assert!((volume(&outcome.solid) - 64.0).abs() < 1e-9);
    assert!(outcome.solid.validity().area - 96.0 < 1e-9);
}

#[test]
fn bottles_are_filled_where_the_ball_does_not_pass_their_necks() {
    let shell = Skin::Joined;
    let whole = ball(4, |_| 1.0);
    let bottle = double(&whole, 0.2, 1, shell);
    // The neck is about 0.2 wide: a small ball goes in and sees the inside of the bottle, which stays.
    let narrow = seen(&bottle.mesh, 0.05);
    assert_eq!(corners(&narrow.solid), corners(&bottle.mesh));
    let wide = seen(&bottle.mesh, 0.4);
    assert!(volume(&wide.solid) > 0.98 * volume(&whole) && wide.solid.validity().genus == Some(0));
}

/// A second skin in which the ball would fit nowhere is not told from the two sides of a wall while both are one surface; apart it goes.
#[test]
fn skins_within_narrow_tubes_go_where_they_are_surfaces_of_their_own() {
    let tube = torus_of(96, 16, 1.0, 0.1);
    for (skin, genus) in [(Skin::Alike, 1), (Skin::Flipped, 1), (Skin::Joined, 2)] {
        let double = double(&tube, 0.02, 1, skin);
        assert_eq!(seen(&double.mesh, 0.3).solid.validity().genus, Some(genus), "{skin:?}");
    }
}

#[test]
fn pinholes_are_listed_by_number_and_can_be_left_open() {
    let whole = ball(3, |_| 1.0);
    let double = double(&whole, 0.1, 3, Skin::Flipped);
    let mut outcome = seen(&double.mesh, 1.3 * double.widest);
    let numbers: Vec<usize> = outcome.report.holes.iter().map(|hole| hole.number).collect();
    assert_eq!(numbers, [1, 2, 3]);
    let lids: usize = outcome.report.holes.iter().map(|hole| hole.triangles).sum();
    assert_eq!(lids, outcome.solid.triangles.len() - double.outer.triangles.len());
    let second = outcome.report.holes[1].clone();
    let opened = outcome.clone().open(&[2]).expect("a lid");
    assert_eq!(opened.mesh.triangles.len(), outcome.solid.triangles.len() - second.triangles);
    assert_eq!(corners(&outcome.open_all().mesh), corners(&double.outer));
}

#[test]
fn sheets_are_refused_or_made_thick() {
    let mut flag = cuboid(DVec3::ZERO, DVec3::ONE);
    let sheet = [[2.0, 0.0, 0.5], [3.0, 0.0, 0.5], [3.0, 1.0, 0.5], [2.0, 1.0, 0.5]].map(DVec3::from_array);
    flag.append(&TriMesh { positions: sheet.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] });
    let error = refused(&flag, 0.2);
    let OuterError::Sheets { triangles: 2, at, widest } = &error else { panic!("{error}") };
    assert!((at.z - 0.5).abs() < 1e-12 && (widest - 2f64.sqrt()).abs() < 1e-12);
    assert!(error.to_string().contains("sees 2 triangles from both sides, one at"), "{error}");
    let thick = OuterOptions { thickness: Some(0.1), ..options(0.2) };
    let outcome = outer(&flag, &thick, &Progress::none()).expect("a solid");
    let found = state(&outcome.solid, true);
    assert!(found.is_valid() && found.bodies == 2);
    assert!(corners(&outcome.solid).is_superset(&corners(&cuboid(DVec3::ZERO, DVec3::ONE))));
    let plate = 0.1 + 4.0 * std::f64::consts::PI * 0.05f64.powi(2) / 2.0;
    assert!((volume(&outcome.solid) - 1.0 - plate).abs() < 0.01, "{}", volume(&outcome.solid));
    assert_eq!(outcome.report.outer.as_ref().and_then(|outer| outer.thickness), Some(0.1));
    // A sheet alone, and a surface with a hole that the ball passes.
    let alone = flag.submesh(&[12, 13]).mesh;
    let plate = outer(&alone, &thick, &Progress::none()).expect("a solid");
    assert!(state(&plate.solid, true).is_valid());
    let cup = TriMesh {
        triangles: cuboid(DVec3::ZERO, DVec3::ONE).triangles[2..].to_vec(),
        ..cuboid(DVec3::ZERO, DVec3::ONE)
    };
    let OuterError::Sheets { triangles, widest, .. } = refused(&cup, 0.2) else { panic!("it goes in") };
    assert_eq!((triangles, widest), (10, 2f64.sqrt()));
    assert_eq!(seen(&cup, 1.6).solid.triangles.len(), 12);
    // Thin walls are no sheets, however thin.
    for thin in [1e-1, 1e-2, 1e-4] {
        let plate = cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, thin));
        assert_eq!(corners(&seen(&plate, 0.3).solid), corners(&plate), "{thin}");
    }
}

#[test]
fn a_ball_that_cannot_be_rolled_is_refused() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    for size in [0.0, -1.0, f64::NAN, 1e-6] {
        assert!(matches!(refused(&cube, size), OuterError::Reach(ReachError::Ball { .. })), "{size}");
    }
    let nothing = TriMesh::default();
    assert!(matches!(refused(&nothing, 0.1), OuterError::Boolean(BooleanError::Empty { operand: 0 })));
    let mut little = options(0.005);
    little.solid.max_memory = Some(20_000_000);
    let error = outer(&cube, &little, &Progress::none()).expect_err("too large a lattice");
    assert!(matches!(error, OuterError::Reach(ReachError::Memory { .. })), "{error}");
    let plan = plan_outer(&cube, &options(0.05)).expect("a plan");
    assert!(plan.dims[0] > 150 && plan.memory > 1_000_000, "{plan:?}");
}

#[test]
fn far_from_the_origin_and_on_one_thread_the_result_is_the_same() {
    let whole = ball(3, |_| 1.0);
    let near = double(&whole, 0.1, 3, Skin::Alike);
    let by = DVec3::new(300_000.0, 5_000_000.0, -70_000.0);
    // Moved there and back, so that both have the same numbers.
    let moved = |mesh: &TriMesh, by: DVec3| TriMesh {
        positions: mesh.positions.iter().map(|&p| p + by).collect(),
        triangles: mesh.triangles.clone(),
    };
    let far = moved(&near.mesh, by);
    let at_origin = moved(&far, -by);
    let ball = 1.3 * near.widest;
    let (here, there) = (seen(&at_origin, ball), seen(&far, ball));
    assert_eq!(here.solid.triangles, there.solid.triangles);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let alone = pool.install(|| seen(&at_origin, ball));
    assert_eq!(alone.solid, here.solid);
    assert_eq!(here.report.holes.len(), 3);
}
