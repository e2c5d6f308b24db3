//! From a mesh to an image.

use std::ops::Range;

use rayon::prelude::*;

use super::background::background;
use super::camera::{Camera, Frame, View};
use super::caption::{Caption, Captions};
use super::image::Image;
use super::light::shade;
use super::lines::LinesByBand;
use super::occlusion::occlusion;
use super::options::{BAND, EdgeDrawing, Painted, RenderError, RenderOptions, check_size};
use super::outline::outline;
use super::rgb::{PixelSample, Rgb};
use super::scene::Scene;
use super::sight::{Sight, sight};
use super::subject::Subject;
use crate::progress::Progress;

/// So many surfaces shine through each other.
const LAYERS: usize = 6;

/// How much of a line is seen through a clear surface.
const BEHIND: f32 = 0.35;

/// Draws a mesh, as large as the image allows, without words. Front sides (counter-clockwise) have their colours, or are grey; back sides,
/// which an intact solid never shows, are rust red.
///
/// # Errors
/// [`RenderError::Empty`] for a mesh without triangles, [`RenderError::Size`] for sizes out of range, and [`RenderError::Stopped`].
pub fn render<'a>(
    mesh: impl Into<Painted<'a>>,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Image, RenderError> {
    let subject = Subject::new(mesh, options.defects, progress)?;
    let mut images = render_views(&[subject], &[options.view], options, &[], progress)?;
    images.pop().ok_or(RenderError::Empty)
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
    let subjects = [Subject::new(before, options.defects, progress)?, Subject::new(after, options.defects, progress)?];
    let images = render_views(&subjects, &[options.view], options, &[], progress)?;
    <[Image; 2]>::try_from(images).map_err(|_| RenderError::Empty)
}

