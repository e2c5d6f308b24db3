//! Times of the layered depth images on the graphics processor and on the main one, for docs/benchmarks.md:
//! `cargo run --release --example gpu_times -- MESH RESOLUTION...`

use std::time::Instant;

use meshwright::gpu::{Device, GpuMethod, GpuOptions, Wanted, ldis};
use meshwright::lattice::{BRICK_VOXELS, Lattice};
use meshwright::ldi::{self, Crossed, Expression, Hit, Layers, Operands, Spans, assemble, snap};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::vote::{Jury, VoteRule, Votes, Winding, vote_near_surface};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: gpu_times MESH RESOLUTION...")?;
    let mesh = meshwright::io::read(std::path::Path::new(&path))?.mesh;
    let bounds = mesh.bounds().ok_or("no triangles")?;
    let start = Instant::now();
    let device = Device::open(&Wanted::Any)?;
    println!("{}, opened in {:.0} ms", device.entry().name, ms(start));
    for resolution in arguments {
        let lattice = Lattice::around(&bounds, bounds.size().max_element() / resolution.parse::<f64>()?);
        let cpu = best(|| Ok(ldi::ldis(&mesh, &lattice, 1, &Progress::none())?))?;
        println!("{resolution}: processor {cpu:.0} ms");
        let layers = ldi::ldis(&mesh, &lattice, 1, &Progress::none())?;
        stages(&mesh, &lattice, layers)?;
        for method in [GpuMethod::Scatter, GpuMethod::Peel] {
            let run = |timings| {
                ldis(
                    &device,
                    &mesh,
                    &lattice,
                    1,
                    &GpuOptions { method, timings, ..GpuOptions::default() },
                    &Progress::none(),
                )
            };
            let time = best(|| Ok(run(false)?.0))?;
            let (layers, report) = run(true)?;
            let crossings: usize = layers.iter().map(|layers| layers.hits.len()).sum();
            let deepest = layers.iter().map(|layers| layers.deepest()).max().unwrap_or(0);
            println!(
                "  {method:?} {time:.0} ms, {crossings} crossings, at most {deepest}, {:.1} MB up, {:.1} MB down",
                report.bytes_up as f64 * 1e-6,
                report.bytes_down as f64 * 1e-6
            );
            for pass in report.passes {
                println!("    {}: {} passes, {:.1} ms", pass.pass, pass.count, 1e3 * pass.seconds);
            }
        }
    }
    Ok(())
}

/// What stays with the main processor whoever rasterises, and the bytes of what later stages work on.
fn stages(mesh: &TriMesh, lattice: &Lattice, layers: Vec<Layers>) -> Result<(), Box<dyn std::error::Error>> {
    let vertices = snap(&mesh.positions, lattice);
    let crossed: Vec<Crossed> = layers.iter().map(crossed).collect();
    let time = best(|| {
        let part = |n: usize| {
            let (direction, crossed) = (layers[n].direction, std::slice::from_ref(&crossed[n]));
            assemble(&vertices, &mesh.triangles, lattice.dims, direction, 1, crossed)
        };
        (0..layers.len()).into_par_iter().map(part).collect::<Option<Vec<_>>>().ok_or("unsound".into())
    })?;
    let crossings: usize = layers.iter().map(|layers| layers.hits.len()).sum();
    let rays: usize = layers.iter().map(Layers::ray_count).sum();
    let operands = Operands::new([mesh.triangles.len()]);
    let expression = Expression::Operand(0);
    let spans: Vec<Spans> = layers.into_iter().map(|layers| ldi::spans(layers, &operands, &expression)).collect();
    let winding = Winding::new(mesh, &operands, lattice, &Progress::none());
    let rule = VoteRule::default();
    let jury = Jury { spans: &spans, operands: &operands, expression: &expression, rule, winding: &winding };
    let bricks = vote_near_surface(&jury, &Progress::none())?.bricks.active().len();
    let mb = |count: usize, size: usize| (count * size) as f64 * 1e-6;
    println!(
        "  depths and sorting {time:.0} ms; LDIs {:.1} MB, {bricks} bricks: votes {:.1} MB, field {:.1} MB",
        mb(crossings, size_of::<Hit>()) + mb(rays, 4),
        mb(bricks * BRICK_VOXELS, size_of::<Votes>()),
        mb(bricks * BRICK_VOXELS, 4)
    );
    Ok(())
}

/// What a device would send back for these layers.
fn crossed(layers: &Layers) -> Crossed {
    Crossed {
        low: layers.low,
        size: layers.size.map(|n| n as u32),
        ends: layers.offsets[1..].to_vec(),
        triangles: layers.hits.iter().map(|hit| hit.triangle()).collect(),
    }
}

fn ms(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

/// Milliseconds of the best of three.
fn best<T>(mut work: impl FnMut() -> Result<T, Box<dyn std::error::Error>>) -> Result<f64, Box<dyn std::error::Error>> {
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let start = Instant::now();
        work()?;
        best = best.min(ms(start));
    }
    Ok(best)
}
