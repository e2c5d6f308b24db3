//! Votes near the surface: of a closed torus, where the rays suffice, and of one with 675 holes.

mod common;

use divan::Bencher;
use glam::{DVec3, IVec3};
use meshwright::ldi::Expression;
use meshwright::progress::Progress;

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

/// Lids over a hole with so many boundary edges: all the lattice edges through the missing top of a
/// tube, some 5,000.
#[divan::bench(args = [200, 2000, 20000], sample_count = 10)]
fn lids(bencher: Bencher<'_, '_>, rim: u32) {
    let ready = common::ready(common::open_tube(rim), 80);
    let (winding, lattice) = (ready.survey.winding(&Progress::none()), ready.survey.lattice);
    let dims = lattice.dims;
    let top = lattice.to_lattice(DVec3::splat(1.0)).z.floor() as i32;
    let edges = (0..dims.y).flat_map(|y| (0..dims.x).map(move |x| IVec3::new(x, y, top)));
    let crossing = |v: IVec3| winding.crossing(v, v + IVec3::Z, &Expression::Operand(0)).expect("nobody stops it");
    let edges: Vec<IVec3> = edges.filter(|&v| crossing(v).is_some()).collect();
    bencher.bench_local(|| edges.iter().filter(|&&v| crossing(v).is_some()).count());
}
