//! Pictures as files: PNG, animated PNG, JPEG.

use std::io::{self, Write};

use super::image::Image;

/// The quality of JPEG files, 1 to 100: edges stay clean.
const QUALITY: u8 = 90;

impl Image {
    /// Writes the image as a PNG file.
    pub fn write_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut writer = encoder(self, out).write_header()?;
        writer.write_image_data(&self.rgba)?;
        Ok(writer.finish()?)
    }

    /// The bytes of a PNG file. Fails only when the image has no pixels or its fields do not fit together.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        Ok(bytes)
    }

    /// The bytes of a JPEG file, over white where the image is clear. Fails for images without pixels or with a side of more than 65,535.
    pub fn to_jpeg(&self) -> io::Result<Vec<u8>> {
        let [Ok(width), Ok(height)] = [self.width, self.height].map(u16::try_from) else {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "a JPEG file holds at most 65535 pixels along a side",
            ));
        };
        let over_white = |p: &[u8; 4]| {
            let alpha = u32::from(p[3]);
            [p[0], p[1], p[2]].map(|c| ((u32::from(c) * alpha + 255 * (255 - alpha) + 127) / 255) as u8)
        };
        let rgb: Vec<u8> = self.rgba.as_chunks::<4>().0.iter().flat_map(over_white).collect();
        let mut bytes = Vec::new();
        let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, QUALITY);
        // Coloured lines are a few pixels wide.
        encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::F_1_1);
        encoder.encode(&rgb, width, height, jpeg_encoder::ColorType::Rgb).map_err(io::Error::other)?;
        Ok(bytes)
    }
}

/// The bytes of an animated PNG file that shows `frames`, all of one size, one after the other and over again, `rate` of them a second. A program that knows
/// no animations shows the first.
///
/// # Errors
/// Without frames, or where they are not of one size.
pub fn to_animated_png(frames: &[Image], rate: u16) -> io::Result<Vec<u8>> {
    let wrong = |what: &str| io::Error::new(io::ErrorKind::InvalidInput, what);
    let first = frames.first().ok_or_else(|| wrong("an animation has at least one frame"))?;
    if frames.iter().any(|frame| (frame.width, frame.height) != (first.width, first.height)) {
        return Err(wrong("the frames of an animation are of one size"));
    }
    let count = u32::try_from(frames.len()).map_err(|_| wrong("there are too many frames"))?;
    let mut bytes = Vec::new();
    let mut encoder = encoder(first, &mut bytes);
    encoder.set_animated(count, 0)?;
    encoder.set_frame_delay(1, rate.max(1))?;
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(&frame.rgba)?;
    }
    writer.finish()?;
    Ok(bytes)
}

fn encoder<W: Write>(image: &Image, out: W) -> png::Encoder<'static, W> {
    let mut encoder = png::Encoder::new(out, image.width, image.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder
}
