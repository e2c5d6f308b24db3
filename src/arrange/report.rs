//! What an exact arrangement found and did.

use serde::{Deserialize, Serialize};

/// The account of an exact arrangement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ArrangeReport {
    /// Triangles that took part.
    pub triangles: usize,
    /// Pairs of triangles that touch elsewhere than at common vertices and edges.
    pub pairs: usize,
    /// Triangles that were cut.
    pub cut: usize,
    /// Points that were made where triangles cross.
    pub points: usize,
    /// Segments along which triangles cross.
    pub curves: usize,
    /// Parts of space between the surfaces, the outside among them.
    pub cells: usize,
    /// For each operand, its shells that faced the wrong way and were taken the other way round.
    pub turned: Vec<usize>,
    /// For each operand, the triangles of those shells.
    pub turned_triangles: Vec<usize>,
    /// How often the result was united with itself again, because triangles crossed once their vertices were rounded.
    pub rounds: usize,
    /// Vertices that were moved apart, by a few steps of the numbers in the file, where solids touched at an edge or a vertex alone.
    pub separated: usize,
    /// By how much rounding changed the volume, as a part of it.
    pub volume_error: f64,
}
