//! Pictures of a plane through a field of signed values, such as distances: colours, lines of equal value, and a bold
//! line where the field is zero.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::colour_map::colour;
use super::digits;
use super::image::Image;
use super::options::{BAND, RenderError, check_size};
use super::rgb::{PixelSample, Rgb};
use crate::mesh::Bounds;
use crate::progress::Progress;

/// The axis that a plane is perpendicular to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The picture shows y to the right and z up.
    X,
    /// The picture shows x to the right and z up.
    Y,
    /// The picture shows x to the right and y up.
    Z,
}

impl Axis {
    /// The number of the axis: 0, 1 or 2 for x, y or z.
    pub fn number(self) -> usize {
        self as usize
    }

    /// The numbers of the axes that the picture shows to the right and up.
    fn sides(self) -> [usize; 2] {
        [[1, 2], [0, 2], [0, 1]][self.number()]
    }
}

/// A rectangle in a plane perpendicular to an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlicePlane {
    /// The axis that the plane is perpendicular to.
    pub axis: Axis,
    /// Where on this axis the plane lies, model units.
    pub at: f64,
    /// The corner on the left and below, model units.
    pub min: DVec2,
    /// The corner on the right and above, model units.
    pub max: DVec2,
}

impl SlicePlane {
    /// The piece of the plane that lies in a box.
    pub fn through(bounds: &Bounds, axis: Axis, at: f64) -> Self {
        let [min, max] = [bounds.min, bounds.max].map(|p| DVec2::from(axis.sides().map(|k| p[k])));
        Self { axis, at, min, max }
    }

    /// The position, model units, of a place on the picture: 0 to 1 from the left and from below.
    fn position(&self, place: DVec2) -> DVec3 {
        let flat = self.min + (self.max - self.min) * place;
        let mut p = DVec3::splat(self.at);
        let [right, up] = self.axis.sides();
        (p[right], p[up]) = (flat.x, flat.y);
        p
    }

    /// Grown along one side, so that model units are squares on `size` pixels.
    fn grown(&self, size: DVec2) -> Self {
        let extent = (self.max - self.min).max(DVec2::splat(f64::MIN_POSITIVE));
        let pixel = (extent / size).max_element();
        let (middle, half) = ((self.min + self.max) / 2.0, size * pixel / 2.0);
        Self { min: middle - half, max: middle + half, ..*self }
    }
}

/// The values of a field on the pixels of a picture.
#[derive(Debug, Clone)]
pub struct SliceSamples {
    layout: Layout,
    /// Row by row from the top; NaN where there is no value.
    values: Vec<f32>,
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
        let least = full / 8.0 * (1.0 - 1e-9);
        let power = 10f64.powi(least.log10().floor() as i32);
        let step = [1.0, 2.0, 5.0].into_iter().map(|round| round * power).find(|&step| step >= least);
        Self { full, step: step.unwrap_or(10.0 * power) }
    }
}

/// Asks `field` for its value at the middle of each pixel of the plane. A value that is not finite stands for none: these
/// pixels stay white. The plane is grown along one side to the shape of the picture.
///
/// # Errors
/// [`RenderError::Size`] for sizes out of the range of [`RenderOptions`](super::RenderOptions), and [`RenderError::Stopped`].
pub fn sample_slice(
    field: impl Fn(DVec3) -> f64 + Sync,
    plane: &SlicePlane,
    size: [u32; 2],
    progress: &Progress,
) -> Result<SliceSamples, RenderError> {
    check_size(size, 1)?;
    let layout = Layout::of(size);
    let [width, height] = [layout.plot, size[1]].map(|k| k as usize);
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
    Ok(SliceSamples { layout, values })
}

