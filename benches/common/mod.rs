//! Generated meshes and the first stages, for the benches of the later ones.

#![allow(dead_code)] // each bench uses its own part

use glam::DVec3;
use meshwright::lattice::{Grid, Lattice};
use meshwright::ldi::{Layers, ldis};
use meshwright::mesh::{Plane, TriMesh};
use meshwright::progress::Progress;
use meshwright::survey::Survey;
use meshwright::vote::{VoteRule, Votes};

/// A bumpy torus of 2 × `around` × `around / 2` triangles; with `holes`, every 97th is missing.
pub fn torus(around: u32, holes: bool) -> TriMesh {
    let tube = around / 2;
    let turn = std::f64::consts::TAU;
    let vertex = |n: u32| {
        let (a, t) = (turn * (n / tube) as f64 / around as f64, turn * (n % tube) as f64 / tube as f64);
        let radius = 0.35 + 0.03 * (9.0 * a).sin() * (5.0 * t).cos();
        let r = 1.0 + radius * t.cos();
        DVec3::new(r * a.cos(), r * a.sin(), radius * t.sin())
    };
    let index = |i: u32, j: u32| (i % around) * tube + j % tube;
    let quad = |n: u32| {
        let (i, j) = (n / tube, n % tube);
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let mut triangles: Vec<[u32; 3]> = (0..around * tube).flat_map(quad).collect();
    if holes {
        let mut n = 0;
        triangles.retain(|_| {
            n += 1;
            n % 97 != 0
        });
    }
    TriMesh { positions: (0..around * tube).map(vertex).collect(), triangles }
}

/// A cylinder of radius 1 from z = 0 to 1, closed below and open above; the open rim has `sides` edges.
pub fn open_tube(sides: u32) -> TriMesh {
    let at = |n: u32, z: f64| {
        let angle = std::f64::consts::TAU * n as f64 / sides as f64;
        DVec3::new(angle.cos(), angle.sin(), z)
    };
    let mut positions = vec![DVec3::ZERO];
    positions.extend((0..sides).flat_map(|n| [at(n, 0.0), at(n, 1.0)]));
    let triangles = (0..sides).flat_map(|n| {
        let [a, b] = [n, (n + 1) % sides].map(|n| 2 * n + 1);
        [[0, b, a], [a, b, a + 1], [b, b + 1, a + 1]]
    });
    TriMesh { positions, triangles: triangles.collect() }
}

/// A mesh with all that comes before its vote.
pub struct Ready {
    pub survey: Survey,
    pub planes: Vec<Plane>,
}

pub fn layers(mesh: &TriMesh, lattice: &Lattice) -> Vec<Layers> {
    ldis(mesh, lattice, 1, &Progress::none()).expect("nobody stops it")
}

pub fn ready(mesh: TriMesh, resolution: u32) -> Ready {
    let bounds = mesh.bounds().expect("triangles");
    let lattice = Lattice::around(&bounds, bounds.size().max_element() / resolution as f64);
    let survey = Survey::of_mesh(&mesh, &lattice, &Progress::none()).expect("nobody stops it");
    let planes = survey.planes();
    Ready { survey, planes }
}

impl Ready {
    pub fn votes(&self) -> Grid<Votes> {
        let winding = self.survey.winding(&Progress::none());
        self.survey.votes(VoteRule::default(), &winding, &Progress::none()).expect("nobody stops it")
    }
}
