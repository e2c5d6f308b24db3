//! The outline of what is seen: a line where a surface ends before the background, or before another surface far behind it.

use std::ops::Range;

use super::line::INK;
use super::rgb::PixelSample;
use super::sight::{On, Sight};

/// How far the line reaches into the surface, pixels.
const WIDTH: f32 = 1.1;
/// How far behind another surface must lie, as a part of the smaller side of the image, to have an outline before it, and that line's opacity.
const STEP: (f32, f32) = (0.03, 0.45);
/// The opacity of the line before the background.
const STRENGTH: f32 = 0.8;

/// Draws the outline into the samples of some pixel rows.
pub(super) fn outline(seen: &Sight, rows: Range<usize>, out: &mut [PixelSample]) {
    let reach = (WIDTH * seen.samples as f32).round().max(1.0) as isize;
    let step = STEP.0 * seen.size[0].min(seen.size[1]) as f32;
    let first = rows.start * seen.samples;
    for row in first..rows.end * seen.samples {
        for column in 0..seen.columns() {
            let strength = strength(seen, row, column, reach, step);
            if strength > 0.0 {
                out[(row - first) * seen.columns() + column].cover(INK, strength);
            }
        }
    }
}

fn strength(seen: &Sight, row: usize, column: usize, reach: isize, step: f32) -> f32 {
    let Some(own) = seen.hit(row, column) else { return 0.0 };
    let limits = [seen.size[1] * seen.samples, seen.columns()];
    let beside = |down: isize, right: isize| {
        let at = [row.checked_add_signed(down)?, column.checked_add_signed(right)?];
        (at[0] < limits[0] && at[1] < limits[1]).then(|| seen.hit(at[0], at[1]))
    };
    let mut most = 0.0f32;
    for (down, right) in [(-reach, 0), (reach, 0), (0, -reach), (0, reach)] {
        match (beside(down, right), beside(-down, -right)) {
            (Some(None), _) => return STRENGTH,
            (Some(Some(other)), across) => {
                // A steep surface goes on to the other side as it went.
                let slope = across.flatten().map_or(0.0, |across| (across.z - own.z).max(0.0));
                let cut = matches!(own.on(), On::Cut) != matches!(other.on(), On::Cut);
                if cut || own.z - other.z > step + 2.0 * slope {
                    most = if cut { STRENGTH } else { most.max(STEP.1) };
                }
            }
            (None, _) => {}
        }
    }
    most
}
