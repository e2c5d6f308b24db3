//! The promise of the contour: for every pattern of signs a closed, oriented, 2-manifold surface
//! without degenerate or intersecting triangles, before and after the collapse.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contour_support::{Case, enclosed, fault, noise};
use glam::{DVec3, IVec3};
use meshwright::contour::{
    Collapsed, Contour, ContourOptions, Crossing, Ground, LatticeEdge, Merge, collapse_same_voxel, contour,
};
use meshwright::lattice::Slot;
use meshwright::mesh::{Plane, TriMesh};
use meshwright::progress::{Progress, Stopped};
use proptest::prelude::*;
use rayon::prelude::*;

fn check(case: &Case, what: &str) {
    let raw = case.contour();
    assert_eq!(raw.folded_loops, 0, "{what}");
    assert_eq!(raw.vertices.len(), raw.mesh.positions.len(), "{what}");
    assert_eq!(fault(&raw.mesh), None, "{what}");
    assert!(raw.mesh.triangles.is_empty() || enclosed(&raw.mesh) > 0.0, "{what}");
    let vertices = raw.mesh.positions.len();
    let euler = euler(&raw.mesh);
    let coarse = case.collapsed(raw);
    assert_eq!(fault(&coarse.contour.mesh), None, "collapsed, {what}");
    assert_eq!(coarse.contour.vertices.len(), coarse.contour.mesh.positions.len(), "collapsed, {what}");
    assert!(coarse.contour.mesh.positions.len() + coarse.merged <= vertices, "collapsed, {what}");
    assert_eq!(self::euler(&coarse.contour.mesh), euler, "collapsed, {what}");
}

/// Euler characteristic of a closed triangle mesh.
fn euler(mesh: &TriMesh) -> i64 {
    mesh.positions.len() as i64 - mesh.triangles.len() as i64 / 2
}

fn in_pattern(pattern: u32, v: IVec3) -> bool {
    (pattern >> (v.x | v.y << 1 | v.z << 2)) & 1 == 1
}

#[test]
fn all_256_patterns_alone_and_as_holes_of_a_block() {
    (0..256u32 * 6).into_par_iter().for_each(|n| {
        let (pattern, seed) = (n & 255, u64::from(n));
        // once within a brick, once across the corner of eight
        for at in [3, 7] {
            let block = |v: IVec3| v.cmpge(IVec3::splat(at)).all() && v.cmplt(IVec3::splat(at + 2)).all();
            let solid = |v: IVec3| block(v) && in_pattern(pattern, v - at);
            check(&Case::new(IVec3::splat(12), seed, solid), &format!("pattern {pattern}, seed {seed}, at {at}"));
            let near = |v: IVec3| v.cmpge(IVec3::splat(at - 2)).all() && v.cmplt(IVec3::splat(at + 4)).all();
            let hollow = |v: IVec3| near(v) && !solid(v);
            let case = Case::new(IVec3::splat(12), seed, hollow);
            check(&case, &format!("hole {pattern}, seed {seed}, at {at}"));
        }
    });
}

