//! What counts as inside, `positive`, `nonzero` and `odd`: the same for shells that stand, rays, votes, winding numbers and outlines.

use crate::common::shapes::cuboid;
use glam::{DVec3, IVec3};
use meshwright::fit::FitOptions;
use meshwright::lattice::{Grid, Lattice};
use meshwright::ldi::{Expression, Inside};
use meshwright::mesh::{Bounds, TriMesh, ValidateOptions, validate};
use meshwright::orient::OrientMode;
use meshwright::pipeline::{
    BooleanError, DistanceMethod, DistanceOptions, DistanceSign, Options, Outcome, VoxelSize, boolean, distance, repair,
};
use meshwright::progress::Progress;
use meshwright::survey::{Cast, Soup, Survey};
use meshwright::vote::{VoteRule, Votes};
use proptest::prelude::*;

const RULES: [Inside; 3] = [Inside::Positive, Inside::Nonzero, Inside::Odd];

fn options(resolution: u32, inside: Inside) -> Options {
    Options { inside, ..Options::new(VoxelSize::Along(resolution)) }
}

/// The cube from `low` to `high` on all axes, inside out where that is said.
fn cube(low: f64, high: f64, inwards: bool) -> TriMesh {
    facing(cuboid(DVec3::splat(low), DVec3::splat(high)), inwards)
}

fn facing(mut mesh: TriMesh, inwards: bool) -> TriMesh {
    mesh.triangles.iter_mut().filter(|_| inwards).for_each(|t| t.swap(1, 2));
    mesh
}

fn joined(meshes: impl IntoIterator<Item = TriMesh>) -> TriMesh {
    let mut all = TriMesh::default();
    meshes.into_iter().for_each(|mesh| all.append(&mesh));
    all
}

/// The volume of a result that is checked to be a valid solid.
fn volume(outcome: &Outcome) -> f64 {
    let all = ValidateOptions { self_intersections: true, weld: true };
    let validity = validate(&outcome.solid, &all, &Progress::none()).expect("not stopped");
    assert!(validity.is_valid(), "{:?}", validity.problems());
    validity.volume
}

/// The rows of the table in `docs/cli.md`: two cubes of side 4 and 2 in each other, or of side 4 and overlapping by a cube of side 2, or one of side
/// 4 alone, with whether each faces inwards; and the volume by each rule.
fn table() -> Vec<(&'static str, TriMesh, [f64; 3])> {
    let nested = |outer, inner| joined([cube(0.0, 4.0, outer), cube(1.0, 3.0, inner)]);
    let crossing = |first, second| joined([cube(0.0, 4.0, first), cube(2.0, 6.0, second)]);
    vec![
        ("a cube inside out", cube(0.0, 4.0, true), [64.0, 64.0, 64.0]),
        ("a smaller one that faces inwards in it", nested(false, true), [56.0, 56.0, 56.0]),
        ("a smaller one that faces outwards in it", nested(false, false), [64.0, 64.0, 56.0]),
        ("the inner one right, the outer one inside out", nested(true, false), [56.0, 56.0, 56.0]),
        ("both inside out", nested(true, true), [56.0, 64.0, 56.0]),
        ("two that overlap", crossing(false, false), [120.0, 120.0, 112.0]),
        ("two that overlap, one inside out", crossing(false, true), [120.0, 112.0, 112.0]),
        ("two that overlap, both inside out", crossing(true, true), [120.0, 120.0, 112.0]),
    ]
}

#[test]
fn each_rule_makes_of_each_row_of_the_table_what_it_says() {
    for (name, mesh, volumes) in table() {
        for (inside, expected) in RULES.into_iter().zip(volumes) {
            let outcome = repair(&mesh, &options(32, inside), &Progress::none()).expect("a solid");
            let (found, report) = (volume(&outcome), &outcome.report);
            assert_eq!(report.inside, inside);
            // What stands is exact, and so is what is cut; where voids touch at an edge, vertices are moved apart by a few numbers.
            assert!(!report.lattice && report.exact.is_some() == name.contains("overlap"), "{name}, {inside:?}");
            let touches = report.exact.as_ref().is_some_and(|exact| exact.separated > 0);
            let allowed = if touches { 4e-6 } else { 1e-12 };
            assert!((found - expected).abs() <= allowed, "{name}, {inside:?}: {found} for {expected}");
        }
    }
}

