//! The robust distance, marching it to a band of 8 h, and the exact distance within that band.

mod common;

use divan::Bencher;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions, Sign, exact};
use meshwright::sdf::{RobustOptions, march, robust};

fn main() {
    divan::main();
}

#[divan::bench(args = [64, 128, 256])]
fn robust_field(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, true), resolution);
    let votes = ready.votes();
    bencher.bench(|| {
        robust(
            &ready.survey.spans,
            &ready.planes,
            (&votes, &ready.survey.lattice),
            &RobustOptions::default(),
            &Progress::none(),
        )
    });
}

#[divan::bench(args = [64, 128])]
fn march_to_8(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, false), resolution);
    let near = robust(
        &ready.survey.spans,
        &ready.planes,
        (&ready.votes(), &ready.survey.lattice),
        &RobustOptions::default(),
        &Progress::none(),
    );
    let near = near.expect("nobody stops it");
    bencher.bench(|| march(&near, 8.0, &Progress::none()));
}

#[divan::bench(args = [64, 128, 256])]
fn exact_within_8(bencher: Bencher<'_, '_>, resolution: u32) {
    let ready = common::ready(common::torus(256, false), resolution);
    let options = ExactOptions { band: Band::Within(8.0), max_memory: None };
    bencher.bench(|| {
        exact(&ready.survey.soup.mesh, &ready.survey.lattice, Sign::Pseudonormal, &options, &Progress::none())
    });
}
