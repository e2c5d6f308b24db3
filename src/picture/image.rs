//! Finished pictures.

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

    /// Lays a colour over a pixel, which it covers by 0 to 1; no effect beside the image.
    pub(super) fn blend(&mut self, x: u32, y: u32, colour: [u8; 3], cover: f32) {
        let Some([r, g, b, a]) = self.pixel(x, y).filter(|_| cover > 0.0) else { return };
        let cover = cover.min(1.0);
        let below = f32::from(a) / 255.0 * (1.0 - cover);
        let alpha = cover + below;
        let mix = |under: u8, over: u8| ((f32::from(under) * below + f32::from(over) * cover) / alpha + 0.5) as u8;
        let mixed = [mix(r, colour[0]), mix(g, colour[1]), mix(b, colour[2]), (alpha * 255.0 + 0.5) as u8];
        self.set(x, y, mixed);
    }

    /// Fills a rectangle: its left upper corner, its size.
    pub(super) fn fill(&mut self, [left, top]: [u32; 2], [across, down]: [u32; 2], colour: [u8; 3]) {
        let [r, g, b] = colour;
        for y in top..top.saturating_add(down).min(self.height) {
            (left..left.saturating_add(across).min(self.width)).for_each(|x| self.set(x, y, [r, g, b, 255]));
        }
    }

    /// Lays another image over this one, its left upper corner at `left` and `top`. What does not fit is left out.
    fn lay(&mut self, image: &Image, [left, top]: [u32; 2]) {
        let across = image.width.min(self.width.saturating_sub(left)) as usize;
        for (row, pixels) in (top..self.height).zip(image.rgba.chunks_exact(4 * image.width.max(1) as usize)) {
            let at = 4 * (row as usize * self.width as usize + left as usize);
            self.rgba[at..at + 4 * across].copy_from_slice(&pixels[..4 * across]);
        }
    }

    /// One sheet with all images in rows of `columns`, in order, each in the middle of its cell, which is as wide as the widest of its column and
    /// as high as the highest of its row, with small white gaps; clear ones where the first image's first pixel is clear.
    pub fn sheet(images: &[Image], columns: usize) -> Image {
        let columns = columns.clamp(1, images.len().max(1));
        let widths: Vec<u32> =
            (0..columns).map(|c| images.iter().skip(c).step_by(columns).map(|i| i.width).max().unwrap_or(0)).collect();
        let heights: Vec<u32> =
            images.chunks(columns).map(|row| row.iter().map(|i| i.height).max().unwrap_or(0)).collect();
        let largest = images.iter().map(|i| i.width.max(i.height)).max().unwrap_or(0);
        let gap = (f64::from(largest) * GAP).ceil() as u32;
        let total = |sizes: &[u32]| sizes.iter().sum::<u32>() + gap * sizes.len().saturating_sub(1) as u32;
        let (width, height) = (total(&widths), total(&heights));
        let clear = images.first().and_then(|image| image.pixel(0, 0)).is_some_and(|pixel| pixel[3] == 0);
        let fill = if clear { [0; 4] } else { [255; 4] };
        let mut sheet = Image { width, height, rgba: fill.repeat(width as usize * height as usize) };
        for (n, image) in images.iter().enumerate() {
            let (row, column) = (n / columns, n % columns);
            let left = widths[..column].iter().map(|w| w + gap).sum::<u32>() + (widths[column] - image.width) / 2;
            let top = heights[..row].iter().map(|h| h + gap).sum::<u32>() + (heights[row] - image.height) / 2;
            sheet.lay(image, [left, top]);
        }
        sheet
    }
}

/// The part of the larger side that separates images on one sheet.
const GAP: f64 = 0.015;
