//! A bar of colours with numbers beside it.

use super::image::Image;
use super::text::{Anchor, Pen};

/// A bar of colours: what values they stand for, and how often these are there.
pub(super) struct Bar<'a> {
    /// The values at its lower and its upper end.
    pub(super) range: [f64; 2],
    pub(super) colour: Box<dyn Fn(f64) -> [u8; 3] + 'a>,
    /// From one number to the next, or more where there is no room.
    pub(super) step: f64,
    /// How often there are values of each of some equal parts of the range, from below.
    pub(super) histogram: &'a [u64],
    /// Above it.
    pub(super) title: &'a str,
    /// Whether each step has a line across the bar, a bold one at zero.
    pub(super) lines: bool,
}

/// The smallest of 1, 2 and 5 times a power of ten that is at least `least`; `None` where there is none.
pub(super) fn round_step(least: f64) -> Option<f64> {
    let least = least * (1.0 - 1e-9);
    let power = 10f64.powi(least.log10().floor() as i32);
    let round = [1.0, 2.0, 5.0, 10.0].into_iter().map(|round| round * power).find(|&step| step >= least);
    round.filter(|step| step.is_normal() && least > 0.0)
}

/// `n` times `step`, which is round, in few characters.
pub(super) fn label(n: i64, step: f64) -> String {
    let value = n as f64 * step;
    let power = step.log10().floor() as i32;
    match power {
        _ if n == 0 => "0".into(),
        -4..=4 => format!("{value:.*}", (-power).max(0) as usize).replace('-', "−"),
        // Two digits are enough: the step has one.
        _ => format!("{value:.1e}").replace(".0e", "e").replace('-', "−"),
    }
}

/// Widths in letters: of the histogram, of the bar, and between things.
const HISTOGRAM: f32 = 3.2;
const WIDE: f32 = 1.1;
const GAP: f32 = 0.45;

