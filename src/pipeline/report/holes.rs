//! Holes that were closed from their rims alone.

use serde::Serialize;

use crate::fill::{Lid, Rim, Style};

/// A hole and the lid over it. Model units.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FilledHole {
    /// The middle of the rim.
    pub centre: [f64; 3],
    /// Edges of the rim.
    pub edges: usize,
    /// The length of the rim.
    pub perimeter: f64,
    /// The largest distance between two vertices of the rim.
    pub diameter: f64,
    /// The largest distance of a vertex of the rim from its plane.
    pub flatness: f64,
    /// How the lid was made.
    pub style: Style,
    /// Triangles of the lid.
    pub triangles: usize,
    /// Area of the lid, square model units.
    pub area: f64,
}

impl FilledHole {
    /// What there is to say of a rim and its lid.
    pub(crate) fn of(rim: &Rim, lid: &Lid) -> Self {
        Self {
            centre: rim.centre.to_array(),
            edges: rim.vertices.len(),
            perimeter: rim.perimeter,
            diameter: rim.diameter,
            flatness: rim.flatness,
            style: lid.style,
            triangles: lid.triangles.len(),
            area: lid.area,
        }
    }
}
