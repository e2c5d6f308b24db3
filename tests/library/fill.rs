//! Holes that are closed from their rims alone: nothing else changes, and what is no hole is left to the voxels.

use crate::common::proofs::state;
use crate::common::shapes::{ball, cuboid, torus};
use glam::DVec3;
use meshwright::fill::Style;
use meshwright::mesh::TriMesh;
use meshwright::pipeline::{
    BooleanError, HoleClosing, LidShape, Method, NotLidded, NotOpened, Options, Outcome, TriangleSource, VoxelSize,
    Warning, holes, repair,
};
use meshwright::progress::Progress;

fn options(fill: Style) -> Options {
    Options { fill, ..Options::new(VoxelSize::Along(64)) }
}

fn repaired(mesh: &TriMesh, options: &Options) -> Outcome {
    let outcome = repair(mesh, options, &Progress::none()).expect("a solid");
    let found = state(&outcome.solid, true);
    assert!(found.is_valid(), "{:?}", found.problems());
    outcome
}

fn volume(mesh: &TriMesh) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// A mesh without the triangles whose middles lie within `radius` of a place.
fn without(mesh: &TriMesh, at: DVec3, radius: f64) -> TriMesh {
    let near = |t: usize| (mesh.corners(t).iter().sum::<DVec3>() / 3.0).distance(at) < radius;
    let triangles = (0..mesh.triangles.len()).filter(|&t| !near(t)).map(|t| mesh.triangles[t]).collect();
    TriMesh { positions: mesh.positions.clone(), triangles }.welded()
}

/// All triangles of the input are there, and all others close holes.
fn check_kept(input: &TriMesh, outcome: &Outcome) {
    let own = outcome.sources.iter().filter(|source| !source.is_made_up()).count();
    assert_eq!(own, input.triangles.len());
    assert_eq!(outcome.report.triangles.kept, own);
    let listed: usize = outcome.report.holes.iter().map(|hole| hole.triangles).sum();
    assert_eq!(listed, outcome.solid.triangles.len() - own);
    assert!(!outcome.report.lattice);
}

#[test]
fn holes_in_round_surfaces_are_closed_round_and_nothing_else_changes() {
    let whole = ball(4, |_| 1.0);
    let open = without(&whole, DVec3::X, 0.3);
    let [smooth, flat] = [Style::Auto, Style::Flat].map(|style| repaired(&open, &options(style)));
    for outcome in [&smooth, &flat] {
        check_kept(&open, outcome);
        assert_eq!(outcome.report.holes.len(), 1);
    }
    let shapes = [&smooth, &flat].map(|outcome| outcome.report.holes[0].closed_by);
    assert_eq!(shapes, [LidShape::Smooth, LidShape::Flat].map(HoleClosing::Lid));
    assert!(flat.report.holes[0].triangles < smooth.report.holes[0].triangles);
    let off = |outcome: &Outcome| (volume(&outcome.solid) / volume(&whole) - 1.0).abs();
    assert!(off(&smooth) < 2e-4 && off(&flat) > 1e-3, "{} and {}", off(&smooth), off(&flat));
}

#[test]
fn several_holes_are_closed_one_by_one_the_longest_first() {
    let whole = torus(96, 48);
    let places = [DVec3::X * 1.3, DVec3::new(-1.0, 0.0, 0.3), DVec3::new(0.0, 1.0, -0.3)];
    let open =
        places.iter().zip([0.25, 0.15, 0.1]).fold(whole.clone(), |mesh, (&at, radius)| without(&mesh, at, radius));
    let outcome = repaired(&open, &options(Style::Auto));
    check_kept(&open, &outcome);
    let holes = &outcome.report.holes;
    assert_eq!(holes.len(), 3);
    for (hole, at) in holes.iter().zip(places) {
        assert!(DVec3::from_array(hole.centre).distance(at) < 0.15, "{hole:?} at {at}");
    }
    assert!(holes.windows(2).all(|pair| pair[0].perimeter >= pair[1].perimeter));
    let off = (volume(&outcome.solid) / volume(&whole) - 1.0).abs();
    assert!(off < 1e-3, "{off}");
}

