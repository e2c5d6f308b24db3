//! What a solid is made with, beside what is asked for.

use super::exit::Failure;
use super::length::Scale;
use crate::pipeline::{Advice, Operand, SurfaceOptions};
use crate::progress::Progress;

/// Makes a failure of a pipeline's error.
pub type Failed<'a> = dyn Fn(&dyn Advice) -> Failure + 'a;

/// What a change is made with.
pub struct Site<'a> {
    /// What the solid was made of.
    pub operands: &'a [Operand<'a>],
    /// How new surface is made.
    pub surface: &'a SurfaceOptions,
    /// What lengths are measured against.
    pub scale: &'a Scale,
    /// What an error means.
    pub failed: &'a Failed<'a>,
    /// How far it is, and whether it is to stop.
    pub progress: &'a Progress,
}
