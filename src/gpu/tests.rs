//! The shaders' arithmetic against Rust's, on the best adapter of this machine. Where there is none these tests say that they are left out,
//! unless `MESHWRIGHT_GPU=required` promises one.

use std::io::Write;

use proptest::prelude::*;

use super::run::{Run, Source};
use super::*;
use crate::lattice::Lattice;

/// A device of the test's own: some tests destroy theirs.
fn open() -> Option<Device> {
    let required = std::env::var_os("MESHWRIGHT_GPU").is_some_and(|value| value == "required");
    match Device::open(&Wanted::Any) {
        Ok(device) => Some(device),
        Err(GpuError::NoAdapter { .. }) if !required => {
            let thread = std::thread::current();
            let test = thread.name().unwrap_or("a test");
            // Around the harness, which keeps what a test that passes prints.
            let line = format!("left out: {test}: no graphics adapter was found\n");
            let _ = std::io::stderr().write_all(line.as_bytes());
            None
        }
        Err(error) => panic!("{error}: {}", error.hint()),
    }
}

/// a b, and a b - c d with what is said of it, as the shader computes them.
fn on_device(device: &Device, given: &[[i32; 4]]) -> Vec<(i64, i64, [f32; 3])> {
    let progress = Progress::none();
    let mut run = Run::new(device, false, &progress);
    let pipeline = shaders::compute(&device.raw, shaders::CHECK_WIDE, "check", &[]);
    let words: Vec<u32> = given.iter().flatten().map(|&n| n as u32).collect();
    let numbers = run.upload(&words, wgpu::BufferUsages::STORAGE);
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let [found, judged] = [(); 2].map(|()| run.buffer(words.len() as u64, usage));
    let buffers = [&numbers, &found, &judged].map(|buffer| buffer.as_entire_binding());
    let group = run.bind(&pipeline.get_bind_group_layout(0), &buffers);
    let mut encoder = run.encoder();
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(given.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    let count = words.len() as u64;
    let read = run.finish(encoder, &[Source::Words(&found, count), Source::Words(&judged, count)]).expect("a device");
    let wide = |words: &[u32]| (u64::from(words[1]) << 32 | u64::from(words[0])) as i64;
    let each = read[0].chunks_exact(4).zip(read[1].chunks_exact(4));
    each.map(|(n, judged)| (wide(&n[..2]), wide(&n[2..]), [0, 1, 2].map(|k| f32::from_bits(judged[k])))).collect()
}

/// Numbers with many bits, few bits, and at the ends; products of two differ by less than 2⁶³.
fn number() -> impl Strategy<Value = i32> {
    let most = i32::MAX;
    prop_oneof![
        any::<i32>().prop_map(|n| n.max(-i32::MAX)),
        -3i32..4,
        (0u32..31, any::<bool>()).prop_map(|(bit, minus)| if minus { -(1 << bit) } else { 1 << bit }),
        prop::sample::select(vec![most, -most, 0xffff, 0x10000, -0x10000]),
    ]
}

#[test]
fn wide_integers_are_those_of_rust() {
    let Some(device) = open() else { return };
    let given = prop::collection::vec(prop::array::uniform4(number()), 200);
    proptest!(ProptestConfig { cases: 12, ..ProptestConfig::default() }, |(given in given)| {
        for (n, (product, difference, [value, negative, zero])) in given.iter().zip(on_device(&device, &given)) {
            let [a, b, c, d] = n.map(i64::from);
            prop_assert_eq!(product, a * b);
            let exact = i128::from(a * b) - i128::from(c * d);
            let Ok(wanted) = i64::try_from(exact) else { continue };
            prop_assert_eq!(difference, wanted, "{:?}", n);
            prop_assert_eq!((negative, zero), (f32::from(u8::from(wanted < 0)), f32::from(u8::from(wanted == 0))));
            prop_assert!((f64::from(value) - wanted as f64).abs() <= 3e-7 * (wanted as f64).abs(), "{} {}", value, wanted);
        }
    });
}

#[test]
fn the_scan_sums_what_comes_before() {
    let Some(device) = open() else { return };
    let progress = Progress::none();
    for count in [1usize, 3, 1023, 1024, 1025, 70_000, 1_100_000] {
        let mut run = Run::new(&device, false, &progress);
        let words: Vec<u32> = (0..count as u32).map(|n| n.wrapping_mul(2_654_435_761) >> 29).collect();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let values = run.upload(&words, usage);
        let mut encoder = run.encoder();
        let total = device.scatter().scan.encode(&mut run, &mut encoder, &values, count as u64);
        let sources = [Source::Words(&values, count as u64), Source::Words(&total, 1)];
        let read = run.finish(encoder, &sources).expect("a device");
        let mut sum = 0;
        for (n, word) in words.iter().enumerate() {
            assert_eq!(read[0][n], sum, "{n} of {count}");
            sum += word;
        }
        assert_eq!(read[1], [sum]);
    }
}

fn triangle() -> (TriMesh, Lattice) {
    let positions = [[0.0, 0.0, 0.0], [5.0, 0.0, 1.0], [0.0, 5.0, 2.0]].map(glam::DVec3::from_array).to_vec();
    let lattice = Lattice { origin: glam::DVec3::splat(-1.0), h: 1.0, dims: glam::IVec3::splat(8) };
    (TriMesh { positions, triangles: vec![[0, 1, 2]] }, lattice)
}

#[test]
fn a_lost_device_is_an_error_for_good() {
    let Some(device) = open() else { return };
    let (mesh, lattice) = triangle();
    let run = || ldis(&device, &mesh, &lattice, 1, &GpuOptions::default(), &Progress::none()).map(|_| ());
    assert_eq!(run(), Ok(()));
    device.raw.destroy();
    for _ in 0..2 {
        let error = run().expect_err("the device is gone");
        assert!(matches!(error, GpuError::Lost { .. } | GpuError::Validation { .. }), "{error:?}");
    }
}

#[test]
fn what_the_driver_refuses_is_an_error_once() {
    let Some(device) = open() else { return };
    let progress = Progress::none();
    let mut run = Run::new(&device, false, &progress);
    let buffer = run.upload(&[1, 2, 3, 4], wgpu::BufferUsages::STORAGE);
    // It may not be copied from.
    let refused = run.finish(run.encoder(), &[Source::Words(&buffer, 4)]);
    assert!(matches!(refused, Err(GpuError::Validation { .. })), "{refused:?}");
    let (mesh, lattice) = triangle();
    assert!(ldis(&device, &mesh, &lattice, 1, &GpuOptions::default(), &Progress::none()).is_ok());
}

#[test]
fn a_buffer_beyond_all_memory_is_an_error() {
    let Some(device) = open() else { return };
    let progress = Progress::none();
    let run = Run::new(&device, false, &progress);
    let _ = run.buffer(u64::MAX / 8, wgpu::BufferUsages::STORAGE);
    let error = device.check().expect_err("there is no such memory");
    assert!(matches!(error, GpuError::OutOfMemory | GpuError::Validation { .. }), "{error:?}");
}
