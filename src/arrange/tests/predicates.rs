//! Points and planes: coordinates up to 2³⁰, so that nothing may overflow.

use num_bigint::BigInt;
use proptest::prelude::*;

use super::super::fine::ERROR;
use super::super::flat::FlatPoints;
use super::super::plane::Plane;
use super::super::point::{Exact, Made, Points};
use super::{Ratio, place, sign, triangle};

/// Whether a point lies on a plane.
fn is_on(p: &Ratio, plane: &Plane) -> bool {
    let sum: BigInt = (0..3).map(|k| &p.at[k] * plane.normal[k]).sum();
    sum == &p.w * plane.offset
}

/// Whether the approximate coordinates are within the error that is promised.
fn is_approximated(p: &Ratio, exact: &Exact) -> bool {
    exact.approximate().to_array().iter().zip(&p.at).all(|(&x, at)| {
        // Multiples of 2⁻⁷⁰, less than what is cut off matters.
        let unit = 2f64.powi(40);
        let scaled = BigInt::from((x * unit) as i128);
        let off: BigInt = &scaled * &p.w - (at << 40);
        let room: BigInt = (&p.w * BigInt::from((ERROR * unit) as i128)) + &p.w;
        off.magnitude() <= room.magnitude()
    })
}

/// How the points turn, seen along an axis from its tip.
fn turn([a, b, c]: [&Ratio; 3], i: usize, j: usize) -> i32 {
    let part = |p: &Ratio, q: &Ratio, k: usize| &q.at[k] * &p.w - &p.at[k] * &q.w;
    sign(&(part(a, b, i) * part(a, c, j) - part(a, b, j) * part(a, c, i)))
}

fn compare(a: &Ratio, b: &Ratio, k: usize) -> std::cmp::Ordering {
    (&a.at[k] * &b.w).cmp(&(&b.at[k] * &a.w))
}

proptest! {
    // Of lines and planes drawn at random, half do not meet.
    #![proptest_config(ProptestConfig {
        cases: 4000, max_global_rejects: 100_000, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn values_of_lattice_points((corners, plane) in triangle(), p in place()) {
        prop_assert_eq!(BigInt::from(plane.value(p)), Ratio::lattice(p).volume(corners));
        prop_assert_eq!(Exact::lattice(p).side_of(&plane), sign(&Ratio::lattice(p).volume(corners)));
        let clear = plane.clear_side(glam::DVec3::from_array(p.map(f64::from)));
        prop_assert!(clear == 0 || clear == sign(&Ratio::lattice(p).volume(corners)));
    }

    #[test]
    fn a_line_meets_a_plane((_, plane) in triangle(), (other, side) in triangle(), a in place(), b in place()) {
        let (one, two) = (plane.value(a), plane.value(b));
        prop_assume!(one.signum() * two.signum() < 0);
        let exact = Exact::on_line([a, b], one, two);
        let p = Ratio::of(&exact);
        prop_assert!(sign(&p.w) > 0);
        prop_assert!(is_on(&p, &plane));
        let from_a = [0, 1, 2].map(|k| &p.at[k] - &p.w * a[k]);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let [x, y] = [i, j].map(|k| i64::from(b[k]) - i64::from(a[k]));
            prop_assert_eq!(&from_a[i] * y, &from_a[j] * x);
        }
        prop_assert!(is_approximated(&p, &exact));
        prop_assert_eq!(exact.side_of(&side), sign(&p.volume(other)));
    }

    #[test]
    fn three_planes_meet((_, p) in triangle(), (_, q) in triangle(), (_, r) in triangle(), (other, side) in triangle()) {
        let n = [&p, &q, &r].map(|plane| plane.normal.map(BigInt::from));
        let minor = |i: usize, j: usize| &n[1][i] * &n[2][j] - &n[1][j] * &n[2][i];
        let determinant = &n[0][0] * minor(1, 2) + &n[0][1] * minor(2, 0) + &n[0][2] * minor(0, 1);
        let Some(exact) = Exact::of_planes([&p, &q, &r]) else {
            prop_assert_eq!(determinant, BigInt::ZERO);
            return Ok(());
        };
        let found = Ratio::of(&exact);
        prop_assert!(sign(&found.w) > 0);
        prop_assert!([p, q, r].iter().all(|plane| is_on(&found, plane)));
        prop_assert_eq!(exact.side_of(&side), sign(&found.volume(other)));
        if found.is_near() {
            prop_assert!(is_approximated(&found, &exact));
        }
    }

    /// Points of one plane, many of them on one line: what is asked of them by number.
    #[test]
    fn points_by_number(
        (corners, plane) in triangle(),
        lines in prop::collection::vec(triangle(), 3..=5),
        (other, side) in triangle(),
    ) {
        let mut points = Points::new(corners.to_vec());
        points.expect(0..3);
        let mut known: Vec<(u32, Ratio)> = (0..3).map(|v| (v, Ratio::lattice(corners[v as usize]))).collect();
        // Where the line of the plane and the first other one meets the rest, and the meetings of the rest.
        for i in 0..lines.len() {
            for j in i + 1..lines.len() {
                let Some(exact) = Exact::of_planes([&plane, &lines[i].1, &lines[j].1]) else { continue };
                let ratio = Ratio::of(&exact);
                if ratio.is_near() {
                    let number = points.number(&Made::new(exact));
                    prop_assert_eq!(points.number(&Made::new(exact)), number);
                    known.push((number, ratio));
                }
            }
        }
        known.sort_by_key(|entry| entry.0);
        let numbers: Vec<u32> = known.iter().map(|entry| entry.0).collect();
        let (i, j) = ((plane.axis() + 1) % 3, (plane.axis() + 2) % 3);
        let flat = FlatPoints::new(&points, &numbers, plane.axis());
        for (m, (a, p)) in known.iter().enumerate() {
            prop_assert_eq!(points.side(&side, *a), sign(&p.volume(other)));
            prop_assert_eq!(points.side(&plane, *a), 0);
            for (n, (b, q)) in known.iter().enumerate() {
                for axis in 0..3 {
                    prop_assert_eq!(points.compare_along(*a, *b, axis), compare(p, q, axis));
                }
                prop_assert_eq!(a == b, (0..3).all(|axis| compare(p, q, axis).is_eq()));
                for (l, (c, r)) in known.iter().enumerate() {
                    let truth = turn([p, q, r], i, j);
                    prop_assert_eq!(flat.turn(m as u32, n as u32, l as u32), truth);
                    // In one plane, seen along its longest axis, points are in line where they do not turn.
                    prop_assert_eq!(points.are_in_line(*a, *b, *c), truth == 0);
                }
            }
        }
    }

    /// A point of an edge has one number, made of the edge and a plane or of three planes.
    #[test]
    fn a_point_has_one_number_however_it_was_made(
        (corners, plane) in triangle(), a in place(), b in place(), tips in prop::array::uniform2(place()),
    ) {
        let (one, two) = (plane.value(a), plane.value(b));
        prop_assume!(one.signum() * two.signum() < 0);
        let through = tips.map(|tip| Plane::through([a, b, tip]));
        let mut points = Points::new(corners.to_vec());
        points.expect(0..3);
        let number = points.number(&Made::new(Exact::on_line([a, b], one, two)));
        prop_assert_eq!(points.number(&Made::new(Exact::on_line([b, a], two, one))), number);
        for order in [[0, 1], [1, 0]] {
            if let Some(exact) = Exact::of_planes([&through[order[0]], &plane, &through[order[1]]]) {
                prop_assert_eq!(points.number(&Made::new(exact)), number);
            }
        }
    }

    /// The middle of an edge is a lattice point, and one that is known is found.
    #[test]
    fn a_lattice_point_is_found(a in place(), half in prop::array::uniform3(-1000i32..1000), tips in prop::array::uniform2(place())) {
        prop_assume!(half != [0; 3]);
        let clamp = |x: i32| x.clamp(-(1 << 29), 1 << 29);
        let middle = a.map(clamp);
        let [low, high] = [-1, 1].map(|way| [0, 1, 2].map(|k| middle[k] + way * half[k]));
        let plane = Plane::through([middle, tips[0], tips[1]]);
        let (one, two) = (plane.value(low), plane.value(high));
        prop_assume!(one.signum() * two.signum() < 0);
        let made = Made::new(Exact::on_line([low, high], one, two));
        let mut points = Points::new(vec![low, middle, high]);
        points.expect(0..3);
        prop_assert_eq!(points.number(&made), 1);
        prop_assert_eq!(points.vertex(1), Some(middle));
        let mut strange = Points::new(vec![low, high]);
        strange.expect(0..2);
        prop_assert_eq!(strange.number(&made), 2);
        prop_assert_eq!(strange.number(&made), 2);
    }
}

