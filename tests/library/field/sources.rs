//! What every field promises: packets, ranges, Lipschitz bound, gradients, filling.

use glam::{DVec3, IVec3};
use meshwright::field::{Ball, Extent, FillOptions, Sample, fill, scattered};
use meshwright::lattice::{Lattice, Slot, brick_of};
use meshwright::mesh::{Bounds, ClosestTree};
use meshwright::progress::Progress;
use proptest::prelude::*;

use super::support::{all, lattice, mesh, room};
use crate::common::proofs::packets_find_what_single_searches_find;
use crate::common::shapes;

/// Points, half of them near each other.
fn places(count: usize, seed: u64) -> Vec<DVec3> {
    let near = Bounds { min: DVec3::splat(0.3), max: DVec3::splat(0.5) };
    let mut places = scattered(count, seed, &room());
    places.extend(scattered(count, seed + 1, &near));
    places
}

#[test]
fn a_packet_says_what_each_point_says() {
    let points = places(40, 1);
    for (name, field) in all() {
        let mut values = vec![0.0; points.len()];
        let mut samples = vec![Sample::default(); points.len()];
        field.values(&points, &mut values);
        field.samples(&points, &mut samples);
        for (k, &p) in points.iter().enumerate() {
            assert_eq!(field.value(p), values[k], "{name} at {p}");
            assert!((samples[k].value - values[k]).abs() < 1e-12, "{name} at {p}");
        }
    }
}

#[test]
fn packets_of_a_tree_find_what_single_searches_find() {
    packets_find_what_single_searches_find(&shapes::scan(), 1.0);
    packets_find_what_single_searches_find(&shapes::torus_of(400, 3, 1.0, 1e-7), 1.0);
    packets_find_what_single_searches_find(&shapes::torus(64, 32), 1e6);
    let mut found = vec![];
    ClosestTree::<[DVec3; 3]>::new(Vec::new()).nearest_all(&[DVec3::ZERO], &mut found);
    assert!(found.is_empty());
}

/// Central differences, where the field is smooth over twice their step.
#[test]
fn gradients_are_those_of_the_values() {
    let step = 1e-6;
    // What is interpolated is single precision: `interpolated.rs` compares its gradients with those that are asked for.
    for (name, field) in all().into_iter().filter(|(name, _)| *name != "interpolated filter") {
        let mut judged = 0;
        for p in scattered(150, 7, &room()) {
            let around = |step: f64| {
                DVec3::from_array([0, 1, 2].map(|axis| {
                    let e = DVec3::AXES[axis] * step;
                    (field.value(p + e) - field.value(p - e)) / (2.0 * step)
                }))
            };
            let (narrow, wide) = (around(step), around(30.0 * step));
            let scale = 1.0 + narrow.length();
            if (narrow - wide).length() < 1e-5 * scale {
                judged += 1;
                let found = field.sample(p).gradient;
                let allowed = if name == "filtered adaptively" { 0.15 } else { 1e-3 };
                assert!((found - narrow).length() < allowed * scale, "{name} at {p}: {found} instead of {narrow}");
            }
        }
        assert!(judged > 50, "{name}: only {judged} smooth places");
    }
}

#[test]
fn values_stay_in_their_ranges() {
    let unit = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
    for (name, field) in all() {
        for (k, centre) in scattered(60, 11, &room()).into_iter().enumerate() {
            let radius = [0.01, 0.1, 0.3, 1.0][k % 4];
            let range = field.range(&Ball { centre, radius });
            let inside = scattered(30, k as u64, &unit).into_iter().filter(|d| d.length() <= 1.0);
            for p in inside.map(|d| centre + d * radius) {
                let value = field.value(p);
                // Sampled values are single precision.
                let rounding = 1e-6;
                assert!(
                    value >= range.min - rounding && value <= range.max + rounding,
                    "{name}: {value} at {p} is not in {range:?} around {centre}, {radius}"
                );
            }
        }
    }
}

#[test]
fn no_field_is_steeper_than_it_says() {
    for (name, field) in all() {
        let most = field.lipschitz();
        let points = places(150, 17);
        for pair in points.windows(2) {
            let [a, b] = [field.value(pair[0]), field.value(pair[1])];
            assert!((a - b).abs() <= most * pair[0].distance(pair[1]) * (1.0 + 1e-6) + 1e-6, "{name}: {a} and {b}");
        }
    }
}

