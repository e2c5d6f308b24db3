//! Comparing meshes whose distances are known.

use crate::common::shapes::{cuboid, torus, torus_of};
use glam::DVec3;
use meshwright::compare::{CompareOptions, Comparison, compare, deviation_map};
use meshwright::io;
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;

fn compared(a: &TriMesh, b: &TriMesh, options: &CompareOptions) -> Comparison {
    compare(a, b, options, &Progress::none()).expect("nobody stops it")
}

/// A cube about the origin.
fn cube(half: f64) -> TriMesh {
    cuboid(DVec3::splat(-half), DVec3::splat(half))
}

fn few() -> CompareOptions {
    CompareOptions { samples: 20_000, ..CompareOptions::default() }
}

#[track_caller]
fn close(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} instead of {expected}");
}

#[test]
fn concentric_cubes() {
    let found = compared(&cube(1.0), &cube(1.5), &few());
    let there = found.a_to_b.expect("both have an area");
    for (value, expected) in [(there.mean, 0.5), (there.rms, 0.5), (there.p99, 0.5), (there.max, 0.5)] {
        close(value, expected, 1e-12);
    }
    close(there.relative.mean, 0.5 / 12f64.sqrt(), 1e-12);
    // The other way: the mean over one face of the larger cube, by the formula for boxes.
    let (mut sum, mut squares, steps) = (0.0, 0.0, 600);
    for i in 0..steps {
        for j in 0..steps {
            let [x, y] = [i, j].map(|k| 3.0 * (f64::from(k) + 0.5) / f64::from(steps) - 1.5);
            let square = 0.25 + (x.abs() - 1.0).max(0.0).powi(2) + (y.abs() - 1.0).max(0.0).powi(2);
            sum += square.sqrt();
            squares += square;
        }
    }
    let count = f64::from(steps * steps);
    let back = found.b_to_a.expect("both have an area");
    close(back.mean, sum / count, 2e-4);
    close(back.rms, (squares / count).sqrt(), 2e-4);
    close(back.max, 0.75f64.sqrt(), 1e-12);
    assert_eq!(back.max_at.map(f64::abs), [1.5; 3]);
    let both = found.symmetric.expect("both have an area");
    close(both.mean, (there.mean + back.mean) / 2.0, 1e-15);
    assert_eq!((both.max, both.p99), (back.max, back.p99));
    close(found.volume_difference.expect("A is closed"), (27.0 - 8.0) / 8.0, 1e-12);
    close(found.area_difference.expect("A has an area"), (54.0 - 24.0) / 24.0, 1e-12);
    let normals = found.normals.expect("both have an area");
    assert!(normals.oriented && normals.mean_degrees < 1e-5 && normals.share_over_10_degrees == 0.0);
}

#[test]
fn sharp_edges_are_found_within_the_tolerance_only() {
    let with = |edge_tolerance| compared(&cube(1.0), &cube(1.5), &CompareOptions { edge_tolerance, ..few() }).sharp;
    let (length_a, length_b) = (with(None).length_a, with(None).length_b);
    close(length_a, 24.0, 1e-12);
    close(length_b, 36.0, 1e-12);
    close(with(None).tolerance, 2.0 / 1024.0, 1e-15);
    assert_eq!((with(None).recall, with(None).precision), (Some(0.0), Some(0.0)));
    // Edges of the smaller cube are all as far away; of those of the larger one, the middle two thirds are.
    let sharp = with(Some(0.5f64.sqrt() + 1e-9));
    assert_eq!(sharp.recall, Some(1.0));
    close(sharp.precision.expect("B has edges"), 2.0 / 3.0, 1e-3);
    let smooth = compared(&torus(64, 32), &cube(1.0), &few()).sharp;
    assert_eq!((smooth.length_a, smooth.recall, smooth.precision), (0.0, None, Some(0.0)));
}

