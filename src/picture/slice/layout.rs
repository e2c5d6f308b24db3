//! Where things are on the picture of a slice, and its words.

use super::plane::{Side, SlicePlane};
use super::{SliceCaption, SliceColours, SliceSize};
use crate::picture::bar::{Bar, label, round_step};
use crate::picture::caption::{LEAST, pen_for};
use crate::picture::colour_map::colour;
use crate::picture::image::Image;
use crate::picture::text::{Anchor, Pen};

/// Where things are on the picture, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) size: [u32; 2],
    /// The left upper corner of the plot.
    pub(super) corner: [u32; 2],
    /// Its size.
    pub(super) plot: [u32; 2],
    /// Width of lines: larger on larger pictures.
    pub(super) line: f32,
    pen: Pen,
}

/// Room for words, in letters: to the left of the plot, above, to the right, below.
const ROOM: [f32; 4] = [3.8, 2.0, 6.4, 2.9];

impl Layout {
    pub(super) fn of(SliceSize { pixels: size, plain }: SliceSize) -> Self {
        let line = (size[0].min(size[1]) as f32 / 700.0).max(1.0);
        let pen = pen_for(size);
        let bare = Self { size, corner: [0, 0], plot: size, line, pen };
        if plain || size[0] < LEAST[0] || size[1] < LEAST[1] {
            return bare;
        }
        let [left, above, right, below] = ROOM.map(|room| (room * pen.size).round() as u32);
        Self { corner: [left, above], plot: [size[0] - left - right, size[1] - above - below], ..bare }
    }

    /// Title, axes and bar, where there is room.
    pub(super) fn draw_words(
        &self,
        image: &mut Image,
        plane: &SlicePlane,
        colours: &SliceColours,
        caption: &SliceCaption,
    ) {
        if self.plot == self.size {
            return;
        }
        let pen = self.pen;
        let [left, top, across, down] = [self.corner[0], self.corner[1], self.plot[0], self.plot[1]].map(|k| k as f32);
        pen.draw_title(image, &caption.title, top);
        self.draw_axes(image, plane, &caption.unit);
        let unit = &caption.unit;
        let bar = Bar {
            range: [-colours.full, colours.full],
            colour: Box::new(|value| colour((value / colours.full) as f32).to_srgb()),
            step: colours.step,
            histogram: &[],
            title: unit,
            lines: true,
        };
        bar.draw(image, &pen, left + across + 0.5 * pen.size, [top, top + down]);
    }

    fn draw_axes(&self, image: &mut Image, plane: &SlicePlane, unit: &str) {
        let pen = self.pen;
        let [left, top, across, down] = [self.corner[0], self.corner[1], self.plot[0], self.plot[1]].map(|k| k as f32);
        let [right_side, up_side] = plane.sides();
        let tick = (0.3 * pen.size).round().max(2.0);
        let numbers = |n: usize, side: Side, length: f32, apart: f32| {
            let (low, high) = (plane.min[n], plane.max[n]);
            let step = round_step((high - low) * f64::from(apart / length));
            let place = move |value: f64| {
                let share = ((value - low) / (high - low)) as f32;
                (if side.1 { 1.0 - share } else { share }) * length
            };
            let step = step.unwrap_or(f64::INFINITY);
            let range = (low / step).ceil() as i64..=(high / step).floor() as i64;
            range.take(100).map(move |k| (place(k as f64 * step), label(k, step)))
        };
        let bottom = top + down;
        for (x, text) in numbers(0, right_side, across, 5.0 * pen.size) {
            image.fill([(left + x) as u32, bottom as u32], [1, tick as u32], pen.colour);
            pen.draw(image, &text, [left + x, bottom + tick + 0.6 * pen.size], Anchor::Middle);
        }
        for (y, text) in numbers(1, up_side, down, 2.5 * pen.size) {
            image.fill([(left - tick) as u32, (bottom - y) as u32], [tick as u32, 1], pen.colour);
            pen.draw(image, &text, [left - tick - 0.2 * pen.size, bottom - y], Anchor::Right);
        }
        let name = |side: Side| ["x", "y", "z"][side.0];
        let across_name = format!("{}{}{unit}", name(right_side), if unit.is_empty() { "" } else { ", " });
        pen.draw(image, &across_name, [left + across, bottom + tick + 1.75 * pen.size], Anchor::Right);
        pen.draw(image, name(up_side), [0.3 * pen.size, top + 0.6 * pen.size], Anchor::Left);
    }
}
