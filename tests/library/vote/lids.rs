//! Lids: the level ½ of the winding number, edge by edge.

use glam::{DMat3, DVec3, IVec3};
use meshwright::lattice::Lattice;
use meshwright::ldi::{Expression, Inside, Operands};
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::vote::{Lid, Winding};
use proptest::prelude::*;

use crate::common::{shapes, stages};

/// The winding number, summed over all triangles.
fn winding(mesh: &TriMesh, p: DVec3) -> f64 {
    let solid_angle = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|q| q - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(denominator)
    };
    (0..mesh.triangles.len()).map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Outwards from the sides of [`shapes::cuboid`].
const SIDES: [DVec3; 6] = [DVec3::NEG_Z, DVec3::Z, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X, DVec3::X];

fn without(mut mesh: TriMesh, missing: impl Fn(usize) -> bool) -> TriMesh {
    let mut t = 0;
    mesh.triangles.retain(|_| {
        t += 1;
        !missing(t - 1)
    });
    mesh
}

/// A box without some of its [`SIDES`].
fn open_box(min: DVec3, max: DVec3, missing: &[usize]) -> TriMesh {
    without(shapes::cuboid(min, max), |t| missing.contains(&(t / 2)))
}

fn turned(mut mesh: TriMesh, turn: DMat3) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
    mesh
}

/// Calls `visit` with each lattice edge whose first end only is inside by `inside`, and its lid.
fn each_edge(
    operands: &[TriMesh],
    expression: &Expression,
    resolution: u32,
    inside: impl Fn(DVec3) -> bool,
    visit: impl FnMut(DVec3, DVec3, Option<Lid>),
) {
    each_edge_by(Inside::Positive, operands, expression, resolution, inside, visit);
}

/// The same where other winding numbers of an operand are inside.
fn each_edge_by(
    rule: Inside,
    operands: &[TriMesh],
    expression: &Expression,
    resolution: u32,
    inside: impl Fn(DVec3) -> bool,
    mut visit: impl FnMut(DVec3, DVec3, Option<Lid>),
) {
    let mut soup = TriMesh::default();
    operands.iter().for_each(|operand| soup.append(operand));
    let lattice = stages::lattice_of(&soup, resolution);
    let counts = Operands::new(operands.iter().map(|operand| operand.triangles.len())).with_inside(rule);
    let winding = Winding::new(&soup, &counts, &lattice, &Progress::none());
    let model = |voxel: IVec3| lattice.to_model(voxel.as_dvec3());
    for voxel in voxels(&lattice) {
        if !inside(model(voxel)) {
            continue;
        }
        for step in [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z] {
            let other = voxel + step;
            if !inside(model(other)) {
                visit(model(voxel), model(other), winding.crossing(voxel, other, expression).expect("not stopped"));
            }
        }
    }
}

fn voxels(lattice: &Lattice) -> impl Iterator<Item = IVec3> {
    super::all_voxels(lattice)
}

fn place(from: DVec3, to: DVec3, lid: &Lid) -> DVec3 {
    from + (to - from) * lid.t
}

