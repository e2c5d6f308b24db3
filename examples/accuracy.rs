//! Tables 1 and 2 of Bærentzen's paper for this program, as Markdown: `docs/accuracy.md`.
//!
//! ```sh
//! cargo run --release --example accuracy -- ../shared/data/broken/stanford-bunny.obj
//! ```
//!
//! Table 2 compares the robust distance field with the exact distance of a closed mesh: the nearest
//! of all triangles, by brute force over those that can be nearest for a brick, with the sign of
//! the winding number, which for a closed mesh is the sign that pseudonormals give.

use std::error::Error;
use std::path::Path;

use glam::{DVec3, IVec3};
use meshwright::lattice::{BRICK, Grid, Lattice, voxel_in_brick};
use meshwright::mesh::TriMesh;
use meshwright::pipeline::{Options, VoxelSize, repair};
use meshwright::progress::{Progress, Stage};
use meshwright::sdf::{RobustOptions, Trust, robust};
use meshwright::survey::Survey;
use meshwright::vote::{VoteRule, WindingTree};
use rayon::prelude::*;

const RESOLUTION: u32 = 256;

fn main() -> Result<(), Box<dyn Error>> {
    let testdata = Path::new(env!("CARGO_MANIFEST_DIR")).join("testdata");
    let torus = read(&testdata.join("torus.ply"))?;
    let cube = read(&testdata.join("noisy_cube.off"))?;
    println!("| model | faces | layers | LDI s | voting s | distance s | contour and collapse s |");
    println!("|---|---|---|---|---|---|---|");
    table_1("torus", &torus)?;
    table_1("noisy cube", &cube)?;
    if let Some(path) = std::env::args().nth(1) {
        table_1("bunny", &read(Path::new(&path))?)?;
    }
    println!();
    println!("| model | field | max error | min error | mean of absolute error | voxels |");
    println!("|---|---|---|---|---|---|");
    let ours = RobustOptions::default();
    let paper = RobustOptions { trust: Trust::Nothing, correct_estimates: true, ..ours };
    for (name, mesh) in [("torus", &torus), ("noisy cube", &cube)] {
        let model = Model::new(mesh)?;
        model.table_2(name, "default, uncorrected", &RobustOptions { correction_rounds: 0, ..ours });
        model.table_2(name, "default, corrected", &ours);
        model.table_2(name, "paper's rules, uncorrected", &RobustOptions { correction_rounds: 0, ..paper });
        model.table_2(name, "paper's rules, corrected", &paper);
    }
    Ok(())
}

fn read(path: &Path) -> Result<TriMesh, Box<dyn Error>> {
    Ok(meshwright::io::read(path)?.mesh)
}

fn table_1(name: &str, mesh: &TriMesh) -> Result<(), Box<dyn Error>> {
    let outcome = repair(mesh, &Options::new(VoxelSize::Along(RESOLUTION)), &Progress::none())?;
    let report = outcome.report;
    let seconds = |stages: &[Stage]| -> f64 {
        report.stages.iter().filter(|s| stages.contains(&s.stage)).map(|s| s.seconds).sum()
    };
    println!(
        "| {name} | {} | {} | {:.3} | {:.3} | {:.3} | {:.3} |",
        mesh.triangles.len(),
        report.ldi.layers,
        seconds(&[Stage::Orient, Stage::Ldi, Stage::Spans]),
        seconds(&[Stage::Vote]),
        seconds(&[Stage::Sdf]),
        seconds(&[Stage::Contour, Stage::Collapse]),
    );
    Ok(())
}

/// A closed mesh in a lattice, with all that the robust field is made of.
struct Model {
    mesh: TriMesh,
    lattice: Lattice,
    tree: WindingTree,
}

impl Model {
    /// The mesh in lattice coordinates, so that distances come out in h.
    fn new(mesh: &TriMesh) -> Result<Self, Box<dyn Error>> {
        let bounds = mesh.bounds().ok_or("no triangles")?;
        let lattice = Lattice::around(&bounds, bounds.size().max_element() / RESOLUTION as f64);
        let mut own = mesh.clone();
        own.positions.iter_mut().for_each(|p| *p = lattice.to_lattice(*p));
        let tree = WindingTree::new(&own, 0..own.triangles.len(), &Progress::none())?;
        let lattice = Lattice { origin: DVec3::ZERO, h: 1.0, dims: lattice.dims };
        Ok(Self { mesh: own, lattice, tree })
    }

    fn field(&self, options: &RobustOptions) -> Grid<f32> {
        let survey = Survey::of_mesh(&self.mesh, &self.lattice, &Progress::none()).expect("nobody stops it");
        let winding = survey.winding(&Progress::none());
        let votes = survey.votes(VoteRule::default(), &winding, &Progress::none()).expect("nobody stops it");
        robust(&survey.spans, &survey.planes(), (&votes, &self.lattice), options, &Progress::none())
            .expect("nobody stops it")
            .grid
    }

    fn table_2(&self, name: &str, field: &str, options: &RobustOptions) {
        let grid = self.field(options);
        let bricks = grid.bricks.active().par_iter().zip(&grid.values);
        let errors: Vec<f64> = bricks.flat_map_iter(|(&brick, values)| self.errors(&grid, brick, values)).collect();
        let max = errors.iter().copied().fold(f64::MIN, f64::max);
        let min = errors.iter().copied().fold(f64::MAX, f64::min);
        let mean = errors.iter().map(|e| e.abs()).sum::<f64>() / errors.len() as f64;
        println!("| {name} | {field} | {max:.4} | {min:.4} | {mean:.5} | {} |", errors.len());
    }

    /// Field less exact distance at the voxels of a brick that have a neighbour of the other sign.
    fn errors(&self, grid: &Grid<f32>, brick: IVec3, values: &[f32]) -> Vec<f64> {
        let steps = [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z];
        let near = self.can_be_nearest(brick);
        let voxels = values.iter().enumerate().map(|(n, &d)| (brick * BRICK + voxel_in_brick(n), d));
        let differs = |v: IVec3, d: f32| steps.iter().any(|&step| (grid.get(v + step) < 0.0) != (d < 0.0));
        voxels.filter(|&(v, d)| differs(v, d)).map(|(v, d)| d as f64 - self.exact(v.as_dvec3(), &near)).collect()
    }

    /// The triangles that can be nearest to a voxel of `brick`.
    fn can_be_nearest(&self, brick: IVec3) -> Vec<usize> {
        let centre = (brick * BRICK).as_dvec3() + 3.5;
        let radius = 3.5 * 3f64.sqrt();
        let distances: Vec<f64> =
            (0..self.mesh.triangles.len()).map(|t| to_triangle(centre, self.mesh.corners(t))).collect();
        let nearest = distances.iter().copied().fold(f64::MAX, f64::min);
        (0..distances.len()).filter(|&t| distances[t] <= nearest + 2.0 * radius).collect()
    }

    fn exact(&self, p: DVec3, near: &[usize]) -> f64 {
        let distance = near.iter().map(|&t| to_triangle(p, self.mesh.corners(t))).fold(f64::MAX, f64::min);
        if self.tree.winding(p) > 0.5 { -distance } else { distance }
    }
}

/// Distance of a point to a triangle.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let beside = |from: DVec3, to: DVec3| normal.cross(to - from).dot(p - from) < 0.0;
    if !beside(a, b) && !beside(b, c) && !beside(c, a) {
        return (p - a).dot(normal).abs() / normal.length();
    }
    let to_segment = |from: DVec3, to: DVec3| {
        let along = ((p - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
        p.distance(from.lerp(to, along))
    };
    to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
}
