//! Numbers and words in a picture: a font of 5 x 7 dots, enlarged.

use super::image::Image;
use super::letters;

/// Dots across and down.
const DOTS: [u32; 2] = [5, 7];
/// Dots from one character to the next.
const ADVANCE: u32 = DOTS[0] + 1;
/// Almost black.
const INK: [u8; 4] = [30, 32, 38, 255];

/// The rows of a character, the leftmost dot highest.
fn dots(character: char) -> [u8; 7] {
    match character {
        '0' => [0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110],
        '1' => [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        '2' => [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111],
        '3' => [0b11111, 0b00010, 0b00100, 0b00110, 0b00001, 0b10001, 0b01110],
        '4' => [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010],
        '5' => [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110],
        '6' => [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110],
        '7' => [0b11111, 0b00001, 0b00010, 0b00100, 0b00100, 0b01000, 0b01000],
        '8' => [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110],
        '9' => [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100],
        '-' => [0, 0, 0, 0b11111, 0, 0, 0],
        '.' => [0, 0, 0, 0, 0, 0b01100, 0b01100],
        other => letters::dots(other),
    }
}

/// Pixels that `text` takes across and down, when each dot is `scale` pixels wide.
pub(super) fn size(text: &str, scale: u32) -> [u32; 2] {
    let across = (text.chars().count() as u32 * ADVANCE).saturating_sub(1);
    [across * scale, DOTS[1] * scale]
}

/// Draws `text` with its top left corner at (`left`, `top`).
pub(super) fn draw(image: &mut Image, text: &str, [left, top]: [u32; 2], scale: u32) {
    for (n, character) in text.chars().enumerate() {
        let left = left + n as u32 * ADVANCE * scale;
        let rows = dots(character);
        for (y, x) in (0..DOTS[1] * scale).flat_map(|y| (0..DOTS[0] * scale).map(move |x| (y, x))) {
            let lit = rows[(y / scale) as usize] >> (DOTS[0] - 1 - x / scale) & 1 == 1;
            if lit {
                image.set(left + x, top + y, INK);
            }
        }
    }
}