#[test]
fn the_largest_triangles_do_not_overflow() {
    const END: i32 = 1 << 30;
    let corner = |n: u32| [0, 1, 2].map(|k| if n >> k & 1 == 1 { END } else { -END });
    for (a, b, c, d) in [(0, 3, 5, 6), (1, 2, 4, 7), (0, 1, 2, 7), (0, 7, 1, 6)] {
        let corners = [a, b, c].map(corner);
        let plane = Plane::through(corners);
        assert_eq!(BigInt::from(plane.value(corner(d))), Ratio::lattice(corner(d)).volume(corners));
    }
    let planes = [[0, 3, 5], [1, 2, 7], [0, 3, 6]].map(|n| Plane::through(n.map(corner)));
    let exact = Exact::of_planes([&planes[0], &planes[1], &planes[2]]).expect("one point");
    assert!(planes.iter().all(|plane| exact.side_of(plane) == 0));
}

/// The planes through this edge meet the third one in a point whose common divisor is a multiple of the prime that points are found again by.
#[test]
fn a_point_without_a_hash_has_one_number_too() {
    const END: i32 = 1 << 30;
    let (a, b) = ([END - 1, -1, -END], [-END, END - 2, END - 2]);
    let plane = Plane::through([[END, 0, 0], [0, 0, 0], [0, 0, -1]]);
    let [p, q] = [0, 1].map(|y| Plane::through([a, b, [END, y, END]]));
    let on_edge = || Made::new(Exact::on_line([a, b], plane.value(a), plane.value(b)));
    let of_planes = || Made::new(Exact::of_planes([&p, &plane, &q]).expect("a point"));
    for made in [[on_edge(), of_planes()], [of_planes(), on_edge()], [of_planes(), of_planes()]] {
        let mut points = Points::new(vec![a, b]);
        points.expect(0..2);
        let [first, again] = made.map(|made| points.number(&made));
        assert_eq!(first, again);
        assert_eq!(points.len(), 3);
    }
}