#[test]
fn a_mesh_is_at_no_distance_from_itself() {
    for mesh in [torus(40, 20), cube(1.0), cuboid(DVec3::new(1e4, 2.0, -3e5), DVec3::new(1e4 + 1.0, 2.7, -3e5 + 0.4))] {
        let found = compared(&mesh, &mesh, &few());
        for distances in [found.a_to_b, found.b_to_a] {
            let d = distances.expect("it has an area");
            assert_eq!([d.mean, d.rms, d.p99, d.max], [0.0; 4]);
        }
        assert_eq!((found.volume_difference, found.area_difference), (Some(0.0), Some(0.0)));
        assert!(found.sharp.recall.is_none_or(|recall| recall == 1.0));
        assert!(found.sharp.precision.is_none_or(|precision| precision == 1.0));
        assert!(found.normals.is_some_and(|normals| normals.mean_degrees < 1e-3));
    }
}

#[test]
fn turned_over_triangles_are_seen_in_the_normals() {
    let mut over = torus(40, 20);
    over.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let normals = compared(&torus(40, 20), &over, &few()).normals.expect("both have an area");
    close(normals.mean_degrees, 180.0, 1e-3);
    close(normals.share_over_10_degrees, 1.0, 0.0);
    // One triangle of A the other way: its sides mean nothing any more.
    let mut mixed = torus(40, 20);
    mixed.triangles[0].swap(1, 2);
    let normals = compared(&mixed, &over, &few()).normals.expect("both have an area");
    assert!(!normals.oriented && normals.mean_degrees < 1e-3);
}

#[test]
fn threads_do_not_matter() {
    let (a, b) = (torus(60, 30), torus_of(50, 20, 1.01, 0.33));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| {
            let map = deviation_map(&b, &a, &Progress::none()).expect("nobody stops it");
            (compared(&a, &b, &few()), map)
        })
    };
    assert_eq!(with(1), with(2));
}

#[test]
fn the_size_of_the_model_does_not_matter() {
    let (a, b) = (cube(1.0), torus(20, 10));
    let plain = compared(&a, &b, &few()).symmetric.expect("both have an area");
    for factor in [2f64.powi(-600), 2f64.powi(600)] {
        let grown = |mesh: &TriMesh| TriMesh {
            positions: mesh.positions.iter().map(|&p| p * factor).collect(),
            triangles: mesh.triangles.clone(),
        };
        let found = compared(&grown(&a), &grown(&b), &few()).symmetric.expect("both have an area");
        assert_eq!(found.relative, plain.relative);
        assert_eq!(found.max, plain.max * factor);
    }
}

#[test]
fn without_area_there_are_no_distances() {
    let flat = TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], triangles: vec![[0, 1, 2]] };
    for (a, b) in [(&flat, &cube(1.0)), (&cube(1.0), &flat), (&TriMesh::default(), &TriMesh::default())] {
        let found = compared(a, b, &few());
        assert_eq!((found.a_to_b, found.symmetric, found.normals), (None, None, None));
    }
    assert_eq!(deviation_map(&cube(1.0), &flat, &Progress::none()), Ok(None));
}

#[test]
fn the_map_is_negative_inside_and_reads_back() {
    let map = |mesh: &TriMesh| deviation_map(mesh, &cube(1.0), &Progress::none()).unwrap().expect("a surface");
    let outside = map(&cube(1.5));
    assert!(outside.distances.iter().all(|d| (d - 0.75f64.sqrt()).abs() < 1e-12));
    assert!(outside.colours().iter().all(|c| c[0] > c[2]), "outside is red");
    let inside = map(&cube(0.75));
    assert!(inside.distances.iter().all(|d| (d + 0.25).abs() < 1e-12));
    assert!(inside.colours().iter().all(|c| c[2] > c[0]), "inside is blue");
    // Zero is a grey that is seen on a white page too.
    let even = |c: &[u8; 3]| c.iter().max().zip(c.iter().min()).is_some_and(|(max, min)| max - min < 8 && *max < 230);
    assert!(map(&cube(1.0)).colours().iter().all(even));

    let mesh = cube(1.5);
    let quality: Vec<f32> = outside.distances.iter().map(|&d| d as f32).collect();
    let attributes =
        io::VertexMap { quality: &quality, colours: &outside.colours(), comments: &["two\nlines".to_string()] };
    let mut bytes = Vec::new();
    io::encode_vertex_map(&mesh, &attributes, &mut bytes).expect("memory takes it");
    let read = io::read_bytes(&bytes, None, None).expect("it is sound");
    assert_eq!((read.format, &read.mesh), (io::Format::Ply, &mesh));
}