#[test]
fn a_box_without_a_side_is_twelve_triangles_again() {
    let whole = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    for missing in 0..whole.triangles.len() {
        for count in [1, 2] {
            let mut open = whole.clone();
            open.triangles.rotate_left(missing);
            open.triangles.truncate(whole.triangles.len() - count);
            let outcome = repaired(&open, &options(Style::Auto));
            assert_eq!(outcome.solid.triangles.len(), 12, "{count} missing at {missing}");
            assert!((volume(&outcome.solid) - 6.0).abs() < 1e-12);
        }
    }
}

/// A ring with a gap that is narrow against its tube: the rims at both ends face each other.
fn torn_ring() -> TriMesh {
    let tube = torus(96, 48);
    let narrow = |p: &DVec3| p.x > 0.0 && p.y.abs() < 0.1;
    let keep = |t: &usize| !narrow(&(tube.corners(*t).iter().sum::<DVec3>() / 3.0));
    let triangles = (0..tube.triangles.len()).filter(keep).map(|t| tube.triangles[t]).collect();
    TriMesh { positions: tube.positions.clone(), triangles }.welded()
}

#[test]
fn what_faces_itself_over_a_gap_is_joined() {
    let open = torn_ring();
    let mut outcome = repaired(&open, &options(Style::Auto));
    check_kept(&open, &outcome);
    let band = HoleClosing::Lid(LidShape::Band);
    assert_eq!(closings(&outcome), [band, band]);
    let partners: Vec<_> = outcome.report.holes.iter().map(|hole| hole.joined_with).collect();
    assert_eq!(partners, [Some(2), Some(1)]);
    assert_eq!(state(&outcome.solid, true).bodies, 1);
    let off = (volume(&outcome.solid) / volume(&torus(96, 48)) - 1.0).abs();
    assert!(off < 2e-3, "{off}");
    // A band goes with either of its rims.
    let opened = outcome.open(&[2]).expect("it is there");
    assert_eq!(opened.mesh.triangles.len(), open.triangles.len());
    assert_eq!(closings(&outcome), [HoleClosing::LeftOpen; 2]);
}

/// A pipe whose wall has lost both ends, with a hole in it besides: its two sides are apart, and the inner one seems to face inwards.
#[test]
fn a_wall_that_has_lost_its_ends_gets_them_back() {
    let (sides, rows) = (48u32, 12u32);
    let tube = |radius: f64, outward: bool| {
        let at = |n: u32, row: u32| {
            let turn = f64::from(n) / f64::from(sides) * std::f64::consts::TAU;
            DVec3::new(radius * turn.cos(), radius * turn.sin(), 3.0 * f64::from(row) / f64::from(rows))
        };
        let positions = (0..=rows).flat_map(|row| (0..sides).map(move |n| at(n, row))).collect();
        let quad = |row: u32, n: u32| {
            let [a, b] = [row * sides + n, row * sides + (n + 1) % sides];
            let [c, d] = [b + sides, a + sides];
            if outward { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] }
        };
        let triangles = (0..rows).flat_map(|row| (0..sides).flat_map(move |n| quad(row, n))).collect();
        TriMesh { positions, triangles }
    };
    let mut pipe = tube(1.0, true);
    pipe.append(&tube(0.8, false));
    let area = f64::from(sides) / 2.0 * (std::f64::consts::TAU / f64::from(sides)).sin();
    let truth = area * (1.0 - 0.64) * 3.0;
    for (open, holes) in [(pipe.clone(), 4), (without(&pipe, DVec3::new(1.0, 0.0, 1.6), 0.1), 5)] {
        let outcome = repaired(&open, &options(Style::Auto));
        check_kept(&open, &outcome);
        let bands = closings(&outcome).iter().filter(|how| **how == HoleClosing::Lid(LidShape::Band)).count();
        assert_eq!((bands, outcome.report.holes.len()), (4, holes), "{:?}", outcome.report.holes);
        let off = (volume(&outcome.solid) / truth - 1.0).abs();
        assert!(off < if holes == 4 { 1e-12 } else { 1e-3 }, "{off}");
    }
}

