//! Pictures of a plane through a field of signed values, such as distances: colours, lines of equal value, and a bold
//! line where the field is zero.

mod layout;
mod plane;
#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

pub use plane::{Axis, SlicePlane};

use super::bar::round_step;
use super::colour_map::colour;
use super::image::Image;
use super::options::{BAND, RenderError, check_size};
use super::rgb::{PixelSample, Rgb};
use crate::progress::Progress;
use layout::Layout;

/// The values of a field on the pixels of a picture.
#[derive(Debug, Clone)]
pub struct SliceSamples {
    layout: Layout,
    /// What is seen, in the shape of the plot.
    plane: SlicePlane,
    /// Row by row from the top; NaN where there is no value.
    values: Vec<f32>,
    /// The value farthest from zero, as it is where a band ends.
    end: f32,
}

/// How values become colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceColours {
    /// The distance from zero, model units, that has full colour: blue below zero, orange above.
    pub full: f64,
    /// The step from one line of equal value to the next, model units.
    pub step: f64,
}

impl SliceColours {
    /// Colours for values up to `farthest` from zero: that value has full colour, and four to eight lines on either side of zero lie at
    /// round values.
    pub fn up_to(farthest: f64) -> Self {
        let full = if farthest > 0.0 && farthest.is_finite() { farthest } else { 1.0 };
        Self { full, step: round_step(full / 8.0).unwrap_or(full / 8.0) }
    }
}

/// The size of the picture of a slice, and what is on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SliceSize {
    /// Pixels across and down.
    pub pixels: [u32; 2],
    /// Whether the slice fills it all, without words, axes and bar; smaller pictures than 240 x 180 never have any.
    pub plain: bool,
}

impl From<[u32; 2]> for SliceSize {
    fn from(pixels: [u32; 2]) -> Self {
        Self { pixels, plain: false }
    }
}

/// What is written around a slice.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SliceCaption {
    /// Above it.
    pub title: String,
    /// The unit of length, of coordinates and values; empty where it is not known.
    pub unit: String,
}

/// Asks `field` for its value at the middle of each pixel of the plane. A value that is not finite stands for none: these
/// pixels are grey. The plane is grown along one side to the shape of the picture.
///
/// # Errors
/// [`RenderError::Size`] for sizes out of the range of [`RenderOptions`](super::RenderOptions), and [`RenderError::Stopped`].
pub fn sample_slice(
    field: impl Fn(DVec3) -> f64 + Sync,
    plane: &SlicePlane,
    size: impl Into<SliceSize>,
    progress: &Progress,
) -> Result<SliceSamples, RenderError> {
    let size = size.into();
    check_size(size.pixels, 1, 1)?;
    let layout = Layout::of(size);
    let [width, height] = layout.plot.map(|k| k as usize);
    let extent = DVec2::new(width as f64, height as f64);
    let plane = plane.grown(extent);
    let mut values = vec![f32::NAN; width * height];
    let rows = values.par_chunks_mut(width).enumerate();
    rows.try_for_each(|(row, values)| {
        progress.check()?;
        for (column, value) in values.iter_mut().enumerate() {
            let place = DVec2::new(column as f64 + 0.5, (height - row) as f64 - 0.5);
            let found = field(plane.position(place / extent)) as f32;
            *value = if found.is_finite() { found } else { f32::NAN };
        }
        Ok::<(), RenderError>(())
    })?;
    let end = values.iter().map(|value| value.abs()).filter(|value| value.is_finite()).fold(0.0, f32::max);
    Ok(SliceSamples { layout, plane, values, end: 0.9999 * end })
}

/// [`sample_slice`] and [`SliceSamples::draw`] in one, with colours to the value farthest from zero, without a title.
///
/// # Errors
/// See [`sample_slice`].
pub fn slice(
    field: impl Fn(DVec3) -> f64 + Sync,
    plane: &SlicePlane,
    size: [u32; 2],
    progress: &Progress,
) -> Result<Image, RenderError> {
    let samples = sample_slice(field, plane, size, progress)?;
    Ok(samples.draw(&SliceColours::up_to(samples.farthest()), &SliceCaption::default()))
}

