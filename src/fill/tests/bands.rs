//! Bands between two rims, against the edges that they have to meet and areas that are known.

use std::f64::consts::TAU;

use super::*;
use crate::fill::band;

/// Two tubes about the z axis with a gap between z = 0 and z = `gap`: the lower one has `counts[0]` sides, the upper one `counts[1]`, of these radii.
fn tubes(counts: [u32; 2], radii: [f64; 2], gap: f64) -> TriMesh {
    let mut mesh = TriMesh::default();
    for (k, (count, radius)) in counts.into_iter().zip(radii).enumerate() {
        let first = mesh.positions.len() as u32;
        let at = |n: u32, z: f64| {
            let turn = f64::from(n) / f64::from(count) * TAU + 0.1;
            DVec3::new(radius * turn.cos(), radius * turn.sin(), z)
        };
        let [low, high] = if k == 0 { [-1.0, 0.0] } else { [gap, gap + 1.0] };
        mesh.positions.extend((0..count).map(|n| at(n, low)));
        mesh.positions.extend((0..count).map(|n| at(n, high)));
        for n in 0..count {
            let [a, b] = [first + n, first + (n + 1) % count];
            mesh.triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
        }
    }
    mesh
}

/// The rims at the gap: the upper one of the lower tube, and the lower one of the other.
fn at_gap(mesh: &TriMesh, gap: f64) -> [Rim; 2] {
    let found = rims(mesh);
    assert_eq!(found.len(), 4);
    let at = |z: f64| found.iter().find(|rim| (rim.centre.z - z).abs() < 1e-9).expect("a rim").clone();
    [at(0.0), at(gap)]
}

/// Asserts that a band meets every edge of both rims once, from the other side, and has every other edge twice.
fn assert_band(rims: [&Rim; 2], lids: &[Lid; 2]) {
    let mut edges: FxHashMap<[u32; 2], i32> = FxHashMap::default();
    for t in lids.iter().flat_map(|lid| &lid.triangles) {
        (0..3).for_each(|k| *edges.entry([t[k], t[(k + 1) % 3]]).or_default() += 1);
    }
    assert!(edges.values().all(|&count| count == 1));
    let mut open: Vec<[u32; 2]> = edges.keys().filter(|&&[a, b]| !edges.contains_key(&[b, a])).copied().collect();
    let rim_edges = rims.into_iter().flat_map(|rim| {
        let ends = rim.vertices.iter().zip(rim.vertices.iter().cycle().skip(1));
        ends.map(|(&a, &b)| [a, b]).collect::<Vec<_>>()
    });
    let mut wanted: Vec<[u32; 2]> = rim_edges.collect();
    open.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(open, wanted);
    for (rim, lid) in rims.iter().zip(lids) {
        assert_eq!(lid.triangles.len(), rim.vertices.len());
        assert!(lid.positions.is_empty());
    }
}

#[test]
fn a_band_meets_both_rims_and_is_as_small_as_the_gap() {
    for (counts, radii, gap) in [
        ([24, 24], [1.0, 1.0], 0.3),
        ([24, 24], [1.0, 1.0], 1.5),
        ([60, 17], [1.0, 1.0], 0.2),
        ([5, 300], [1.0, 1.2], 0.1),
        ([48, 48], [1.0, 0.4], 0.05),
    ] {
        let mesh = tubes(counts, radii, gap);
        let found = at_gap(&mesh, gap);
        let both = [&found[0], &found[1]];
        let lids = band(&Surroundings::new(&mesh), both).expect("a band");
        assert_band(both, &lids);
        // The frustum between the two circles; polygons are smaller, and chords between unlike ones are longer.
        let slant = (radii[0] - radii[1]).hypot(gap);
        let truth = TAU / 2.0 * (radii[0] + radii[1]) * slant;
        let area = lids[0].area + lids[1].area;
        let most = if counts[0].min(counts[1]) > 16 { 1.02 } else { 2.5 };
        assert!(area > 0.9 * truth && area < most * truth, "{counts:?} {radii:?} {gap}: {area} for {truth}");
    }
}

/// Long rims are joined over the shorter edge each.
#[test]
fn long_rims_are_joined_as_well() {
    let mesh = tubes([2000, 1900], [1.0, 1.0], 0.05);
    let found = at_gap(&mesh, 0.05);
    let both = [&found[0], &found[1]];
    let lids = band(&Surroundings::new(&mesh), both).expect("a band");
    assert_band(both, &lids);
    let area = lids[0].area + lids[1].area;
    assert!((area / (TAU * 0.05) - 1.0).abs() < 0.01, "{area}");
}

#[test]
fn what_a_band_cannot_join_is_said() {
    let mesh = tubes([12, 12], [1.0, 1.0], 0.3);
    let found = at_gap(&mesh, 0.3);
    let around = Surroundings::new(&mesh);
    assert_eq!(band(&around, [&found[0], &found[0]]), Err(NoLid::NoLoop));
    // The two ends of one tube are joined by its own edges where it is one ring of triangles: each band repeats them.
    let ends = rims(&mesh);
    let of_lower: Vec<&Rim> = ends.iter().filter(|rim| rim.centre.z < 0.1).collect();
    assert_eq!(band(&around, [of_lower[0], of_lower[1]]), Err(NoLid::Folded));
}
