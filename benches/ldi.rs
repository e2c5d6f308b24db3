//! Rays and spans of all 13 directions, on a torus of 65,536 triangles.

mod common;

use divan::Bencher;
use meshwright::ldi::{Expression, spans};

fn main() {
    divan::main();
}

#[divan::bench(args = [64, 128, 256, 512])]
fn rasterise(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, false), resolution);
    bencher.bench(|| common::layers(&ready.survey.soup.mesh, &ready.survey.lattice));
}

#[divan::bench(args = [64, 128, 256, 512])]
fn walk_spans(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, false), resolution);
    let layers = common::layers(&ready.survey.soup.mesh, &ready.survey.lattice);
    let walk = |layers| spans(layers, &ready.survey.soup.operands, &Expression::Operand(0));
    bencher.with_inputs(|| layers.clone()).bench_values(|layers| layers.into_iter().map(walk).collect::<Vec<_>>());
}