#[test]
fn rays_and_winding_numbers_say_the_same_as_shells_that_stand() {
    for (name, mesh, volumes) in table() {
        for (inside, expected) in RULES.into_iter().zip(volumes) {
            let rebuild = Some(FitOptions { rebuild: true, ..FitOptions::default() });
            let anew = Options { fit: rebuild, ..options(32, inside) };
            let found = volume(&repair(&mesh, &anew, &Progress::none()).expect("a solid"));
            assert!((found - expected).abs() <= 2e-3 * expected, "{name}, {inside:?}: {found} for {expected}");
        }
    }
}

#[test]
fn a_file_that_is_trusted_is_taken_by_its_word() {
    let keep = |inside| Options { orient: OrientMode::Keep, ..options(32, inside) };
    for (name, mesh, [_, nonzero, odd]) in table() {
        for (inside, expected) in [(Inside::Nonzero, nonzero), (Inside::Odd, odd)] {
            let found = volume(&repair(&mesh, &keep(inside), &Progress::none()).expect("a solid"));
            assert!((found - expected).abs() <= 2e-3 * expected, "{name}, {inside:?}: {found} for {expected}");
        }
    }
    let inverted = repair(&cube(0.0, 4.0, true), &keep(Inside::Positive), &Progress::none());
    assert!(matches!(inverted, Err(BooleanError::Nothing(_))));
}

#[test]
fn with_holes_each_rule_makes_what_it_makes_of_the_whole() {
    for (name, mesh, volumes) in table() {
        // Of each cube one of the two triangles of its side at the least x is gone, where no other cube is.
        let holes = |t: usize| t % 12 == 8;
        let triangles = mesh.triangles.iter().enumerate().filter(|(t, _)| !holes(*t)).map(|(_, t)| *t).collect();
        let open = TriMesh { positions: mesh.positions.clone(), triangles };
        for (inside, expected) in RULES.into_iter().zip(volumes) {
            let found = volume(&repair(&open, &options(32, inside), &Progress::none()).expect("a solid"));
            assert!((found - expected).abs() <= 0.04 * expected, "{name}, {inside:?}: {found} for {expected}");
        }
    }
}

#[test]
fn a_patch_is_turned_to_the_surface_that_it_is_a_part_of_by_every_rule() {
    // A cube of two halves that share no vertex, the upper one facing inwards: rays across both see it enter twice.
    let (mut lower, mut upper) = (
        cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 2.0)),
        cuboid(DVec3::new(0.0, 0.0, 2.0 + 1e-5), DVec3::new(4.0, 4.0, 4.0)),
    );
    lower.triangles.drain(2..4);
    upper.triangles.drain(0..2);
    let cracked = joined([lower, facing(upper, true)]);
    for inside in RULES {
        let cracked = |tolerance: Option<f64>| {
            let options = meshwright::Options { tolerance, ..options(32, inside) };
            repair(&cracked, &options, &Progress::none()).expect("a solid")
        };
        let outcome = cracked(Some(0.0));
        let found = volume(&outcome);
        assert!((found - 64.0).abs() < 0.5, "{inside:?}: {found}");
        assert!(outcome.report.orient[0].flipped_patches == 1, "{inside:?}");
        // A crack as narrow as that is closed first, and neighbours agree.
        let outcome = cracked(None);
        let found = volume(&outcome);
        assert!((found - 64.0).abs() < 1e-3 && !outcome.report.lattice, "{inside:?}: {found}");
        assert_eq!(outcome.report.orient[0].flipped_in_patches, 10, "{inside:?}");
    }
}

/// Integer boxes, and whether each faces inwards.
fn any_boxes() -> impl Strategy<Value = Vec<([i32; 3], [i32; 3], bool)>> {
    let one = (prop::array::uniform3(-5i32..5), prop::array::uniform3(1i32..7), any::<bool>());
    prop::collection::vec(one, 1..6)
}

