//! Meshes and small helpers of all tests.

use glam::DVec3;
use meshwright::mesh::{TriMesh, ValidateOptions, Validity, validate};
use meshwright::progress::Progress;
use proptest::prelude::ProptestConfig;

pub fn cube(low: DVec3, size: f64) -> TriMesh {
    let corner = |i: u32| low + size * DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// A torus of n × m quads around the z axis.
pub fn torus(n: u32, m: u32) -> TriMesh {
    let turn = |k: u32, of: u32| std::f64::consts::TAU * f64::from(k) / f64::from(of);
    let point = |i: u32, j: u32| {
        let (a, b) = (turn(i, n), turn(j, m));
        DVec3::new((3.0 + b.cos()) * a.cos(), (3.0 + b.cos()) * a.sin(), b.sin())
    };
    let id = |i: u32, j: u32| (i % n) * m + j % m;
    let quad = |i, j| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
    let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    TriMesh {
        positions: cells().map(|(i, j)| point(i, j)).collect(),
        triangles: cells().map(|(i, j)| quad(i, j)).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// Every triangle with vertices of its own, as in an STL file.
pub fn soup_of(mesh: &TriMesh) -> TriMesh {
    TriMesh {
        positions: (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).collect(),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}

pub fn checked(mesh: &TriMesh) -> Validity {
    validate(mesh, &ValidateOptions::default(), &Progress::none()).unwrap()
}

/// Flat triangles are thrown away by the tests, so many more may be drawn than are used.
pub fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, max_global_rejects: 20 * cases, failure_persistence: None, ..ProptestConfig::default() }
}

pub fn unit_cube() -> TriMesh {
    cube(DVec3::ZERO, 1.0)
}
