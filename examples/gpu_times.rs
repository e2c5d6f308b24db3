//! Times of the layered depth images, and of prism scan conversion, on the graphics processor and on the main one, for docs/benchmarks.md:
//! `cargo run --release --example gpu_times -- MESH RESOLUTION...`

use std::time::Instant;

use meshwright::gpu::{self, Device, GpuMethod, GpuOptions, Wanted, ldis};
use meshwright::lattice::{BRICK_VOXELS, Lattice};
use meshwright::ldi::{self, Crossed, Hit, Layers, assemble, snap};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions};
use meshwright::sdf::prism::{Prisms, Table, prism};
use meshwright::survey::Survey;
use meshwright::vote::{VoteRule, Votes};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: gpu_times MESH RESOLUTION...")?;
    let mesh = meshwright::io::read(&path)?.mesh;
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
        prisms(&device, &mesh, &lattice)?;
    }
    Ok(())
}

/// The distance within a tenth of the longest side, by prisms on either processor; for closed meshes.
fn prisms(device: &Device, mesh: &TriMesh, lattice: &Lattice) -> Result<(), Box<dyn std::error::Error>> {
    let band = f64::from(lattice.dims.max_element()) / 10.0;
    let room = band.ceil() as i32;
    let origin = lattice.origin - glam::DVec3::splat(f64::from(room) * lattice.h);
    let lattice = Lattice { origin, dims: lattice.dims + 2 * room, ..*lattice };
    let options = ExactOptions { band: Band::Within(band), max_memory: None };
    let cpu = best(|| Ok(prism(mesh, &lattice, &options, &Progress::none())?))?;
    let drawn = |timings| gpu::prism(device, mesh, &lattice, &options, timings, &Progress::none());
    let time = best(|| Ok(drawn(false)?.0))?;
    let setup = best(|| {
        let prisms = Prisms::new(mesh, &lattice, band);
        let table = Table::new(&prisms.frusta, lattice.dims.z);
        Ok(table.sweep().map(|listed| listed.len()).sum::<usize>())
    })?;
    let prisms = Prisms::new(mesh, &lattice, band);
    let polygons: usize = Table::new(&prisms.frusta, lattice.dims.z).sweep().map(|listed| listed.len()).sum();
    let (_, report) = drawn(true)?;
    println!(
        "  prisms: processor {cpu:.0} ms, drawn {time:.0} ms, of it frusta and edge tables {setup:.0} ms; {} frusta, {polygons} polygons, \
         {:.1} MB up, {:.1} MB down",
        prisms.frusta.len(),
        report.bytes_up as f64 * 1e-6,
        report.bytes_down as f64 * 1e-6
    );
    for pass in report.passes {
        println!("    {}: {} passes, {:.1} ms", pass.pass, pass.count, 1e3 * pass.seconds);
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
    let survey = Survey::of_mesh(mesh, lattice, &Progress::none())?;
    let winding = survey.winding(&Progress::none());
    let bricks = survey.votes(VoteRule::default(), &winding, &Progress::none())?.bricks.active().len();
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
