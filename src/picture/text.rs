//! Words and numbers in a picture, in Roboto.

use ab_glyph::{Font, FontRef, Glyph, Point, PxScale, ScaleFont, point};

use super::image::Image;

const FONT: &[u8] = include_bytes!("font/Roboto-Regular.ttf");

/// Almost black.
pub(super) const INK: [u8; 3] = [30, 32, 38];

/// What is free beside words at the sides of a picture, in letters.
pub(super) const MARGIN: f32 = 0.7;

/// Which place of the text a position is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// Its left end.
    Left,
    /// The middle between left and right.
    Middle,
    /// Its right end.
    Right,
}

/// The font in a size: the height of a line, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) size: f32,
    pub(super) colour: [u8; 3],
}

impl Pen {
    pub(super) fn new(size: f32) -> Self {
        Self { size, colour: INK }
    }

    /// How far a text goes from left to right, pixels.
    pub(super) fn width(&self, text: &str) -> f32 {
        self.laid(text).1
    }

    /// The text, shortened in its middle until it is no wider than `most` pixels.
    pub(super) fn shortened(&self, text: &str, most: f32) -> String {
        let letters: Vec<char> = text.chars().collect();
        let with = |kept: usize| -> String {
            let head = kept.div_ceil(2);
            letters[..head].iter().chain(&['…']).chain(&letters[letters.len() - (kept - head)..]).collect()
        };
        match self.width(text) <= most {
            true => text.to_string(),
            false => (0..letters.len()).rev().map(with).find(|short| self.width(short) <= most).unwrap_or_default(),
        }
    }

    /// Draws a text with the middle of its capitals at height `y`.
    pub(super) fn draw(&self, image: &mut Image, text: &str, [x, y]: [f32; 2], anchor: Anchor) {
        let Ok(font) = FontRef::try_from_slice(FONT) else { return };
        let (glyphs, width) = self.laid(text);
        let left = match anchor {
            Anchor::Left => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::Right => x - width,
        };
        // Capitals of the font are 0.61 of a line high.
        let base = (y + 0.305 * self.size).round();
        for mut glyph in glyphs {
            glyph.position = point(glyph.position.x + left.round(), base);
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|across, down, cover| {
                let at = [corner.x as i64 + i64::from(across), corner.y as i64 + i64::from(down)];
                if let [Ok(x), Ok(y)] = at.map(u32::try_from) {
                    image.blend(x, y, self.colour, cover);
                }
            });
        }
    }

    /// Draws the title of a picture in the room above it, a little larger than other words.
    pub(super) fn draw_title(&self, image: &mut Image, text: &str, above: f32) {
        let title = Self { size: 1.15 * self.size, ..*self };
        let margin = MARGIN * self.size;
        let text = title.shortened(text, image.width as f32 - 2.0 * margin);
        title.draw(image, &text, [margin, 0.55 * above], Anchor::Left);
    }

    /// The letters beside each other from 0 on, and their width.
    fn laid(&self, text: &str) -> (Vec<Glyph>, f32) {
        let Ok(font) = FontRef::try_from_slice(FONT) else { return (Vec::new(), 0.0) };
        let scaled = font.as_scaled(PxScale::from(self.size));
        let (mut glyphs, mut at) = (Vec::new(), 0.0);
        for letter in text.chars().filter(|letter| !letter.is_control()) {
            let id = font.glyph_id(letter);
            glyphs.push(Glyph { id, scale: PxScale::from(self.size), position: Point { x: at, y: 0.0 } });
            at += scaled.h_advance(id);
        }
        (glyphs, at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blank(width: u32, height: u32) -> Image {
        Image { width, height, rgba: vec![255; 4 * (width * height) as usize] }
    }

    fn inked(image: &Image) -> Vec<[u32; 2]> {
        let cells = (0..image.height).flat_map(|y| (0..image.width).map(move |x| [x, y]));
        cells.filter(|&[x, y]| image.pixel(x, y).is_some_and(|p| p[0] < 128)).collect()
    }

    #[test]
    fn every_letter_that_is_used_is_in_the_font() {
        let font = FontRef::try_from_slice(FONT).expect("a font");
        for letter in "AZaz09 .,:;-+±×%°²³µ()/'’“”…–—−≤≥äöüßéñ".chars() {
            assert!(font.glyph_id(letter).0 != 0, "{letter}");
        }
    }

    #[test]
    fn texts_lie_where_they_should() {
        let pen = Pen::new(20.0);
        let width = pen.width("HHHH");
        for (anchor, left) in
            [(Anchor::Left, 100.0), (Anchor::Middle, 100.0 - width / 2.0), (Anchor::Right, 100.0 - width)]
        {
            let mut image = blank(200, 60);
            pen.draw(&mut image, "HHHH", [100.0, 30.0], anchor);
            let dots = inked(&image);
            let [low, high] =
                [dots.iter().map(|d| d[0]).min(), dots.iter().map(|d| d[0]).max()].map(|x| x.expect("ink") as f32);
            assert!((low - left).abs() < 4.0 && (high - left - width).abs() < 4.0, "{anchor:?} {low} {high} {left}");
            let [top, bottom] =
                [dots.iter().map(|d| d[1]).min(), dots.iter().map(|d| d[1]).max()].map(|y| y.expect("ink") as f32);
            assert!(
                ((top + bottom) / 2.0 - 30.0).abs() <= 1.5 && (10.0..16.0).contains(&(bottom - top)),
                "{top} {bottom}"
            );
        }
    }

    #[test]
    fn long_texts_lose_their_middle() {
        let pen = Pen::new(16.0);
        let short = pen.shortened("a_very_long_name_of_a_file.stl", 120.0);
        assert!(short.starts_with("a_very") && short.ends_with(".stl") && short.contains('…'), "{short}");
        assert!(pen.width(&short) <= 120.0 && pen.width(&short) > 100.0);
        assert_eq!(pen.shortened("part.stl", 120.0), "part.stl");
        assert_eq!(pen.shortened("part.stl", 1.0), "");
    }

    #[test]
    fn what_lies_beside_the_picture_is_left_out() {
        let mut image = blank(10, 10);
        Pen::new(40.0).draw(&mut image, "MMMM", [-20.0, 0.0], Anchor::Left);
        assert_eq!(image.rgba.len(), 400);
        assert!(!inked(&image).is_empty());
    }
}
