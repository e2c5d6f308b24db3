//! Times of the layered depth images on the graphics processor and on the main one, for docs/benchmarks.md:
//! `cargo run --release --example gpu_times -- MESH RESOLUTION...`

use std::time::Instant;

use meshwright::gpu::{Device, GpuMethod, GpuOptions, Wanted, ldis};
use meshwright::lattice::Lattice;
use meshwright::ldi;
use meshwright::progress::Progress;

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
