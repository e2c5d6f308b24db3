//! Contour and collapse of a bumpy torus in a 256 lattice.

use std::sync::{Arc, Mutex};

use divan::Bencher;
use glam::{DVec3, IVec3};
use meshwright::contour::{
    Contour, ContourOptions, Crossing, Ground, LatticeEdge, Merge, collapse_same_voxel, contour,
};
use meshwright::lattice::{Bricks, DistanceField, Grid, Lattice, voxel_in_brick};
use meshwright::mesh::Plane;
use meshwright::progress::Progress;
use rustc_hash::FxHashMap;

const N: i32 = 256;

fn main() {
    divan::main();
}

/// Signed distance to the torus, nearly, in voxels.
fn field(p: DVec3) -> f64 {
    let p = p - f64::from(N) / 2.0;
    let around = p.y.atan2(p.x);
    let across = DVec3::new(p.x.hypot(p.y) - 80.0, p.z, 0.0);
    let bumps = 4.0 * (14.0 * around).sin() * (6.0 * across.y.atan2(across.x)).cos();
    (across.length() - 40.0 - bumps) * 0.8
}

/// The tangent plane at `p`.
fn plane(p: DVec3) -> Plane {
    let slope = DVec3::AXES.map(|e| field(p + e * 0.01) - field(p - e * 0.01));
    let normal = DVec3::from_array(slope).normalize_or(DVec3::Z);
    Plane { normal, offset: normal.dot(p) }
}

/// Everything that is not part of the measured work.
struct Scene {
    lattice: Lattice,
    distance: DistanceField,
    /// Each crossing has its own plane.
    crossings: FxHashMap<LatticeEdge, Crossing>,
    planes: Vec<Plane>,
}

impl Scene {
    fn new() -> Self {
        let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: IVec3::splat(N) };
        let side = 0..N / 8;
        let all = side.clone().flat_map(|z| {
            let side = side.clone();
            side.clone().flat_map(move |y| side.clone().map(move |x| IVec3::new(x, y, z)))
        });
        let middle = |b: IVec3| field((b * 8).as_dvec3() + 3.5);
        let mut bricks = Bricks::new(all.clone().filter(|&b| middle(b).abs() < 16.0));
        all.filter(|&b| middle(b) < 0.0).for_each(|b| bricks.set_inside(b));
        let mut distance = Grid::filled(Arc::new(bricks), 0.0, -3.0, 3.0);
        let bricks = distance.bricks.clone();
        for (values, &b) in distance.values.iter_mut().zip(bricks.active()) {
            for (k, value) in (0..).zip(values) {
                *value = field((b * 8 + voxel_in_brick(k)).as_dvec3()) as f32;
            }
        }
        let distance = DistanceField::in_voxels(lattice, distance);
        let mut scene = Self { lattice, distance, crossings: FxHashMap::default(), planes: Vec::new() };
        let seen = Mutex::new(Vec::new());
        let note = |edge: LatticeEdge| {
            let (low, high) = (edge.voxel, edge.voxel + IVec3::AXES[edge.axis as usize]);
            let (low, high) = (field(low.as_dvec3()), field(high.as_dvec3()));
            seen.lock().unwrap().push((edge, low / (low - high)));
            None
        };
        contour(&scene.distance, &note, &ContourOptions::default(), &Progress::none()).unwrap();
        for (triangle, (edge, t)) in (0..).zip(seen.into_inner().unwrap()) {
            scene.crossings.insert(edge, Crossing { t, triangle: Some(triangle) });
            scene.planes.push(plane(edge.voxel.as_dvec3() + DVec3::AXES[edge.axis as usize] * t));
        }
        scene
    }

    fn contour(&self) -> Contour {
        let crossing = |edge: LatticeEdge| self.crossings.get(&edge).copied();
        contour(&self.distance, &crossing, &ContourOptions::default(), &Progress::none()).unwrap()
    }
}

#[divan::bench(sample_count = 20)]
fn raw(bencher: Bencher<'_, '_>) {
    let scene = Scene::new();
    bencher.bench(|| scene.contour());
}

#[divan::bench(sample_count = 20)]
fn collapse(bencher: Bencher<'_, '_>) {
    let scene = Scene::new();
    let planes = |ground: Ground| match ground {
        Ground::Triangle(triangle) => scene.planes.get(triangle as usize).copied(),
        Ground::Plane(_) | Ground::Unknown => None,
    };
    bencher
        .with_inputs(|| scene.contour())
        .bench_values(|raw| collapse_same_voxel(raw, &scene.lattice, &planes, Merge::All, &Progress::none()).unwrap());
}
