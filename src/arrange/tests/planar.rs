//! Triangulations of the plane: what goes in comes out, and nothing overlaps.

use proptest::prelude::*;
use rustc_hash::FxHashSet;

use super::super::flat::FlatPoints;
use super::super::planar::Planar;
use super::super::point::Points;

type Place = [i64; 2];

fn area([a, b, c]: [Place; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether two segments have more in common than an end of both.
fn meet([a, b]: [Place; 2], [c, d]: [Place; 2]) -> bool {
    let between = |p: Place, q: Place, r: Place| {
        area([p, q, r]) == 0 && (0..2).all(|k| p[k].min(q[k]) <= r[k] && r[k] <= p[k].max(q[k])) && r != p && r != q
    };
    let cross = area([a, b, c]).signum() * area([a, b, d]).signum() < 0
        && area([c, d, a]).signum() * area([c, d, b]).signum() < 0;
    let same = [a, b] == [c, d] || [a, b] == [d, c];
    cross || same || between(a, b, c) || between(a, b, d) || between(c, d, a) || between(c, d, b)
}

/// Twice the signed area of the circle's lift: positive if `d` lies inside of the circle through the others, which run counter-clockwise.
fn in_circle(places: [Place; 4]) -> i64 {
    let [a, b, c] = [0, 1, 2].map(|n| [0, 1].map(|k| places[n][k] - places[3][k]));
    let lift = |p: Place| p[0] * p[0] + p[1] * p[1];
    let part = |p: Place, q: Place| p[0] * q[1] - p[1] * q[0];
    lift(a) * part(b, c) + lift(b) * part(c, a) + lift(c) * part(a, b)
}

/// Triangulates points and those of the segments that meet no earlier one and no point; checks all that is promised.
fn check(corners: [Place; 3], others: &[Place], wanted: &[[usize; 2]], axis: usize) -> Result<(), TestCaseError> {
    let mut places: Vec<Place> = corners.to_vec();
    places.extend(others.iter().filter(|&&p| {
        let [a, b, c] = corners;
        [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|t| area(t) >= 0)
    }));
    let mut seen = FxHashSet::default();
    places.retain(|&p| seen.insert(p));
    let in_space = |p: &Place| {
        let mut at = [0; 3];
        (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (p[0] as i32, p[1] as i32);
        at
    };
    let points = Points::new(places.iter().map(in_space).collect());
    let numbers: Vec<u32> = (0..places.len() as u32).collect();
    let flat = FlatPoints::new(&points, &numbers, axis);
    let mut planar = Planar::new(&flat, [0, 1, 2]);
    numbers[3..].iter().for_each(|&p| planar.insert(p));
    let mut segments: Vec<[usize; 2]> = Vec::new();
    for ends in wanted.iter().map(|ends| ends.map(|n| n % places.len())) {
        let [a, b] = ends.map(|n| places[n]);
        let passes = |p: &Place| *p != a && *p != b && meet([a, b], [*p, *p]);
        let free = segments.iter().all(|other| !meet([a, b], other.map(|n| places[n])));
        if a != b && free && !places.iter().any(passes) {
            segments.push(ends);
        }
    }
    segments.iter().zip(0..).for_each(|(ends, n)| planar.fix(ends[0] as u32, ends[1] as u32, n));
    planar.relax();

    let at = |t: [u32; 3]| t.map(|v| places[v as usize]);
    prop_assert!(planar.triangles.iter().all(|&t| area(at(t)) > 0), "an inverted or flat triangle");
    prop_assert_eq!(planar.triangles.iter().map(|&t| area(at(t))).sum::<i64>(), area(corners));
    let used: FxHashSet<u32> = planar.triangles.iter().flatten().copied().collect();
    prop_assert_eq!(used.len(), places.len());
    let mut found = vec![false; segments.len()];
    for (t, &corners) in planar.triangles.iter().enumerate() {
        for k in 0..3 {
            let ends = [corners[k], corners[(k + 1) % 3]];
            let other = planar.across(t as u32, k).map(|other| planar.triangles[other as usize]);
            if let Some(other) = other {
                prop_assert!((0..3).any(|j| [other[(j + 1) % 3], other[j]] == ends), "neighbours without an edge");
            }
            match (planar.fixed(t as u32, k), other) {
                (Some(segment), _) => {
                    let [a, b] = segments[segment as usize].map(|n| n as u32);
                    prop_assert!([a, b] == ends || [b, a] == ends);
                    found[segment as usize] = true;
                }
                (None, Some(other)) => {
                    // A free edge is Delaunay; coordinates are so small that floating point tells.
                    let tip = other.iter().find(|v| !ends.contains(v)).copied().unwrap_or(ends[0]);
                    let [a, b, c] = at(corners);
                    prop_assert!(in_circle([a, b, c, places[tip as usize]]) <= 0, "not Delaunay");
                }
                (None, None) => {}
            }
        }
    }
    prop_assert!(found.iter().all(|&found| found), "segments that are no edges: {:?} of {:?}", found, segments);
    Ok(())
}

fn points(size: i64, most: usize) -> impl Strategy<Value = Vec<Place>> {
    prop::collection::vec([0..=size, 0..=size], 0..=most)
}

fn segments() -> impl Strategy<Value = Vec<[usize; 2]>> {
    prop::collection::vec(prop::array::uniform2(0usize..1000), 0..=60)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn points_and_segments_become_a_triangulation(others in points(60, 60), wanted in segments(), axis in 0usize..3) {
        check([[0, 0], [60, 0], [0, 60]], &others, &wanted, axis)?;
    }

    /// Many points on one line, many in one place, many on the border.
    #[test]
    fn so_they_do_on_a_small_grid(others in points(6, 40), wanted in segments(), axis in 0usize..3) {
        check([[0, 0], [6, 0], [0, 6]], &others, &wanted, axis)?;
        check([[0, 0], [6, 1], [2, 6]], &others, &wanted, axis)?;
    }
}
