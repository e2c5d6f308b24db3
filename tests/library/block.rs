//! Blocks under open sheets: the sheet as it is, upright walls, a flat base, and the volume that there is between them.

use std::collections::HashSet;

use glam::DVec3;
use meshwright::mesh::TriMesh;
use meshwright::picture::Axis;
use meshwright::pipeline::{Base, BlockError, Options, Outcome, VoxelSize, block, plan_block};
use meshwright::progress::Progress;
use proptest::prelude::*;

use crate::common::proofs::state;
use crate::common::shapes::{cuboid, turned};

/// Squares of side 1 of which some are there, two triangles each, over vertices of these heights.
fn field(cells: [u32; 2], is_there: impl Fn(u32, u32) -> bool, height: impl Fn(f64, f64) -> f64) -> TriMesh {
    let [nx, ny] = cells;
    let at = |x: u32, y: u32| y * (nx + 1) + x;
    let vertex = |n: u32| {
        let (x, y) = (f64::from(n % (nx + 1)), f64::from(n / (nx + 1)));
        DVec3::new(x, y, height(x, y))
    };
    let cell = |n: u32| {
        let (x, y) = (n % nx, n / nx);
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        let both = if (x + y) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        both.into_iter().take(if is_there(x, y) { 2 } else { 0 }).collect::<Vec<_>>()
    };
    let positions = (0..(nx + 1) * (ny + 1)).map(vertex).collect();
    TriMesh { positions, triangles: (0..nx * ny).flat_map(cell).collect() }.welded()
}

fn hills(x: f64, y: f64) -> f64 {
    3.0 + (0.7 * x).sin() + 0.8 * (0.9 * y + 0.3 * x).cos()
}

/// What lies between a sheet that is nowhere steep and a plane across z below it.
fn volume_over(sheet: &TriMesh, base: f64) -> f64 {
    let prism = |[a, b, c]: [DVec3; 3]| {
        (b - a).truncate().perp_dot((c - a).truncate()) / 2.0 * ((a.z + b.z + c.z) / 3.0 - base)
    };
    (0..sheet.triangles.len()).map(|t| prism(sheet.corners(t)).abs()).sum()
}

fn made(sheet: &TriMesh, base: Base) -> Outcome {
    let outcome = block(sheet, base, &Options::new(VoxelSize::Along(64)), &Progress::none()).expect("a block");
    let found = state(&outcome.solid, true);
    assert!(found.is_valid(), "{:?}", found.problems());
    assert!(!outcome.report.lattice);
    outcome
}

fn error(sheet: &TriMesh, base: Base) -> BlockError {
    block(sheet, base, &Options::new(VoxelSize::Along(64)), &Progress::none()).expect_err("no block")
}

/// The corners of triangles, bit for bit, in any order.
fn corners(mesh: &TriMesh) -> HashSet<[[u64; 3]; 3]> {
    let of = |t: usize| {
        let mut corners = mesh.corners(t).map(|p| p.to_array().map(f64::to_bits));
        corners.sort_unstable();
        corners
    };
    (0..mesh.triangles.len()).map(of).collect()
}

fn has_all_of(outcome: &Outcome, sheet: &TriMesh) {
    assert!(corners(&outcome.solid).is_superset(&corners(sheet)));
    assert_eq!(outcome.report.triangles.kept, sheet.triangles.len());
}

#[track_caller]
fn near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() <= share, "{found} instead of {expected}");
}

#[test]
fn terrain_becomes_a_block_of_known_volume_with_two_triangles_a_wall() {
    let sheet = field([12, 9], |_, _| true, hills);
    let low = sheet.positions.iter().map(|p| p.z).fold(f64::MAX, f64::min);
    for (base, at) in [(Base::Below(2.0), low - 2.0), (Base::Plane { axis: Axis::Z, at: -1.0 }, -1.0)] {
        let outcome = made(&sheet, base);
        has_all_of(&outcome, &sheet);
        let report = outcome.report.block.as_ref().expect("a report");
        assert_eq!((report.edges, report.wall_triangles, report.base_triangles), (42, 84, 40));
        assert_eq!((report.axis.as_str(), report.base, report.sheets, report.turned), ("z", at, 1, 0));
        assert_eq!(outcome.solid.triangles.len(), sheet.triangles.len() + 84 + 40);
        assert_eq!(outcome.solid.validity().genus, Some(0));
        near(report.volume, volume_over(&sheet, at), 1e-12);
    }
}