fn any_turn() -> impl Strategy<Value = DMat3> {
    (prop::array::uniform3(-1.0f64..1.0), 0.0f64..6.3).prop_map(|(axis, angle)| {
        DMat3::from_axis_angle(DVec3::from_array(axis).try_normalize().unwrap_or(DVec3::Z), angle)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, ..ProptestConfig::default() })]

    #[test]
    fn over_the_missing_side_of_a_turned_cube_lies_its_plane(turn in any_turn(), missing in 0usize..6) {
        let mesh = turned(open_box(DVec3::splat(-0.5), DVec3::splat(0.5), &[missing]), turn);
        let plane = turn * SIDES[missing];
        let inside = |p: DVec3| (turn.transpose() * p).abs().max_element() < 0.5;
        let (mut lids, mut worst, mut tilt) = (0, 0.0f64, 0.0f64);
        let mut others = 0;
        each_edge(std::slice::from_ref(&mesh), &Expression::Operand(0), 32, inside, |from, to, lid| {
            let across = (plane.dot(from) - 0.5) * (plane.dot(to) - 0.5) < 0.0;
            let crossing = from + (to - from) * (0.5 - plane.dot(from)) / plane.dot(to - from);
            let on_lid = across && (turn.transpose() * crossing).abs().max_element() < 0.5 + 1e-12;
            match lid {
                Some(lid) if on_lid => {
                    lids += 1;
                    let error = (plane.dot(place(from, to, &lid)) - 0.5).abs();
                    worst = worst.max(error);
                    // Right beside the rim the field turns within less than the place is known to.
                    if (turn.transpose() * crossing).abs().to_array().iter().filter(|x| **x < 0.499).count() == 2 {
                        tilt = tilt.max(lid.normal.distance(plane));
                    }
                }
                None if !on_lid => {}
                _ => others += 1,
            }
        });
        prop_assert!(lids > 300 && others == 0, "{lids} lids, {others} others");
        prop_assert!(worst < 1e-9 && tilt < 1e-8, "{worst} off, {tilt} tilted");
    }

    #[test]
    fn lids_are_where_the_sum_over_all_triangles_says(
        turn in any_turn(),
        offset in prop::array::uniform3(-0.6f64..0.6),
        holes in 1u32..4,
        which in 0usize..4,
        rule in prop::sample::select(vec![Inside::Positive, Inside::Nonzero, Inside::Odd]),
        inwards in any::<bool>(),
    ) {
        // Bent rims on a torus, and an open box that meets it.
        let torus = without(shapes::torus(24, 12), |t| t % 192 < 40 * holes as usize);
        // No rim shall lie on a lattice edge.
        let torus = turned(torus, DMat3::from_rotation_z(0.1) * DMat3::from_rotation_x(0.2));
        let offset = DVec3::from_array(offset);
        let mut open = turned(open_box(offset - 0.7, offset + 0.7, &[1, 4]), turn);
        open.triangles.iter_mut().filter(|_| inwards).for_each(|t| t.swap(1, 2));
        let [a, b] = [0, 1].map(|n| Box::new(Expression::Operand(n)));
        let expression = [
            Expression::union(2),
            Expression::intersection(2),
            Expression::Difference(a.clone(), b.clone()),
            Expression::SymmetricDifference(b, a),
        ][which].clone();
        let compared = compare(&[torus.clone(), open.clone()], &expression, rule);
        // An intersection or a difference may lose all of them.
        prop_assert!(compared > 0 || which == 1 || which == 2, "no lid at all");
        // Both in one operand: where they overlap its number passes other levels.
        let mut both = torus;
        both.append(&open);
        let nothing = shapes::cuboid(DVec3::ZERO, DVec3::splat(0.01));
        prop_assert!(compare(&[both, nothing], &Expression::Operand(0), rule) > 0, "no lid of the sum");
    }
}

/// Compares the lids of all lattice edges with the summed winding numbers; returns how many there
/// were.
fn compare(operands: &[TriMesh; 2], expression: &Expression, rule: Inside) -> usize {
    let values = |p: DVec3| [0, 1].map(|n| winding(&operands[n], p));
    let inside = |p: DVec3| expression.evaluate(&values(p).map(|w| rule.holds_near(w)));
    let mut compared = 0;
    each_edge_by(rule, operands, expression, 16, inside, |from, to, lid| {
        let around = |t: f64| [t - 1e-9, t + 1e-9].map(|t| values(from.lerp(to, t)));
        let passing =
            |sides: [[f64; 2]; 2]| (0..2).find(|&n| rule.holds_near(sides[0][n]) != rule.holds_near(sides[1][n]));
        let Some(lid) = lid else {
            // Then a triangle makes the change, or several rims that are hard to tell apart.
            let (mut low, mut high) = (0.0, 1.0);
            while high - low > 1e-12 {
                let middle = (low + high) / 2.0;
                *(if inside(from.lerp(to, middle)) { &mut low } else { &mut high }) = middle;
            }
            let sides = around(low);
            let n = passing(sides).expect("an operand that changes");
            let change = (sides[0][n] - sides[1][n]).abs();
            assert!(change > 1e-6, "no lid between {from} and {to} at {low}");
            return;
        };
        let (p, sides) = (place(from, to, &lid), around(lid.t));
        let [before, after] = sides.map(|values| expression.evaluate(&values.map(|w| rule.holds_near(w))));
        assert!(before && !after, "{lid:?} between {from} and {to}: {sides:?}");
        let n = passing(sides).expect("an operand that changes");
        let steep = (sides[0][n] - sides[1][n]).abs() * 5e8;
        let w = winding(&operands[n], p);
        let off = w - 0.5 - (w - 0.5).round();
        assert!(off.abs() < 1e-10 * (1.0 + steep), "{lid:?} at {p}: {w}, {steep}");
        let difference = |axis: DVec3| {
            let change = values(p + axis * 1e-7)[n] - values(p - axis * 1e-7)[n];
            change - change.round()
        };
        let gradient = DVec3::from_array(DVec3::AXES.map(difference)).normalize();
        let outwards = if sides[0][n] > sides[1][n] { -gradient } else { gradient };
        // Right beside a rim the differences are not good enough.
        assert!(steep > 300.0 || lid.normal.distance(outwards) < 1e-5, "{lid:?} and {outwards} at {p}");
        compared += 1;
    });
    compared
}

