//! Measures the convolution filter: how it converges, what a packet saves, what becomes of creases, and how far
//! interpolated distances are off.
//!
//! `cargo run --release --example filter -- MESH...`: the first of the meshes for all of it, the others for the last.
//! With `--interpolated` before them only the last is measured.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use meshwright::field::filter::{Adaptive, Distances, FilterOptions, Kernel, Sampling, WIDEST, filtered};
use meshwright::field::{Body, MeshField, Shared, Solid, scattered};
use meshwright::io;
use meshwright::mesh::Bounds;
use meshwright::pipeline::field_values;
use meshwright::sdf::exact::{ExactDistance, PointSign};

/// Samples of what counts as the true value.
const REFERENCE: usize = 1 << 14;
/// Points at which values are compared.
const POINTS: usize = 200;
/// Points at which interpolated distances are compared.
const COMPARED: usize = 10_000;
/// Points at which times are taken.
const TIMED: usize = 1600;

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths: Vec<String> = std::env::args().skip(1).collect();
    if paths.first().is_some_and(|first| first == "--interpolated") {
        return interpolated(&paths.split_off(1));
    }
    let path = paths.first().cloned().ok_or("the name of a mesh is wanted")?;
    let mesh = io::read(&path)?.mesh;
    let bounds = mesh.bounds().ok_or("the mesh is empty")?;
    let cap = 0.05 * bounds.diagonal();
    let field: Shared = Arc::new(MeshField::new(&mesh, PointSign::Pseudonormal, 0));
    let cube: Shared = Arc::new(Body { solid: Solid::Box { size: DVec3::ONE }, centre: DVec3::ZERO, axis: 2 });
    let cube_bounds = Bounds { min: DVec3::splat(-0.6), max: DVec3::splat(0.6) };
    convergence("a box", &cube, &cube_bounds, 0.1)?;
    convergence(&path, &field, &bounds, cap)?;
    let distance = ExactDistance::of(&mesh, PointSign::Pseudonormal);
    rate(&distance, &field, &bounds, cap)?;
    creases(&cube, 0.1)?;
    interpolated(&paths)
}

/// How far filtered values by interpolated distances are from those by distances that are asked for, over the cap.
fn interpolated(paths: &[String]) -> Result<(), Box<dyn Error>> {
    println!("\n| mesh | cap, of the diagonal | cells | mean | 99.9 % | greatest | times as fast |");
    println!("|---|---|---|---|---|---|---|");
    for path in paths {
        let mesh = io::read(path)?.mesh;
        let bounds = mesh.bounds().ok_or("the mesh is empty")?;
        let field: Shared = Arc::new(MeshField::new(&mesh, PointSign::Pseudonormal, 0));
        for share in [0.02, 0.035, 0.07] {
            let cap = share * bounds.diagonal();
            let near = Bounds { min: bounds.min - 2.0 * cap, max: bounds.max + 2.0 * cap };
            let points = scattered(COMPARED, 5, &near);
            let values = |distances| -> Result<(Vec<f64>, f64), Box<dyn Error>> {
                let field = filtered(field.clone(), &FilterOptions { distances, ..FilterOptions::new(cap) })?;
                let started = Instant::now();
                Ok((field_values(&field, &points), started.elapsed().as_secs_f64()))
            };
            let (truth, slow) = values(Distances::Asked)?;
            for cells in [16, 24, 32] {
                let (found, quick) = values(Distances::interpolated(cells))?;
                let mut off: Vec<f64> = found.iter().zip(&truth).map(|(a, b)| (a - b).abs() / cap).collect();
                off.sort_by(f64::total_cmp);
                let (mean, last) = (off.iter().sum::<f64>() / off.len() as f64, off.len() - 1);
                let (most, nearly) = (off[last], off[last * 999 / 1000]);
                println!(
                    "| {path} | {share} | {cells} | {mean:.2e} | {nearly:.2e} | {most:.2e} | {:.1} |",
                    slow / quick
                );
            }
        }
    }
    Ok(())
}

fn drawn(count: usize, mirrored: bool) -> Sampling {
    Sampling::Drawn { count, seed: 0, mirrored }
}

