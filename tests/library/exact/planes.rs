//! Some planes of a lattice alone: the values of the whole, to the last bit.

use meshwright::TriMesh;
use meshwright::glam::DVec3;
use meshwright::pipeline::{
    DistanceError, DistanceMethod, DistanceOptions, DistanceOutcome, DistanceSign, VoxelSize, distance, plan_distance,
};
use meshwright::progress::Progress;

use crate::common::shapes::ball;

fn made(mesh: &TriMesh, options: &DistanceOptions) -> DistanceOutcome {
    distance(mesh, options, &Progress::none()).expect("a field")
}

fn values(outcome: &DistanceOutcome) -> Vec<Vec<u32>> {
    let plane = |z| {
        let mut values = Vec::new();
        outcome.plane(z, &mut values);
        values.into_iter().map(f32::to_bits).collect()
    };
    (0..outcome.field.lattice.dims.z as usize).map(plane).collect()
}

/// A lumpy ball far from the origin, with a smaller one in it that faces inwards.
fn hollow() -> TriMesh {
    let mut mesh = ball(4, |p| 0.5 + 0.1 * (9.0 * p.x).sin() * (7.0 * p.z).cos());
    let inner = ball(3, |_| 0.2);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(inner.positions);
    mesh.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| v + first)));
    mesh.positions.iter_mut().for_each(|p| *p += DVec3::new(100.0, -20.0, 3.0));
    mesh
}

#[test]
fn slabs_joined_are_the_whole() {
    let mesh = hollow();
    for (sign, band) in [
        (DistanceSign::Pseudonormal, Some(0.04)),
        (DistanceSign::Pseudonormal, None),
        (DistanceSign::Votes, Some(0.1)),
        (DistanceSign::Winding, Some(0.04)),
        (DistanceSign::Levels, Some(0.04)),
    ] {
        let options = DistanceOptions { sign, band, ..DistanceOptions::new(VoxelSize::Along(70)) };
        let whole = made(&mesh, &options);
        let all = values(&whole);
        let count = all.len() as u32;
        for length in [8, 40] {
            let (mut joined, mut stored) = (Vec::new(), Vec::new());
            for from in (0..count).step_by(length) {
                let planes = Some([from, (from + length as u32).min(count)]);
                let part = made(&mesh, &DistanceOptions { planes, ..options });
                let low = whole.field.lattice.origin.z + f64::from(from) * whole.field.lattice.h;
                assert_eq!(part.field.lattice.origin.z, low);
                stored.push(part.report.stored);
                joined.extend(values(&part));
            }
            assert!(joined == all, "{sign:?} {band:?} {length}");
            // Each holds its own planes and no more.
            assert!(stored.iter().sum::<usize>() <= whole.report.stored, "{stored:?}");
        }
    }
}

#[test]
fn planes_cost_what_lies_in_them() {
    let mesh = hollow();
    let options = DistanceOptions {
        sign: DistanceSign::Pseudonormal,
        band: Some(0.02),
        ..DistanceOptions::new(VoxelSize::Along(400))
    };
    let cost = |planes| plan_distance(&mesh, &DistanceOptions { planes, ..options }).expect("a plan").stored;
    let (whole, count) = (cost(None), plan_distance(&mesh, &options).expect("a plan").dims[2] as u32);
    let parts: Vec<u64> = (0..count).step_by(64).map(|z| cost(Some([z, (z + 64).min(count)]))).collect();
    assert!(parts.iter().all(|&part| part < whole / 2), "{parts:?} of {whole}");
    // Each reaches a little into its neighbours.
    let sum: u64 = parts.iter().sum();
    assert!(sum >= whole && sum < 2 * whole, "{sum} {whole}");
}

#[test]
fn planes_that_are_not_there_or_cut_bricks_are_refused() {
    let mesh = hollow();
    let exact = DistanceOptions::new(VoxelSize::Along(30));
    let refused = |planes, method| {
        let options = DistanceOptions { planes: Some(planes), method, ..exact };
        matches!(distance(&mesh, &options, &Progress::none()), Err(DistanceError::Planes { .. }))
    };
    assert!(!refused([8, 11], DistanceMethod::Exact));
    assert!(refused([4, 16], DistanceMethod::Exact) && refused([8, 8], DistanceMethod::Exact));
    assert!(refused([0, 1000], DistanceMethod::Exact) && refused([0, 8], DistanceMethod::Robust));
}
