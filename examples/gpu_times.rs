//! Times of exact fields and of layered depth images on the graphics processor and on the main one, for docs/benchmarks.md and tools/gpu_bench.sh:
//! `cargo run --release --example gpu_times -- MESH [--rows] [--peel] [--field N]... [--ldi N]...`. With `--rows` only the rows of the table, tabs between.

use std::path::Path;
use std::time::Instant;

use meshwright::gpu::{Device, FieldOptions, GpuMethod, GpuOptions, GpuReport, Wanted, distances, ldis};
use meshwright::lattice::{BRICK_VOXELS, Lattice};
use meshwright::ldi::{self, Crossed, Hit, Layers, assemble, snap};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions, Sign, exact};
use meshwright::survey::Survey;
use meshwright::vote::{VoteRule, Votes};
use rayon::prelude::*;

type Done<T> = Result<T, Box<dyn std::error::Error>>;

/// What is asked for.
#[derive(Default)]
struct Asked {
    mesh: String,
    rows: bool,
    peel: bool,
    fields: Vec<f64>,
    ldis: Vec<f64>,
}

fn main() -> Done<()> {
    let asked = asked()?;
    let mesh = meshwright::io::read(&asked.mesh)?.mesh;
    let start = Instant::now();
    let device = Device::open(&Wanted::Any)?;
    if !asked.rows {
        println!("{}, opened in {:.0} ms; times in ms, bytes in MB", device.entry().name, ms(start));
        println!("mesh\twhat\tat\tmain processor\tall\tpasses\tup\tdown\tnote");
    }
    let name = Path::new(&asked.mesh).file_stem().map_or_else(String::new, |name| name.to_string_lossy().into());
    for &at in &asked.fields {
        field(&device, (&name, &mesh), at, &asked)?;
    }
    for &at in &asked.ldis {
        layers(&device, (&name, &mesh), at, &asked)?;
    }
    Ok(())
}

fn asked() -> Done<Asked> {
    let mut asked = Asked::default();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || arguments.next().ok_or("a number is missing")?.parse::<f64>().map_err(|e| e.to_string());
        match argument.as_str() {
            "--rows" => asked.rows = true,
            "--peel" => asked.peel = true,
            "--field" => asked.fields.push(number()?),
            "--ldi" => asked.ldis.push(number()?),
            _ => asked.mesh = argument,
        }
    }
    if asked.mesh.is_empty() {
        Err("usage: gpu_times MESH [--rows] [--peel] [--field N]... [--ldi N]...".into())
    } else {
        Ok(asked)
    }
}

/// One row, and the passes.
fn row(what: &str, (name, at): (&str, f64), [cpu, gpu]: [f64; 2], report: &GpuReport, note: &str, rows: bool) {
    let passes: f64 = report.passes.iter().map(|pass| 1e3 * pass.seconds).sum();
    let [up, down] = [report.bytes_up, report.bytes_down].map(|bytes| bytes as f64 * 1e-6);
    println!("{name}\t{what}\t{at}\t{cpu:.0}\t{gpu:.0}\t{passes:.1}\t{up:.1}\t{down:.1}\t{note}");
    for pass in report.passes.iter().filter(|_| !rows) {
        println!("    {}: {} passes, {:.1} ms", pass.pass, pass.count, 1e3 * pass.seconds);
    }
}

/// The distance within a tenth of the longest side.
fn field(device: &Device, (name, mesh): (&str, &TriMesh), at: f64, asked: &Asked) -> Done<()> {
    let lattice = lattice(mesh, at)?;
    let band = f64::from(lattice.dims.max_element()) / 10.0;
    let room = band.ceil() as i32;
    let origin = lattice.origin - glam::DVec3::splat(f64::from(room) * lattice.h);
    let lattice = Lattice { origin, dims: lattice.dims + 2 * room, ..lattice };
    let options = ExactOptions { band: Band::Within(band), max_memory: None };
    let cpu = best(|| Ok(exact(mesh, &lattice, Sign::Pseudonormal, &options, &Progress::none())?))?;
    let made = |timings| {
        let both = (&options, &FieldOptions { timings, ..FieldOptions::default() });
        distances(device, mesh, &lattice, Sign::Pseudonormal, both, &Progress::none())
    };
    let gpu = best(|| Ok(made(false)?))?;
    let timed = made(true)?;
    let note = format!("{} of {} voxels in doubt", timed.doubtful, timed.measured);
    row("field", (name, at), [cpu, gpu], &timed.report, &note, asked.rows);
    Ok(())
}

/// The layered depth images in all directions.
fn layers(device: &Device, (name, mesh): (&str, &TriMesh), at: f64, asked: &Asked) -> Done<()> {
    let lattice = lattice(mesh, at)?;
    let cpu = best(|| Ok(ldi::ldis(mesh, &lattice, 1, &Progress::none())?))?;
    let methods = [(GpuMethod::Scatter, "LDIs"), (GpuMethod::Peel, "LDIs, peeled")];
    for (method, what) in methods.into_iter().take(1 + usize::from(asked.peel)) {
        let run = |timings| {
            let options = GpuOptions { method, timings, ..GpuOptions::default() };
            ldis(device, mesh, &lattice, 1, &options, &Progress::none())
        };
        let gpu = best(|| Ok(run(false)?.0))?;
        let (layers, report) = run(true)?;
        let crossings: usize = layers.iter().map(|layers| layers.hits.len()).sum();
        let deepest = layers.iter().map(|layers| layers.deepest()).max().unwrap_or(0);
        let note = format!(
            "{crossings} crossings, at most {deepest} on a ray; {:.0} until the card had sent all",
            1e3 * report.sent
        );
        row(what, (name, at), [cpu, gpu], &report, &note, asked.rows);
    }
    if !asked.rows {
        stages(mesh, &lattice, ldi::ldis(mesh, &lattice, 1, &Progress::none())?)?;
    }
    Ok(())
}

fn lattice(mesh: &TriMesh, at: f64) -> Done<Lattice> {
    let bounds = mesh.bounds().ok_or("no triangles")?;
    Ok(Lattice::around(&bounds, bounds.size().max_element() / at))
}

/// What stays with the main processor whoever rasterises, and the bytes of what later stages work on.
fn stages(mesh: &TriMesh, lattice: &Lattice, layers: Vec<Layers>) -> Done<()> {
    let vertices = snap(&mesh.positions, lattice);
    let crossed: Vec<Crossed<'_>> = layers.iter().map(crossed).collect();
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
fn crossed(layers: &Layers) -> Crossed<'_> {
    Crossed {
        low: layers.low,
        size: layers.size.map(|n| n as u32),
        first: 0,
        ends: layers.offsets[1..].into(),
        triangles: layers.hits.iter().map(|hit| hit.triangle()).collect(),
    }
}

fn ms(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

/// Milliseconds of the best of three.
fn best<T>(mut work: impl FnMut() -> Done<T>) -> Done<f64> {
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let start = Instant::now();
        work()?;
        best = best.min(ms(start));
    }
    Ok(best)
}