#[test]
fn two_opposite_holes_have_a_lid_each() {
    let mesh = open_box(DVec3::splat(-0.5), DVec3::splat(0.5), &[0, 1]);
    let inside = |p: DVec3| winding(&mesh, p) > 0.5;
    let mut lids = [0, 0];
    each_edge(std::slice::from_ref(&mesh), &Expression::Operand(0), 20, inside, |from, to, lid| {
        if let Some(lid) = lid {
            let p = place(from, to, &lid);
            let w = winding(&mesh, p);
            assert!((w - 0.5).abs() < 1e-10, "{w} at {p}");
            assert!(lid.normal.z * p.z > 0.0, "{lid:?} at {p}");
            lids[usize::from(p.z > 0.0)] += 1;
        } else {
            // A wall makes the change.
            assert!(from.truncate().abs().max_element() < 0.5 && to.truncate().abs().max_element() > 0.5);
        }
    });
    assert!(lids[0] > 300 && lids[1] > 300, "{lids:?}");
}

#[test]
fn two_open_boxes_in_one_operand_have_the_lid_of_their_sum() {
    // The smaller one pierces the lid of the larger one; where both are, the winding number passes 1½ too.
    let mut mesh = open_box(DVec3::splat(-0.5), DVec3::splat(0.5), &[1]);
    mesh.append(&open_box(DVec3::new(-0.2, -0.3, 0.1), DVec3::new(0.3, 0.2, 0.9), &[1]));
    let inside = |p: DVec3| winding(&mesh, p) > 0.5;
    let (mut lids, mut upper) = (0, 0);
    each_edge(std::slice::from_ref(&mesh), &Expression::Operand(0), 24, inside, |from, to, lid| {
        if let Some(lid) = lid {
            let w = winding(&mesh, place(from, to, &lid));
            assert!((w - 0.5).abs() < 1e-10, "{w}");
            lids += 1;
            upper += usize::from(from.z > 0.6);
        }
    });
    assert!(lids > 300 && upper > 50, "{lids} {upper}");
}

#[test]
fn a_subtracted_operand_faces_into_itself() {
    // An open box taken out of a closed one: the lid over its opening looks into the hollow.
    let block = shapes::cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
    let tool = open_box(DVec3::splat(-0.5), DVec3::splat(0.5), &[5]);
    let expression = Expression::difference(2);
    let inside = |p: DVec3| p.abs().max_element() < 1.0 && p.abs().max_element() > 0.5;
    let mut lids = 0;
    each_edge(&[block, tool], &expression, 40, inside, |from, to, lid| {
        if from.x > 0.5 && to.x < 0.5 {
            let lid = lid.expect("a lid over the missing side");
            assert!((place(from, to, &lid).x - 0.5).abs() < 1e-12);
            assert!(lid.normal.distance(DVec3::NEG_X) < 1e-8, "{lid:?}");
            lids += 1;
        } else {
            assert_eq!(lid, None);
        }
    });
    assert!(lids > 300, "{lids}");
}

#[test]
fn the_same_lid_of_two_operands_is_one() {
    let mesh = open_box(DVec3::splat(-0.5), DVec3::splat(0.5), &[1]);
    let inside = |p: DVec3| p.abs().max_element() < 0.5;
    for (expression, found) in
        [(Expression::union(2), true), (Expression::intersection(2), true), (Expression::difference(2), false)]
    {
        each_edge(&[mesh.clone(), mesh.clone()], &expression, 12, inside, |from, to, lid| {
            let expected = found && to.z > 0.5;
            assert_eq!(lid.is_some(), expected, "{expression:?}");
            if let Some(lid) = lid {
                assert!((place(from, to, &lid).z - 0.5).abs() < 1e-12 && lid.normal.z > 1.0 - 1e-12);
            }
        });
    }
}

#[test]
fn closed_operands_have_no_lids() {
    for which in 0..4 {
        let (name, mesh) = shapes::closed(which);
        let lattice = stages::lattice_of(&mesh, 24);
        let operands = Operands::new([mesh.triangles.len()]);
        let winding = Winding::new(&mesh, &operands, &lattice, &Progress::none());
        for voxel in voxels(&lattice) {
            for axis in IVec3::AXES {
                let lid = winding.crossing(voxel, voxel + axis, &Expression::Operand(0));
                assert_eq!(lid, Ok(None), "{name} at {voxel}");
            }
        }
    }
}

#[test]
fn a_soup_of_loose_triangles_has_lids_too() {
    // Every third triangle of a torus is missing: 8192 boundary edges, more than are summed one by one.
    let mesh = without(shapes::torus(128, 64), |t| t % 6 < 2);
    let inside = |p: DVec3| winding(&mesh, p) > 0.5;
    let (mut lids, mut edges) = (0, 0);
    each_edge(std::slice::from_ref(&mesh), &Expression::Operand(0), 12, inside, |from, to, lid| {
        edges += 1;
        if let Some(lid) = lid {
            let w = winding(&mesh, place(from, to, &lid));
            assert!((w - 0.5).abs() < 2e-3, "{w}");
            lids += 1;
        }
    });
    assert!(lids > 50, "{lids} of {edges}");
}
