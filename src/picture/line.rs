//! Lines over a surface, and what they stand for.

use glam::Vec3;

use super::rgb::Rgb;

/// What a line stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Style {
    /// An edge like any other, drawn with a strength of 0 to 1.
    Plain {
        /// Opacity.
        strength: f32,
    },
    /// A sharp edge, drawn with a strength of 0 to 1.
    Sharp {
        /// Opacity.
        strength: f32,
    },
    /// A part of a line along which triangles cross.
    Crossing,
    /// A line that is laid over the mesh.
    Marked {
        /// Its colour.
        colour: Rgb,
    },
    /// An edge with more than two triangles.
    Crowded,
    /// An edge with one triangle.
    Open,
}

/// Edges and outlines.
pub(super) const INK: Rgb = Rgb::new(0.012, 0.018, 0.03);

impl Style {
    /// Lines of higher rank cover those of lower rank.
    pub(super) fn rank(self) -> u8 {
        match self {
            Self::Plain { .. } => 0,
            Self::Sharp { .. } => 1,
            Self::Crossing => 2,
            Self::Crowded => 3,
            Self::Open => 4,
            Self::Marked { .. } => 5,
        }
    }

    /// Colour, opacity, and width in pixels.
    pub(super) fn pen(self) -> (Rgb, f32, f32) {
        match self {
            Self::Plain { strength } => (INK, 0.45 * strength, 0.8),
            Self::Sharp { strength } => (INK, 0.85 * strength, 1.3),
            Self::Marked { colour } => (colour, 1.0, 2.0),
            Self::Crossing => (Rgb::new(0.0, 0.03, 0.72), 1.0, 2.4),
            Self::Crowded => (Rgb::new(0.80, 0.0, 0.62), 1.0, 3.0),
            Self::Open => (Rgb::new(0.85, 0.0, 0.02), 1.0, 3.0),
        }
    }
}

/// A line in camera space, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) ends: [Vec3; 2],
    pub(super) style: Style,
}

/// An edge of the welded triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawnEdge {
    pub(super) ends: [u32; 2],
    pub(super) style: Style,
    /// Two of its triangles.
    pub(super) triangles: [u32; 2],
}