fn point(p: [i32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

fn soup(boxes: &[([i32; 3], [i32; 3], bool)]) -> TriMesh {
    joined(boxes.iter().map(|&(low, size, inwards)| facing(cuboid(point(low), point(low) + point(size)), inwards)))
}

/// How often the boxes wind around a point that lies on none of them.
fn number(boxes: &[([i32; 3], [i32; 3], bool)], p: DVec3) -> i32 {
    let around = |low: [i32; 3], size: [i32; 3]| {
        let (low, high) = (point(low), point(low) + point(size));
        p.cmpgt(low).all() && p.cmplt(high).all()
    };
    boxes.iter().filter(|(low, size, _)| around(*low, *size)).map(|b| if b.2 { -1 } else { 1 }).sum()
}

fn votes(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule, inside: Inside) -> Grid<Votes> {
    let soup = Soup::as_it_is(mesh.clone()).with_inside(inside);
    let cast = Cast::on_cpu(soup, lattice, OrientMode::Keep, &Progress::none()).expect("not stopped");
    let survey = Survey::of(cast, &Expression::Operand(0), &Progress::none()).expect("not stopped");
    if !inside.needs_outward() {
        assert_eq!(survey.silent_rays(), 0, "closed surfaces leave every ray balanced");
    }
    survey.votes(rule, &survey.winding(&Progress::none()), &Progress::none()).expect("not stopped")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    /// Voxels lie in the middle between integers, where no box has a side. By `positive` rays are silent behind what faces inwards, and the
    /// winding number has to say it.
    #[test]
    fn a_voxel_is_inside_where_its_winding_number_is(boxes in any_boxes(), rule in 0usize..3) {
        let mesh = soup(&boxes);
        let bounds = mesh.bounds().expect("triangles");
        let room = Bounds { min: bounds.min.floor() - 1.75, max: bounds.max + 2.0 };
        let dims = ((room.max - room.min) * 2.0).ceil().as_ivec3();
        let lattice = Lattice { origin: room.min, h: 0.5, dims };
        let inside = RULES[rule];
        let grid = votes(&mesh, &lattice, VoteRule::Winding, inside);
        for n in 0..dims.element_product() {
            let voxel = IVec3::new(n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y));
            let times = number(&boxes, lattice.to_model(voxel.as_dvec3()));
            prop_assert_eq!(grid.get(voxel).is_inside, inside.holds(times), "{:?} {} at {}", inside, times, voxel);
        }
    }

    /// The outlines of `sdf --sign levels` and its winding numbers.
    #[test]
    fn distances_have_the_signs_of_winding_numbers(boxes in any_boxes(), rule in 0usize..3, levels in any::<bool>()) {
        let (mesh, inside) = (soup(&boxes), RULES[rule]);
        let sign = if levels { DistanceSign::Levels } else { DistanceSign::Winding };
        let asked = DistanceOptions {
            sign, inside, orient: OrientMode::Keep, method: DistanceMethod::Exact,
            ..DistanceOptions::new(VoxelSize::Length(0.57))
        };
        let field = distance(&mesh, &asked, &Progress::none()).expect("a field").field;
        let dims = field.lattice.dims;
        for n in 0..dims.element_product() {
            let voxel = IVec3::new(n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y));
            let value = field.grid.get(voxel);
            let expected = inside.holds(number(&boxes, field.lattice.to_model(voxel.as_dvec3())));
            prop_assert!(value.abs() < 1e-4 || (value < 0.0) == expected, "{inside:?} {value} at {voxel}");
        }
    }

    /// Shells in each other, facing any way, apart from other ones: exact, whatever the voxel.
    #[test]
    fn shells_in_each_other_are_counted_exactly(
        inwards in prop::collection::vec(any::<bool>(), 1..7), rule in 1usize..3, resolution in 2u32..100
    ) {
        let side = |k: usize| 2.0 * (inwards.len() - k) as f64;
        let shells = inwards.iter().enumerate().map(|(k, &inwards)| cube(k as f64, k as f64 + side(k), inwards));
        let mut times = 0;
        let mut expected = 0.0;
        for (k, &inwards) in inwards.iter().enumerate() {
            times += if inwards { -1 } else { 1 };
            let hole = if k + 1 < shells.len() { side(k + 1).powi(3) } else { 0.0 };
            expected += if RULES[rule].holds(times) { side(k).powi(3) - hole } else { 0.0 };
        }
        let outcome = repair(&joined(shells), &options(resolution, RULES[rule]), &Progress::none()).expect("a solid");
        prop_assert!(!outcome.report.lattice && outcome.report.standing.turned == 0);
        let found = volume(&outcome);
        prop_assert!((found - expected).abs() <= 1e-14 * expected, "{} for {}", found, expected);
    }
}

