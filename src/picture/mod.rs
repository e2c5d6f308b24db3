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
mod line;
mod lines;
mod occlusion;
mod options;
mod ramp;
mod render;
mod rgb;
mod scene;
mod sight;
mod slice;
#[cfg(test)]
mod tests;

pub use camera::View;
pub use image::Image;
pub use legend::draw_legend;
pub use options::{Background, EdgeDrawing, Painted, RenderError, RenderOptions};
pub use ramp::ramp_colour;
pub use render::{render, render_pair};
pub use slice::{Axis, SliceColours, SlicePlane, SliceSamples, sample_slice, slice};
