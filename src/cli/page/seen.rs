//! What a verb has in its hands when it has made a solid.

use crate::cli::input::Input;
use crate::mesh::TriMesh;
use crate::pipeline::{Operand, TriangleKind, TriangleSource};

/// What is known of a solid that was made.
pub struct SolidSeen<'a> {
    /// The files.
    pub inputs: &'a [Input],
    /// What it was made of; negative parts come after the files' own.
    pub operands: &'a [Operand<'a>],
    /// The result, with holes open that were to be left so.
    pub mesh: &'a TriMesh,
    /// Where its triangles come from.
    pub origin: Origin,
    /// The canal that each bounds, from 1; nothing where none were looked for.
    pub canal_of: &'a [u32],
}

/// Where the triangles of a result come from.
pub enum Origin {
    /// As the run has it: where each comes from, and what it is.
    Known(Vec<TriangleSource>, Vec<TriangleKind>),
    /// There are only the files: which triangles are those of the input can be seen, and no more.
    Files,
}
