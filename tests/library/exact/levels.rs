//! Sides by outlines in planes along z.

use glam::{DVec3, IVec3};
use meshwright::lattice::{Grid, Lattice};
use meshwright::ldi::Inside;
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::Levels;
use meshwright::sdf::exact::{Band, ExactOptions, Sign, exact};
use proptest::prelude::*;

use crate::common::exact::{distance_to, lattice, same_sides, threads_leave_levels_alone, voxels, winding};
use crate::common::shapes::{self, ball, hard, knot, scan};

fn levels(mesh: &TriMesh, lattice: &Lattice) -> Levels {
    Levels::of(mesh, lattice, Inside::Positive, &Progress::none()).expect("levels")
}

fn field(mesh: &TriMesh, lattice: &Lattice, sign: Sign<'_>, band: Band) -> Grid<f32> {
    let options = ExactOptions { band, max_memory: None };
    exact(mesh, lattice, sign, &options, &Progress::none()).expect("a field").grid
}

#[test]
fn closed_meshes_have_the_sides_of_their_normals() {
    for (name, mesh) in hard() {
        for band in [Band::Within(3.0), Band::Full] {
            same_sides(name, &mesh, &lattice(&mesh, 1.0 / 40.0, 3), band);
        }
    }
    let knot = knot(96, 16);
    let size = knot.bounds().expect("triangles").size().max_element();
    assert!(same_sides("knot", &knot, &lattice(&knot, size / 100.0, 3), Band::Within(3.0)) > 10_000);
}

/// Vertices, edges and sides on voxels: all else is as if they were not.
#[test]
fn a_surface_through_the_voxels_makes_no_trouble() {
    let around = Lattice { origin: DVec3::splat(-1.0), h: 0.125, dims: IVec3::splat(17) };
    let ball = ball(1, |_| 0.5);
    let count = same_sides("octahedron's corners", &ball, &around, Band::Full);
    assert!(count > 100, "{count}");
    // Of the voxels on the sides of a box those on the lower ones are outside: 4 instead of 5 along each axis.
    let cuboid = shapes::cuboid(DVec3::splat(-0.25), DVec3::splat(0.25));
    assert_eq!(same_sides("box", &cuboid, &around, Band::Full), 3 * 3 * 3, "without those at distance 0");
    let levels = levels(&cuboid, &around);
    assert_eq!(voxels(&around).filter(|&v| levels.is_inside(v)).count(), 4 * 4 * 4);
}

/// Shells that overlap are one solid, a shell that faces inwards is a void, and one that does so alone is nothing.
#[test]
fn shells_count_as_they_face() {
    let cuboid = |a: f64, b: f64| shapes::cuboid(DVec3::splat(a), DVec3::splat(b));
    let around = lattice(&cuboid(0.0, 1.0), 1.0 / 20.0, 1);
    let count = |mesh: &TriMesh| {
        let levels = levels(mesh, &around);
        voxels(&around).filter(|&v| levels.is_inside(v)).count()
    };
    let mut void = cuboid(0.25, 0.5);
    void.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert_eq!(count(&void), 0);
    let (mut hollow, mut doubled) = (cuboid(0.0, 1.0), cuboid(0.0, 1.0));
    hollow.append(&void);
    doubled.append(&cuboid(0.25, 0.5));
    let whole = count(&cuboid(0.0, 1.0));
    assert_eq!(count(&doubled), whole);
    assert_eq!(count(&hollow), whole - count(&cuboid(0.25, 0.5)));
}

#[test]
fn small_holes_change_nothing_a_voxel_away() {
    let whole = ball(4, |_| 0.5);
    let around = lattice(&whole, 1.0 / 40.0, 2);
    let (mut holed, mut lids) = (whole.clone(), Vec::new());
    for n in (0..whole.triangles.len()).step_by(97).rev() {
        lids.push(whole.corners(n));
        holed.triangles.remove(n);
    }
    let by_levels = field(&holed, &around, Sign::Levels(&levels(&holed, &around)), Band::Within(3.0));
    let truth = field(&whole, &around, Sign::Pseudonormal, Band::Within(3.0));
    for v in voxels(&around).filter(|&v| (by_levels.get(v) < 0.0) != (truth.get(v) < 0.0)) {
        let p = around.to_model(v.as_dvec3());
        let from_lid = lids.iter().map(|&lid| distance_to(p, lid) / around.h).fold(f64::INFINITY, f64::min);
        assert!(from_lid < 1.0, "{v} is {from_lid} h from the nearest lid");
    }
}

