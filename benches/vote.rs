//! Votes near the surface: of a closed torus, where the rays suffice, and of one with 675 holes.

mod common;

use divan::Bencher;

fn main() {
    divan::main();
}

#[divan::bench(args = [64, 128, 256])]
fn closed(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, false), resolution);
    bencher.bench(|| ready.votes());
}

#[divan::bench(args = [64, 128, 256])]
fn with_holes(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, true), resolution);
    bencher.bench(|| ready.votes());
}
