//! Lines over the shaded surface, hidden where it is in front of them.

use std::ops::Range;

use glam::Vec2;

use super::line::Line;
use super::rgb::PixelSample;
use super::scene::Scene;
use super::sight::{On, Sight};

/// Lines by the bands of pixel rows that they touch.
pub(super) struct LinesByBand(Vec<Vec<u32>>);

impl LinesByBand {
    pub(super) fn new(lines: &[Line], height: usize, band: usize) -> Self {
        let mut bands = vec![Vec::new(); height.div_ceil(band)];
        for (id, line) in (0u32..).zip(lines) {
            let [a, b] = line.ends.map(|p| p.y);
            let reach = line.style.pen().2;
            let first = ((a.min(b) - reach).max(0.0) as usize) / band;
            let last = ((a.max(b) + reach).max(0.0) as usize) / band;
            bands.iter_mut().take(last + 1).skip(first).for_each(|b| b.push(id));
        }
        Self(bands)
    }

    /// Draws the lines of band number `band`, the pixel rows `rows`, over its samples.
    /// `behind`: how much of a line is seen through what hides it, 0 to 1.
    pub(super) fn draw(
        &self,
        band: usize,
        (scene, seen): (&Scene, &Sight),
        rows: Range<usize>,
        behind: f32,
        out: &mut [PixelSample],
    ) {
        for &id in &self.0[band] {
            draw_line(&scene.lines[id as usize], (scene, seen), &rows, behind, out);
        }
    }
}

fn draw_line(line: &Line, (scene, seen): (&Scene, &Sight), rows: &Range<usize>, behind: f32, out: &mut [PixelSample]) {
    let (colour, opacity, width) = line.style.pen();
    let samples = seen.samples as f32;
    // Lines fade out over a sample's width.
    let (half, fade) = (width / 2.0, 0.5 / samples);
    let reach = half + fade;
    let [a, b] = line.ends.map(|p| Vec2::new(p.x, p.y));
    let first = rows.start * seen.samples;
    let to_row = |y: f32| (y * samples).max(0.0) as usize;
    let from = to_row(a.y.min(b.y) - reach).max(first);
    let to = (to_row(a.y.max(b.y) + reach) + 1).min(rows.end * seen.samples);
    for row in from..to {
        for column in columns(a, b, reach, seen, row) {
            let [x, y] = seen.position(row, column);
            let (distance, along) = distance(a, b, Vec2::new(x, y));
            let cover = ((reach - distance) / (2.0 * fade)).clamp(0.0, 1.0);
            let z = line.ends[0].z + along * (line.ends[1].z - line.ends[0].z);
            if cover > 0.0 {
                let hidden = is_hidden(scene, seen, row, column, z, distance);
                let share = if hidden { behind } else { 1.0 };
                out[(row - first) * seen.columns() + column].cover(colour, opacity * cover * share);
            }
        }
    }
}

/// The samples of a row that a line comes near to.
fn columns(a: Vec2, b: Vec2, reach: f32, seen: &Sight, row: usize) -> Range<usize> {
    let y = seen.position(row, 0)[1];
    let along = b - a;
    let (mut low, mut high) = (a.x.min(b.x), a.x.max(b.x));
    if along.y.abs() > 1e-3 {
        let x = a.x + (y - a.y) * along.x / along.y;
        let spread = reach * along.length() / along.y.abs();
        (low, high) = (low.max(x - spread), high.min(x + spread));
    }
    let to_column = |x: f32| (x * seen.samples as f32).max(0.0) as usize;
    to_column(low - reach)..(to_column(high + reach) + 1).min(seen.columns())
}

/// Distance of `p` to the segment, and where on it the nearest point lies, 0 to 1.
fn distance(a: Vec2, b: Vec2, p: Vec2) -> (f32, f32) {
    let along = b - a;
    let square = along.length_squared();
    let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    ((a + along * t).distance(p), t)
}

/// Whether the surface at a sample lies in front of a line that passes at `distance` pixels with depth `z`.
fn is_hidden(scene: &Scene, seen: &Sight, row: usize, column: usize, z: f32, distance: f32) -> bool {
    let Some(hit) = seen.hit(row, column) else { return false };
    // A surface through the line rises towards the viewer by its slope, up to the sample.
    let slope = match hit.on() {
        On::Triangle(t) => scene.slope[t],
        On::Cut => 0.0,
    };
    hit.z > z + 0.75 + slope * (distance + 0.25)
}