/// A ball in three wedges with gaps between them: each rim faces two others, and no band joins three.
fn wedges() -> TriMesh {
    let whole = ball(4, |_| 1.0);
    let middle = |t: usize| whole.corners(t).iter().sum::<DVec3>() / 3.0;
    let near = |p: DVec3| {
        (0..3).any(|k| {
            let turn = f64::from(k) * std::f64::consts::TAU / 3.0 + 0.3;
            let (along, across) =
                (p.dot(DVec3::new(turn.cos(), turn.sin(), 0.0)), p.dot(DVec3::new(-turn.sin(), turn.cos(), 0.0)));
            along > -0.06 && across.abs() < 0.06
        })
    };
    let triangles = (0..whole.triangles.len()).filter(|&t| !near(middle(t))).map(|t| whole.triangles[t]).collect();
    TriMesh { positions: whole.positions.clone(), triangles }.welded()
}

#[test]
fn three_that_face_each_other_are_closed_from_voxels() {
    let open = wedges();
    let outcome = repaired(&open, &options(Style::Auto));
    let found = state(&outcome.solid, true);
    let holes = &outcome.report.holes;
    assert!(holes.len() == 3 && found.bodies == 1, "{holes:?}");
    assert!(holes.iter().all(|hole| matches!(hole.closed_by, HoleClosing::Voxels(_))), "{holes:?}");
    let off = (volume(&outcome.solid) / volume(&ball(4, |_| 1.0)) - 1.0).abs();
    assert!(off < 0.01, "{off}");
}

#[test]
fn sheets_are_not_closed_and_voxels_can_be_asked_for() {
    let whole = ball(4, |_| 1.0);
    let cap = without(&whole, DVec3::NEG_X, 1.9);
    assert!(matches!(repair(&cap, &options(Style::Auto), &Progress::none()), Err(BooleanError::Nothing(_))));
    let open = without(&whole, DVec3::X, 0.3);
    let outcome = repaired(&open, &Options { method: Method::Voxel, ..options(Style::Auto) });
    assert!(outcome.report.holes.is_empty() && outcome.report.lattice);
}

/// A piece of a wavy sheet, from `at` on, of this width.
fn wavy(at: DVec3, width: f64) -> TriMesh {
    let place = |n: u32, m: u32| {
        let (x, y) = (f64::from(n) / 12.0, f64::from(m) / 12.0);
        at + width * DVec3::new(x, y, 0.1 * (6.0 * x).sin())
    };
    let positions = (0..=12).flat_map(|n| (0..=12).map(move |m| place(n, m))).collect();
    let quad = |n: u32, m: u32| {
        let a = 13 * n + m;
        [[a, a + 13, a + 14], [a, a + 14, a + 1]]
    };
    TriMesh { positions, triangles: (0..12).flat_map(|n| (0..12).flat_map(move |m| quad(n, m))).collect() }
}

