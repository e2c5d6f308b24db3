//! What fields are made with, and why one cannot be made.

use std::collections::BTreeMap;

use super::table::Reading;
use crate::field::filter::FilterError;
use crate::field::{FillError, Shared};
use crate::lattice::Lattice;
use crate::mesh::Bounds;
use crate::progress::{Progress, Stopped};

/// The operands as fields, each read in the ways that the tree asks for: see [`Node::readings`](super::Node::readings).
pub type Operands = BTreeMap<(usize, Reading), Shared>;

/// Why a tree does not become a field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A field that was to be sampled over a lattice could not be.
    #[error(transparent)]
    Fill(#[from] FillError),
    /// A filter cannot be.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// A shape must have an end here.
    #[error("the shape has no end: intersect it with one that has (`... & box(...)`)")]
    Endless,
    /// A shape must have an inside here.
    #[error("the field is nowhere negative: nothing is inside")]
    Nothing,
    /// A shape of no size is to be given the size of another.
    #[error("a shape without a size cannot be aligned")]
    NoSize,
    /// A shape is to be weighted by its radius.
    #[error("a shape without an inside has no radius to be weighted by")]
    NoRadius,
    /// Points are to be scattered where nothing is.
    #[error("points are scattered in the box of the operands and bodies before them, and there are none")]
    NoBox,
    /// A ramp that begins where it ends.
    #[error("a ramp from {from} to {to} has no length")]
    Ramp {
        /// Where it begins, model units.
        from: f64,
        /// Where it ends, model units.
        to: f64,
    },
    /// A lattice that cannot be.
    #[error("{reason}")]
    Lattice {
        /// Why, in a sentence.
        reason: String,
    },
    /// The tree was not made by the parser: it uses an operand that was not read, or a call lacks fields or arguments.
    #[error("`{name}` lacks what it needs")]
    Incomplete {
        /// The operand or function.
        name: String,
    },
}

/// Makes the lattice around a box with a spacing, model units; without one, with that of the run. Or says why there is none.
pub type MakeLattice<'a> = dyn Fn(&Bounds, Option<f64>) -> Result<Lattice, String> + 'a;

/// What the functions of an expression are made with, besides their fields.
pub struct Site<'a> {
    /// The box around all operands, and around the bodies that were made before; model units.
    pub parts: Option<Bounds>,
    /// Makes lattices for what has to be sampled.
    pub lattice: &'a MakeLattice<'a>,
    /// Lattices take no more bytes than this.
    pub max_memory: Option<u64>,
    /// Progress and cancellation.
    pub progress: &'a Progress,
}
