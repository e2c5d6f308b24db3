//! Filters that interpolate: as near to the exact way as they promise, and the same whatever was asked before.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use meshwright::field::filter::{Distances, FilterError, FilterOptions, Sampling, filtered};
use meshwright::field::{MeshField, Placement, Shared, placed, scattered};
use meshwright::mesh::{Bounds, TriMesh};
use meshwright::sdf::exact::PointSign;

use super::support::{cube, mesh};
use crate::common::shapes;

const CAP: f64 = 0.2;
/// Across a crease of the distance the mean gradient of 64 samples is as uncertain by itself.
const GRADIENT: f64 = 0.1;

fn with(field: &Shared, distances: Distances) -> Shared {
    let sampling = Sampling::Drawn { count: 64, seed: 0, mirrored: true };
    filtered(field.clone(), &FilterOptions { sampling, distances, ..FilterOptions::new(CAP) }).unwrap()
}

fn around(mesh: &TriMesh) -> Bounds {
    let bounds = mesh.bounds().unwrap();
    Bounds { min: bounds.min - 2.0 * CAP, max: bounds.max + 2.0 * CAP }
}

fn meshes() -> [(&'static str, TriMesh); 3] {
    [("torus", shapes::torus(64, 32)), ("gear", shapes::turned(shapes::gear(12), 0.3)), ("knot", shapes::knot(96, 16))]
}

#[test]
fn a_thousandth_of_the_cap_from_the_exact_way_and_the_same_near_the_surface() {
    for (name, shape) in meshes() {
        let plain = mesh(&shape);
        let (asked, quick) = (with(&plain, Distances::Asked), with(&plain, Distances::default()));
        let mut far = 0;
        for p in scattered(600, 4, &around(&shape)) {
            let (wanted, found) = (asked.sample(p), quick.sample(p));
            assert!((wanted.value - found.value).abs() <= 1e-3 * CAP, "{name}: {} not {}", found.value, wanted.value);
            assert!(
                wanted.gradient.distance(found.gradient) < GRADIENT,
                "{name}: {} {}",
                found.gradient,
                wanted.gradient
            );
            assert!((quick.value(p) - found.value).abs() < 1e-9, "{name}");
            let own = plain.value(p).abs();
            if own < 0.4 * CAP {
                assert_eq!(quick.value(p), asked.value(p), "{name}");
            }
            far += usize::from(own > 0.5 * CAP && quick.value(p) != asked.value(p));
        }
        assert!(far > 100, "{name}: {far} values were interpolated");
    }
}

#[test]
fn neither_threads_nor_memory_nor_what_was_asked_before_change_a_value() {
    let (_, shape) = meshes().into_iter().nth(1).unwrap();
    let plain = mesh(&shape);
    let points = scattered(400, 5, &around(&shape));
    let values = |distances, threads: usize, backwards: bool| {
        let field = with(&plain, distances);
        let mut order: Vec<usize> = (0..points.len()).collect();
        if backwards {
            order.reverse();
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let ordered: Vec<DVec3> = order.iter().map(|&k| points[k]).collect();
        let found = pool.install(|| meshwright::pipeline::field_values(&field, &ordered));
        let mut values = vec![0.0; points.len()];
        order.iter().zip(found).for_each(|(&k, value)| values[k] = value);
        values
    };
    let once = values(Distances::default(), 1, false);
    assert_eq!(once, values(Distances::default(), 2, true));
    for memory in [0, 64 * 120_000] {
        assert_eq!(once, values(Distances::Interpolated { cells: 24, memory }, 2, false), "{memory}");
    }
}

#[test]
fn a_mesh_tells_the_values_over_a_lattice_as_it_does_at_its_points() {
    for (name, shape) in meshes() {
        let small = Placement { scale: 0.7, shift: DVec3::new(0.1, -0.2, 0.3), ..Placement::moved(DVec3::ZERO) };
        for field in [mesh(&shape), placed(mesh(&shape), small)] {
            let (h, origin) = (0.03, DVec3::new(-0.4, -0.3, -0.5));
            let cubes = field.over(origin, h).expect("a closed mesh has a quick way");
            for cube in [IVec3::ZERO, IVec3::new(-1, 0, 1), IVec3::new(3, -2, 0), IVec3::new(8, 2, 1)] {
                let found = cubes.cube(cube).expect("near enough");
                assert_eq!(found.len(), 32 * 32 * 32);
                for (n, value) in (0..).zip(found).step_by(7) {
                    let at = cube * 29 - 1 + IVec3::new(n % 32, n / 32 % 32, n / 1024);
                    let p = origin + h * at.as_dvec3();
                    let wanted = field.value(p);
                    assert!((wanted - f64::from(value)).abs() < 1e-3 * h, "{name}: {value} not {wanted} at {p}");
                }
            }
            assert!(cubes.cube(IVec3::splat(1 << 20)).is_none());
        }
    }
}

#[test]
fn what_cannot_be_interpolated_is_asked() {
    let none = Distances::Interpolated { cells: 0, memory: 1 << 20 };
    let options = FilterOptions { distances: none, ..FilterOptions::new(CAP) };
    assert_eq!(filtered(cube(1.0), &options).map(|_| ()), Err(FilterError::Cells));
    assert_eq!(Distances::interpolated(0), Distances::Asked);
    let unsigned: Shared = Arc::new(MeshField::new(&shapes::torus(32, 16), PointSign::Unsigned, 0));
    for field in [cube(1.0), unsigned, Arc::new(MeshField::new(&TriMesh::default(), PointSign::Pseudonormal, 0))] {
        let (asked, quick) = (with(&field, Distances::Asked), with(&field, Distances::default()));
        for p in scattered(50, 6, &Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) }) {
            assert_eq!(asked.value(p), quick.value(p));
        }
    }
}