/// Pieces that float around a scan: they are left out with a note, and the holes of the body have lids. What is large, or encloses something with others, is not.
#[test]
fn small_sheets_beside_a_body_are_left_out() {
    let body = without(&torus(96, 48), DVec3::new(-1.0, 0.0, 0.3), 0.12);
    let with = |sheets: &[TriMesh]| {
        let mut all = body.clone();
        sheets.iter().for_each(|sheet| all.append(sheet));
        repaired(&all, &options(Style::Auto))
    };
    let alone = with(&[]);
    let (floating, inside) = (wavy(DVec3::new(1.6, 0.0, 0.0), 0.4), wavy(DVec3::new(0.9, -0.1, 0.0), 0.2));
    for sheets in [vec![floating.clone()], vec![inside.clone()], vec![floating, inside]] {
        let outcome = with(&sheets);
        assert_eq!(outcome.solid.triangles.len(), alone.solid.triangles.len());
        assert!(!outcome.report.lattice && (volume(&outcome.solid) - volume(&alone.solid)).abs() < 1e-12);
        let left = closings(&outcome).iter().filter(|how| **how == HoleClosing::LeftOut).count();
        assert_eq!(left, sheets.len());
        let triangles = 288 * sheets.len();
        assert!(
            outcome.report.warnings.contains(&Warning::SheetsLeftOut { triangles }),
            "{:?}",
            outcome.report.warnings
        );
    }
    // Single triangles that stick in a box.
    let mut pierced = cuboid(DVec3::ZERO, DVec3::ONE);
    for n in 0..8 {
        let at = DVec3::new(0.1 + 0.1 * f64::from(n), 0.07 * f64::from(n), 0.95);
        let positions = vec![at, at + DVec3::new(0.05, 0.01, 0.1), at + DVec3::new(-0.03, 0.08, 0.02)];
        pierced.append(&TriMesh { positions, triangles: vec![[0, 1, 2]] });
    }
    let outcome = repaired(&pierced, &options(Style::Auto));
    assert!(!outcome.report.lattice && outcome.solid.triangles.len() == 12);
    assert!(outcome.report.warnings.contains(&Warning::SheetsLeftOut { triangles: 8 }));
    let large = with(&[wavy(DVec3::new(1.6, -0.7, 0.0), 1.4)]);
    assert!(large.report.lattice && !closings(&large).contains(&HoleClosing::LeftOut));
    // The sides of a box with gaps between them.
    let whole = cuboid(DVec3::ZERO, DVec3::splat(0.3));
    let sides = (0..6).map(|side| {
        let (axis, high) = (side / 2, side % 2 == 1);
        let on = |v: u32| whole.positions[v as usize][axis] == if high { 0.3 } else { 0.0 };
        let of: Vec<_> = whole.triangles.iter().filter(|t| t.iter().all(|&v| on(v))).copied().collect();
        let middle = DVec3::splat(0.15);
        let aside = DVec3::AXES[axis] * if high { 0.01 } else { -0.01 };
        let positions = whole.positions.iter().map(|&p| middle + (p - middle) + aside + DVec3::X * 1.7);
        TriMesh { positions: positions.collect(), triangles: of }.welded()
    });
    let sides: Vec<TriMesh> = sides.collect();
    let outcome = with(&sides);
    assert!(!closings(&outcome).contains(&HoleClosing::LeftOut));
    assert_eq!(state(&outcome.solid, true).bodies, 2);
}

fn closings(outcome: &Outcome) -> Vec<HoleClosing> {
    outcome.report.holes.iter().map(|hole| hole.closed_by).collect()
}

/// The one beside the other: a hole that a lid closes keeps it where others need voxels. An open box lies where the band between the ends of the ring would.
#[test]
fn voxels_close_only_the_holes_that_no_lid_closes() {
    let mut open = without(&torn_ring(), DVec3::new(-1.0, 0.0, 0.3), 0.12);
    let mut between = cuboid(DVec3::new(1.3, -0.04, -0.04), DVec3::new(1.4, 0.04, 0.04));
    between.triangles.retain(|t| !t.iter().all(|&v| between.positions[v as usize].x == 1.4));
    open.append(&between);
    let outcome = repaired(&open, &options(Style::Auto));
    let voxels = HoleClosing::Voxels(NotLidded::Meets);
    let lids = [LidShape::Smooth, LidShape::Flat].map(HoleClosing::Lid);
    assert_eq!(closings(&outcome), [voxels, voxels, lids[0], lids[1]]);
    let of_lid = outcome.sources.iter().filter(|source| matches!(source, TriangleSource::Lid { hole: 3, .. })).count();
    assert_eq!(of_lid, outcome.report.holes[2].triangles);
    assert!(outcome.report.lattice);
}

/// A ball cut off along a wave: no plane is near its rim, and a smooth lid would be what was cut off.
#[test]
fn where_a_body_is_cut_off_unevenly_the_lid_is_a_level_of_the_winding_number() {
    let whole = ball(4, |_| 1.0);
    let below = |p: DVec3| p.z < 0.4 + 0.15 * (3.0 * p.y.atan2(p.x)).sin();
    let keep = |t: &usize| below(whole.corners(*t).iter().sum::<DVec3>() / 3.0);
    let triangles = (0..whole.triangles.len()).filter(keep).map(|t| whole.triangles[t]).collect();
    let most = TriMesh { positions: whole.positions.clone(), triangles }.welded();
    let outcome = repaired(&most, &options(Style::Auto));
    check_kept(&most, &outcome);
    assert_eq!(closings(&outcome), [HoleClosing::Lid(LidShape::Level)]);
    // The lid of voxels is the same level.
    let voxels = repaired(&most, &Options { method: Method::Voxel, ..options(Style::Auto) });
    let off = (volume(&outcome.solid) / volume(&voxels.solid) - 1.0).abs();
    assert!(off < 0.005, "{off}");
}

