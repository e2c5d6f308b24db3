//! Prism scan conversion against the exact field.

use glam::DVec3;
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::exact::{Band, ExactOptions};
use meshwright::sdf::prism::prism;
use proptest::prelude::*;

use crate::common::exact::{Case, cases, from_prisms, lattice};
use crate::common::shapes::{ball, turned};

#[test]
fn prisms_give_the_exact_field_of_hard_meshes_and_parts() {
    // Nothing in single precision tells the sides of sheets 1e-7 apart.
    for Case { name, mesh, lattice: near, band } in cases().into_iter().filter(|case| !case.name.starts_with("sheets"))
    {
        let wide = lattice(&mesh, 0.6 * near.h, 12);
        for (around, band) in [(near, band), (wide, 12.0)] {
            let (most, wrong, count) = from_prisms(&mesh, &around, band);
            assert!(most < 1e-4 && wrong == 0 && count > 1000, "{name} {band}: {most} h, {wrong} of {count} sides");
        }
    }
}

#[test]
fn a_step_lower_than_a_voxel_hides_nothing() {
    // Beside a small concave neighbour, the paper's half-angle plane would cut off what is nearest to the large triangle.
    let outline = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.51), (1.0, 0.51), (1.0, 0.5), (0.0, 0.5)];
    let positions = [0.0, 1.0].into_iter().flat_map(|z| outline.map(|(x, y)| DVec3::new(x, y, z))).collect();
    let cap = [[0, 4, 5], [0, 1, 4], [1, 3, 4], [1, 2, 3]];
    let mut triangles: Vec<[u32; 3]> = cap.iter().flat_map(|&[a, b, c]| [[a, c, b], [a + 6, b + 6, c + 6]]).collect();
    triangles.extend((0..6).flat_map(|k| [[k, (k + 1) % 6, k + 6], [(k + 1) % 6, (k + 1) % 6 + 6, k + 6]]));
    let mesh = turned(TriMesh { positions, triangles }, 0.4);
    let (most, wrong, count) = from_prisms(&mesh, &lattice(&mesh, 0.03, 16), 16.0);
    assert!(most < 1e-4 && wrong == 0, "{most} h, {wrong} of {count} sides");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mesh = ball(3, |p| 0.4 + 0.1 * (7.0 * p.x).sin());
    let options = ExactOptions { band: Band::Within(5.0), max_memory: None };
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let field = pool.install(|| prism(&mesh, &lattice(&mesh, 0.02, 5), &options, &Progress::none()));
        field.expect("a field").grid.values.concat().iter().map(|value| value.to_bits()).collect::<Vec<u32>>()
    };
    assert_eq!(of(1), of(3));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn prisms_give_the_exact_field_of_random_stars(
        waves in prop::collection::vec((0.0f64..12.0, 0.0f64..12.0, 0.0f64..12.0, 0.02f64..0.2), 1..4),
        band in 1.0f64..14.0,
        angle in 0.0f64..3.0,
    ) {
        let radius = |p: DVec3| {
            0.5 + waves.iter().map(|w| w.3 * (w.0 * p.x + w.1 * p.y).sin() * (w.2 * p.z).cos()).sum::<f64>()
        };
        let mesh = turned(ball(3, |p| radius(p).max(0.05)), angle);
        let (most, wrong, count) = from_prisms(&mesh, &lattice(&mesh, 0.04, band as i32), band);
        prop_assert!(most < 1e-4 && wrong == 0, "{} h, {} of {} sides", most, wrong, count);
    }
}
