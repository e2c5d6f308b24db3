//! What is written around a picture: its title above; below it the axes, a scale, and what colours mean; beside it a bar of colours.

use glam::DVec2;

use super::bar::{Bar, round_step};
use super::camera::{Camera, Frame};
use super::image::Image;
use super::legend::{LINE, LegendLines};
use super::text::{Anchor, MARGIN, Pen};
use crate::digits::number;
use crate::io::{ColourScale, LegendEntry};

/// Pictures that are narrower or lower have no words.
pub(super) const LEAST: [u32; 2] = [240, 180];

/// What is written around a picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Caption {
    /// Above it.
    pub title: String,
    /// What its colours mean, below it.
    pub legend: Vec<LegendEntry>,
    /// A bar of colours beside it, and how often each is there.
    pub scale: Option<ColourScale>,
    /// The unit of length, for the scale below it; empty where it is not known.
    pub unit: String,
}

/// The letters for an image of a size.
pub(super) fn pen_for([width, height]: [u32; 2]) -> Pen {
    Pen::new(((0.75 * width as f32).min(height as f32) / 48.0).clamp(11.0, 96.0))
}

/// Where the captions of images of one size are.
pub(super) struct Captions {
    pen: Pen,
    size: [f32; 2],
    /// Heights above and below the picture, widths to the right, pixels.
    above: f32,
    below: f32,
    right: f32,
    /// Whether what colours mean is beside the axes and the scale; else below them, where there is more room for long words.
    beside: bool,
}

/// The side of the axes' field, and the room for the scale beside it, in letters.
const AXES: f32 = 3.6;
const SCALE: f32 = 9.0;

impl Captions {
    /// Room for the largest of all; `None` where there is none, or no captions.
    pub(super) fn new(captions: &[Caption], size: [u32; 2]) -> Option<Self> {
        if captions.is_empty() || size[0] < LEAST[0] || size[1] < LEAST[1] {
            return None;
        }
        let pen = pen_for(size);
        let sizes = size.map(|k| k as f32);
        let titled = captions.iter().any(|caption| !caption.title.is_empty());
        let above = if titled { 1.9 * pen.size } else { 0.0 };
        let mut all = Self { pen, size: sizes, above, below: 0.0, right: 0.0, beside: true };
        let longest = captions.iter().map(|caption| LegendLines::widest(&caption.legend, &pen)).fold(0.0, f32::max);
        all.beside = longest <= all.legend_width();
        let lines = |caption: &Caption| LegendLines::new(&caption.legend, &pen, all.legend_width()).count() as f32;
        let lines = captions.iter().map(lines).fold(0.0, f32::max);
        let letters = if all.beside { AXES.max(LINE * lines) } else { AXES + LINE * lines };
        // No more than this part of the picture is for words below it.
        let most = if all.beside { 1.0 / 3.0 } else { 0.55 };
        all.below = ((letters + MARGIN) * pen.size).min(sizes[1] * most);
        let bar = |caption: &Caption| caption.scale.as_ref().map_or(0.0, |scale| bar_of(scale).width(&pen));
        all.right = captions.iter().map(bar).fold(0.0, f32::max);
        Some(all)
    }

    /// Where the mesh is drawn.
    pub(super) fn frame(&self) -> Frame {
        let [width, height] = self.size;
        let size = DVec2::new(f64::from(width - self.right), f64::from(height - self.above - self.below));
        Frame { corner: DVec2::new(0.0, f64::from(self.above)), size: size.max(DVec2::ONE) }
    }

    /// Where the legend begins.
    fn legend_left(&self) -> f32 {
        let before = if self.beside { MARGIN + AXES + SCALE } else { 0.0 };
        (MARGIN + before) * self.pen.size
    }

    fn legend_width(&self) -> f32 {
        self.size[0] - self.legend_left() - MARGIN * self.pen.size
    }

    /// Draws a caption.
    pub(super) fn draw(&self, image: &mut Image, caption: &Caption, camera: &Camera) {
        let pen = self.pen;
        let [width, height] = self.size;
        let margin = MARGIN * pen.size;
        pen.draw_title(image, &caption.title, self.above);
        let top = height - self.below;
        draw_axes(image, &pen, [margin + AXES / 2.0 * pen.size, top + AXES / 2.0 * pen.size], camera);
        self.draw_scale(image, caption, camera, [margin + (AXES + 0.6) * pen.size, top + AXES / 2.0 * pen.size]);
        let legend = LegendLines::new(&caption.legend, &pen, self.legend_width());
        let first = if self.beside {
            (self.below - margin - legend.count() as f32 * LINE * pen.size).max(0.0) / 2.0
        } else {
            AXES * pen.size
        };
        legend.draw(image, &pen, [self.legend_left(), top + first], self.legend_width());
        if let Some(scale) = &caption.scale {
            let frame = self.frame();
            let down = [frame.corner.y as f32 + margin, top - margin];
            bar_of(scale).draw(image, &pen, width - self.right, down);
        }
    }