#[test]
fn what_faces_inwards_is_closed_and_turned_over() {
    let whole = ball(3, |_| 1.0);
    let mut open = without(&whole, DVec3::X, 0.4);
    open.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let outcome = repaired(&open, &options(Style::Auto));
    check_kept(&open, &outcome);
    assert_eq!(outcome.report.orient[0].flipped_patches, 1);
    assert!((volume(&outcome.solid) / volume(&whole) - 1.0).abs() < 0.01);
}

/// A tube that ends open inside a box, as spouts and handles of teapots do.
#[test]
fn what_is_open_inside_of_another_body_is_closed_there() {
    let mut both = cuboid(DVec3::ZERO, DVec3::splat(2.0));
    let mut peg = cuboid(DVec3::new(0.5, 0.5, 1.0), DVec3::new(1.5, 1.5, 3.0));
    let at_end = |peg: &TriMesh, t: usize| peg.corners(t).iter().all(|p| p.z == 1.0);
    let sides = (0..12).filter(|&t| !at_end(&peg, t)).map(|t| peg.triangles[t]).collect();
    peg.triangles = sides;
    both.append(&peg);
    let outcome = repaired(&both, &options(Style::Auto));
    assert!(!outcome.report.lattice);
    assert!((volume(&outcome.solid) - 9.0).abs() < 1e-9, "{}", volume(&outcome.solid));
}

#[test]
fn holes_are_listed_before_a_repair_and_may_be_left_open() {
    let whole = torus(96, 48);
    let places = [DVec3::X * 1.3, DVec3::new(-1.0, 0.0, 0.3), DVec3::new(0.0, 1.0, -0.3)];
    let open = places.iter().zip([0.25, 0.15, 0.1]).fold(whole, |mesh, (&at, radius)| without(&mesh, at, radius));
    let options = options(Style::Auto);
    let mut outcome = repaired(&open, &options);
    assert_eq!(holes(&open, &options, &Progress::none()).expect("a list"), outcome.report.holes);
    let lids: Vec<usize> = outcome.report.holes.iter().map(|hole| hole.triangles).collect();
    assert_eq!(outcome.open(&[4]).map(|_| ()), Err(NotOpened::NoHole { number: 4, count: 3 }));
    let all = outcome.solid.triangles.len();
    let opened = outcome.clone().open(&[1, 3]).expect("they are there");
    assert_eq!(opened.mesh.triangles.len(), all - lids[0] - lids[2]);
    let rims = meshwright::fill::rims(&opened.mesh);
    assert_eq!(rims.len(), 2);
    // Without any lid it is the mesh that was given, whatever was asked for before.
    outcome.open(&[2]).expect("it is there");
    let opened = outcome.open_all();
    assert_eq!(opened.mesh.triangles.len(), open.triangles.len());
    assert_eq!((outcome.report.triangles.made_up, outcome.report.closed_triangles), (0, 0));
    assert!(outcome.report.holes.iter().all(|hole| hole.closed_by == HoleClosing::LeftOpen));
}

/// Every triangle by itself, with corners that rounding has moved by a millionth: all of it is cracks.
#[test]
fn cracks_of_rounding_close_and_larger_ones_do_when_that_is_asked_for() {
    let whole = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    let torn = |by: f64| {
        let number = |k: usize| ((k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1u64 << 53) as f64;
        let corners = whole.triangles.iter().flatten().enumerate();
        let moved = |(n, &v): (usize, &u32)| {
            whole.positions[v as usize] + DVec3::new(number(3 * n), number(3 * n + 1), number(3 * n + 2)) * by
        };
        let triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        TriMesh { positions: corners.map(moved).collect(), triangles }
    };
    for (by, tolerance) in [(1e-6, None), (0.01, Some(0.02))] {
        let mesh = torn(by);
        let outcome = repaired(&mesh, &Options { tolerance, ..options(Style::Auto) });
        assert_eq!(outcome.solid.triangles.len(), 12);
        assert!(!outcome.report.lattice && (volume(&outcome.solid) - 6.0).abs() < 22.0 * by);
        let zip = outcome.report.zip.expect("cracks");
        assert_eq!((zip.open_before, zip.open_after), (36, 0));
        let sources: Vec<u32> = outcome
            .sources
            .iter()
            .map(|source| match *source {
                TriangleSource::Operand { triangle, .. } => triangle,
                _ => panic!("made up"),
            })
            .collect();
        let mut sorted = sources.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..12).collect::<Vec<u32>>());
    }
    let outcome = repaired(&torn(0.01), &options(Style::Auto));
    assert!(outcome.report.zip.is_none() && outcome.report.lattice);
}

