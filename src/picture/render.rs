//! From a mesh to an image.

use std::ops::Range;

use rayon::prelude::*;

use super::camera::Camera;
use super::image::Image;
use super::light::shade;
use super::lines::LinesByBand;
use super::occlusion::occlusion;
use super::options::{BAND, Background, Painted, RenderError, RenderOptions, check_size};
use super::rgb::{PixelSample, Rgb};
use super::scene::Scene;
use super::sight::{Sight, sight};
use crate::mesh::TriMesh;
use crate::progress::Progress;

/// Draws a mesh, as large as the image allows. Front sides (counter-clockwise) have their colours, or are grey; back sides,
/// which an intact solid never shows, are rust red.
///
/// # Errors
/// [`RenderError::Empty`] for a mesh without triangles, [`RenderError::Size`] for sizes out of range, and [`RenderError::Stopped`].
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
///
/// # Errors
/// As [`render`], but [`RenderError::Empty`] only when neither mesh has triangles.
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
fn shade_band(scene: &Scene, seen: &Sight, darkness: &[f32], rows: Range<usize>) -> Vec<PixelSample> {
    let (columns, per_pixel) = (seen.columns(), seen.samples);
    let sample_rows = rows.start * per_pixel..rows.end * per_pixel;
    let cells = sample_rows.flat_map(|row| (0..columns).map(move |column| (row, column)));
    cells
        .map(|(row, column)| match seen.hit(row, column) {
            None => PixelSample { colour: Rgb::BLACK, alpha: 0.0 },
            Some(hit) => {
                let pixel = (row / per_pixel) * (columns / per_pixel) + column / per_pixel;
                PixelSample { colour: shade(scene, hit, seen.position(row, column), darkness[pixel]), alpha: 1.0 }
            }
        })
        .collect()
}

/// The bytes of some pixel rows from their samples.
fn average(colours: &[PixelSample], samples: usize, width: usize, background: Background, out: &mut [u8]) {
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
