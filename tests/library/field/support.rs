//! Fields to test with, and how they are looked at.

use std::sync::Arc;

use glam::DVec3;
use meshwright::field::algebra::{self, average, complement, difference, morph, offset, ramp, shell, union};
use meshwright::field::blend::{blend_difference, blend_intersection, blend_union};
use meshwright::field::blob::{self, BlobOptions, blob_difference, blob_intersection, blob_union};
use meshwright::field::filter::{
    Adaptive, Distances, FilterOptions, Kernel, Sampling, SmoothOptions, filtered, smooth,
};
use meshwright::field::{
    Body, FillOptions, Level, MeshField, Placement, PointField, Sampled, Shared, Solid, fill, level, material, placed,
    scattered,
};
use meshwright::lattice::Lattice;
use meshwright::mesh::{Bounds, TriMesh, ValidateOptions, Validity, validate};
use meshwright::progress::Progress;
use meshwright::sdf::exact::PointSign;

use crate::common::shapes;

pub fn body(solid: Solid, centre: [f64; 3]) -> Shared {
    Arc::new(Body { solid, centre: DVec3::from_array(centre), axis: 2 })
}

pub fn sphere(radius: f64, centre: [f64; 3]) -> Shared {
    body(Solid::Sphere { radius }, centre)
}

pub fn cube(size: f64) -> Shared {
    body(Solid::Box { size: DVec3::splat(size) }, [0.0; 3])
}

pub fn mesh(mesh: &TriMesh) -> Shared {
    Arc::new(MeshField::new(mesh, PointSign::Pseudonormal, 0))
}

/// The box in which fields are looked at.
pub fn room() -> Bounds {
    Bounds { min: DVec3::splat(-1.6), max: DVec3::splat(1.6) }
}

pub fn lattice(h: f64) -> Lattice {
    Lattice::around(&room(), h)
}

/// A field of each kind, by name.
pub fn all() -> Vec<(&'static str, Shared)> {
    let (ball, block) = (|| sphere(0.8, [0.2, 0.1, 0.0]), || cube(1.3));
    let torus = || mesh(&shapes::torus_of(40, 20, 0.9, 0.3));
    let mirrored = Sampling::Drawn { count: 16, seed: 3, mirrored: true };
    let filter = |field, options| filtered(field, &options).unwrap();
    let options = FilterOptions { sampling: mirrored, ..FilterOptions::new(0.3) };
    let safe = FilterOptions { kernel: Kernel::gaussian(0.2), sign_safe: true, ..options };
    let asked = FilterOptions { distances: Distances::Asked, ..options };
    let many = Sampling::Drawn { count: 64, seed: 0, mirrored: true };
    let adaptive = FilterOptions { adaptive: Some(Adaptive { least: 24 }), sampling: many, ..asked };
    let regular = FilterOptions { sampling: Sampling::Regular { side: 4 }, ..options };
    let blobs = BlobOptions { radius: 0.6, gain: 0.6 };
    let grid = fill(&*ball(), &lattice(0.1), &FillOptions { band: Some(0.5), max_memory: None }, &Progress::none());
    vec![
        ("ball", ball()),
        ("box", block()),
        (
            "cylinder",
            Arc::new(Body { solid: Solid::Cylinder { radius: 0.5, height: 1.2 }, centre: DVec3::ZERO, axis: 0 }),
        ),
        ("torus", Arc::new(Body { solid: Solid::Torus { major: 0.9, minor: 0.3 }, centre: DVec3::X * 0.1, axis: 1 })),
        ("half space", body(Solid::HalfSpace, [0.0, 0.0, 0.2])),
        ("mesh", torus()),
        ("points", Arc::new(PointField::new(&scattered(40, 5, &room())))),
        ("sampled", Arc::new(Sampled::new(grid.unwrap()))),
        ("offset", offset(torus(), 0.2)),
        ("shell", shell(torus(), 0.2)),
        ("complement", complement(ball())),
        ("union", union(vec![ball(), torus()])),
        ("difference", difference(block(), vec![torus(), ball()])),
        ("exactly one", algebra::symmetric_difference(vec![block(), torus(), ball()])),
        (
            "two apart, grown",
            offset(algebra::intersection(vec![sphere(0.5, [-0.6, 0.0, 0.0]), sphere(0.5, [0.6, 0.0, 0.0])]), 0.4),
        ),
        ("average", average(vec![ball(), block(), torus()], &[1.0, 1.0, 2.0])),
        ("morph", morph(torus(), ball(), 0.3)),
        ("morph by radii", algebra::morph_by_radii([torus(), ball()], [0.3, 0.8], 0.6)),
        ("ramp", ramp(block(), ball(), 0, -0.5, 0.5)),
        ("blend", blend_union(torus(), sphere(0.5, [0.9, 0.0, 0.3]), 0.3)),
        ("blended intersection", blend_intersection(block(), ball(), 0.3)),
        ("blended difference", blend_difference(block(), ball(), 0.2)),
        ("blobs", blob_union(vec![ball(), torus()], blobs)),
        ("blobs of little gain", blob::blob(torus(), BlobOptions { gain: 0.3, ..blobs })),
        ("common blob", blob_intersection(vec![ball(), torus()], blobs)),
        ("bitten blob", blob_difference(block(), vec![sphere(0.3, [0.6, 0.5, 0.0])], blobs)),
        ("compared", blob::compare(block(), ball(), blobs)),
        ("material", material(vec![ball(), torus()], vec![2.0, 5.0])),
        ("filtered", filter(block(), options)),
        ("filtered mesh", filter(torus(), asked)),
        ("interpolated filter", filter(torus(), options)),
        ("filtered safely", filter(block(), safe)),
        ("filtered adaptively", filter(torus(), adaptive)),
        ("filtered on a grid", filter(block(), regular)),
        ("filtered twice", filter(filter(block(), options), options)),
        ("moved", placed(block(), Placement::moved(DVec3::new(0.1, 0.2, -0.3)))),
        ("larger", placed(torus(), Placement::scaled(1.2, DVec3::X * 0.3))),
        ("turned", placed(block(), Placement::turned(1, 0.7, DVec3::Y * 0.2))),
        ("smoothed", smooth(block(), ball(), &SmoothOptions { depth: 0.2, radius: 0.2, sampling: mirrored })),
    ]
}

/// The zero level, and what it is worth.
pub fn surface(field: &Shared, h: f64) -> (Level, Validity) {
    let extent = field.extent().bounds().expect("the field has an end");
    let lattice = Lattice::around(&extent, h);
    let level = level(&**field, &lattice, None, &Progress::none()).unwrap();
    let options = ValidateOptions { self_intersections: true, weld: false };
    let validity = validate(&level.contour.mesh, &options, &Progress::none()).unwrap();
    (level, validity)
}