/// A bar with a pit in its underside, whose tip looks out of an opening of the top: no lid over the rim there misses it. Besides, a small hole at the far end.
fn pierced_bar() -> TriMesh {
    let step = 0.25;
    let at = |x: usize, y: usize, z: f64| DVec3::new(x as f64 * step, y as f64 * step, z);
    let low = |x: usize, y: usize| at(x, y, if (x, y) == (4, 2) { 1.3 } else { 0.0 });
    let high = |x: usize, y: usize| at(x, y, 1.0);
    let mut quads: Vec<[DVec3; 4]> = Vec::new();
    for (x, y) in (0..48).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        let [a, b, c, d] = corners.map(|(x, y)| low(x, y));
        quads.push([d, c, b, a]);
        let is_open = (2..6).contains(&x) && (1..3).contains(&y) || (x, y) == (44, 1);
        if !is_open {
            quads.push(corners.map(|(x, y)| high(x, y)));
        }
    }
    for x in 0..48 {
        quads.push([low(x, 0), low(x + 1, 0), high(x + 1, 0), high(x, 0)]);
        quads.push([low(x + 1, 4), low(x, 4), high(x, 4), high(x + 1, 4)]);
    }
    for y in 0..4 {
        quads.push([low(48, y), low(48, y + 1), high(48, y + 1), high(48, y)]);
        quads.push([low(0, y + 1), low(0, y), high(0, y), high(0, y + 1)]);
    }
    let mut triangles: Vec<[DVec3; 3]> = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    for _ in 0..2 {
        let cut = |[a, b, c]: [DVec3; 3]| {
            let (d, e, f) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    let numbers = (0..triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]);
    TriMesh { triangles: numbers.collect(), positions: triangles.into_iter().flatten().collect() }.welded()
}

#[test]
fn voxels_lie_around_the_hole_alone_that_no_lid_closes() {
    let open = pierced_bar();
    let outcome = repaired(&open, &options(Style::Auto));
    let found = closings(&outcome);
    assert!(matches!(found[..], [HoleClosing::Voxels(_), HoleClosing::Lid(_)]), "{found:?}");
    // The rim is 1.1 across: a tenth of the bar.
    let size = outcome.lattice.dims.as_dvec3() * outcome.lattice.h;
    assert!(outcome.report.lattice && size.max_element() < 3.0, "{size}");
    let far = |t: usize| open.corners(t).iter().all(|p| p.x > 4.0);
    let mut own: Vec<u32> = Vec::new();
    for (t, source) in outcome.sources.iter().enumerate() {
        match *source {
            TriangleSource::Operand { triangle, .. } if far(triangle as usize) => {
                assert_eq!(outcome.solid.corners(t), open.corners(triangle as usize), "{triangle} stays");
                own.push(triangle);
            }
            TriangleSource::Closed => assert!(outcome.solid.corners(t).iter().all(|p| p.x < 2.0)),
            _ => {}
        }
    }
    own.sort_unstable();
    assert_eq!(own, (0..open.triangles.len() as u32).filter(|&t| far(t as usize)).collect::<Vec<_>>());
    // As from voxels of the whole bar, of the same size.
    let whole = Options { method: Method::Voxel, ..Options::new(VoxelSize::Length(outcome.lattice.h)) };
    let off = volume(&outcome.solid) / volume(&repaired(&open, &whole).solid) - 1.0;
    assert!(off.abs() < 1e-3, "{off}");
}