#[test]
fn holes_of_the_sheet_go_through_the_block_and_islands_stand_in_them() {
    let hole = |x: u32, y: u32| (2..7).contains(&x) && (2..7).contains(&y) && !(x == 4 && y == 4);
    let sheet = field([12, 12], |x, y| !(hole(x, y) || x == 9 && y == 3), hills);
    let outcome = made(&sheet, Base::Plane { axis: Axis::Z, at: 0.0 });
    has_all_of(&outcome, &sheet);
    let found = outcome.solid.validity();
    assert_eq!((found.bodies, found.genus), (2, Some(2)));
    near(found.volume, volume_over(&sheet, 0.0), 1e-12);
}

#[test]
fn which_way_triangles_face_does_not_matter() {
    let sheet = field([7, 5], |_, _| true, hills);
    let upwards = made(&sheet, Base::Below(1.0));
    let mut down = sheet.clone();
    down.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let mut mixed = sheet.clone();
    mixed.triangles.iter_mut().step_by(3).for_each(|t| t.swap(1, 2));
    for (other, turned) in [(&down, 1), (&mixed, 0)] {
        let outcome = made(other, Base::Below(1.0));
        has_all_of(&outcome, other);
        assert_eq!(outcome.solid.triangles.len(), upwards.solid.triangles.len());
        near(outcome.solid.validity().volume, upwards.solid.validity().volume, 1e-12);
        assert_eq!(outcome.report.block.as_ref().map(|block| block.turned), Some(turned));
    }
    assert!(made(&mixed, Base::Below(1.0)).report.orient[0].flipped_in_patches > 0);
    // Below a plane that lies above: the block hangs from it.
    let hanging = made(&sheet, Base::Plane { axis: Axis::Z, at: 9.0 });
    has_all_of(&hanging, &sheet);
    near(hanging.solid.validity().volume, volume_over(&sheet, 9.0), 1e-12);
}

#[test]
fn a_relief_that_stands_upright_gets_its_base_behind_it() {
    // Seen from the front, along y, it faces to smaller y.
    let mut relief = field([6, 6], |_, _| true, hills);
    relief.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x, -p.z, p.y));
    let back = relief.positions.iter().map(|p| p.y).fold(f64::MIN, f64::max);
    let outcome = made(&relief, Base::Below(0.5));
    let report = outcome.report.block.as_ref().expect("a report");
    assert_eq!((report.axis.as_str(), report.base), ("y", back + 0.5));
    has_all_of(&outcome, &relief);
    relief.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let turned = made(&relief, Base::Below(0.5));
    assert!(turned.report.block.as_ref().is_some_and(|block| block.base < back - 1.0));
}

#[test]
fn several_sheets_and_closed_bodies_make_one_solid() {
    let mut all = field([4, 4], |_, _| true, hills);
    let mut other = field([3, 3], |_, _| true, |x, y| 2.0 + 0.1 * x * y);
    other.positions.iter_mut().for_each(|p| p.x += 6.0);
    other.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let sum = volume_over(&all, 0.0) + volume_over(&other, 0.0);
    all.append(&other);
    let base = Base::Plane { axis: Axis::Z, at: 0.0 };
    let two = made(&all, base);
    has_all_of(&two, &all);
    assert_eq!(two.solid.validity().bodies, 2);
    near(two.solid.validity().volume, sum, 1e-12);
    // A house that sinks into the ground: what stands out of it is added.
    let flat = field([4, 4], |_, _| true, |_, _| 1.0);
    let mut town = flat.clone();
    town.append(&cuboid(DVec3::new(1.25, 1.25, 0.5), DVec3::new(2.75, 2.5, 2.0)));
    let house = made(&town, base);
    near(house.solid.validity().volume, 16.0 + 1.5 * 1.25, 1e-6);
    // One sheet over another: the lower one is inside.
    let mut roofed = flat;
    let mut roof = field([2, 2], |_, _| true, |_, _| 3.0);
    roof.positions.iter_mut().for_each(|p| *p += DVec3::new(0.5, 0.5, 0.0));
    roofed.append(&roof);
    near(made(&roofed, base).solid.validity().volume, 16.0 + 4.0 * 2.0, 1e-6);
}