/// [`sample_slice`] and [`SliceSamples::draw`] in one, with colours to the value farthest from zero.
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
    Ok(samples.draw(&SliceColours::up_to(samples.farthest())))
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

    /// The picture: colours, thin lines every `step`, a bold one at zero, and a bar of the colours with its values.
    pub fn draw(&self, colours: &SliceColours) -> Image {
        let [width, height] = self.layout.size;
        let mut image = Image { width, height, rgba: vec![255; 4 * width as usize * height as usize] };
        let row_bytes = 4 * width as usize;
        image.rgba.par_chunks_mut(row_bytes * BAND).enumerate().for_each(|(band, rows)| {
            for (row, pixels) in rows.chunks_mut(row_bytes).enumerate() {
                for (column, pixel) in
                    pixels.as_chunks_mut::<4>().0.iter_mut().take(self.layout.plot as usize).enumerate()
                {
                    let [r, g, b] = self.pixel(column, band * BAND + row, colours).to_srgb();
                    *pixel = [r, g, b, 255];
                }
            }
        });
        self.layout.draw_bar(&mut image, colours);
        image
    }

    fn pixel(&self, column: usize, row: usize, colours: &SliceColours) -> Rgb {
        let value = self.at(column as isize, row as isize);
        if value.is_nan() {
            return Rgb::WHITE;
        }
        let (full, step) = (colours.full as f32, colours.step as f32);
        let slope = self.slope(column as isize, row as isize, value);
        // Where the field is flat there are no lines, even at a value that has one.
        let pixels = |level: f32| if slope > 1e-5 * step { (value - level).abs() / slope } else { f32::INFINITY };
        let mut sample = PixelSample { colour: colour(value / full), alpha: 1.0 };
        let level = (value / step).round();
        if level != 0.0 {
            sample.cover(LINE, 0.5 * cover(pixels(level * step), 0.45 * self.layout.pen));
        }
        sample.cover(ZERO, cover(pixels(0.0), 1.25 * self.layout.pen));
        sample.colour
    }

    /// The value of a pixel of the plot, NaN beside it.
    fn at(&self, column: isize, row: isize) -> f32 {
        let [width, height] = [self.layout.plot, self.layout.size[1]].map(|k| k as isize);
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

const LINE: Rgb = Rgb::new(0.02, 0.025, 0.035);
const ZERO: Rgb = Rgb::new(0.004, 0.005, 0.008);

/// The share of a pixel that a line covers whose middle is `distance` pixels away.
fn cover(distance: f32, half_width: f32) -> f32 {
    (half_width + 0.5 - distance).clamp(0.0, (2.0 * half_width).min(1.0))
}

/// Where things are on the picture, pixels.
#[derive(Debug, Clone, Copy)]
struct Layout {
    size: [u32; 2],
    /// Width of the plot; the bar is to the right of it.
    plot: u32,
    /// Width of lines: larger on larger pictures.
    pen: f32,
    /// Pixels of a dot of the digits.
    scale: u32,
}

/// Pictures narrower than this have no bar.
const LEAST_WITH_BAR: u32 = 240;
/// Characters of the longest number beside the bar.
const CHARACTERS: &str = "-0.0000";

impl Layout {
    fn of(size: [u32; 2]) -> Self {
        let small = size[0].min(size[1]);
        let pen = (small as f32 / 700.0).max(1.0);
        let scale = (small / 400).max(1);
        let bar = if size[0] < LEAST_WITH_BAR { 0 } else { 7 * Self::GAP * scale + digits::size(CHARACTERS, scale)[0] };
        Self { size, plot: size[0] - bar, pen, scale }
    }

    /// Between plot, bar and numbers, dots.
    const GAP: u32 = 4;

    fn draw_bar(&self, image: &mut Image, colours: &SliceColours) {
        if self.plot == self.size[0] {
            return;
        }
        let gap = Self::GAP * self.scale;
        let [left, right] = [self.plot + 2 * gap, self.plot + 5 * gap];
        let [top, bottom] = [3 * gap, self.size[1].saturating_sub(3 * gap)];
        if bottom <= top + 8 * gap {
            return;
        }
        let length = f64::from(bottom - top);
        let row_of = |value: f64| f64::from(top) + (1.0 - value / colours.full) / 2.0 * length;
        for y in top..bottom {
            let value = 1.0 - 2.0 * (f64::from(y - top) + 0.5) / length;
            let [r, g, b] = colour(value as f32).to_srgb();
            (left..right).for_each(|x| image.set(x, y, [r, g, b, 255]));
        }
        let most = (colours.full / colours.step * (1.0 + 1e-9)).floor().min(1e3) as i32;
        let apart = length / 2.0 / colours.full * colours.step;
        let [_, high] = digits::size("0", self.scale);
        let stride = (f64::from(2 * high) / apart).ceil().max(1.0) as i32;
        for n in -most..=most {
            let middle = row_of(f64::from(n) * colours.step);
            let thick = if n == 0 { self.scale + 1 } else { 1 };
            let first = (middle - f64::from(thick) / 2.0).round().max(0.0) as u32;
            (first..first + thick).for_each(|y| (left..right).for_each(|x| image.set(x, y, [0, 0, 0, 255])));
            if n % stride == 0 {
                let above = (middle - f64::from(high) / 2.0).round().max(0.0) as u32;
                digits::draw(image, &label(n, colours.step), [right + gap, above], self.scale);
            }
        }
    }
}

/// `n` times `step`, which is round, in few characters.
fn label(n: i32, step: f64) -> String {
    let value = f64::from(n) * step;
    let power = step.log10().floor() as i32;
    match power {
        _ if n == 0 => "0".into(),
        -3..=3 => format!("{value:.*}", (-power).max(0) as usize),
        // Two digits are enough: the step has one.
        _ => {
            let text = format!("{value:.1e}");
            text.replace(".0e", "e")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(axis: Axis) -> SlicePlane {
        SlicePlane { axis, at: 0.25, min: DVec2::splat(-1.0), max: DVec2::splat(1.0) }
    }

    fn drawn(field: impl Fn(DVec3) -> f64 + Sync, axis: Axis, size: [u32; 2]) -> Image {
        slice(field, &square(axis), size, &Progress::none()).expect("it can be drawn")
    }

    fn darkness(image: &Image, x: u32, y: u32) -> f64 {
        let pixel = image.pixel(x, y).expect("a pixel");
        1.0 - f64::from(pixel[..3].iter().map(|&c| u32::from(c)).sum::<u32>()) / 765.0
    }

    #[test]
    fn the_plane_is_the_one_that_was_asked_for() {
        for (axis, right, up) in [(Axis::X, 1, 2), (Axis::Y, 0, 2), (Axis::Z, 0, 1)] {
            let seen = |k: usize| {
                let size = [100, 80];
                let samples = sample_slice(|p| p[k], &square(axis), size, &Progress::none()).expect("values");
                samples.range().expect("values")
            };
            let [low, high] = seen(right);
            assert!((low + 1.2375).abs() < 1e-6 && (high - 1.2375).abs() < 1e-6, "{axis:?}: {low} {high}");
            let [low, high] = seen(up);
            assert!((low + 0.9875).abs() < 1e-6 && (high - 0.9875).abs() < 1e-6, "{axis:?}: {low} {high}");
            assert_eq!(seen(axis.number()), [0.25; 2]);
        }
        // Up is up.
        let image = drawn(|p| p.y, Axis::Z, [60, 60]);
        let [top, bottom] = [3, 56].map(|y| image.pixel(30, y).expect("a pixel"));
        assert!(top[0] > top[2] && bottom[2] > bottom[0], "{top:?} {bottom:?}");
    }

    #[test]
    fn the_line_of_zero_is_bold_smooth_and_in_its_place() {
        for place in [-0.31, -0.302, 0.0, 0.123_4] {
            // A steep field and a shallow one have the same line.
            for steep in [1.0, 20.0] {
                let image = drawn(|p| steep * (p.x - place + 0.1 * p.y), Axis::Z, [200, 200]);
                for y in [40, 100, 171] {
                    let dark: Vec<f64> = (0..200).map(|x| (darkness(&image, x, y) - 0.67).max(0.0)).collect();
                    let total: f64 = dark.iter().sum();
                    let middle = (0..200).map(|x| (x as f64 + 0.5) * dark[x]).sum::<f64>() / total;
                    let expected = 100.0 * (1.0 + place - 0.1 * (99.5 - f64::from(y)) / 100.0);
                    assert!(total > 0.2 && (middle - expected).abs() < 0.25, "{place} {y}: {middle} not {expected}");
                }
            }
        }
    }

    #[test]
    fn lines_are_at_even_steps_and_flat_places_have_none() {
        let samples = sample_slice(|p| p.x, &square(Axis::Z), [200, 40], &Progress::none()).expect("values");
        let draw = |step: f64| samples.draw(&SliceColours { full: 5.0, step });
        // A step as long as this leaves the line of zero alone.
        let plain = draw(100.0);
        let lines = |step: f64| {
            let image = draw(step);
            let dark: Vec<bool> = (0..200).map(|x| darkness(&image, x, 20) > darkness(&plain, x, 20) + 0.02).collect();
            dark.windows(2).filter(|pair| !pair[0] && pair[1]).count()
        };
        // From -5 to 5, which itself may be half a pixel outside.
        let (coarse, fine) = (lines(1.0), lines(0.5));
        assert!((8..=10).contains(&coarse) && (18..=20).contains(&fine), "{coarse} {fine}");
        let flat = sample_slice(|_| 2.0, &square(Axis::Z), [60, 60], &Progress::none()).expect("values");
        let image = flat.draw(&SliceColours { full: 4.0, step: 1.0 });
        assert!(image.rgba.chunks(4).all(|pixel| pixel == &image.rgba[..4]));
    }

    #[test]
    fn round_steps() {
        for (farthest, step) in [(1.0, 0.2), (0.8, 0.1), (7.9, 1.0), (8.1, 2.0), (4e-5, 5e-6), (3.0e9, 5e8)] {
            let got = SliceColours::up_to(farthest).step;
            assert!((got / step - 1.0).abs() < 1e-9, "{farthest}: {got}");
        }
        assert_eq!(SliceColours::up_to(f64::NAN).full, 1.0);
        for (n, step, text) in [
            (3, 0.2, "0.6"),
            (-2, 0.05, "-0.10"),
            (4, 500.0, "2000"),
            (0, 1e9, "0"),
            (3, 2e-5, "6e-5"),
            (-7, 5e8, "-3.5e9"),
        ] {
            assert_eq!(label(n, step), text);
        }
    }

    #[test]
    fn nothing_is_drawn_where_there_is_no_value() {
        let image = drawn(|p| if p.x < 0.0 { f64::NAN } else { p.x - 0.5 }, Axis::Z, [100, 100]);
        let white = |x: u32| (0..100).all(|y| image.pixel(x, y) == Some([255; 4]));
        assert!((0..50).all(white) && (50..100).all(|x| !white(x)));
        let empty = sample_slice(|_| f64::NAN, &square(Axis::X), [300, 100], &Progress::none()).expect("a picture");
        assert_eq!((empty.range(), empty.farthest()), (None, 0.0));
    }

    #[test]
    fn the_bar_shows_the_colours_and_their_values() {
        let image = drawn(|p| p.x, Axis::Z, [600, 400]);
        let plot = Layout::of([600, 400]).plot;
        assert!(plot < 560 && Layout::of([200, 400]).plot == 200);
        let strip = |y: u32| image.pixel(plot + 9, y).expect("a pixel");
        assert!(strip(16)[0] > strip(16)[2] && strip(383)[2] > strip(383)[0]);
        let ink = (plot + 22..600).flat_map(|x| (0..400).map(move |y| (x, y)));
        let dark = ink.filter(|&(x, y)| image.pixel(x, y).is_some_and(|pixel| pixel[0] < 60)).count();
        assert!((200..4000).contains(&dark), "{dark}");
    }

    #[test]
    fn threads_change_nothing_and_sizes_are_checked() {
        let field = |p: DVec3| p.length() - 0.7;
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| drawn(field, Axis::Y, [300, 170]))
        };
        assert_eq!(run(1), run(3));
        let error = slice(field, &square(Axis::X), [0, 5], &Progress::none()).unwrap_err();
        assert_eq!(error, RenderError::Size { width: 0, height: 5, supersampling: 1 });
        let late = Progress::none().with_deadline(std::time::Instant::now());
        let stopped = slice(field, &square(Axis::X), [50, 50], &late).unwrap_err();
        assert!(matches!(stopped, RenderError::Stopped(_)));
    }
}
