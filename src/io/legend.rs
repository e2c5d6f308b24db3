//! What the colours of a map mean: comments in the header of a PLY file.

use std::fmt;

/// Entries that are read of one file.
const MOST_ENTRIES: usize = 16;

/// Characters of an entry that are read.
const LONGEST_TEXT: usize = 60;

/// The first letters of a text that goes into a picture and onto a terminal.
pub(super) fn plain_text(text: &[u8], most: usize) -> String {
    text.trim_ascii().iter().map(|&byte| char::from(byte)).filter(|c| matches!(c, ' '..='~')).take(most).collect()
}

/// A colour of a map and what it means. As text it is the comment that the reader of PLY knows: `legend #RRGGBB text`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LegendEntry {
    /// Red, green and blue.
    pub colour: [u8; 3],
    /// What the colour means.
    pub text: String,
}

impl fmt::Display for LegendEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.colour;
        write!(f, "legend #{red:02X}{green:02X}{blue:02X} {}", self.text)
    }
}

impl LegendEntry {
    /// The entry in a comment, without the word `comment`, if it is one.
    fn parse(comment: &[u8]) -> Option<Self> {
        let rest = comment.trim_ascii().strip_prefix(b"legend #")?;
        let (digits, text) = rest.split_at_checked(6)?;
        let mut colour = [0; 3];
        for (channel, pair) in colour.iter_mut().zip(digits.chunks_exact(2)) {
            let [high, low] = [pair[0], pair[1]].map(|digit| char::from(digit).to_digit(16));
            *channel = (16 * high? + low?) as u8;
        }
        let text = plain_text(text, LONGEST_TEXT);
        (!text.is_empty()).then_some(Self { colour, text })
    }

    /// Adds the entry in a comment to those of a file.
    pub(super) fn gather(comment: &[u8], legend: &mut Vec<Self>) {
        if legend.len() < MOST_ENTRIES {
            legend.extend(Self::parse(comment));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_read_back_and_nothing_else_does() {
        let entry = LegendEntry { colour: [1, 0xab, 255], text: "kept: as it was".into() };
        assert_eq!(entry.to_string(), "legend #01ABFF kept: as it was");
        assert_eq!(LegendEntry::parse(entry.to_string().as_bytes()), Some(entry));
        for text in ["", "legend", "legend #12345", "legend #12345g x", "legend #123456", "legend #123456 \x1b", "made"]
        {
            assert_eq!(LegendEntry::parse(text.as_bytes()), None, "{text}");
        }
        let hostile = format!("legend #102030 \x1b[31m{}", "x".repeat(1000));
        let text = LegendEntry::parse(hostile.as_bytes()).expect("an entry").text;
        assert!(text.starts_with("[31m") && text.len() == LONGEST_TEXT, "{text}");
        let mut legend = Vec::new();
        (0..100).for_each(|_| LegendEntry::gather(b"legend #102030 x", &mut legend));
        assert_eq!(legend.len(), MOST_ENTRIES);
    }
}
