//! Where triangles of a result come from.

/// Where a triangle of the result comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TriangleSource {
    /// It lies on a triangle of an operand.
    Operand {
        /// Number of the operand, from 0.
        operand: u32,
        /// Number of the triangle in it.
        triangle: u32,
    },
    /// It closes a hole, or morphology has made it: no triangle of an operand is there.
    Closed,
}
