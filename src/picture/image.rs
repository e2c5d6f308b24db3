//! Finished pictures.

use std::io::{self, Write};

/// The part of the larger side that separates images on one sheet.
const GAP: f64 = 0.015;

/// An image of 8 bits a channel, sRGB, rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green, blue, alpha (not multiplied in) of each pixel.
    pub rgba: Vec<u8>,
}

impl Image {
    /// Writes the image as a PNG file.
    pub fn write_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgba)?;
        Ok(writer.finish()?)
    }

    /// The bytes of a PNG file. Fails only when the image has no pixels or its fields do not fit together.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        Ok(bytes)
    }

    /// The colour of a pixel, if there is one.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        let at = 4 * (y as usize * self.width as usize + x as usize);
        let inside = x < self.width && y < self.height;
        self.rgba.get(at..at + 4).filter(|_| inside).and_then(|p| p.try_into().ok())
    }

    /// Gives a pixel a colour; no effect beside the image.
    pub(super) fn set(&mut self, x: u32, y: u32, colour: [u8; 4]) {
        if x < self.width && y < self.height {
            let at = 4 * (y as usize * self.width as usize + x as usize);
            self.rgba[at..at + 4].copy_from_slice(&colour);
        }
    }

    /// One sheet with all images side by side, in order, centred vertically, with small gaps. Gaps are filled with the colour
    /// of the first image's first pixel.
    pub fn beside(images: &[Image]) -> Image {
        let height = images.iter().map(|i| i.height).max().unwrap_or(0);
        let widest = images.iter().map(|i| i.width.max(i.height)).max().unwrap_or(0);
        let gap = (f64::from(widest) * GAP).ceil() as u32;
        let gaps = gap * images.len().saturating_sub(1) as u32;
        let width = images.iter().map(|i| i.width).sum::<u32>() + gaps;
        let fill = images.first().and_then(|i| i.pixel(0, 0)).unwrap_or([0; 4]);
        let mut rgba = fill.repeat(width as usize * height as usize);
        let mut left = 0;
        for image in images {
            let top = (height - image.height) / 2;
            for (row, pixels) in image.rgba.chunks_exact(4 * image.width.max(1) as usize).enumerate() {
                let at = 4 * ((top as usize + row) * width as usize + left as usize);
                rgba[at..at + pixels.len()].copy_from_slice(pixels);
            }
            left += image.width + gap;
        }
        Image { width, height, rgba }
    }
}