#[test]
fn thousands_of_random_voxel_sets() {
    (0..4_000u64).into_par_iter().for_each(|seed| {
        let density = 0.05 + 0.9 * noise(seed, IVec3::ZERO, 90);
        let low = IVec3::new(0, 1, 2).map(|k| (noise(seed, IVec3::splat(k), 91) * 8.0) as i32);
        let inside = |v: IVec3| v.cmpge(low).all() && v.cmplt(low + 4).all() && noise(seed, v, 92) < density;
        let mut case = Case::new(low + 4, seed, inside);
        case.extreme = noise(seed, IVec3::ZERO, 93);
        case.interpolated = 0.5 * noise(seed, IVec3::ZERO, 94);
        check(&case, &format!("seed {seed}"));
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn random_voxel_sets_across_bricks(seed: u64, size in 1i32..=9, at in 0i32..=8, density in 0.05f64..0.95) {
        let low = IVec3::splat(at);
        let inside = |v: IVec3| {
            v.cmpge(low).all() && v.cmplt(low + size).all() && noise(seed, v, 92) < density
        };
        check(&Case::new(IVec3::splat(at + size), seed, inside), "random set");
    }
}

#[test]
fn a_ball_with_an_inactive_core_has_the_volume_of_a_ball() {
    let (centre, radius) = (DVec3::new(31.3, 30.8, 31.1), 27.4);
    let inside = |v: IVec3| v.as_dvec3().distance(centre) < radius;
    let mut case = Case::new(IVec3::splat(64), 1, inside);
    let bricks = case.distance.grid.bricks.clone();
    assert!(bricks.slot(IVec3::splat(3)) == Slot::Inside);
    for (n, &b) in bricks.active().iter().enumerate() {
        for k in 0..512 {
            let v = b * 8 + IVec3::new(k & 7, k >> 3 & 7, k >> 6);
            case.distance.grid.values[n][k as usize] = (v.as_dvec3().distance(centre) - radius) as f32;
        }
    }
    case.interpolated = 1.0;
    let ball = case.contour();
    let volume = enclosed(&ball.mesh) / case.lattice.h.powi(3);
    let exact = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    assert!((volume / exact - 1.0).abs() < 1e-3, "{volume} {exact}");
    for p in &ball.mesh.positions {
        let off = (case.lattice.to_lattice(*p).distance(centre) - radius).abs();
        assert!(off < 0.02, "{off}");
    }
}

#[test]
fn a_box_with_exact_crossings_is_exact_up_to_its_rounded_edges() {
    let inside = |v: IVec3| v.cmpge(IVec3::splat(5)).all() && v.cmplt(IVec3::new(20, 16, 33)).all();
    let case = Case::new(IVec3::splat(40), 3, inside);
    let crossing = |_| Some(Crossing { t: 0.5, triangle: Some(0) });
    let solid = contour(&case.distance, &crossing, &ContourOptions::default(), &Progress::none());
    let volume = enclosed(&solid.unwrap().mesh) / case.lattice.h.powi(3);
    let (exact, edges): (f64, f64) = (15.0 * 11.0 * 28.0, 4.0 * (15.0 + 11.0 + 28.0));
    // each edge loses a prism of half by half a voxel, halved
    assert!((exact - volume - edges / 8.0).abs() < 1.0, "{volume} {exact}");
}

#[test]
fn the_collapse_brings_the_edges_of_a_box_back() {
    let inside = |v: IVec3| v.cmpge(IVec3::splat(5)).all() && v.cmplt(IVec3::new(20, 16, 33)).all();
    let case = Case::new(IVec3::splat(40), 3, inside);
    // one triangle for each side: low x, low y, low z, high x, high y, high z
    let side = |edge: LatticeEdge| u32::from(edge.axis) + 3 * u32::from(inside(edge.voxel));
    let crossing = |edge: LatticeEdge| Some(Crossing { t: 0.3, triangle: Some(side(edge)) });
    let places = [4.3, 4.3, 4.3, 19.3, 15.3, 32.3];
    let planes = |ground: Ground| {
        let Ground::Triangle(side) = ground else { return None };
        let normal = DVec3::AXES[side as usize % 3] * if side < 3 { -1.0 } else { 1.0 };
        Some(Plane { normal, offset: normal.dot(case.lattice.to_model(DVec3::splat(places[side as usize]))) })
    };
    let raw = contour(&case.distance, &crossing, &ContourOptions::default(), &Progress::none()).unwrap();
    let rounded = enclosed(&raw.mesh) / case.lattice.h.powi(3);
    let solid = collapse_same_voxel(raw, &case.lattice, &planes, Merge::All, &Progress::none()).unwrap();
    assert_eq!(fault(&solid.contour.mesh), None);
    assert_eq!((solid.merged, solid.kept_apart), (4 * (15 + 11 + 28) - 16, 0));
    let volume = enclosed(&solid.contour.mesh) / case.lattice.h.powi(3);
    let exact = 15.0 * 11.0 * 28.0;
    assert!((volume - exact).abs() < 0.02 * (rounded - exact).abs(), "{rounded} {volume} {exact}");
}

#[test]
fn a_cancelled_contour_stops() {
    let progress = Progress::none().with_flag(Arc::new(AtomicBool::new(true)));
    let case = Case::new(IVec3::splat(20), 2, |v| v.x > 9);
    let stopped = contour(&case.distance, &|_| None, &ContourOptions::default(), &progress);
    assert_eq!(stopped, Err(Stopped::Interrupted));
    let planes = |_| None;
    let stopped = collapse_same_voxel(case.contour(), &case.lattice, &planes, Merge::All, &progress);
    assert_eq!(stopped, Err(Stopped::Interrupted));
}

fn with_threads(threads: usize, case: &Case) -> (Contour, Collapsed) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| (case.contour(), case.collapsed(case.contour())))
}

#[test]
fn one_thread_or_two_give_the_same() {
    let inside = |v: IVec3| noise(5, v / 3, 92) < 0.4;
    let case = Case::new(IVec3::splat(50), 5, inside);
    let one = with_threads(1, &case);
    assert!(one.0.mesh.triangles.len() > 10_000 && one.1.merged > 1000);
    assert!(one == with_threads(2, &case));
}
