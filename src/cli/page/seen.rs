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
    /// Where each of its triangles comes from.
    pub sources: Vec<TriangleSource>,
    /// What each of them is.
    pub kinds: Vec<TriangleKind>,
    /// The canal that each bounds, from 1; nothing where none were looked for.
    pub canal_of: &'a [u32],
}
