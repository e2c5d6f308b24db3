//! Validation of a closed mesh, self-intersections included.

mod common;

use divan::Bencher;
use meshwright::mesh::{ValidateOptions, validate};
use meshwright::progress::Progress;

fn main() {
    divan::main();
}

#[divan::bench(args = [128, 256, 512])]
fn validate_torus(bencher: Bencher<'_, '_>, around: u32) {
    let mesh = common::torus(around, false);
    bencher.bench(|| validate(&mesh, &ValidateOptions::default(), &Progress::none()));
}
