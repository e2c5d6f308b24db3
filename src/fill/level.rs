//! A lid along a level of a number that is known everywhere, such as the winding number: where that is larger, inside is.

use glam::DVec3;
use rayon::prelude::*;

use super::boundary::Boundary;
use super::sheet::Sheet;
use super::{FillOptions, Lid, NoLid, Rim, Style, Surroundings, finished, least, of_sheet, refine};

/// The value along which a lid lies.
const LEVEL: f64 = 0.5;

/// How often vertices are moved to the level, and spread evenly in between.
const ROUNDS: usize = 8;

/// In steps of this share of the mean length of the edges at a vertex the level is looked for, so many at once. Vertices that go farther leave their neighbours
/// behind, and the lid folds.
const REACH: f64 = 0.5;
const REACHES: usize = 2;

/// The interval in which the level is found is narrowed so often; each time it becomes half as long or less.
const NARROWED: usize = 8;

/// How much sparser vertices are with each triangle that lies between them and the rim: a level of winding numbers is the smoother the farther it is from the rim.
const GROWS: f64 = 1.25;

/// Closes a rim along the level ½ of `value`, which is larger behind the lid than before it. `value` takes model coordinates.
///
/// # Errors
/// As [`lid`](super::lid).
pub fn level_lid(
    around: &Surroundings<'_>,
    rim: &Rim,
    value: &(dyn Fn(DVec3) -> f64 + Sync),
    options: &FillOptions,
) -> Result<Lid, NoLid> {
    let boundary = Boundary::new(around, rim)?;
    let (_, mut sheet) = finished(&boundary, rim, around, least(&boundary, rim), Style::Flat)?;
    refine::refine(&mut sheet, options.most_vertices, GROWS);
    let above = |p: DVec3| value(p / boundary.scale) - LEVEL;
    for round in 1..=ROUNDS {
        sheet.divide_chords();
        to_level(&mut sheet, &above);
        if round < ROUNDS {
            spread(&mut sheet);
            sheet.turn_edges();
        }
    }
    of_sheet(&boundary, rim, around, &sheet, Style::Flat)
}

/// The neighbours of each vertex that may move, and its normal, zero where it has none.
struct Stars {
    first: usize,
    neighbours: Vec<Vec<u32>>,
    normals: Vec<DVec3>,
}

impl Stars {
    fn of(sheet: &Sheet<'_>) -> Self {
        let first = sheet.below() as usize + 1;
        let count = sheet.points.len() - first;
        let mut stars = Self { first, neighbours: vec![Vec::new(); count], normals: vec![DVec3::ZERO; count] };
        for t in sheet.triangles() {
            let [a, b, c] = sheet.corners(t);
            let across = (b - a).cross(c - a);
            for k in 0..3 {
                let Some(v) = (t[k] as usize).checked_sub(first) else { continue };
                // Each neighbour is the next one in one triangle.
                stars.neighbours[v].push(t[(k + 1) % 3]);
                stars.normals[v] += across;
            }
        }
        stars.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        stars
    }

    fn mean(&self, v: usize, sheet: &Sheet<'_>) -> DVec3 {
        let near = &self.neighbours[v];
        near.iter().map(|&w| sheet.points[w as usize]).sum::<DVec3>() / near.len().max(1) as f64
    }
}

/// Moves vertices along their normals to the level, as far as it is found.
fn to_level(sheet: &mut Sheet<'_>, above: &(dyn Fn(DVec3) -> f64 + Sync)) {
    let stars = Stars::of(sheet);
    let moved = |v: usize| {
        let (at, normal) = (sheet.points[stars.first + v], stars.normals[v]);
        let near = &stars.neighbours[v];
        let mean = near.iter().map(|&w| sheet.points[w as usize].distance(at)).sum::<f64>() / near.len().max(1) as f64;
        level_along(at, normal, REACH * mean, above).unwrap_or(at)
    };
    let moved: Vec<DVec3> = (0..stars.normals.len()).into_par_iter().map(moved).collect();
    sheet.points[stars.first..].copy_from_slice(&moved);
}

/// Where the level is on the line through a point, at most a few steps away: outwards from where the value is above it, inwards from where it is below.
fn level_along(at: DVec3, normal: DVec3, step: f64, above: &(dyn Fn(DVec3) -> f64 + Sync)) -> Option<DVec3> {
    let here = above(at);
    let step = if here > 0.0 { step } else { -step };
    let (mut near, mut far) = ((0.0, here), (0.0, here));
    for k in 1..=REACHES {
        let t = step * k as f64;
        far = (t, above(at + normal * t));
        if (far.1 > 0.0) != (here > 0.0) {
            break;
        }
        near = far;
    }
    if (far.1 > 0.0) == (here > 0.0) {
        return None;
    }
    for _ in 0..NARROWED {
        // Between the place where a straight line would pass and the middle, so that no end stays for ever.
        let share = (near.1 / (near.1 - far.1)).clamp(0.1, 0.9);
        let t = near.0 + (far.0 - near.0) * share;
        let value = above(at + normal * t);
        if value.abs() < 1e-4 {
            return Some(at + normal * t);
        }
        if (value > 0.0) == (here > 0.0) {
            near = (t, value);
        } else {
            far = (t, value);
        }
    }
    Some(at + normal * ((near.0 + far.0) / 2.0))
}

/// Moves vertices half of the way to the middle of their neighbours, within the surface.
fn spread(sheet: &mut Sheet<'_>) {
    let stars = Stars::of(sheet);
    let moved: Vec<DVec3> = (0..stars.normals.len())
        .map(|v| {
            let at = sheet.points[stars.first + v];
            let (way, normal) = (stars.mean(v, sheet) - at, stars.normals[v]);
            at + (way - normal * way.dot(normal)) / 2.0
        })
        .collect();
    sheet.points[stars.first..].copy_from_slice(&moved);
}