/// Root mean square and greatest difference from the filter with very many samples, over the cap.
fn convergence(name: &str, field: &Shared, bounds: &Bounds, cap: f64) -> Result<(), Box<dyn Error>> {
    let points = scattered(POINTS, 1, bounds);
    let values = |sampling, kernel, adaptive| -> Result<Vec<f64>, Box<dyn Error>> {
        let sign_safe = matches!(kernel, Kernel::Gaussian { .. });
        let options = FilterOptions {
            sampling,
            kernel,
            adaptive,
            sign_safe,
            distances: Distances::Asked,
            ..FilterOptions::new(cap)
        };
        let field = filtered(field.clone(), &options)?;
        Ok(field_values(&field, &points))
    };
    println!("{name}: rms and greatest error over the cap at {POINTS} points\n");
    println!("| samples | bump | bump, mirrored | Gaussian | Gaussian, mirrored |");
    println!("|---|---|---|---|---|");
    let kernels = [Kernel::Bump { width: WIDEST * cap }, Kernel::gaussian(cap / 4.0)];
    let truth = [values(drawn(REFERENCE, true), kernels[0], None)?, values(drawn(REFERENCE, true), kernels[1], None)?];
    let error = |values: &[f64], truth: &[f64]| {
        let off = || values.iter().zip(truth).map(|(a, b)| (a - b).abs() / cap);
        let rms = (off().map(|e| e * e).sum::<f64>() / values.len() as f64).sqrt();
        format!("{rms:.2e}, {:.2e}", off().fold(0.0, f64::max))
    };
    for count in [32, 64, 92, 256] {
        let mut row = format!("| {count}");
        for (kernel, truth) in kernels.into_iter().zip(&truth) {
            for mirrored in [false, true] {
                row += &format!(" | {}", error(&values(drawn(count, mirrored), kernel, None)?, truth));
            }
        }
        println!("{row} |");
    }
    for side in [3, 4, 6] {
        let of = |k: usize| values(Sampling::Regular { side }, kernels[k], None).map(|v| error(&v, &truth[k]));
        println!("| grid of {side}³ | {} | | {} | |", of(0)?, of(1)?);
    }
    let adaptive = values(drawn(92, true), kernels[0], Some(Adaptive { least: 32 }))?;
    println!("| 32 to 92 | | {} | | |\n", error(&adaptive, &truth[0]));
    Ok(())
}

fn rate(distance: &ExactDistance, field: &Shared, bounds: &Bounds, cap: f64) -> Result<(), Box<dyn Error>> {
    let points = scattered(TIMED, 2, bounds);
    let mut values = vec![0.0; points.len()];
    let started = Instant::now();
    let sum: f64 = points.iter().filter_map(|&p| distance.at(p)).map(|nearest| nearest.signed).sum();
    let single = started.elapsed().as_secs_f64() / TIMED as f64;
    println!("one distance query {:.2} us (sum {sum:.3})\n", single * 1e6);
    println!("| samples | us | over as many single queries of the same points |");
    println!("|---|---|---|");
    for count in [32, 64, 92, 256] {
        let field = filtered(
            field.clone(),
            &FilterOptions { sampling: drawn(count, true), distances: Distances::Asked, ..FilterOptions::new(cap) },
        )?;
        let started = Instant::now();
        field.values(&points, &mut values);
        let packet = started.elapsed().as_secs_f64() / TIMED as f64;
        // The same displaced points, one by one, near enough: the kernel's spread around each point.
        let around = scattered(count, 3, &Bounds { min: DVec3::splat(-0.4 * cap), max: DVec3::splat(0.4 * cap) });
        let started = Instant::now();
        let all = points.iter().take(TIMED / 8).flat_map(|p| around.iter().map(move |d| *p + *d));
        let sum: f64 = all.filter_map(|p| distance.at(p)).map(|nearest| nearest.signed).sum();
        let separate = started.elapsed().as_secs_f64() / (TIMED / 8) as f64;
        // Eight neighbouring points at a time, as a lattice asks.
        let step = 0.03 * cap;
        let corner = |k: usize| DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64) * step;
        let blocks: Vec<DVec3> =
            points.iter().take(TIMED / 8).flat_map(|p| (0..8).map(move |k| *p + corner(k))).collect();
        let started = Instant::now();
        blocks.chunks(8).zip(values.chunks_mut(8)).for_each(|(block, values)| field.values(block, values));
        let eight = started.elapsed().as_secs_f64() / blocks.len() as f64;
        println!(
            "| {count} | {:.1} | {:.3} | {:.1} | {:.3} ({sum:.1}) |",
            packet * 1e6,
            packet / separate,
            eight * 1e6,
            eight / separate
        );
    }
    println!();
    Ok(())
}

/// Greatest second differences across the medial planes of a box.
fn creases(cube: &Shared, cap: f64) -> Result<(), Box<dyn Error>> {
    let filtered = filtered(cube.clone(), &FilterOptions::new(cap))?;
    println!("| spacing | second difference | filtered | times smaller |");
    println!("|---|---|---|---|");
    for step in [1.0 / 32.0, 1.0 / 64.0, 1.0 / 128.0] {
        let most = |field: &Shared| {
            let line = (-40..=40).map(|k| DVec3::new(0.2 + f64::from(k) * 0.002, 0.25, 0.03));
            let second = |p: DVec3| {
                let at = |k: f64| field.value(p + DVec3::X * (k * step));
                (at(1.0) - 2.0 * at(0.0) + at(-1.0)).abs() / step
            };
            line.map(second).fold(0.0, f64::max)
        };
        let (plain, smooth) = (most(cube), most(&filtered));
        println!("| {step} | {plain:.4} | {smooth:.4} | {:.1} |", plain / smooth);
    }
    Ok(())
}
