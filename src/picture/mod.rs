//! Pictures, drawn on the CPU: of meshes, shaded, with edges and with defects coloured; and of slices of fields.
//!
//! The way of the data: [`View`] and size make a camera; the mesh in the camera's space makes a
//! scene (triangles, normals, lines); a depth buffer finds what each sample sees, rays how much of the sky that sees;
//! shading, lines and averaging make an [`Image`]. Lengths within are pixels.

mod camera;
mod colour_map;
mod digits;
mod image;
mod legend;
mod letters;
mod light;
mod lines;
mod occlusion;
mod ramp;
mod scene;
mod sight;
mod slice;

use rayon::prelude::*;

pub use camera::View;
pub use image::Image;
pub use legend::draw_legend;
pub use ramp::ramp_colour;
pub use slice::{Axis, SliceColours, SlicePlane, SliceSamples, sample_slice, slice};

use crate::io::Colours;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};
use camera::Camera;
use light::{Rgb, shade};
use lines::LinesByBand;
use occlusion::occlusion;
use scene::Scene;
use sight::{Sight, sight};

/// The most pixels along a side of an image, before supersampling.
const MAX_SIDE: u32 = 16_384;

/// The most samples of an image: what is seen in one takes eight bytes.
const MAX_SAMPLES: u64 = 1 << 27;

/// Rows of pixels that one thread shades at a time.
const BAND: usize = 16;

/// Which edges are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeDrawing {
    /// None.
    None,
    /// Edges whose triangles are more than 30 degrees apart, and those without exactly two triangles.
    #[default]
    Sharp,
    /// All edges, faint where triangles are small, and the sharp ones as above.
    All,
}

/// What is seen where the mesh is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Background {
    /// White, opaque.
    #[default]
    White,
    /// Nothing: alpha 0.
    Transparent,
}

/// Options of [`render`] and [`render_pair`].
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Pixels across, 1 to 16,384.
    pub width: u32,
    /// Pixels down, 1 to 16,384.
    pub height: u32,
    /// From where the mesh is seen.
    pub view: View,
    /// Which edges are drawn.
    pub edges: EdgeDrawing,
    /// Whether defects are coloured: open edges red, edges with more than two triangles magenta, triangles that
    /// intersect others yellow. Vertices of equal coordinates count as one.
    pub defects: bool,
    /// Samples along each side of a pixel, 1 to 8. One draws jagged outlines, 2 is good.
    pub supersampling: u32,
    /// Whether hollows are darkened by the share of the sky that they do not see.
    pub occlusion: bool,
    /// What is behind the mesh.
    pub background: Background,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 768,
            view: View::ISO,
            edges: EdgeDrawing::Sharp,
            defects: false,
            supersampling: 2,
            occlusion: true,
            background: Background::White,
        }
    }
}

/// Why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// Nothing to see.
    #[error("there are no triangles to draw")]
    Empty,
    /// Sides of 0 or over 16,384 pixels, or supersampling out of 1 to 8.
    #[error(
        "a picture of {width} x {height} pixels with {supersampling} x {supersampling} samples each cannot be made: sides go from 1 to 16384, samples from 1 to 8"
    )]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Samples along each side of a pixel.
        supersampling: u32,
    },
}

/// A mesh, and the colours of its front sides.
#[derive(Debug, Clone, Copy)]
pub struct Painted<'a> {
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// Its colours; alpha does not count. `None`: grey.
    pub colours: Option<&'a Colours>,
}

impl<'a> From<&'a TriMesh> for Painted<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self { mesh, colours: None }
    }
}

/// Draws a mesh, as large as the image allows. Front sides (counter-clockwise) have their colours, or are grey; back sides,
/// which an intact solid never shows, are rust red.
pub fn render<'a>(
    mesh: impl Into<Painted<'a>>,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Image, RenderError> {
    let mesh = mesh.into();
    let camera = camera_for(&[mesh.mesh], options)?;
    draw(mesh, &camera, options, progress)
}

/// Draws two meshes with the same camera, so that the images can be laid over each other. A mesh without
/// triangles gives an empty image.
pub fn render_pair<'a>(
    before: impl Into<Painted<'a>>,
    after: impl Into<Painted<'a>>,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<[Image; 2], RenderError> {
    let (before, after) = (before.into(), after.into());
    let camera = camera_for(&[before.mesh, after.mesh], options)?;
    Ok([draw(before, &camera, options, progress)?, draw(after, &camera, options, progress)?])
}

