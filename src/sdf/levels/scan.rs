//! Scan conversion of the slice contours of one plane.

use super::Segment;
use crate::ldi::Inside;

/// Where a slice contour crosses a row.
struct RowCrossing {
    row: u32,
    x: f64,
    /// +1 where the way along x goes in.
    turn: i32,
}

/// Sets the bits that closed contours wind around as often as the rule says. `plane` has rows of `width` bytes.
pub(super) fn fill(plane: &mut [u8], width: usize, contours: Vec<Segment>, inside: Inside) {
    let mut crossings = Vec::new();
    contours.into_iter().for_each(|segment| cross(segment, plane.len() / width, &mut crossings));
    crossings.sort_unstable_by(|a, b| a.row.cmp(&b.row).then(a.x.total_cmp(&b.x)));
    for row in crossings.chunk_by(|a, b| a.row == b.row) {
        let start = row[0].row as usize * width;
        let bits = &mut plane[start..start + width];
        let mut winding = 0;
        for pair in row.windows(2) {
            winding += pair[0].turn;
            if inside.holds(winding) {
                set(bits, after(pair[0].x, width), after(pair[1].x, width));
            }
        }
    }
}

/// Adds the crossings of a segment with the rows of its plane.
fn cross([from, to]: Segment, rows: usize, crossings: &mut Vec<RowCrossing>) {
    let (low, high) = if from.y < to.y { (from, to) } else { (to, from) };
    let turn = if from.y < to.y { -1 } else { 1 };
    let number = |y: f64| (y.floor() + 1.0).clamp(0.0, rows as f64) as u32;
    let slope = (high.x - low.x) / (high.y - low.y);
    let (left, right) = (low.x.min(high.x), low.x.max(high.x));
    crossings.extend((number(low.y)..number(high.y)).map(|row| {
        let x = low.x + (f64::from(row) - low.y) * slope;
        RowCrossing { row, x: x.clamp(left, right), turn }
    }));
}

/// The first voxel of a row of `width` bytes that comes after `x`.
fn after(x: f64, width: usize) -> usize {
    (x.floor() + 1.0).clamp(0.0, (8 * width) as f64) as usize
}

/// Sets the bits `from` to before `to`.
fn set(bits: &mut [u8], from: usize, to: usize) {
    if from >= to {
        return;
    }
    let (first, last) = (from / 8, (to - 1) / 8);
    let (low, high) = (0xFF << (from % 8), 0xFF >> (7 - (to - 1) % 8));
    if first == last {
        bits[first] |= low & high;
        return;
    }
    bits[first] |= low;
    bits[first + 1..last].fill(0xFF);
    bits[last] |= high;
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    const RULES: [Inside; 3] = [Inside::Positive, Inside::Nonzero, Inside::Odd];

    fn contour(points: &[[f64; 2]]) -> Vec<Segment> {
        (0..points.len()).map(|n| [points[n], points[(n + 1) % points.len()]].map(DVec2::from)).collect()
    }

    fn is_set(plane: &[u8], width: usize, x: usize, y: usize) -> bool {
        plane[y * width + x / 8] >> (x % 8) & 1 == 1
    }

    proptest! {
        /// Any closed contour, also one that crosses itself: a voxel's bit is set where the contour turns around it as often as the rule says.
        #[test]
        fn bits_are_winding_numbers(points in prop::collection::vec([-3.0..27.0, -3.0..27.0], 3..9)) {
            let planes = RULES.map(|inside| {
                let mut plane = vec![0; 3 * 24];
                fill(&mut plane, 3, contour(&points), inside);
                plane
            });
            for (x, y) in (0..24).flat_map(|x| (0..24).map(move |y| (x, y))) {
                let p = DVec2::new(x as f64, y as f64);
                let turned = |[a, b]: Segment| (a - p).perp_dot(b - p).atan2((a - p).dot(b - p));
                let angle: f64 = contour(&points).into_iter().map(turned).sum();
                let turns = (angle / std::f64::consts::TAU).round() as i32;
                for (plane, inside) in planes.iter().zip(RULES) {
                    prop_assert_eq!(is_set(plane, 3, x, y), inside.holds(turns), "{:?} {} {}", inside, x, y);
                }
            }
        }
    }

    #[test]
    fn voxels_on_the_contour_belong_to_one_side_of_it() {
        let (left, right) =
            ([[2.0, 1.0], [9.0, 1.0], [9.0, 5.0], [2.0, 5.0]], [[9.0, 1.0], [14.0, 1.0], [14.0, 5.0], [9.0, 5.0]]);
        let planes = [left, right].map(|points| {
            let mut plane = vec![0; 2 * 8];
            fill(&mut plane, 2, contour(&points), Inside::Positive);
            plane
        });
        for (x, y) in (0..16).flat_map(|x| (0..8).map(move |y| (x, y))) {
            let [in_left, in_right] = [&planes[0], &planes[1]].map(|plane| is_set(plane, 2, x, y));
            let row = (2..=5).contains(&y);
            assert_eq!(in_left, row && (3..=9).contains(&x), "{x} {y}");
            assert_eq!(in_right, row && (10..=14).contains(&x), "{x} {y}");
        }
    }
}
