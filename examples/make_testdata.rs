//! Makes the meshes of `testdata/`: small, our own, the same on every machine.
//!
//! ```text
//! cargo run --example make_testdata            writes into testdata/
//! cargo run --example make_testdata -- FOLDER  writes into FOLDER
//! ```
//!
//! Coordinates are rounded to four decimals, so that the last bit of a sine does not show.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::PathBuf;

use glam::{DVec3, dvec3};
use meshwright::mesh::TriMesh;

#[allow(dead_code)] // The test that compares the files includes this program as a module.
fn main() -> std::io::Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("testdata"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for (name, bytes) in files() {
        println!("{name}: {} bytes", bytes.len());
        std::fs::write(folder.join(name), bytes)?;
    }
    Ok(())
}

/// Every file of `testdata/`: its name and its bytes.
pub fn files() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("torus.ply", binary_ply(&deformed_torus())),
        ("noisy_cube.off", off(&noisy_cube())),
        ("hollow_ball.stl", binary_stl(&hollow_ball())),
        ("overlapping_boxes.obj", obj(&overlapping_boxes())),
        ("open_cube.off", off(&open_cube())),
        ("cracked_ball.stl", binary_stl(&cracked_ball())),
        ("open_sheet.obj", obj(&[("sheet", open_sheet())])),
        ("inside_out_cube.stl", ascii_stl(&turned_over(cuboid(DVec3::ZERO, DVec3::splat(10.0))))),
        ("flipped_patches.ply", ascii_ply(&flipped_patches())),
        ("doubled_faces.off", off(&doubled_faces())),
        ("touching_boxes.obj", obj(&touching_boxes())),
        ("thin_plate.stl", binary_stl(&cuboid(DVec3::ZERO, dvec3(10.0, 4.0, 0.04)))),
        ("monkey_saddle.off", off(&monkey_saddle())),
        ("broken_mug.obj", obj(&broken_mug())),
        ("bored_block.off", off(&bored_block())),
        ("thin_parts.obj", obj(&thin_parts())),
    ]
}

// ---- shapes ----------------------------------------------------------------------------------

/// 64 x 32 quads: a torus whose tube swells and whose ring sways up and down.
fn deformed_torus() -> TriMesh {
    grid(64, 32, Wrap::Both, |u, v| {
        let (around, across) = (TAU * u, TAU * v);
        let tube = 3.0 + 0.8 * (3.0 * around).sin();
        let ring = 10.0 + tube * across.cos();
        dvec3(ring * around.cos(), ring * around.sin(), tube * across.sin() + 1.5 * (2.0 * around).cos())
    })
}

/// A cube of 8 x 8 quads a side whose vertices are off by up to 3 % of its edge.
fn noisy_cube() -> TriMesh {
    let mut cube = TriMesh::default();
    for side in 0..6 {
        let (axis, outwards) = (side / 2, side % 2 == 1);
        cube.append(&grid(8, 8, Wrap::None, |u, v| {
            let (u, v) = if outwards { (u, v) } else { (v, u) };
            let mut p = DVec3::ZERO;
            p[axis] = if outwards { 10.0 } else { 0.0 };
            p[(axis + 1) % 3] = 10.0 * u;
            p[(axis + 2) % 3] = 10.0 * v;
            p
        }));
    }
    let mut cube = cube.welded();
    let mut noise = Noise(1);
    for p in &mut cube.positions {
        *p += 0.3 * noise.vector();
    }
    cube
}

/// Two concentric spheres, the inner one facing inwards: a ball with a void.
fn hollow_ball() -> TriMesh {
    let mut ball = sphere(DVec3::ZERO, 10.0, 2);
    ball.append(&turned_over(sphere(DVec3::ZERO, 6.0, 2)));
    ball
}

/// Three boxes through each other, as three objects of one file.
fn overlapping_boxes() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("lying", cuboid(dvec3(0.0, 0.0, 0.0), dvec3(20.0, 8.0, 6.0))),
        ("standing", cuboid(dvec3(5.0, 2.0, -3.0), dvec3(10.0, 6.0, 15.0))),
        ("across", cuboid(dvec3(12.0, -4.0, 1.0), dvec3(16.0, 12.0, 5.0))),
    ]
}

