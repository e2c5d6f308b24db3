//! What is asked of lids, on shapes whose truth is known.

mod bands;
mod loops;
mod truth;

use std::time::Instant;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::{FillOptions, Lid, NoLid, Rim, Style, Surroundings, lid, rims};
use crate::mesh::{HalfEdges, TriMesh, ValidateOptions, validate};
use crate::progress::Progress;

/// The mesh without the triangles whose middle fulfils a condition.
fn without(mesh: &TriMesh, gone: impl Fn(DVec3) -> bool) -> TriMesh {
    let mut cut = mesh.clone();
    cut.triangles.retain(|t| !gone(t.map(|v| mesh.positions[v as usize]).iter().sum::<DVec3>() / 3.0));
    assert!(cut.triangles.len() < mesh.triangles.len());
    cut
}

/// The mesh with a lid over every rim, and the lids.
fn closed(mesh: &TriMesh, style: Style) -> (TriMesh, Vec<Lid>) {
    let around = Surroundings::new(mesh);
    let options = FillOptions { style, ..FillOptions::default() };
    let lids: Vec<Lid> =
        rims(mesh).iter().map(|rim| lid(&around, rim, &options).expect("the rim can be closed")).collect();
    let mut whole = mesh.clone();
    for lid in &lids {
        let shift = (whole.positions.len() - mesh.positions.len()) as u32;
        let number = |v: u32| if (v as usize) < mesh.positions.len() { v } else { v + shift };
        whole.triangles.extend(lid.triangles.iter().map(|t| t.map(number)));
        whole.positions.extend(&lid.positions);
    }
    (whole, lids)
}

/// Points all over a lid.
fn samples(mesh: &TriMesh, lid: &Lid) -> Vec<DVec3> {
    let at = |v: u32| {
        let v = v as usize;
        if v < mesh.positions.len() { mesh.positions[v] } else { lid.positions[v - mesh.positions.len()] }
    };
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(at);
        [a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]
    };
    lid.triangles.iter().flat_map(of).collect()
}

/// The largest and the mean (by squares) distance of a lid from the truth.
fn distances(mesh: &TriMesh, lid: &Lid, distance: impl Fn(DVec3) -> f64) -> [f64; 2] {
    let all: Vec<f64> = samples(mesh, lid).into_iter().map(|p| distance(p).abs()).collect();
    let squares: f64 = all.iter().map(|d| d * d).sum();
    [all.iter().fold(0.0, |most: f64, &d| most.max(d)), (squares / all.len() as f64).sqrt()]
}

/// Asserts that a mesh bounds a solid.
fn assert_solid(mesh: &TriMesh) {
    let validity = validate(mesh, &ValidateOptions::default(), &Progress::default()).expect("nothing stops it");
    assert!(validity.is_valid(), "{:?}", validity.problems());
}

/// A mesh of points on a parametric surface, closed along u and v where the points coincide.
fn welded(points: &[Vec<DVec3>]) -> TriMesh {
    let columns = points[0].len();
    let flat: Vec<DVec3> = points.iter().flatten().copied().collect();
    let mut triangles = Vec::new();
    for row in 0..points.len() - 1 {
        for column in 0..columns - 1 {
            let a = (row * columns + column) as u32;
            let [b, c, d] = [a + 1, a + columns as u32 + 1, a + columns as u32];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut mesh = TriMesh { positions: flat, triangles }.welded();
    mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    mesh
}

/// A sphere around the origin made of a divided octahedron.
fn sphere(radius: f64, times: usize) -> TriMesh {
    let corners = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let mut triangles: Vec<[DVec3; 3]> = faces.iter().map(|f: &[usize; 3]| f.map(|v| corners[v])).collect();
    for _ in 0..times {
        let divided = triangles.iter().flat_map(|&[a, b, c]| {
            let [p, q, r] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
        });
        triangles = divided.collect();
    }
    let positions = triangles.iter().flatten().map(|&p| p * radius).collect::<Vec<_>>();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriMesh { positions, triangles }.welded()
}

/// A point of a circle: one of `count`, the same bits for the first and the last.
fn on_circle(k: usize, count: usize) -> [f64; 2] {
    let (sin, cos) = ((k % count) as f64 / count as f64 * std::f64::consts::TAU).sin_cos();
    [cos, sin]
}

/// A torus around z.
fn torus(large: f64, small: f64, around: usize, across: usize) -> TriMesh {
    let row = |k: usize| {
        let [x, y] = on_circle(k, around);
        let point = |j: usize| {
            let [u, z] = on_circle(j, across);
            DVec3::new(x * (large + small * u), y * (large + small * u), small * z)
        };
        (0..=across).rev().map(point).collect()
    };
    welded(&(0..=around).map(row).collect::<Vec<Vec<_>>>())
}

/// A cylinder around z from -1 to 1 with radius 1; its ends are divided, too.
fn cylinder(around: usize, along: usize) -> TriMesh {
    let rings = along / 2;
    let mut profile: Vec<[f64; 2]> = (0..rings).map(|k| [k as f64 / rings as f64, -1.0]).collect();
    profile.extend((0..=along).map(|k| [1.0, 2.0 * k as f64 / along as f64 - 1.0]));
    profile.extend((0..rings).rev().map(|k| [k as f64 / rings as f64, 1.0]));
    let row = |&[radius, z]: &[f64; 2]| {
        let point = |k: usize| DVec3::new(on_circle(k, around)[0] * radius, on_circle(k, around)[1] * radius, z);
        (0..=around).map(point).collect()
    };
    welded(&profile.iter().map(row).collect::<Vec<Vec<_>>>())
}

/// A cube from -1 to 1 with so many squares along each edge.
fn cube(count: usize) -> TriMesh {
    let step = |k: usize| 2.0 * k as f64 / count as f64 - 1.0;
    let mut whole = TriMesh::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let point = |i: usize, j: usize| {
                let mut p = DVec3::ZERO;
                p[axis] = side;
                p[(axis + 1) % 3] = step(if side > 0.0 { i } else { j });
                p[(axis + 2) % 3] = step(if side > 0.0 { j } else { i });
                p
            };
            let rows: Vec<Vec<DVec3>> = (0..=count).map(|j| (0..=count).map(|i| point(i, j)).collect()).collect();
            whole.append(&welded(&rows));
        }
    }
    whole.welded()
}

#[test]
fn the_shapes_are_solid() {
    for mesh in [sphere(1.0, 3), torus(2.0, 0.5, 24, 12), cylinder(24, 8), cube(4)] {
        assert_solid(&mesh);
    }
}
