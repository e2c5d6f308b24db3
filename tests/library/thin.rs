//! Thin walls: measured, and made as thick as is wanted.

use crate::common::repaired::thickened;
use crate::common::shapes::cuboid;
use glam::{DMat3, DVec3};
use meshwright::ldi::Expression;
use meshwright::mesh::{TriMesh, ValidateOptions, Validity, validate};
use meshwright::pipeline::{
    Options, Outcome, SheetSide, SurfaceOptions, ThickenError, ThickenOptions, ThicknessReport, TriangleSource,
    VoxelSize, boolean, thickness,
};
use meshwright::progress::Progress;

fn turned(mesh: TriMesh) -> TriMesh {
    let turn = DMat3::from_euler(glam::EulerRot::ZYX, 0.4, 0.7, 0.2);
    TriMesh { positions: mesh.positions.iter().map(|&p| turn * p).collect(), ..mesh }
}

/// A block with three plates on it.
fn plates(widths: [f64; 3]) -> TriMesh {
    let plate = |x: f64, width: f64| cuboid(DVec3::new(x, 0.2, 0.4), DVec3::new(x + width, 0.8, 1.0));
    let parts = [
        cuboid(DVec3::ZERO, DVec3::new(1.2, 1.0, 0.5)),
        plate(0.2, widths[0]),
        plate(0.5, widths[1]),
        plate(0.8, widths[2]),
    ];
    let plain = Options::new(VoxelSize::Along(128));
    boolean(&parts, &Expression::union(4), &plain, &Progress::none()).expect("a solid").solid.into_mesh()
}

/// A square sheet, `n` by `n` squares, normals along +z.
fn sheet(n: u32) -> TriMesh {
    let at = |i: u32, j: u32| DVec3::new(f64::from(i), f64::from(j), 0.0) / f64::from(n);
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let triangles = (0..n)
        .flat_map(|j| (0..n).map(move |i| i + j * (n + 1)))
        .flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    TriMesh { triangles: triangles.collect(), positions }
}

fn measured(mesh: &TriMesh, voxel: VoxelSize) -> ThicknessReport {
    thickness(mesh, &Options::new(voxel), &Progress::none()).expect("rays")
}

fn grown(mesh: &TriMesh, least: f64, side: SheetSide) -> (Outcome, Validity) {
    let options = ThickenOptions { min: least, side, surface: SurfaceOptions::new(VoxelSize::Along(96)) };
    let outcome = thickened(mesh, &options).expect("a solid");
    let judge = ValidateOptions { self_intersections: true, weld: true };
    let validity = validate(&outcome.solid, &judge, &Progress::none()).expect("not stopped");
    assert!(validity.is_valid(), "{:?}", validity.problems());
    (outcome, validity)
}

#[test]
fn walls_and_gaps_have_their_widths_whichever_way_they_lie() {
    for mesh in [plates([0.1, 0.1, 0.1]), turned(plates([0.1, 0.1, 0.1]))] {
        let found = measured(&mesh, VoxelSize::Length(0.01));
        assert!((found.walls.least - 0.1).abs() < 1e-3, "{found:?}");
        assert!((found.walls.percentiles[0] - 0.1).abs() < 1e-3, "{found:?}");
        assert!((found.gaps.least - 0.2).abs() < 1e-3 && (found.gaps.percentiles[5] - 0.2).abs() < 1e-3, "{found:?}");
        assert_eq!((found.walls.thin, found.gaps.thin, found.silent), (0.0, 0.0, 0.0));
        assert!((found.voxel_that_keeps.expect("walls") - 0.05).abs() < 1e-3, "{found:?}");
    }
    // At 0.06 the same walls are under two voxels, the gaps are not.
    let coarse = measured(&plates([0.1, 0.1, 0.1]), VoxelSize::Length(0.06));
    assert!(coarse.walls.thin > 0.1 && coarse.gaps.thin == 0.0, "{coarse:?}");
}

#[test]
fn rays_through_open_sheets_are_told_and_not_counted() {
    let found = measured(&sheet(4), VoxelSize::Length(0.1));
    assert_eq!((found.walls.count, found.silent, found.voxel_that_keeps), (0, 1.0, None));
}

#[test]
fn thin_plates_grow_to_the_thickness_and_thick_ones_stay() {
    let mesh = turned(plates([0.02, 0.06, 0.2]));
    let (outcome, validity) = grown(&mesh, 0.1, SheetSide::Both);
    let h = outcome.lattice.h;
    let found = measured(&outcome.solid, VoxelSize::Length(h));
    // Of the rays, 1 % meet what became round, near its rim.
    assert!(found.walls.percentiles[1] > 0.1 - 0.1 * h, "{found:?}");
    let report = outcome.report.thicken.expect("it was done");
    assert!(report.thin_area > 1.0 && report.sheet_area == 0.0 && validity.volume > report.volume_before);
    let kept = outcome.sources.iter().filter(|s| matches!(s, TriangleSource::Operand { .. })).count();
    assert!(kept > 10, "{kept}");
    // The corners of the block and of the thick plate are where they were.
    let corners = turned(plates([0.2, 0.2, 0.2])).positions;
    let held = |p: &&DVec3| outcome.solid.positions.iter().any(|q| q.distance(**p) < 1e-6);
    assert!(corners.iter().filter(held).count() >= 12, "{}", corners.iter().filter(held).count());
    // A second time there is little left to do.
    let again = ThickenOptions {
        min: 0.1 - 0.5 * h,
        side: SheetSide::Both,
        surface: SurfaceOptions::new(VoxelSize::Length(h)),
    };
    let again = thickened(&outcome.solid, &again).expect("a solid");
    let left = again.report.thicken.expect("it was done").thin_area;
    assert!(left < 0.01 * report.thin_area, "{left} of {}", report.thin_area);
}