#[test]
fn nothing_is_inside_beyond_the_extent() {
    for (name, field) in all() {
        let outside = |p: DVec3| match field.extent() {
            Extent::Empty => true,
            Extent::Within(b) => p.cmplt(b.min).any() || p.cmpgt(b.max).any(),
            Extent::Unbounded => false,
        };
        for p in scattered(2000, 23, &room()).into_iter().filter(|&p| outside(p)) {
            assert!(field.value(p) > -1e-6, "{name}: {} at {p}", field.value(p));
        }
    }
}

#[test]
fn filling_finds_all_values_in_the_band_and_all_sides() {
    let lattice = lattice(0.1);
    for (name, field) in all() {
        for band in [Some(0.25), None] {
            let grid =
                fill(&*field, &lattice, &FillOptions { band, max_memory: None }, &Progress::none()).unwrap().grid;
            let band = band.unwrap_or(f64::INFINITY);
            let voxels = lattice.dims.element_product();
            for n in (0..voxels).step_by(31) {
                let voxel = IVec3::new(
                    n % lattice.dims.x,
                    n / lattice.dims.x % lattice.dims.y,
                    n / lattice.dims.x / lattice.dims.y,
                );
                let value = field.value(lattice.to_model(voxel.as_dvec3()));
                let found = f64::from(grid.get(voxel));
                let held = value.clamp(-band, band);
                assert!((found - held).abs() < 1e-6, "{name} at {voxel}: {found} instead of {held}");
            }
        }
    }
}

#[test]
fn filling_follows_the_surface_and_refuses_what_does_not_fit() {
    let torus = mesh(&shapes::torus_of(60, 30, 1.0, 0.3));
    let stored = |h: f64, max_memory: Option<u64>| {
        let lattice = Lattice::around(&torus.extent().bounds().unwrap(), h);
        let options = FillOptions { band: Some(1.8 * h), max_memory };
        fill(&*torus, &lattice, &options, &Progress::none()).map(|field| field.grid.values.len())
    };
    let (coarse, fine) = (stored(0.02, None).unwrap(), stored(0.01, None).unwrap());
    assert!(fine < 5 * coarse, "{coarse} bricks, and {fine} at half the spacing");
    let error = stored(0.01, Some(1_000_000)).unwrap_err();
    assert!(error.to_string().contains("1 MB are allowed"), "{error}");
}

/// The inside of a complement has no stored brick before it.
#[test]
fn what_is_inside_without_an_end_is_inside() {
    let lattice = lattice(0.05);
    let all = all();
    let (_, field) = all.iter().find(|(name, _)| *name == "complement").unwrap();
    let options = FillOptions { band: Some(0.1), max_memory: None };
    let grid = fill(&**field, &lattice, &options, &Progress::none()).unwrap().grid;
    assert_eq!(grid.bricks.slot(brick_of(IVec3::ONE)), Slot::Inside);
    assert_eq!(grid.bricks.slot(brick_of(lattice.dims / 2)), Slot::Outside);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Triangles of any shape and place, also degenerate ones.
    #[test]
    fn packets_agree_on_any_soup(
        soup in proptest::collection::vec(proptest::array::uniform9(-3i8..4), 1..40),
        points in proptest::collection::vec(proptest::array::uniform3(-4.0..4.0f64), 1..40),
        scale in prop_oneof![Just(1.0), Just(1e-7), Just(1e9)],
    ) {
        let corner = |t: &[i8; 9], k: usize| DVec3::new(t[3 * k].into(), t[3 * k + 1].into(), t[3 * k + 2].into()) * scale;
        let tree = ClosestTree::new(soup.iter().map(|t| [0, 1, 2].map(|k| corner(t, k))).collect());
        let points: Vec<DVec3> = points.into_iter().map(|p| DVec3::from_array(p) * scale).collect();
        let mut found = Vec::new();
        tree.nearest_all(&points, &mut found);
        for (p, found) in points.iter().zip(&found) {
            prop_assert_eq!(tree.nearest(*p), Some(*found));
        }
    }
}