/// A cube without its top.
fn open_cube() -> TriMesh {
    let mut cube = cuboid(DVec3::ZERO, DVec3::splat(10.0));
    cube.triangles.retain(|t| !t.iter().all(|&v| cube.positions[v as usize].z == 10.0));
    cube
}

/// A sphere whose triangles were each moved on their own, by up to 0.1 % of its diameter.
fn cracked_ball() -> TriMesh {
    let mut ball = torn(&sphere(DVec3::ZERO, 10.0, 2));
    let mut noise = Noise(2);
    for corners in ball.positions.chunks_exact_mut(3) {
        let step = 0.02 * noise.vector();
        corners.iter_mut().for_each(|p| *p += step);
    }
    ball
}

/// A wavy sheet with a rim all around: it encloses nothing.
fn open_sheet() -> TriMesh {
    grid(12, 12, Wrap::None, |u, v| dvec3(20.0 * u, 20.0 * v, (TAU * u).sin() * (TAU * v).cos()))
}

/// A sphere with two patches facing inwards.
fn flipped_patches() -> TriMesh {
    let mut ball = sphere(DVec3::ZERO, 10.0, 2);
    turn_over_near(&mut ball, dvec3(0.0, 0.0, 10.0), 5.0);
    turn_over_near(&mut ball, dvec3(8.0, 6.0, 0.0), 4.0);
    ball
}

/// A sphere of which a third of the triangles is there twice, half of these the other way round.
fn doubled_faces() -> TriMesh {
    let mut ball = sphere(DVec3::ZERO, 10.0, 2);
    let again: Vec<[u32; 3]> = ball
        .triangles
        .iter()
        .step_by(3)
        .enumerate()
        .map(|(n, &[a, b, c])| if n % 2 == 0 { [a, b, c] } else { [a, c, b] })
        .collect();
    ball.triangles.extend(again);
    ball
}

/// Two boxes that share a whole face.
fn touching_boxes() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("left", cuboid(DVec3::ZERO, DVec3::splat(10.0))),
        ("right", cuboid(dvec3(10.0, 0.0, 0.0), dvec3(20.0, 10.0, 10.0))),
    ]
}

/// A slab under and over the monkey saddle z = x³ - 3xy².
fn monkey_saddle() -> TriMesh {
    let steps = 20;
    let face = |lift: f64| {
        grid(steps, steps, Wrap::None, move |u, v| {
            let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
            dvec3(10.0 * x, 10.0 * y, 3.0 * (x * x * x - 3.0 * x * y * y) + lift)
        })
    };
    let (top, bottom) = (face(1.5), face(-1.5));
    let side = steps as u32 + 1;
    let rim: Vec<u32> = (0..side)
        .map(|i| i * side)
        .chain((1..side).map(|j| (side - 1) * side + j))
        .chain((0..side - 1).rev().map(|i| i * side + side - 1))
        .chain((1..side - 1).rev())
        .collect();
    let mut body = top;
    let below = body.positions.len() as u32;
    body.append(&turned_over(bottom));
    for (i, &a) in rim.iter().enumerate() {
        let b = rim[(i + 1) % rim.len()];
        body.triangles.extend([[a, below + b, b], [a, below + a, below + b]]);
    }
    body
}

/// Diameters of the bores of [`bored_block`].
const BORES: [f64; 5] = [0.6, 1.0, 1.6, 2.4, 3.6];