/// A ramp that winds one and a half times around z: seen from above its rims cross, and its upper part hides the lower one.
#[test]
fn what_lies_over_itself_is_cut_exactly() {
    let steps = 90;
    let vertex = |n: u32| {
        let (angle, radius) =
            (f64::from(n / 2) * 3.0 * std::f64::consts::PI / f64::from(steps), f64::from(n % 2) + 1.0);
        // Wider at its end, so that its rims cross those below.
        let radius = if n % 2 == 1 { radius + 0.06 * angle } else { radius - 0.03 * angle };
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 1.0 + 0.5 * angle)
    };
    let quad = |k: u32| [[2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2]];
    let ramp =
        TriMesh { positions: (0..2 * steps + 2).map(vertex).collect(), triangles: (0..steps).flat_map(quad).collect() };
    let outcome = made(&ramp, Base::Plane { axis: Axis::Z, at: 0.0 });
    // By the heights of the sheet over points of the base.
    let n = 400;
    let place = |k: usize| -2.7 + 5.4 * (k as f64 + 0.5) / n as f64;
    let height = |x: f64, y: f64| {
        let over = |[a, b, c]: [DVec3; 3]| {
            let p = glam::DVec2::new(x, y);
            let side = |a: DVec3, b: DVec3| (b.truncate() - a.truncate()).perp_dot(p - a.truncate());
            let [u, v, w] = [side(b, c), side(c, a), side(a, b)];
            (u >= 0.0 && v >= 0.0 && w >= 0.0).then(|| (u * a.z + v * b.z + w * c.z) / (u + v + w))
        };
        (0..ramp.triangles.len()).filter_map(|t| over(ramp.corners(t))).fold(0.0, f64::max)
    };
    let sum: f64 = (0..n * n).map(|k| height(place(k % n), place(k / n))).sum();
    near(outcome.solid.validity().volume, sum * (5.4 / n as f64).powi(2), 5e-3);
}

#[test]
fn an_overhang_at_the_rim_is_cut_where_it_goes_through_the_wall() {
    // The sheet bulges out below its upper rim: there the wall goes through it.
    let mut sheet = field([8, 8], |_, _| true, |x, _| if x > 6.5 { 4.0 } else { 2.0 });
    for p in sheet.positions.iter_mut().filter(|p| p.x == 7.0) {
        p.x = 9.0;
        p.z = 3.0;
    }
    let outcome = made(&sheet, Base::Plane { axis: Axis::Z, at: 0.0 });
    assert!(outcome.report.exact.is_some());
    let volume = outcome.solid.validity().volume;
    assert!(volume > 8.0 * 6.0 * 2.0 && volume < 8.0 * 9.0 * 4.0, "{volume}");
}

#[test]
fn terrain_far_from_the_origin_keeps_its_numbers() {
    let mut sheet = field([10, 10], |x, y| x != 5 || y != 5, hills);
    sheet.positions.iter_mut().for_each(|p| *p = *p * 0.1 + DVec3::new(512_345.7, 5_412_345.3, 431.9));
    let outcome = made(&sheet, Base::Below(2.0));
    has_all_of(&outcome, &sheet);
    let base = outcome.report.block.as_ref().expect("a report").base;
    near(outcome.solid.validity().volume, volume_over(&sheet, base), 1e-6);
}

#[test]
fn what_is_no_sheet_over_its_base_is_refused_with_the_place() {
    let sheet = field([4, 4], |_, _| true, |x, y| x - y);
    let through = error(&sheet, Base::Plane { axis: Axis::Z, at: 0.5 });
    let BlockError::Through { low, high, through: at, .. } = &through else { panic!("{through}") };
    assert_eq!((*low, *high), (-4.0, 4.0));
    assert!((at.z - 0.5).abs() < 1.0, "{at}");
    assert!(through.to_string().contains("both sides of its base z = 0.5: it reaches from -4 to 4"), "{through}");
    assert_eq!(error(&sheet, Base::Below(0.0)), BlockError::Depth { depth: 0.0 });
    assert_eq!(error(&cuboid(DVec3::ZERO, DVec3::ONE), Base::Below(1.0)), BlockError::Closed);
    let upright = error(&field([4, 4], |_, _| true, |_, _| 0.0), Base::Plane { axis: Axis::X, at: -1.0 });
    assert!(matches!(upright, BlockError::Upright { axis: Axis::X, .. }), "{upright}");
    let planned = plan_block(&sheet, Base::Below(1.0), &Options::new(VoxelSize::Along(64))).expect("a plan");
    assert_eq!((planned.dims, planned.triangles), ([0; 3], 32 + 32 + 14));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Also where cells touch at corners alone, where walls meet in an upright edge.
    #[test]
    fn any_cells_of_any_heights_make_a_valid_block(
        taken in prop::collection::vec(any::<bool>(), 25), heights in prop::collection::vec(0.0f64..3.0, 36),
        turn in 0.0f64..1.0
    ) {
        prop_assume!(taken.contains(&true));
        let mut sheet = field(
            [5, 5], |x, y| taken[(5 * y + x) as usize], |x, y| heights[6 * y as usize + x as usize]
        );
        sheet.triangles.iter_mut().step_by(2).for_each(|t| t.swap(1, 2));
        let outcome = made(&sheet, Base::Plane { axis: Axis::Z, at: -1.0 });
        near(outcome.solid.validity().volume, volume_over(&sheet, -1.0), 1e-6);
        // Tilted there are overhangs.
        let tilted = turned(sheet, turn);
        made(&tilted, Base::Below(0.5));
    }
}
