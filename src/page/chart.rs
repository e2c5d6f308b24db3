//! Histograms, drawn as SVG.

use std::fmt::Write;

use super::escape::html;
use crate::digits::number;

/// A histogram: shares of a whole over a range of lengths.
#[derive(Debug, Clone, Default)]
pub struct Histogram {
    /// A sentence on what is shown.
    pub title: String,
    /// The smallest and the largest length.
    pub range: [f64; 2],
    /// Shares of the bins, of equal width, 0 to 1.
    pub shares: Vec<f64>,
    /// What stands under the axis: `mm from the other surface`.
    pub axis: String,
    /// What a share is one of: `of the area`.
    pub whole: String,
}

/// The size of the drawing, and the space around the bars.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 220.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 44.0;

impl Histogram {
    /// The shares of weighted values within a range; what is outside counts at its end. `None` where nothing has a weight.
    pub fn of(values: impl IntoIterator<Item = (f64, f64)>, range: [f64; 2], bins: usize) -> Option<Self> {
        let mut shares = vec![0.0; bins.max(1)];
        let width = (range[1] - range[0]).max(f64::MIN_POSITIVE);
        for (value, weight) in values.into_iter().filter(|(value, weight)| value.is_finite() && *weight > 0.0) {
            let bin = ((value - range[0]) / width * bins as f64).clamp(0.0, bins as f64 - 1.0);
            shares[bin as usize] += weight;
        }
        let all: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|share| *share /= all);
        (all > 0.0).then(|| Self { range, shares, ..Self::default() })
    }

    /// The drawing, with its title.
    pub(super) fn svg(&self) -> String {
        let most = self.shares.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let top = round_up(most);
        let (width, height) = (WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
        let base = TOP + height;
        let mut out = format!(
            "<figure class=\"chart\"><figcaption>{}</figcaption><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
            html(&self.title),
            html(&self.title)
        );
        // Writing to a string cannot fail.
        for line in 0..=4 {
            let share = top * f64::from(line) / 4.0;
            let y = base - height * f64::from(line) / 4.0;
            let text = format!("{} %", number(100.0 * share));
            let _ = write!(
                out,
                "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                y + 4.0
            );
        }
        let bar = width / self.shares.len() as f64;
        let at = |n: usize| self.range[0] + (self.range[1] - self.range[0]) * n as f64 / self.shares.len() as f64;
        for (n, share) in self.shares.iter().enumerate() {
            let tall = height * share / top;
            let tip = format!("{} to {}: {} % {}", number(at(n)), number(at(n + 1)), number(100.0 * share), self.whole);
            let _ = write!(
                out,
                "<rect class=\"bar\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{tall:.1}\"><title>{}</title></rect>",
                LEFT + bar * n as f64 + 0.5,
                base - tall,
                (bar - 1.0).max(0.5),
                html(&tip)
            );
        }
        for tick in 0..=4usize {
            let (x, value) =
                (LEFT + width * tick as f64 / 4.0, self.range[0] + (self.range[1] - self.range[0]) * tick as f64 / 4.0);
            let anchor = ["start", "middle", "middle", "middle", "end"][tick];
            let _ = write!(
                out,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
                base + 16.0,
                number(value)
            );
        }
        let _ = write!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text></svg></figure>",
            LEFT + width / 2.0,
            HEIGHT - 8.0,
            html(&self.axis)
        );
        out
    }
}

/// The next of 1, 2, 5, 10 and so on.
fn round_up(share: f64) -> f64 {
    let decade = 10f64.powf(share.log10().floor());
    [1.0, 2.0, 4.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * decade)
        .find(|top| *top >= share * 0.9999)
        .unwrap_or(share)
        .min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_ends_take_what_is_beyond() {
        let chart = Histogram::of([(-1.0, 1.0), (0.1, 1.0), (0.9, 1.0), (7.0, 1.0), (f64::NAN, 9.0)], [0.0, 1.0], 2);
        assert_eq!(chart.expect("values").shares, [0.5, 0.5]);
        assert!(Histogram::of([(1.0, 0.0)], [0.0, 1.0], 2).is_none());
        assert_eq!([0.03, 0.2, 0.41, 0.99].map(round_up), [0.04, 0.2, 0.5, 1.0]);
    }
}
