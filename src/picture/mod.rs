//! Pictures, drawn on the CPU: of meshes, shaded, with edges and with defects coloured; and of slices of fields.
//!
//! The way of the data: a mesh makes a [`Subject`] (normals, edges, defects), whatever it is seen from; [`View`] and size make a camera; both make a
//! scene (triangles, normals, lines on the image); a depth buffer finds what each sample sees, rays how much of the sky that sees;
//! shading, outline, lines and averaging make an [`Image`], around which [`Caption`]s are written. Lengths within are pixels.

mod background;
mod bar;
mod camera;
mod caption;
mod colour_map;
mod encode;
#[cfg(test)]
pub(crate) mod eyes;
mod image;
mod legend;
mod light;
mod line;
mod lines;
mod occlusion;
mod options;
mod outline;
mod ramp;
mod render;
mod rgb;
mod scene;
mod sight;
mod slice;
mod specks;
mod subject;
#[cfg(test)]
mod tests;
mod text;

pub use camera::{Projection, View};
pub use caption::Caption;
pub use encode::to_animated_png;
pub use image::Image;
pub use legend::{DEFECT_COLOURS, defect_legend};
pub use options::{Background, Clip, EdgeDrawing, Painted, RenderError, RenderOptions};
pub use ramp::ramp_colour;
pub use render::{render, render_pair, render_views, turntable};
pub use slice::{Axis, SliceCaption, SliceColours, SlicePlane, SliceSamples, SliceSize, sample_slice, slice};
pub use subject::{DefectCounts, Subject};
