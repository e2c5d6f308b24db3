//! Made triangles: on rays, on edges of one another, doubled, without area, far away.

use glam::{DVec3, IVec3};
use meshwright::gpu::{GpuLimits, GpuOptions};
use meshwright::lattice::Lattice;
use meshwright::mesh::TriMesh;
use proptest::prelude::*;

use crate::common::gpu::{BOTH, by, compare, device};
use crate::common::shapes;

fn lattice(dims: IVec3) -> Lattice {
    Lattice { origin: DVec3::ZERO, h: 1.0, dims }
}

/// A coordinate: mostly on rays, sometimes between them, rarely far outside.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => (-2i32..12).prop_map(f64::from),
        3 => (-8i32..48).prop_map(|n| f64::from(n) / 4.0),
        2 => -2.0f64..12.0,
        1 => -9000.0f64..9000.0,
        1 => (0i32..10, -3i32..4).prop_map(|(n, k)| f64::from(n) + f64::from(k) / 65536.0),
    ]
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let positions =
        prop::collection::vec([coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array), 3..12);
    (positions, prop::collection::vec(prop::array::uniform3(0usize..1000), 1..40), any::<bool>()).prop_map(
        |(positions, picks, doubled)| {
            let count = positions.len();
            let mut triangles: Vec<[u32; 3]> = picks.iter().map(|t| t.map(|n| (n % count) as u32)).collect();
            if doubled {
                let turned: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
                triangles.extend(turned);
            }
            TriMesh { positions, triangles }
        },
    )
}

#[test]
fn random_soups_have_the_same_crossings() {
    let Some(device) = device() else { return };
    proptest!(ProptestConfig { cases: 48, ..ProptestConfig::default() }, |(
        soup in soup(),
        dims in prop::sample::select(vec![[9, 7, 8], [1, 1, 1], [3, 12, 2]]),
        factor in 1u32..3,
        tile_side in prop::sample::select(vec![u32::MAX, 7]),
    )| {
        let limits = GpuLimits { tile_side, ..GpuLimits::default() };
        let options = BOTH.map(|method| GpuOptions { limits, ..by(method) });
        compare(device, "soup", &soup, &lattice(IVec3::from_array(dims)), factor, &options);
    });
}

#[test]
fn boxes_with_sides_in_common_lose_no_layer() {
    let Some(device) = device() else { return };
    let mut mesh = TriMesh::default();
    for n in 0..5 {
        // Each box twice, and its neighbour's side on its own.
        for _ in 0..2 {
            let low = DVec3::new(2.0 * f64::from(n), 1.0, 1.5);
            mesh.append(&shapes::cuboid(low, low + DVec3::new(2.0, 4.0, 3.0)));
        }
    }
    let layers = compare(device, "boxes", &mesh, &lattice(IVec3::new(12, 8, 7)), 1, &BOTH.map(by));
    assert_eq!(layers[0].deepest(), 20, "two boxes at each of five places along x");
}

#[test]
fn slivers_and_needles_across_the_lattice_are_not_lost() {
    let Some(device) = device() else { return };
    let mut mesh = TriMesh::default();
    for n in 0..60 {
        let (t, thin) = (f64::from(n) * 0.37, 2f64.powi(-(n % 17)));
        let at = (mesh.positions.len()) as u32;
        let start = DVec3::new(-3.0 + t, -5.0, 2.0);
        mesh.positions.extend([start, start + DVec3::new(40.0 - t, 90.0, 20.0), start + DVec3::new(thin, 0.0, thin)]);
        mesh.triangles.push([at, at + 1, at + 2]);
    }
    compare(device, "slivers", &mesh, &lattice(IVec3::new(40, 80, 30)), 2, &BOTH.map(by));
}

#[test]
fn an_empty_soup_has_no_crossings() {
    let Some(device) = device() else { return };
    let layers = compare(device, "nothing", &TriMesh::default(), &lattice(IVec3::splat(4)), 1, &BOTH.map(by));
    assert!(layers.iter().all(|layers| layers.hits.is_empty()));
}
