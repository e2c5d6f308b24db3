//! The whole repair of a torus of 65,536 triangles, closed and with 675 holes.

mod common;

use divan::Bencher;
use meshwright::pipeline::{Options, VoxelSize, repair};
use meshwright::progress::Progress;

fn main() {
    divan::main();
}

#[divan::bench(args = [64, 128, 256], sample_count = 10)]
fn closed(bencher: Bencher<'_, '_>, resolution: u32) {
    let mesh = common::torus(256, false);
    bencher.bench(|| repair(&mesh, &Options::new(VoxelSize::Along(resolution)), &Progress::none()));
}

#[divan::bench(args = [64, 128, 256], sample_count = 10)]
fn with_holes(bencher: Bencher<'_, '_>, resolution: u32) {
    let mesh = common::torus(256, true);
    bencher.bench(|| repair(&mesh, &Options::new(VoxelSize::Along(resolution)), &Progress::none()));
}