/// Straight lids level by level: the missing side of a box is as it was, whichever it is.
#[test]
fn a_flat_side_that_is_missing_comes_back() {
    let [low, high] = [DVec3::ZERO, DVec3::new(1.0, 0.8, 0.6)];
    for side in 0..6 {
        let mut mesh = shapes::cuboid(low, high);
        let around = lattice(&mesh, 1.0 / 50.0, 2);
        mesh.triangles.drain(2 * side..2 * side + 2);
        let grid = field(&mesh, &around, Sign::Levels(&levels(&mesh, &around)), Band::Within(2.0));
        for v in voxels(&around) {
            let p = around.to_model(v.as_dvec3());
            let inside = p.cmpgt(low).all() && p.cmplt(high).all();
            assert_eq!(grid.get(v) < 0.0, inside, "side {side}, {v}");
        }
    }
}

#[test]
fn a_flat_sheet_encloses_nothing() {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let positions = corners.map(|(x, y)| DVec3::new(x, y, 0.71 * x + 0.33 * y)).to_vec();
    let mesh = TriMesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] };
    let around = lattice(&mesh, 1.0 / 64.0, 2);
    let levels = levels(&mesh, &around);
    assert_eq!(voxels(&around).find(|&v| levels.is_inside(v)), None);
    let grid = field(&mesh, &around, Sign::Levels(&levels), Band::Within(2.0));
    assert!(voxels(&around).all(|v| grid.get(v) >= 0.0));
}

#[test]
fn threads_do_not_change_a_bit() {
    threads_leave_levels_alone(scan());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the triangles, every voxel has a side, and none is inside beyond the triangles' box.
    #[test]
    fn any_soup_has_sides(
        positions in prop::collection::vec([-9..9_i32, -9..9, -9..9], 3..20),
        corners in prop::collection::vec([0..20_usize, 0..20, 0..20], 1..40),
    ) {
        let count = positions.len();
        let mesh = TriMesh {
            positions: positions.iter().map(|&p| IVec3::from(p).as_dvec3() / 4.0).collect(),
            triangles: corners.iter().map(|t| t.map(|v| (v % count) as u32)).collect(),
        };
        let bounds = mesh.bounds().expect("triangles");
        let around = Lattice { origin: DVec3::splat(-2.0), h: 0.25, dims: IVec3::splat(14) };
        let levels = levels(&mesh, &around);
        for v in voxels(&around).filter(|&v| levels.is_inside(v)) {
            let p = around.to_model(v.as_dvec3());
            prop_assert!(p.cmpge(bounds.min).all() && p.cmple(bounds.max).all(), "{}", v);
        }
    }

    /// Closed, but through itself: inside is where the surface winds around at least once.
    #[test]
    fn closed_soups_have_the_sides_of_their_winding_numbers(
        positions in prop::collection::vec([-0.9..0.9_f64, -0.9..0.9, -0.9..0.9], 4..7),
    ) {
        // The surfaces of tetrahedra over each four points in a row.
        let count = positions.len() as u32;
        let tetrahedra = (0..count).map(|n| [n, (n + 1) % count, (n + 2) % count, (n + 3) % count]);
        let sides = tetrahedra.flat_map(|[a, b, c, d]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]);
        let mesh = TriMesh { positions: positions.iter().map(|&p| p.into()).collect(), triangles: sides.collect() };
        let around = Lattice { origin: DVec3::splat(-1.0), h: 0.17, dims: IVec3::splat(13) };
        let levels = levels(&mesh, &around);
        for v in voxels(&around).step_by(3) {
            let p = around.to_model(v.as_dvec3());
            let near = (0..mesh.triangles.len()).map(|t| distance_to(p, mesh.corners(t))).fold(f64::INFINITY, f64::min);
            prop_assert!(near < 1e-9 || levels.is_inside(v) == (winding(&mesh, p) > 0.5), "{}", v);
        }
    }
}