#[test]
fn what_is_thick_enough_comes_back_as_it_was() {
    let mesh = plates([0.2, 0.2, 0.2]);
    let outcome = grown(&mesh, 0.1, SheetSide::Both).0;
    let report = outcome.report.thicken.expect("it was done");
    assert_eq!((report.thin_area, report.volume_before), (0.0, report.volume_after));
    assert_eq!(outcome.report.closed_triangles, 0);
}

#[test]
fn an_open_sheet_becomes_a_plate_on_the_side_that_is_wanted() {
    for (side, low, high) in
        [(SheetSide::Both, -0.05, 0.05), (SheetSide::Front, 0.0, 0.1), (SheetSide::Back, -0.1, 0.0)]
    {
        let (outcome, validity) = grown(&sheet(6), 0.1, side);
        let h = outcome.lattice.h;
        let [min, max] = [0, 1].map(|end| validity.bounds.expect("not empty")[end][2]);
        assert!((min - low).abs() < 0.1 * h && (max - high).abs() < 0.1 * h, "{side:?}: {min} to {max}");
        // A plate, half a pipe along each side, a quarter of a ball at each corner.
        let r = 0.05f64;
        let volume = 2.0 * r + std::f64::consts::PI * (2.0 * r * r + 4.0 / 3.0 * r.powi(3));
        assert!((validity.volume / volume - 1.0).abs() < 0.01, "{side:?}: {} for {volume}", validity.volume);
        assert_eq!(validity.genus, Some(0));
    }
}

#[test]
fn a_sheet_beside_a_solid_grows_and_the_solid_stays() {
    let mut mesh = cuboid(DVec3::new(0.0, 0.0, 0.4), DVec3::new(1.0, 1.0, 1.0));
    mesh.append(&sheet(6));
    let (outcome, validity) = grown(&mesh, 0.1, SheetSide::Both);
    let report = outcome.report.thicken.expect("it was done");
    assert!((report.sheet_area - 1.0).abs() < 1e-9 && report.thin_area == 0.0, "{report:?}");
    assert_eq!(validity.bodies, 2);
    assert!(outcome.solid.positions.iter().any(|p| p.distance(DVec3::ONE) < 1e-6));
}

#[test]
fn a_thickness_that_the_lattice_cannot_hold_is_refused_with_the_voxel_that_can() {
    for (least, says) in [(0.02, "a voxel of at most 0.005"), (0.0, "above zero"), (f64::NAN, "above zero")] {
        let options =
            ThickenOptions { min: least, side: SheetSide::Both, surface: SurfaceOptions::new(VoxelSize::Along(96)) };
        match thickened(&sheet(2), &options) {
            Err(error) => assert!(error.to_string().contains(says), "{error}"),
            Ok(outcome) => panic!("{} triangles", outcome.solid.triangles.len()),
        }
    }
}

#[test]
fn walls_far_below_the_wanted_thickness_are_seen_and_grow_to_it() {
    let plate = cuboid(DVec3::ZERO, DVec3::new(10.0, 10.0, 0.4));
    for least in [0.7, 12.0] {
        let options =
            ThickenOptions { min: least, side: SheetSide::Both, surface: SurfaceOptions::new(VoxelSize::Along(64)) };
        let outcome = thickened(&plate, &options).expect("a solid");
        let report = outcome.report.thicken.expect("it was done");
        assert!(report.thin_area > 180.0, "{least}: {report:?}");
        let bounds = outcome.solid.bounds().expect("triangles");
        assert!((bounds.size().z - least).abs() < 0.1 * outcome.lattice.h, "{least}: {bounds:?}");
    }
    // The wall of a round body is thin all around.
    let torus = crate::common::shapes::torus_of(64, 32, 10.0, 0.3);
    let options =
        ThickenOptions { min: 8.0, side: SheetSide::Both, surface: SurfaceOptions::new(VoxelSize::Along(64)) };
    let report = thickened(&torus, &options).expect("a solid").report.thicken.expect("it was done");
    let area = 4.0 * std::f64::consts::PI.powi(2) * 10.0 * 0.3;
    assert!(report.thin_area > 0.95 * area && report.volume_after > 20.0 * report.volume_before, "{report:?}");
}

#[test]
fn a_thickness_far_beyond_the_model_is_refused() {
    let options =
        ThickenOptions { min: 1000.0, side: SheetSide::Both, surface: SurfaceOptions::new(VoxelSize::Along(64)) };
    match thickened(&crate::common::shapes::torus(64, 32), &options) {
        Err(ThickenError::WallsForModel { min: 1000.0, .. }) => {}
        other => panic!("{:?}", other.map(|outcome| outcome.solid.triangles.len())),
    }
}