/// Draws each mesh from each of some views (that of the options does not count), all in one scale: the views of the first mesh, then those of the next.
/// Each image has the caption of its number in `captions`, if there is one, and all leave the same room for them.
///
/// # Errors
/// As [`render`], but [`RenderError::Empty`] only when no mesh has triangles.
pub fn render_views(
    subjects: &[Subject<'_>],
    views: &[View],
    options: &RenderOptions,
    captions: &[Caption],
    progress: &Progress,
) -> Result<Vec<Image>, RenderError> {
    let &RenderOptions { width, height, supersampling, .. } = options;
    let layers = if options.opacity < 1.0 { LAYERS as u32 } else { 1 };
    check_size([width, height], supersampling, layers)?;
    let words = Captions::new(captions, [width, height]);
    let frame = words.as_ref().map_or(Frame::whole([width, height]), Captions::frame);
    let meshes: Vec<_> = subjects.iter().map(|subject| subject.painted.mesh).collect();
    let cameras = Camera::for_views(views, &meshes, options.focus.as_ref(), options.projection, &frame);
    let cameras = cameras.ok_or(RenderError::Empty)?;
    let mut images = Vec::new();
    for subject in subjects {
        for camera in &cameras {
            let mut image = draw(subject, camera, options, progress)?;
            if let (Some(words), Some(caption)) = (&words, captions.get(images.len())) {
                words.draw(&mut image, caption, camera);
            }
            images.push(image);
        }
    }
    Ok(images)
}

fn draw(
    subject: &Subject<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Image, RenderError> {
    progress.check()?;
    let scene = Scene::new(subject, camera, options, progress)?;
    let (width, height) = (options.width as usize, options.height as usize);
    let samples = options.supersampling as usize;
    let layers = layers(&scene, options, progress)?;
    let front = &layers[0];
    let darkness = match options.occlusion && options.opacity >= 1.0 {
        true => occlusion(&scene, front, progress)?,
        false => vec![0.0; width * height],
    };
    let lines = LinesByBand::new(&scene.lines, height, BAND);
    let opacity = options.opacity.clamp(0.05, 1.0);
    let behind = if opacity < 1.0 { BEHIND } else { 0.0 };
    let mut rgba = vec![0u8; 4 * width * height];
    rgba.par_chunks_mut(4 * width * BAND).enumerate().for_each(|(band, out)| {
        let first = band * BAND;
        let rows = first..first + out.len() / (4 * width);
        let mut colours = shade_band(&scene, &layers, opacity, &darkness, rows.clone());
        if options.edges != EdgeDrawing::None {
            outline(front, rows.clone(), &mut colours);
        }
        lines.draw(band, (&scene, front), rows.clone(), behind, &mut colours);
        let behind = |row: usize| background(options.background, (first + row) as f32 / height.max(2) as f32);
        average(&colours, samples, width, behind, out);
    });
    progress.check()?;
    Ok(Image { width: options.width, height: options.height, rgba })
}

/// What the samples see, first the nearest surfaces; more where they are clear.
fn layers(scene: &Scene, options: &RenderOptions, progress: &Progress) -> Result<Vec<Sight>, RenderError> {
    let size = [options.width as usize, options.height as usize];
    let samples = options.supersampling as usize;
    let mut layers = vec![sight(scene, size, samples, None, progress)?];
    while options.opacity < 1.0 && layers.len() < LAYERS {
        let next = sight(scene, size, samples, layers.last(), progress)?;
        layers.push(next);
    }
    Ok(layers)
}

/// The colour of each sample of some pixel rows; alpha 0 where nothing is seen.
fn shade_band(scene: &Scene, layers: &[Sight], opacity: f32, darkness: &[f32], rows: Range<usize>) -> Vec<PixelSample> {
    let (columns, per_pixel) = (layers[0].columns(), layers[0].samples);
    let sample_rows = rows.start * per_pixel..rows.end * per_pixel;
    let cells = sample_rows.flat_map(|row| (0..columns).map(move |column| (row, column)));
    let shaded = |(row, column): (usize, usize)| {
        let pixel = (row / per_pixel) * (columns / per_pixel) + column / per_pixel;
        let mut sample = PixelSample { colour: Rgb::BLACK, alpha: 0.0 };
        for seen in layers.iter().rev() {
            if let Some(hit) = seen.hit(row, column) {
                sample.cover(shade(scene, hit, seen.position(row, column), darkness[pixel]), opacity);
            }
        }
        sample
    };
    cells.map(shaded).collect()
}

/// The bytes of some pixel rows from their samples; `behind` says what is behind a row.
fn average(
    colours: &[PixelSample],
    samples: usize,
    width: usize,
    behind: impl Fn(usize) -> Option<Rgb>,
    out: &mut [u8],
) {
    let columns = width * samples;
    let share = 1.0 / (samples * samples) as f32;
    for (row, line) in out.chunks_exact_mut(4 * width).enumerate() {
        let behind = behind(row);
        for (column, bytes) in line.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let first = row * samples * columns + column * samples;
            let (mut sum, mut alpha) = (Rgb::BLACK, 0.0);
            for line in 0..samples {
                for sample in &colours[first + line * columns..][..samples] {
                    sum = sum + sample.colour * sample.alpha;
                    alpha += sample.alpha;
                }
            }
            let (sum, alpha) = (sum * share, alpha * share);
            let (colour, opacity) = match behind {
                Some(behind) => (sum + behind * (1.0 - alpha), 1.0),
                None if alpha > 0.0 => (sum * (1.0 / alpha), alpha),
                None => (Rgb::BLACK, 0.0),
            };
            let [r, g, b] = colour.to_srgb();
            *bytes = [r, g, b, (opacity * 255.0 + 0.5) as u8];
        }
    }
}

/// Draws a mesh `frames` times while it turns once about the upward direction of the options' view, all in one scale.
///
/// # Errors
/// As [`render_views`].
pub fn turntable(
    subject: &Subject<'_>,
    frames: usize,
    options: &RenderOptions,
    caption: Option<&Caption>,
    progress: &Progress,
) -> Result<Vec<Image>, RenderError> {
    let angle = |frame: usize| frame as f64 / frames.max(1) as f64 * std::f64::consts::TAU;
    let views: Vec<View> = (0..frames).map(|frame| options.view.turned(angle(frame))).collect();
    let captions: Vec<Caption> =
        caption.into_iter().flat_map(|caption| std::iter::repeat_n(caption.clone(), frames)).collect();
    render_views(std::slice::from_ref(subject), &views, options, &captions, progress)
}