/// A block of 30 x 6 x 8 with five bores through it, as a soup of plates with round holes and of tubes.
fn bored_block() -> TriMesh {
    const SIDES: usize = 32;
    let mut block = TriMesh::default();
    for (cell, diameter) in BORES.into_iter().enumerate() {
        let middle = dvec3(6.0 * cell as f64 + 3.0, 3.0, 0.0);
        let round = |u: f64, z: f64| {
            let angle = TAU * (u - 0.375);
            middle + dvec3(angle.cos(), angle.sin(), 0.0) * diameter / 2.0 + DVec3::Z * z
        };
        let square = |u: f64, z: f64| {
            let corner =
                |n: usize| [dvec3(-3.0, -3.0, z), dvec3(3.0, -3.0, z), dvec3(3.0, 3.0, z), dvec3(-3.0, 3.0, z)][n % 4];
            let side = (4.0 * u) as usize;
            middle + corner(side).lerp(corner(side + 1), 4.0 * u - side as f64)
        };
        let ring = |z: f64| grid(SIDES, 1, Wrap::First, |u, v| square(u, z).lerp(round(u, z), v));
        block.append(&ring(8.0));
        block.append(&turned_over(ring(0.0)));
        block.append(&turned_over(grid(SIDES, 1, Wrap::First, |u, v| round(u, 8.0 * v))));
    }
    for side in 0..4 {
        let ends = [dvec3(0.0, 0.0, 0.0), dvec3(30.0, 0.0, 0.0), dvec3(30.0, 6.0, 0.0), dvec3(0.0, 6.0, 0.0)];
        let (from, to) = (ends[side], ends[(side + 1) % 4]);
        let pieces = [BORES.len(), 1][side % 2] * SIDES / 4;
        block.append(&grid(pieces, 1, Wrap::None, |u, v| from.lerp(to, u) + DVec3::Z * 8.0 * v));
    }
    block
}

/// A block that carries plates and a rod, most of them thin.
fn thin_parts() -> Vec<(&'static str, TriMesh)> {
    let plate = |x: f64, width: f64| cuboid(dvec3(x, 3.0, 9.0), dvec3(x + width, 17.0, 18.0));
    let mut rod = grid(24, 1, Wrap::First, |u, v| {
        dvec3(1.5 + 0.3 * (TAU * u).cos(), 1.5 + 0.3 * (TAU * u).sin(), 9.0 + 11.0 * v)
    });
    for (z, up) in [(9.0, false), (20.0, true)] {
        let disc = grid(24, 1, Wrap::First, |u, v| {
            dvec3(1.5 + 0.3 * (1.0 - v) * (TAU * u).cos(), 1.5 + 0.3 * (1.0 - v) * (TAU * u).sin(), z)
        });
        rod.append(&without_slivers(if up { disc } else { turned_over(disc) }));
    }
    vec![
        ("block", cuboid(DVec3::ZERO, dvec3(20.0, 20.0, 10.0))),
        ("thin plate", plate(4.0, 0.3)),
        ("plate", plate(9.0, 0.6)),
        ("thick plate", plate(14.0, 3.0)),
        ("rod", rod),
    ]
}

/// A mug as people find them: a wall that does not close at its seam, a floor that only pokes
/// through it, a handle whose open ends end inside the wall, beads half of which are inside out,
/// holes, patches facing inwards, and triangles that are there twice.
fn broken_mug() -> Vec<(&'static str, TriMesh)> {
    let mut wall = mug_wall();
    remove_near(&mut wall, dvec3(-33.0, -22.0, 40.0), 5.0);
    remove_near(&mut wall, dvec3(10.0, -39.0, 24.0), 4.0);
    remove_near(&mut wall, dvec3(-20.0, -34.0, 82.0), 4.0);
    turn_over_near(&mut wall, dvec3(-8.0, -38.0, 45.0), 13.0);
    turn_over_near(&mut wall, dvec3(30.0, -24.0, 60.0), 11.0);
    let again: Vec<[u32; 3]> = wall.triangles.iter().skip(7).step_by(29).copied().collect();
    wall.triangles.extend(again);
    let mut handle = grid(32, 14, Wrap::Second, |u, v| {
        let bow = PI * (1.12 * u - 0.56);
        let (out, up) = (bow.cos(), bow.sin());
        let thickness = 4.5 + 1.2 * (TAU * u).cos();
        let (side, lift) = ((TAU * v).cos() * thickness, (TAU * v).sin() * thickness * 1.15);
        // Both ends lie between the outside and the inside of the wall, which leans outwards.
        let along = 24.0 * out + 41.3 + up + lift * out;
        dvec3(along, side, 48.0 + 30.0 * up + lift * up)
    });
    remove_near(&mut handle, dvec3(70.0, -4.0, 58.0), 3.5);
    let floor = grid(48, 1, Wrap::First, |u, v| {
        let r = 30.6 * v;
        dvec3(r * (TAU * u).cos(), r * (TAU * u).sin(), 0.6)
    });
    let mut parts = vec![("wall", wall), ("handle", handle), ("floor", turned_over(without_slivers(floor)))];
    for n in 0..14 {
        let angle = TAU * (f64::from(n) + 0.5) / 14.0;
        let bead = sphere(dvec3(40.6 * angle.cos(), 40.6 * angle.sin(), 78.0), 4.0, 1);
        parts.push(("bead", if n % 2 == 0 { bead } else { turned_over(bead) }));
    }
    parts
}