fn camera_for(meshes: &[&TriMesh], options: &RenderOptions) -> Result<Camera, RenderError> {
    let &RenderOptions { width, height, supersampling, .. } = options;
    check_size([width, height], supersampling)?;
    Camera::new(&options.view, meshes, [width, height]).ok_or(RenderError::Empty)
}

fn check_size([width, height]: [u32; 2], supersampling: u32) -> Result<(), RenderError> {
    let side = 1..=MAX_SIDE;
    let samples = u64::from(width) * u64::from(height) * u64::from(supersampling.min(9)).pow(2);
    let small = samples <= MAX_SAMPLES;
    if !side.contains(&width) || !side.contains(&height) || !(1..=8).contains(&supersampling) || !small {
        return Err(RenderError::Size { width, height, supersampling });
    }
    Ok(())
}

fn draw(
    mesh: Painted<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Image, RenderError> {
    progress.check()?;
    let scene = Scene::new(mesh, camera, options, progress)?;
    let (width, height) = (options.width as usize, options.height as usize);
    let samples = options.supersampling as usize;
    let seen = sight(&scene, [width, height], samples, progress)?;
    let darkness = match options.occlusion {
        true => occlusion(&scene, &seen, progress)?,
        false => vec![0.0; width * height],
    };
    let lines = LinesByBand::new(&scene.lines, height, BAND);
    let mut rgba = vec![0u8; 4 * width * height];
    rgba.par_chunks_mut(4 * width * BAND).enumerate().for_each(|(band, out)| {
        let first = band * BAND;
        let rows = out.len() / (4 * width);
        let mut colours = shade_band(&scene, &seen, &darkness, first..first + rows);
        lines.draw(band, &scene, &seen, first..first + rows, &mut colours);
        average(&colours, samples, width, options.background, out);
    });
    progress.check()?;
    Ok(Image { width: options.width, height: options.height, rgba })
}

/// The colour of each sample of some pixel rows; alpha 0 where nothing is seen.
fn shade_band(scene: &Scene, seen: &Sight, darkness: &[f32], rows: std::ops::Range<usize>) -> Vec<Sample> {
    let (columns, per_pixel) = (seen.columns(), seen.samples);
    let sample_rows = rows.start * per_pixel..rows.end * per_pixel;
    let cells = sample_rows.flat_map(|row| (0..columns).map(move |column| (row, column)));
    cells
        .map(|(row, column)| match seen.hit(row, column) {
            None => Sample { colour: Rgb::BLACK, alpha: 0.0 },
            Some(hit) => {
                let pixel = (row / per_pixel) * (columns / per_pixel) + column / per_pixel;
                Sample { colour: shade(scene, hit, seen.position(row, column), darkness[pixel]), alpha: 1.0 }
            }
        })
        .collect()
}

/// A colour in linear light, not multiplied by its alpha.
#[derive(Debug, Clone, Copy)]
struct Sample {
    colour: Rgb,
    alpha: f32,
}

impl Sample {
    /// Lays `colour` over it.
    fn cover(&mut self, colour: Rgb, alpha: f32) {
        let total = alpha + self.alpha * (1.0 - alpha);
        if total > 0.0 {
            self.colour = self.colour * (self.alpha * (1.0 - alpha) / total) + colour * (alpha / total);
            self.alpha = total;
        }
    }
}

/// The bytes of some pixel rows from their samples.
fn average(colours: &[Sample], samples: usize, width: usize, background: Background, out: &mut [u8]) {
    let columns = width * samples;
    let share = 1.0 / (samples * samples) as f32;
    for (pixel, bytes) in out.chunks_exact_mut(4).enumerate() {
        let first = (pixel / width) * samples * columns + (pixel % width) * samples;
        let (mut sum, mut alpha) = (Rgb::BLACK, 0.0);
        for row in 0..samples {
            for sample in &colours[first + row * columns..][..samples] {
                sum = sum + sample.colour * sample.alpha;
                alpha += sample.alpha;
            }
        }
        let (sum, alpha) = (sum * share, alpha * share);
        let (colour, opacity) = match background {
            Background::White => (sum + Rgb::WHITE * (1.0 - alpha), 1.0),
            Background::Transparent if alpha > 0.0 => (sum * (1.0 / alpha), alpha),
            Background::Transparent => (Rgb::BLACK, 0.0),
        };
        bytes[..3].copy_from_slice(&colour.to_srgb());
        bytes[3] = (opacity * 255.0 + 0.5) as u8;
    }
}

#[cfg(test)]
mod tests;