impl Bar<'_> {
    /// What it takes from left to right, pixels.
    pub(super) fn width(&self, pen: &Pen) -> f32 {
        let numbers = self.numbers(1).map(|(_, text)| pen.width(&text)).fold(0.0, f32::max);
        let histogram = if self.histogram.is_empty() { 0.0 } else { HISTOGRAM };
        ((histogram + WIDE + 4.0 * GAP) * pen.size + numbers.max(2.0 * pen.size)).ceil()
    }

    /// Every `stride`-th number of the bar.
    fn numbers(&self, stride: i64) -> impl Iterator<Item = (f64, String)> + '_ {
        let slack = 1e-9;
        let [first, last] = match self.step > 0.0 {
            true => {
                [(self.range[0] / self.step - slack).ceil() as i64, (self.range[1] / self.step + slack).floor() as i64]
            }
            false => [0, -1],
        };
        let last = last.min(first.saturating_add(1000));
        (first..=last).filter(move |n| n % stride == 0).map(|n| (n as f64 * self.step, label(n, self.step)))
    }

    /// Draws it from `left` on, between two heights.
    pub(super) fn draw(&self, image: &mut Image, pen: &Pen, left: f32, [top, bottom]: [f32; 2]) {
        let top = if self.title.is_empty() { top } else { top + 1.5 * pen.size };
        let span = self.range[1] - self.range[0];
        let length = bottom - top;
        if length < 4.0 * pen.size || span.is_nan() || span <= 0.0 {
            return;
        }
        let gap = GAP * pen.size;
        let bar = left + gap + if self.histogram.is_empty() { 0.0 } else { HISTOGRAM * pen.size };
        let wide = (WIDE * pen.size).round();
        let row_of = |value: f64| bottom - ((value - self.range[0]) / span) as f32 * length;
        let from = bar.round() as u32;
        let rows = top.round() as u32..bottom.round() as u32;
        for y in rows.clone() {
            let value = self.range[0] + f64::from(bottom - y as f32 - 0.5) / f64::from(length) * span;
            image.fill([from, y], [wide as u32, 1], (self.colour)(value));
        }
        self.draw_histogram(image, [bar - gap, HISTOGRAM * pen.size - gap], rows);
        let stride = f64::from(1.6 * pen.size) / (self.step / span * f64::from(length));
        let stride = if stride.is_finite() { stride.ceil().max(1.0) as i64 } else { 1 };
        let thin = (0.05 * pen.size).round().max(1.0);
        if self.lines {
            for (value, _) in self.numbers(1) {
                let thick = if value == 0.0 { 2.0 * thin } else { thin };
                image.fill(
                    [from, (row_of(value) - thick / 2.0).round() as u32],
                    [wide as u32, thick as u32],
                    pen.colour,
                );
            }
        }
        for (value, text) in self.numbers(stride) {
            let y = row_of(value);
            image.fill([from + wide as u32, y.round() as u32], [(gap / 2.0).round() as u32, thin as u32], pen.colour);
            pen.draw(image, &text, [bar + wide + gap, y], Anchor::Left);
        }
        let title = pen.shortened(self.title, image.width as f32 - left - gap);
        pen.draw(image, &title, [left + gap, top - 0.9 * pen.size], Anchor::Left);
    }

    /// Grey bars that grow to the left from `right`, at most `wide` pixels, on the root of how often a value is there.
    fn draw_histogram(&self, image: &mut Image, [right, wide]: [f32; 2], rows: std::ops::Range<u32>) {
        let most = self.histogram.iter().copied().max().unwrap_or(0);
        if most == 0 {
            return;
        }
        let bins = self.histogram.len();
        let height = rows.len() as f64;
        for y in rows.clone() {
            let share = 1.0 - (f64::from(y - rows.start) + 0.5) / height;
            let bin = ((share * bins as f64) as usize).min(bins - 1);
            // The root keeps rare values in sight beside frequent ones.
            let part = (self.histogram[bin] as f64 / most as f64).sqrt() as f32;
            let across = (part * wide).round();
            image.fill([(right - across).round().max(0.0) as u32, y], [across as u32, 1], [120, 124, 130]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_labels_short() {
        for (least, step) in [(0.9, 1.0), (1.0, 1.0), (1.1, 2.0), (3.0, 5.0), (6.0, 10.0), (0.0021, 0.005)] {
            let found = round_step(least).expect("there is one");
            assert!((found - step).abs() < 1e-12, "{least}: {found}");
        }
        for least in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(round_step(least), None);
        }
        let labels = [(3, 0.5, "1.5"), (-2, 0.05, "−0.10"), (0, 10.0, "0"), (4, 1e-6, "4e−6"), (3, 20.0, "60")];
        for (n, step, text) in labels {
            assert_eq!(label(n, step), text);
        }
    }

    #[test]
    fn colours_and_counts_lie_beside_their_values() {
        let bar = Bar {
            range: [-1.0, 1.0],
            colour: Box::new(|value| if value < 0.0 { [0, 0, 255] } else { [255, 0, 0] }),
            step: 0.5,
            histogram: &[0, 0, 9, 0],
            title: "",
            lines: false,
        };
        let pen = Pen::new(12.0);
        let mut image = Image { width: 200, height: 220, rgba: vec![255; 4 * 200 * 220] };
        bar.draw(&mut image, &pen, 10.0, [10.0, 210.0]);
        let count = |colour: [u8; 3], rows: std::ops::Range<u32>| {
            rows.flat_map(|y| (0..200).map(move |x| (x, y)))
                .filter(|&(x, y)| image.pixel(x, y).is_some_and(|p| p[..3] == colour))
                .count()
        };
        assert!(count([255, 0, 0], 10..110) > 900 && count([255, 0, 0], 111..220) == 0);
        assert!(count([0, 0, 255], 110..210) > 900 && count([0, 0, 255], 0..109) == 0);
        // The third quarter from below.
        assert!(
            count([120, 124, 130], 60..110) > 900
                && count([120, 124, 130], 112..220) == 0
                && count([120, 124, 130], 0..58) == 0
        );
        assert!(bar.width(&pen) > 60.0 && bar.width(&pen) < 120.0);
    }
}