impl SliceSamples {
    /// The smallest and the largest value, model units; `None` where there is no value at all.
    pub fn range(&self) -> Option<[f64; 2]> {
        let finite = self.values.iter().filter(|value| !value.is_nan()).map(|&value| f64::from(value));
        finite.map(|value| [value, value]).reduce(|[a, b], [low, high]| [a.min(low), b.max(high)])
    }

    /// The largest distance of a value from zero, model units.
    pub fn farthest(&self) -> f64 {
        self.range().map_or(0.0, |[low, high]| low.abs().max(high.abs()))
    }

    /// The picture: colours, grey beyond the band of values, thin lines every `step`, a bold one at zero; unless it is plain, a bar of the colours with its values, and the
    /// axes with theirs.
    pub fn draw(&self, colours: &SliceColours, caption: &SliceCaption) -> Image {
        let [width, height] = self.layout.size;
        let mut image = Image { width, height, rgba: vec![255; 4 * width as usize * height as usize] };
        let [left, top] = self.layout.corner.map(|k| k as usize);
        let [across, down] = self.layout.plot.map(|k| k as usize);
        let row_bytes = 4 * width as usize;
        let plot = &mut image.rgba[top * row_bytes..(top + down) * row_bytes];
        plot.par_chunks_mut(row_bytes * BAND).enumerate().for_each(|(band, rows)| {
            for (row, pixels) in rows.chunks_mut(row_bytes).enumerate() {
                let pixels = pixels.as_chunks_mut::<4>().0.iter_mut().skip(left).take(across);
                for (column, pixel) in pixels.enumerate() {
                    let [r, g, b] = self.pixel(column, band * BAND + row, colours).to_srgb();
                    *pixel = [r, g, b, 255];
                }
            }
        });
        self.layout.draw_words(&mut image, &self.plane, colours, caption);
        image
    }

    fn pixel(&self, column: usize, row: usize, colours: &SliceColours) -> Rgb {
        let value = self.at(column as isize, row as isize);
        if value.is_nan() {
            return NOTHING;
        }
        let (full, step) = (colours.full as f32, colours.step as f32);
        let slope = self.slope(column as isize, row as isize, value);
        // A band ends where its values do not grow any more.
        if slope == 0.0 && value.abs() >= self.end {
            return BEYOND[usize::from(value > 0.0)];
        }
        // Where the field is flat there are no lines, even at a value that has one.
        let pixels = |level: f32| if slope > 1e-5 * step { (value - level).abs() / slope } else { f32::INFINITY };
        let mut sample = PixelSample { colour: colour(value / full), alpha: 1.0 };
        let level = (value / step).round();
        if level != 0.0 {
            sample.cover(LINE, 0.5 * cover(pixels(level * step), 0.45 * self.layout.line));
        }
        sample.cover(ZERO, cover(pixels(0.0), 1.25 * self.layout.line));
        sample.colour
    }

    /// The value of a pixel of the plot, NaN beside it.
    fn at(&self, column: isize, row: isize) -> f32 {
        let [width, height] = self.layout.plot.map(|k| k as isize);
        let inside = (0..width).contains(&column) && (0..height).contains(&row);
        if inside { self.values[(row * width + column) as usize] } else { f32::NAN }
    }

    /// The change of the value per pixel; on ridges, where differences across cancel, that to one side.
    fn slope(&self, column: isize, row: isize, value: f32) -> f32 {
        let change = |right: isize, down: isize| {
            let sides = [self.at(column + right, row + down), self.at(column - right, row - down)];
            sides.map(|side| (side - value).abs()).into_iter().fold(0.0f32, f32::max)
        };
        change(1, 0).hypot(change(0, 1))
    }
}

/// Where there is no value. Every value has a lighter colour or one with a hue.
const NOTHING: Rgb = Rgb::new(0.30, 0.30, 0.30);
/// Beyond a band, inside and outside: all that is known is the side.
const BEYOND: [Rgb; 2] = [Rgb::new(0.38, 0.40, 0.44), Rgb::new(0.60, 0.58, 0.56)];
const LINE: Rgb = Rgb::new(0.02, 0.025, 0.035);
const ZERO: Rgb = Rgb::new(0.004, 0.005, 0.008);

/// The share of a pixel that a line covers whose middle is `distance` pixels away.
fn cover(distance: f32, half_width: f32) -> f32 {
    (half_width + 0.5 - distance).clamp(0.0, (2.0 * half_width).min(1.0))
}
