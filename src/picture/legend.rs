//! What colours mean: patches of colour beside words.

use super::image::Image;
use super::subject::DefectCounts;
use super::text::{Anchor, Pen};
use crate::digits::count;
use crate::io::LegendEntry;

/// The colours of defects in a picture, sRGB: open edges, edges of more than two triangles, triangles that intersect others, lines along which they cross, inner
/// sides.
pub const DEFECT_COLOURS: [[u8; 3]; 5] = [[237, 0, 39], [230, 0, 206], [255, 211, 0], [0, 48, 220], [212, 101, 63]];

/// The colour of outer sides, sRGB.
const OUTER: [u8; 3] = [190, 203, 217];

/// The entries for what is wrong with a mesh, with how many there are of each; where nothing is, one that says so.
pub fn defect_legend(found: &DefectCounts) -> Vec<LegendEntry> {
    let number = |n: usize, one: &str, many: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{} {many}", count(n)),
    };
    let [open, crowded, crossing, curve, inside] = DEFECT_COLOURS;
    let all = [
        (found.open_edges > 0, open, number(found.open_edges, "open edge", "open edges")),
        (
            found.crowded_edges > 0,
            crowded,
            number(found.crowded_edges, "edge of more than two triangles", "edges of more than two triangles"),
        ),
        (
            found.crossing_triangles > 0,
            crossing,
            number(found.crossing_triangles, "crossing triangle", "crossing triangles"),
        ),
        (found.crossing_triangles > 0, curve, "where they cross".into()),
        (found.shows_inside, inside, "inner sides".into()),
    ];
    let entry = |colour, text| LegendEntry { colour, text };
    match *found == DefectCounts::default() {
        true => vec![entry(OUTER, "closed, and nothing crosses".into())],
        false => all.into_iter().filter(|(there, ..)| *there).map(|(_, colour, text)| entry(colour, text)).collect(),
    }
}

/// Entries in lines of a width.
pub(super) struct LegendLines<'a> {
    /// Each entry with the line that it is on, and where on it it begins, pixels.
    entries: Vec<(&'a LegendEntry, u32, f32)>,
}

/// The side of a patch, and what is free after it and after each entry, parts of the letters' size.
const PATCH: f32 = 0.78;
const AFTER_PATCH: f32 = 0.40;
const AFTER_ENTRY: f32 = 1.30;
/// From one line to the next.
pub(super) const LINE: f32 = 1.45;

impl<'a> LegendLines<'a> {
    pub(super) fn new(entries: &'a [LegendEntry], pen: &Pen, width: f32) -> Self {
        let (mut line, mut at) = (0, 0.0);
        let mut placed = Vec::new();
        for entry in entries {
            let wide = Self::wide(entry, pen);
            if at > 0.0 && at + wide > width {
                (line, at) = (line + 1, 0.0);
            }
            placed.push((entry, line, at));
            at += wide + AFTER_ENTRY * pen.size;
        }
        Self { entries: placed }
    }

    /// The width of the widest entry.
    pub(super) fn widest(entries: &[LegendEntry], pen: &Pen) -> f32 {
        entries.iter().map(|entry| Self::wide(entry, pen)).fold(0.0, f32::max)
    }

    fn wide(entry: &LegendEntry, pen: &Pen) -> f32 {
        (PATCH + AFTER_PATCH) * pen.size + pen.width(&entry.text)
    }

    /// How many lines there are.
    pub(super) fn count(&self) -> u32 {
        self.entries.last().map_or(0, |&(_, line, _)| line + 1)
    }

    /// Draws the entries, the first line around the height `top` + half a line.
    pub(super) fn draw(&self, image: &mut Image, pen: &Pen, [left, top]: [f32; 2], width: f32) {
        let side = (PATCH * pen.size).round();
        for &(entry, line, at) in &self.entries {
            let middle = top + (line as f32 + 0.5) * LINE * pen.size;
            let corner = [left + at, middle - side / 2.0].map(|x| x.round().max(0.0) as u32);
            // A thin frame, for light on light.
            image.fill(corner, [side as u32; 2], [110, 114, 120]);
            image.fill(corner.map(|x| x + 1), [(side as u32).saturating_sub(2); 2], entry.colour);
            let from = left + at + side + AFTER_PATCH * pen.size;
            let text = pen.shortened(&entry.text, width - (from - left));
            pen.draw(image, &text, [from, middle], Anchor::Left);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::eyes::{EYES, apart};

    fn entry(colour: [u8; 3], text: &str) -> LegendEntry {
        LegendEntry { colour, text: text.into() }
    }

    #[test]
    fn entries_wrap_and_stay_in_their_order() {
        let entries =
            [entry([200, 10, 10], "one"), entry([10, 200, 10], "a longer one"), entry([10, 10, 200], "three")];
        let pen = Pen::new(16.0);
        assert_eq!(LegendLines::new(&entries, &pen, 1000.0).count(), 1);
        assert_eq!(LegendLines::new(&entries, &pen, 10.0).count(), 3);
        assert_eq!(LegendLines::new(&[], &pen, 10.0).count(), 0);
        let mut image = Image { width: 300, height: 100, rgba: vec![255; 120_000] };
        LegendLines::new(&entries, &pen, 10.0).draw(&mut image, &pen, [5.0, 4.0], 290.0);
        for (line, entry) in entries.iter().enumerate() {
            let middle = 4.0 + (line as f32 + 0.5) * LINE * 16.0;
            let [r, g, b] = entry.colour;
            assert_eq!(image.pixel(11, middle as u32), Some([r, g, b, 255]), "{line}");
        }
    }

    #[test]
    fn every_eye_tells_the_defects_apart() {
        for eye in &EYES {
            for (i, a) in DEFECT_COLOURS.iter().enumerate() {
                for (j, b) in DEFECT_COLOURS.iter().enumerate().take(i) {
                    assert!(apart(*a, *b, eye) > 10.0, "{i} and {j} are {} apart for {eye:?}", apart(*a, *b, eye));
                }
            }
        }
    }

    #[test]
    fn only_what_is_there_is_told_and_how_often() {
        let nothing = defect_legend(&DefectCounts::default());
        assert!(nothing.len() == 1 && nothing[0].text == "closed, and nothing crosses", "{nothing:?}");
        let found = DefectCounts { open_edges: 1, crossing_triangles: 1234, shows_inside: true, ..Default::default() };
        let texts: Vec<String> = defect_legend(&found).into_iter().map(|entry| entry.text).collect();
        assert_eq!(texts, ["1 open edge", "1,234 crossing triangles", "where they cross", "inner sides"]);
    }
}