    /// A length across the view, and how long it is. In perspective there is none.
    fn draw_scale(&self, image: &mut Image, caption: &Caption, camera: &Camera, [left, middle]: [f32; 2]) {
        let pen = self.pen;
        let Some(pixels) = camera.pixels_of(1.0).filter(|&pixels| pixels > 0.0 && pixels.is_finite()) else { return };
        let most = f64::from((SCALE - 2.0) * pen.size) / pixels;
        // From one round number to the next it is 2.5 times as far at most.
        let Some(length) = round_step(most / 2.5) else { return };
        let wide = (length * pixels) as f32;
        let thick = (0.11 * pen.size).round().max(1.0);
        let line = |image: &mut Image, [x, y]: [f32; 2], [across, down]: [f32; 2]| {
            image.fill(
                [x, y].map(|k| k.round().max(0.0) as u32),
                [across, down].map(|k| k.round().max(1.0) as u32),
                pen.colour,
            );
        };
        let y = middle + 0.55 * pen.size;
        line(image, [left, y], [wide, thick]);
        let tick = 0.45 * pen.size;
        line(image, [left, y - tick], [thick, tick]);
        line(image, [left + wide - thick, y - tick], [thick, tick]);
        let text = format!("{} {}", number(length), caption.unit);
        pen.draw(image, text.trim_end(), [left + wide / 2.0, middle - 0.6 * pen.size], Anchor::Middle);
    }
}

/// The model's axes as the view has them: those that come towards the viewer over the others.
fn draw_axes(image: &mut Image, pen: &Pen, [x, y]: [f32; 2], camera: &Camera) {
    const COLOURS: [[u8; 3]; 3] = [[178, 34, 34], [0, 110, 60], [24, 66, 190]];
    let letters = Pen { size: 0.85 * pen.size, ..*pen };
    let mut axes: Vec<_> = camera.shown_axes().into_iter().zip(["x", "y", "z"]).zip(COLOURS).collect();
    axes.sort_by(|((a, _), _), ((b, _), _)| a.z.total_cmp(&b.z));
    let reach = 1.15 * pen.size;
    for ((axis, name), colour) in axes {
        let flat = [axis.x as f32, -axis.y as f32];
        let steps = (4.0 * reach) as u32;
        let thick = (0.07 * pen.size).max(0.7);
        for step in 0..=steps {
            let along = step as f32 / steps as f32 * reach;
            dot(image, [x + flat[0] * along, y + flat[1] * along], thick, colour);
        }
        let far = 1.15 * reach + 0.35 * letters.size;
        // An axis straight at the viewer, or away, has no letter of its own place.
        let aside = if flat[0].hypot(flat[1]) < 0.2 {
            [-0.55 * letters.size, 0.55 * letters.size]
        } else {
            flat.map(|k| k * far)
        };
        let written = Pen { colour, ..letters };
        written.draw(image, name, [x + aside[0], y + aside[1]], Anchor::Middle);
    }
}

/// A round dot.
fn dot(image: &mut Image, [x, y]: [f32; 2], radius: f32, colour: [u8; 3]) {
    let low = [x, y].map(|k| (k - radius - 1.0).floor());
    let count = (2.0 * radius + 3.0) as u32;
    for (down, across) in (0..count).flat_map(|down| (0..count).map(move |across| (down, across))) {
        let at = [low[0] + across as f32, low[1] + down as f32];
        let cover = (radius + 0.5 - (at[0] + 0.5 - x).hypot(at[1] + 0.5 - y)).clamp(0.0, 1.0);
        if at[0] >= 0.0 && at[1] >= 0.0 {
            image.blend(at[0] as u32, at[1] as u32, colour, cover);
        }
    }
}

fn bar_of(scale: &ColourScale) -> Bar<'_> {
    Bar {
        range: [scale.low, scale.high],
        colour: Box::new(|value| scale.colour(value)),
        step: round_step((scale.high - scale.low) / 9.0).unwrap_or(0.0),
        histogram: &scale.histogram,
        title: &scale.title,
        lines: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_words_get_the_whole_width_of_a_small_picture() {
        let entry = |text: &str| LegendEntry { colour: [9; 3], text: text.into() };
        let caption = Caption { legend: vec![entry("made up: no surface of the input there")], ..Caption::default() };
        let short = Caption { legend: vec![entry("inner sides")], ..Caption::default() };
        for (captions, size, beside) in [
            (vec![caption.clone()], [300, 240], false),
            (vec![caption.clone()], [1200, 900], true),
            (vec![short.clone()], [300, 240], true),
            // Pictures beside each other have their words at the same places.
            (vec![short, caption], [300, 240], false),
        ] {
            let lay = Captions::new(&captions, size).expect("there is room");
            assert_eq!(lay.beside, beside, "{size:?}");
            let longest = captions.iter().map(|c| LegendLines::widest(&c.legend, &lay.pen)).fold(0.0, f32::max);
            assert!(longest <= lay.legend_width() && lay.legend_left() + lay.legend_width() < size[0] as f32);
            assert!(lay.frame().size.y > 0.5 * f64::from(size[1]));
        }
    }
}