#[test]
fn each_operand_of_a_boolean_is_counted_by_itself() {
    // A hollow cube by `odd`, both shells facing outwards, and a bar through its middle.
    let hollow = joined([cube(0.0, 4.0, false), cube(1.0, 3.0, false)]);
    let bar = cuboid(DVec3::new(-1.0, 1.5, 1.5), DVec3::new(5.0, 2.5, 2.5));
    for (inside, union, common) in [(Inside::Odd, 60.0, 2.0), (Inside::Nonzero, 66.0, 4.0)] {
        for (expression, expected) in [(Expression::union(2), union), (Expression::intersection(2), common)] {
            let made = boolean([&hollow, &bar], &expression, &options(60, inside), &Progress::none()).expect("a solid");
            let found = volume(&made);
            assert!((found - expected).abs() < 2e-3 * expected, "{inside:?} {expression:?}: {found}");
        }
    }
}

#[test]
fn bodies_inside_others_are_left_out_and_counted_but_by_odd_they_are_voids() {
    let mesh = joined([cube(0.0, 8.0, false), cube(1.0, 3.0, false), cube(5.0, 7.0, false)]);
    for (inside, left_out, expected) in
        [(Inside::Positive, 2, 512.0), (Inside::Nonzero, 2, 512.0), (Inside::Odd, 0, 496.0)]
    {
        let outcome = repair(&mesh, &options(16, inside), &Progress::none()).expect("a solid");
        assert_eq!(outcome.report.standing.left_out, left_out, "{inside:?}");
        assert!((volume(&outcome) - expected).abs() < 1e-10, "{inside:?}");
    }
}

#[test]
fn bodies_that_cross_or_have_holes_inside_others_are_counted_and_not_told_as_lost() {
    let big = cube(0.0, 8.0, false);
    let mut open = cube(2.0, 5.0, false);
    open.triangles.pop();
    let crossing = joined([cube(1.0, 3.0, false), cube(2.0, 4.0, false)]);
    for (mesh, count) in [(joined([big.clone(), open.clone()]), 1), (joined([big.clone(), crossing.clone()]), 2)] {
        let outcome = repair(&mesh, &options(32, Inside::Positive), &Progress::none()).expect("a solid");
        let topology = outcome.report.topology.as_ref().expect("a repair has one");
        assert_eq!((topology.buried, topology.lost_count, topology.is_large()), (count, 0, false));
        assert_eq!((outcome.solid.triangles.len(), volume(&outcome)), (12, 512.0));
        // Where each surface swaps the sides, they are voids.
        let odd = repair(&mesh, &options(32, Inside::Odd), &Progress::none()).expect("a solid");
        assert_eq!(odd.report.topology.as_ref().map(|topology| topology.buried), Some(0));
        assert!(volume(&odd) < 499.0, "{}", volume(&odd));
    }
    // Of several operands: in a union they are gone; taken away they are not, but for the cube that lies in another one that is.
    let operands = [big, open, crossing];
    let by = |expression: &Expression| {
        boolean(&operands, expression, &options(32, Inside::Positive), &Progress::none()).expect("a solid")
    };
    let union = by(&Expression::union(3));
    assert_eq!((union.report.topology.as_ref().map(|topology| topology.buried), volume(&union)), (Some(3), 512.0));
    let less = by(&Expression::difference(3));
    assert_eq!(less.report.topology.as_ref().map(|topology| topology.buried), Some(1));
    // Outside of what all have in common, too.
    let far = cuboid(DVec3::splat(20.0), DVec3::splat(24.0));
    let mut broken = cuboid(DVec3::splat(30.0), DVec3::splat(34.0));
    broken.triangles.pop();
    let common = boolean(
        [&joined([operands[0].clone(), broken]), &joined([operands[0].clone(), far])],
        &Expression::intersection(2),
        &options(32, Inside::Positive),
        &Progress::none(),
    )
    .expect("a solid");
    // The broken one, and the second of the two equal cubes, which the first stands for.
    assert_eq!(common.report.topology.map(|topology| topology.buried), Some(2));
}

#[test]
fn a_body_that_is_there_twice_counts_once_by_every_rule() {
    let twice = joined([cube(0.0, 4.0, false), cube(0.0, 4.0, false)]);
    for inside in RULES {
        let outcome = repair(&twice, &options(32, inside), &Progress::none()).expect("a solid");
        assert_eq!((outcome.report.orient[0].duplicates_dropped, volume(&outcome)), (12, 64.0), "{inside:?}");
    }
}
