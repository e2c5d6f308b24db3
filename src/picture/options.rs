//! What is drawn, and how.

use super::camera::{Projection, View};
use super::slice::Axis;
use crate::io::Colours;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::Stopped;

/// The most pixels along a side of an image, before supersampling.
const MAX_SIDE: u32 = 16_384;

/// The most samples of an image: what is seen in one takes eight bytes.
const MAX_SAMPLES: u64 = 1 << 27;

/// Rows of pixels that one thread shades at a time.
pub(super) const BAND: usize = 16;

/// Which edges are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeDrawing {
    /// No edges.
    None,
    /// Edges whose triangles are more than 30 degrees apart, and those without exactly two triangles, where they hang together over a length that can be
    /// seen; and the outline.
    #[default]
    Sharp,
    /// All edges, faint where triangles are small, and the sharp ones as above.
    All,
}

/// What is seen where the mesh is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Background {
    /// Light grey, a little darker below, so that white parts stand out.
    #[default]
    Gradient,
    /// White, opaque.
    White,
    /// Nothing: pixels with alpha 0.
    Transparent,
}

/// A plane perpendicular to an axis, on the viewer's side of which nothing is drawn. Where that cuts through the inside of a mesh without open
/// edges, the cut is hatched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clip {
    /// The axis that the plane is perpendicular to.
    pub axis: Axis,
    /// Where on this axis the plane lies, model units. In a view along the plane what lies beyond goes.
    pub at: f64,
}

/// Options of [`render`](super::render) and [`render_pair`](super::render_pair).
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Pixels across, 1 to 16,384.
    pub width: u32,
    /// Pixels down, 1 to 16,384.
    pub height: u32,
    /// From where the mesh is seen.
    pub view: View,
    /// Whether what is farther away looks smaller.
    pub projection: Projection,
    /// A box that fills the picture, model units, instead of the whole mesh.
    pub focus: Option<Bounds>,
    /// What is cut away.
    pub clip: Option<Clip>,
    /// How much a surface hides of what is behind it: 1 all of it, at least 0.05. Up to six surfaces shine through.
    pub opacity: f32,
    /// Which edges are drawn.
    pub edges: EdgeDrawing,
    /// Whether defects are coloured: open edges red, edges with more than two triangles magenta, triangles that
    /// intersect others yellow, and the lines along which they cross blue. Vertices of equal coordinates count as one.
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
            projection: Projection::Orthographic,
            focus: None,
            clip: None,
            opacity: 1.0,
            edges: EdgeDrawing::Sharp,
            defects: false,
            supersampling: 2,
            occlusion: true,
            background: Background::Gradient,
        }
    }
}

/// Why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// The work was interrupted, or its deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There are no triangles to draw.
    #[error("there are no triangles to draw")]
    Empty,
    /// The picture would have a side of 0 or over 16,384 pixels, too many samples in all, or supersampling out of 1 to 8.
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
    /// The colours of its front sides, of which alpha does not count; `None` for grey.
    pub colours: Option<&'a Colours>,
    /// Whether the colours mean something that a legend explains: then shade changes them little.
    pub is_map: bool,
}

impl<'a> From<&'a TriMesh> for Painted<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self { mesh, colours: None, is_map: false }
    }
}

/// Refuses sizes of images that cannot be made. `layers`: what is seen in each sample, one behind the other.
pub(super) fn check_size([width, height]: [u32; 2], supersampling: u32, layers: u32) -> Result<(), RenderError> {
    let side = 1..=MAX_SIDE;
    let samples = u64::from(width) * u64::from(height) * u64::from(supersampling.min(9)).pow(2) * u64::from(layers);
    let small = samples <= MAX_SAMPLES;
    if !side.contains(&width) || !side.contains(&height) || !(1..=8).contains(&supersampling) || !small {
        return Err(RenderError::Size { width, height, supersampling });
    }
    Ok(())
}
