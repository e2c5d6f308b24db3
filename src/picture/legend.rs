//! A legend in a corner of a picture: patches of colour and what they mean.

use super::digits;
use super::image::Image;
use crate::io::LegendEntry;

/// Dots of the font between what stands beside each other, and around all.
const GAP: u32 = 3;
/// A patch is so wide and high, dots.
const PATCH: u32 = 9;
/// The picture has a dot of one more pixel for every so many pixels of its height.
const PIXELS_PER_DOT: u32 = 360;
/// At most this part of the width and height of the picture is for the legend.
const MOST: f64 = 0.75;

/// Draws a legend on white, as large as suits the picture, in the corner where it hides least, or in the lower left one if all corners hide
/// the same. Nothing is drawn where there is no room for letters of one pixel a dot.
pub fn draw_legend(image: &mut Image, entries: &[LegendEntry]) {
    let longest = entries.iter().map(|entry| digits::size(&entry.text, 1)[0]).max().unwrap_or(0);
    let [across, down] = [3 * GAP + PATCH + longest, GAP + (PATCH + GAP) * entries.len() as u32];
    let fits = |scale: u32| {
        f64::from(across * scale) <= MOST * f64::from(image.width)
            && f64::from(down * scale) <= MOST * f64::from(image.height)
    };
    let largest = (image.height / PIXELS_PER_DOT).max(1);
    let Some(scale) = (1..=largest).rev().find(|&scale| fits(scale)).filter(|_| !entries.is_empty()) else { return };
    let size = [across * scale, down * scale];
    let [right, low] = [image.width - size[0], image.height - size[1]];
    let corners = [[0, low], [right, low], [0, 0], [right, 0]];
    let Some([left, top]) = corners.into_iter().min_by_key(|&corner| hidden(image, corner, size)) else { return };
    fill(image, [left, top], size, [255; 4]);
    for (n, entry) in (0..).zip(entries) {
        let row = top + (GAP + n * (PATCH + GAP)) * scale;
        let [red, green, blue] = entry.colour;
        // A thin frame, for white on white.
        fill(image, [left + GAP * scale, row], [PATCH * scale; 2], [120, 124, 130, 255]);
        let inner = [left + GAP * scale + 1, row + 1];
        fill(image, inner, [PATCH * scale - 2; 2], [red, green, blue, 255]);
        // The letters are lower than the patch.
        digits::draw(image, &entry.text, [left + (2 * GAP + PATCH) * scale, row + scale], scale);
    }
}

/// How many pixels there are not white.
fn hidden(image: &Image, [left, top]: [u32; 2], [across, down]: [u32; 2]) -> usize {
    let places = (top..top + down).flat_map(|y| (left..left + across).map(move |x| [x, y]));
    places.filter(|&[x, y]| image.pixel(x, y) != Some([255; 4])).count()
}

fn fill(image: &mut Image, [left, top]: [u32; 2], [across, down]: [u32; 2], colour: [u8; 4]) {
    for y in top..top + down {
        (left..left + across).for_each(|x| image.set(x, y, colour));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries() -> Vec<LegendEntry> {
        let entry = |colour, text: &str| LegendEntry { colour, text: text.into() };
        vec![entry([200, 10, 10], "one"), entry([10, 200, 10], "a longer one")]
    }

    fn grey(width: u32, height: u32) -> Image {
        Image { width, height, rgba: [90, 90, 90, 255].repeat((width * height) as usize) }
    }

    #[test]
    fn patches_stand_in_order_beside_their_words() {
        for scale in [1, 2, 3] {
            let mut image = grey(480 * scale, 360 * scale);
            draw_legend(&mut image, &entries());
            let from_below =
                |dots: u32| image.pixel((GAP + 4) * scale, image.height - 1 - dots * scale).expect("there");
            assert_eq!(from_below(GAP + 4)[..3], [10, 200, 10]);
            assert_eq!(from_below(2 * GAP + PATCH + 4)[..3], [200, 10, 10]);
            let ink = image.rgba.chunks(4).filter(|pixel| pixel[..3] == [30, 32, 38]).count() as u32;
            let lit = |c: char| super::super::letters::dots(c).map(u8::count_ones).iter().sum::<u32>();
            assert_eq!(ink, "onea longer one".chars().map(lit).sum::<u32>() * scale * scale);
            // Only the corner is taken.
            assert_eq!(image.pixel(image.width - 1, image.height - 1), Some([90, 90, 90, 255]));
        }
    }

    #[test]
    fn the_corner_that_is_free_is_taken() {
        let [width, height] = [480, 360];
        for free in [[0, 0], [width - 150, 0], [0, height - 40], [width - 150, height - 40]] {
            let mut image = grey(width, height);
            fill(&mut image, free, [150, 40], [255; 4]);
            let before = image.clone();
            draw_legend(&mut image, &entries());
            let changed = |x: u32, y: u32| image.pixel(x, y) != before.pixel(x, y);
            let inside = |x: u32, y: u32| (free[0]..free[0] + 150).contains(&x) && (free[1]..free[1] + 40).contains(&y);
            let cells = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            assert!(cells().all(|(x, y)| !changed(x, y) || inside(x, y)), "{free:?}");
            assert!(cells().any(|(x, y)| changed(x, y)));
        }
    }

    #[test]
    fn small_pictures_and_empty_legends_stay_as_they_are() {
        for (mut image, entries) in [(grey(60, 200), entries()), (grey(300, 20), entries()), (grey(300, 300), vec![])] {
            let before = image.clone();
            draw_legend(&mut image, &entries);
            assert_eq!(image, before);
        }
    }
}