/// Outside, rim and inside of the mug as one strip around z that misses itself at the seam.
fn mug_wall() -> TriMesh {
    let outline: [(f64, f64); 21] = [
        (30.0, 0.0),
        (33.5, 1.5),
        (35.8, 5.0),
        (37.4, 14.0),
        (38.3, 24.0),
        (39.0, 35.0),
        (39.5, 46.0),
        (39.9, 57.0),
        (40.1, 68.0),
        (40.3, 79.0),
        (40.6, 90.0),
        (40.2, 92.6),
        (38.6, 93.6),
        (37.0, 92.6),
        (36.4, 90.0),
        (36.0, 70.0),
        (35.4, 46.0),
        (34.6, 24.0),
        (33.0, 9.0),
        (27.0, 5.0),
        (0.0, 4.5),
    ];
    let rows = outline.len() - 1;
    let wall = grid(56, rows, Wrap::None, |u, v| {
        let (r, z) = outline[(v * rows as f64).round() as usize];
        // The seam lies in front, where one sees it.
        let angle = TAU * u - 1.9;
        let gap = if u == 1.0 && r > 0.0 { 0.12 } else { 0.0 };
        dvec3(r * angle.cos(), r * angle.sin(), z) + DVec3::splat(gap)
    });
    without_slivers(wall)
}

// ---- building blocks -------------------------------------------------------------------------

#[derive(Clone, Copy, PartialEq)]
enum Wrap {
    None,
    First,
    Second,
    Both,
}

