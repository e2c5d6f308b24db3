//! Why the exact way cannot be gone.

use crate::progress::Stopped;

/// An edge around which the triangles of an operand do not close.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// The number of the operand.
    pub operand: usize,
    /// The ends of the edge, model units.
    pub ends: [[f64; 3]; 2],
}

/// Why there is no exact result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ArrangeError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The triangles of an operand do not close: exact arithmetic does not say what is inside.
    #[error(
        "operand {} has holes: its triangles do not close around {edges} edges, the first of them at {}, {}, {}",
        first.operand, first.ends[0][0], first.ends[0][1], first.ends[0][2]
    )]
    Open {
        /// How many edges are open, once everything is cut.
        edges: usize,
        /// The first of them.
        first: Opening,
        /// For each operand whether it is closed.
        closed: Vec<bool>,
        /// How many triangles were cut, because they touch others.
        cut: usize,
        /// How many of the edges are pieces of rims that run into other triangles.
        rims_cut: usize,
    },
    /// Triangles touch in more places than there may be.
    #[error("triangles touch in {pairs} pairs, more than the {most} that are cut exactly")]
    Crowded {
        /// How many pairs of triangles touch.
        pairs: usize,
        /// How many may.
        most: usize,
    },
    /// No way was found to round the result to numbers that a file holds without its triangles crossing each other.
    #[error("the exact result cannot be rounded to the numbers that files hold without crossing itself")]
    Rounding,
}
