//! What the colours of measured values mean: comments in the header of a PLY file.

use super::legend::plain_text;

/// Colours, and bars of a histogram, that are read of one file.
const MOST: usize = 256;

/// The colours of values, and how often each is there. As text it is three comments that the reader of PLY knows: `colour scale LOW HIGH title`, `colour stops #RRGGBB ...`
/// and `colour histogram N ...`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColourScale {
    /// What is measured, and its unit.
    pub title: String,
    /// The value that has the first colour; so have smaller ones.
    pub low: f64,
    /// The value that has the last colour; so have larger ones.
    pub high: f64,
    /// The colours of values at even steps from `low` to `high`; between them colours change evenly.
    pub stops: Vec<[u8; 3]>,
    /// How many values lie in each of some equal parts of the range, those beyond it in the first and the last.
    pub histogram: Vec<u64>,
}

impl ColourScale {
    /// The colour of a value; grey where there is none.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        let share = (value - self.low) / (self.high - self.low);
        let (Some(&last), false) = (self.stops.last(), share.is_nan()) else { return [128; 3] };
        let at = share.clamp(0.0, 1.0) * (self.stops.len() - 1) as f64;
        let first = at as usize;
        let (a, b) = (self.stops[first], self.stops.get(first + 1).copied().unwrap_or(last));
        std::array::from_fn(|k| (f64::from(a[k]) + (f64::from(b[k]) - f64::from(a[k])) * at.fract()).round() as u8)
    }

    /// Counts values into `parts` equal parts of a range, those beyond it into the first and the last.
    pub fn count(values: impl IntoIterator<Item = f64>, [low, high]: [f64; 2], parts: usize) -> Vec<u64> {
        let mut counts = vec![0u64; parts];
        let span = high - low;
        for value in values.into_iter().filter(|value| value.is_finite() && span > 0.0 && parts > 0) {
            let part = ((value - low) / span * parts as f64).clamp(0.0, parts as f64 - 1.0);
            counts[part as usize] += 1;
        }
        counts
    }

    /// The comments, without the word `comment`.
    pub fn comments(&self) -> [String; 3] {
        let stops: Vec<String> = self.stops.iter().map(|[r, g, b]| format!("#{r:02X}{g:02X}{b:02X}")).collect();
        let counts: Vec<String> = self.histogram.iter().map(u64::to_string).collect();
        [
            format!("colour scale {} {} {}", self.low, self.high, self.title),
            format!("colour stops {}", stops.join(" ")),
            format!("colour histogram {}", counts.join(" ")),
        ]
    }

    /// Adds what a comment says to what was found before.
    pub(super) fn gather(comment: &[u8], found: &mut Self) {
        let Some((what, rest)) = comment.trim_ascii().strip_prefix(b"colour ").and_then(|rest| {
            let at = rest.iter().position(|&byte| byte == b' ')?;
            Some(rest.split_at(at))
        }) else {
            return;
        };
        let text = plain_text(rest, 16 * MOST);
        let mut words = text.split_ascii_whitespace();
        match what {
            b"scale" => {
                let mut number = || words.next()?.parse::<f64>().ok().filter(|value| value.is_finite());
                if let (Some(low), Some(high)) = (number(), number()) {
                    (found.low, found.high) = (low, high);
                    let title: Vec<&str> = words.collect();
                    found.title = plain_text(title.join(" ").as_bytes(), 40);
                }
            }
            b"stops" => {
                let colour = |word: &str| {
                    let number = u32::from_str_radix(word.strip_prefix('#')?, 16).ok().filter(|_| word.len() == 7)?;
                    let [_, r, g, b] = number.to_be_bytes();
                    Some([r, g, b])
                };
                found.stops = words.map_while(colour).take(MOST).collect();
            }
            b"histogram" => found.histogram = words.map_while(|word| word.parse().ok()).take(MOST).collect(),
            _ => {}
        }
    }

    /// The scale, if all of it was found.
    pub(super) fn whole(self) -> Option<Self> {
        (self.low < self.high && self.stops.len() > 1).then_some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale() -> ColourScale {
        ColourScale {
            title: "signed distance, mm".into(),
            low: -0.25,
            high: 0.25,
            stops: vec![[0, 0, 255], [200, 200, 200], [255, 0, 0]],
            histogram: vec![1, 20, 3],
        }
    }

    fn read(comments: &[String]) -> Option<ColourScale> {
        let mut found = ColourScale::default();
        comments.iter().for_each(|comment| ColourScale::gather(comment.as_bytes(), &mut found));
        found.whole()
    }

    #[test]
    fn scales_read_back() {
        assert_eq!(read(&scale().comments()), Some(scale()));
        assert_eq!(read(&scale().comments()[1..]), None);
        assert_eq!(read(&scale().comments()[..1]), None);
        for text in [
            "colour",
            "colour scale",
            "colour scale 1 nan x",
            "colour scale 2 1 x",
            "colour stops #12 #34",
            "colour other 1",
        ] {
            assert_eq!(read(&[text.into()]), None, "{text}");
        }
        let hostile = format!("colour histogram {}", "9 ".repeat(100_000));
        let mut found = ColourScale::default();
        ColourScale::gather(hostile.as_bytes(), &mut found);
        assert_eq!(found.histogram.len(), MOST);
    }

    #[test]
    fn colours_change_evenly() {
        let scale = scale();
        assert_eq!(
            [-9.0, -0.25, 0.0, 0.25, 9.0].map(|v| scale.colour(v)),
            [[0, 0, 255], [0, 0, 255], [200, 200, 200], [255, 0, 0], [255, 0, 0]]
        );
        assert_eq!(scale.colour(0.125), [228, 100, 100]);
        assert_eq!(scale.colour(f64::NAN), [128; 3]);
    }

    #[test]
    fn what_lies_beyond_counts_at_the_ends() {
        assert_eq!(ColourScale::count([-5.0, 0.1, 0.6, 0.9, 5.0, f64::NAN], [0.0, 1.0], 2), [2, 3]);
        assert_eq!(ColourScale::count([1.0], [1.0, 1.0], 3), [0, 0, 0]);
    }
}