/// A grid of `nu` x `nv` quads, two triangles each, at `place(u, v)` with u and v from 0 to 1.
/// It faces along du x dv.
fn grid(nu: usize, nv: usize, wrap: Wrap, place: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let rows = if matches!(wrap, Wrap::First | Wrap::Both) { nu } else { nu + 1 };
    let columns = if matches!(wrap, Wrap::Second | Wrap::Both) { nv } else { nv + 1 };
    let positions = (0..rows * columns)
        .map(|n| place((n / columns) as f64 / nu as f64, (n % columns) as f64 / nv as f64))
        .collect();
    let vertex = |i: usize, j: usize| ((i % rows) * columns + j % columns) as u32;
    let triangles = (0..nu * nv)
        .flat_map(|n| {
            let (i, j) = (n / nv, n % nv);
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriMesh { positions, triangles }
}

/// A box of 12 triangles over 8 vertices.
fn cuboid(min: DVec3, max: DVec3) -> TriMesh {
    let pick = |bit: u32, axis: usize| if bit == 0 { min[axis] } else { max[axis] };
    let positions = (0..8).map(|n| dvec3(pick(n & 1, 0), pick(n >> 1 & 1, 1), pick(n >> 2 & 1, 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh { positions, triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect() }
}

/// An octahedron, each triangle split in four `splits` + 1 times, on a sphere.
fn sphere(centre: DVec3, radius: f64, splits: u32) -> TriMesh {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mut ball = torn(&TriMesh { positions: axes.to_vec(), triangles });
    for _ in 0..=splits {
        let mut finer = TriMesh::default();
        for t in 0..ball.triangles.len() {
            let [a, b, c] = ball.corners(t);
            let [ab, bc, ca] = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
            for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                let first = finer.positions.len() as u32;
                finer.positions.extend(corners.map(DVec3::normalize));
                finer.triangles.push([first, first + 1, first + 2]);
            }
        }
        ball = finer;
    }
    let mut ball = ball.welded();
    ball.positions.iter_mut().for_each(|p| *p = centre + radius * *p);
    ball
}

/// The same triangles, none sharing a vertex with another.
fn torn(mesh: &TriMesh) -> TriMesh {
    let positions = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriMesh { positions, triangles }
}

fn turned_over(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

fn near(mesh: &TriMesh, triangle: usize, place: DVec3, radius: f64) -> bool {
    mesh.corners(triangle).iter().sum::<DVec3>().distance(3.0 * place) < 3.0 * radius
}

fn turn_over_near(mesh: &mut TriMesh, place: DVec3, radius: f64) {
    for t in 0..mesh.triangles.len() {
        if near(mesh, t, place, radius) {
            mesh.triangles[t].swap(1, 2);
        }
    }
}

fn remove_near(mesh: &mut TriMesh, place: DVec3, radius: f64) {
    let kept = (0..mesh.triangles.len()).filter(|&t| !near(mesh, t, place, radius)).collect::<Vec<_>>();
    mesh.triangles = kept.iter().map(|&t| mesh.triangles[t]).collect();
}

/// Without the triangles that a grid makes where it ends in a point.
fn without_slivers(mut mesh: TriMesh) -> TriMesh {
    let kept = (0..mesh.triangles.len()).filter(|&t| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length() > 1e-9
    });
    mesh.triangles = kept.map(|t| mesh.triangles[t]).collect();
    mesh
}

/// A linear congruential generator (Knuth's MMIX constants).
struct Noise(u64);

impl Noise {
    /// From -1 to 1.
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 23) - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        dvec3(self.number(), self.number(), self.number())
    }
}

// ---- formats ---------------------------------------------------------------------------------

/// Four decimals, -0 as 0.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4 + 0.0
}

fn triple(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(rounded);
    format!("{x} {y} {z}")
}

fn off(mesh: &TriMesh) -> Vec<u8> {
    let mut text = format!("OFF\n{} {} 0\n", mesh.positions.len(), mesh.triangles.len());
    mesh.positions.iter().for_each(|&p| text.push_str(&format!("{}\n", triple(p))));
    mesh.triangles.iter().for_each(|[a, b, c]| text.push_str(&format!("3 {a} {b} {c}\n")));
    text.into_bytes()
}

fn obj(objects: &[(&str, TriMesh)]) -> Vec<u8> {
    let mut text = String::new();
    let mut first = 1;
    for (name, mesh) in objects {
        let _ = writeln!(text, "o {name}");
        mesh.positions.iter().for_each(|&p| text.push_str(&format!("v {}\n", triple(p))));
        for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v + first)) {
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        first += mesh.positions.len() as u32;
    }
    text.into_bytes()
}

fn ply_header(mesh: &TriMesh, encoding: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )
}

fn ascii_ply(mesh: &TriMesh) -> Vec<u8> {
    let mut text = ply_header(mesh, "ascii");
    mesh.positions.iter().for_each(|&p| text.push_str(&format!("{}\n", triple(p))));
    mesh.triangles.iter().for_each(|[a, b, c]| text.push_str(&format!("3 {a} {b} {c}\n")));
    text.into_bytes()
}

fn binary_ply(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = ply_header(mesh, "binary_little_endian").into_bytes();
    let coordinates = mesh.positions.iter().flat_map(|p| p.to_array());
    coordinates.for_each(|x| bytes.extend((rounded(x) as f32).to_le_bytes()));
    for t in &mesh.triangles {
        bytes.push(3);
        t.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    bytes
}

fn ascii_stl(mesh: &TriMesh) -> Vec<u8> {
    let mut text = String::from("solid made by make_testdata\n");
    for t in 0..mesh.triangles.len() {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        mesh.corners(t).iter().for_each(|&p| text.push_str(&format!("vertex {}\n", triple(p))));
        text.push_str("endloop\nendfacet\n");
    }
    text.push_str("endsolid\n");
    text.into_bytes()
}

fn binary_stl(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..21].copy_from_slice(b"made by make_testdata");
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for t in 0..mesh.triangles.len() {
        bytes.extend([0; 12]);
        for p in mesh.corners(t) {
            p.to_array().iter().for_each(|&x| bytes.extend((rounded(x) as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}
